//! Which instants of a motion become rows, and the window that they are seen through.

use crate::diagnosis::rows::signals::Signals;

/// How motions are cut into segments that are held out.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(in crate::diagnosis) struct Cut {
    /// Segments per motion: one, or more where there are few motions to hold out.
    pub segments: usize,
    /// Whether the segments with one number are held out together, those of all motions: where no other motion shows what one
    /// does, as when each moves a joint of its own, or is slow where another is fast.
    pub together: bool,
    /// Whether a single motion is predicted forward in time. Else each of its stretches is from all others, as where what comes
    /// first shows nothing of what comes then.
    pub forward: bool,
}

impl Cut {
    /// Whole motions.
    pub const NOT: Self = Self { segments: 1, together: false, forward: true };
}

/// What decides where rows are.
pub(in crate::diagnosis) struct RowSelection<'a> {
    /// Half-width of the window, s; rows are as far apart.
    pub half: f64,
    /// Least speed per joint.
    pub slowest: &'a [f64],
    /// Linear forms of dq whose sign enters each joint's row.
    pub directions: &'a [Vec<Vec<f64>>],
    /// How the motions of the recording that is diagnosed are cut.
    pub cut: Cut,
    /// Times that no row may use, per signal: `[from, to]`.
    pub excluded: &'a [Vec<[f64; 2]>],
}

impl RowSelection<'_> {
    /// Whether a row of a joint may lie at an instant: the joint moves, what is known of the robot says something of its torque, and
    /// nothing excluded lies in the window.
    pub fn accepts(&self, joint: usize, signal: usize, s: &Signals, centre: usize, half: usize) -> bool {
        let (from, to) = (s.time(centre - half), s.time(centre + half));
        let is_known = |unknown: &Vec<bool>| !unknown[centre - half..=centre + half].contains(&true);
        s.unknown.get(joint).is_none_or(is_known)
            && moves(s, centre, half, &self.directions[joint], self.slowest)
            && !self.excluded[signal].iter().any(|w| w[0] < to && w[1] > from)
    }
}

/// Hann window of half-width `half`, its taps adding up to 1.
pub(in crate::diagnosis) fn hann(half: usize) -> Vec<f64> {
    let n = 2 * half + 1;
    let taps: Vec<f64> =
        (0..n).map(|k| (std::f64::consts::PI * (k + 1) as f64 / (n + 1) as f64).sin().powi(2)).collect();
    let sum: f64 = taps.iter().sum();
    taps.iter().map(|t| t / sum).collect()
}

/// Whether every sign that enters the row is certain all over the window.
fn moves(s: &Signals, centre: usize, half: usize, directions: &[Vec<f64>], slowest: &[f64]) -> bool {
    directions.iter().all(|form| {
        // A motor that turns with several joints is judged by the slowest of their limits.
        let least = form
            .iter()
            .zip(slowest)
            .filter(|(f, _)| **f != 0.0)
            .map(|(f, v)| f.abs() * v)
            .fold(f64::INFINITY, f64::min);
        let speed = |t: usize| form.iter().zip(&s.dq).map(|(f, v)| f * v[t]).sum::<f64>();
        let sign = speed(centre).signum();
        (centre - half..=centre + half).all(|t| speed(t) * sign > least)
    })
}
