//! A recording cut into units of a few seconds: what a law's evidence is compared between.

use crate::diagnosis::rows::design::Design;
use std::ops::Range;

/// Shortest and longest unit of a baseline, s: a law must show in one, and what differs between days or poses must not
/// be averaged away. Where the recording's motions are shorter than the longest, units are no longer than they.
const OF_BASELINE: [f64; 2] = [1.0, 12.0];
/// Shortest and longest unit where a recording is compared with itself, s.
const OF_ITSELF: [f64; 2] = [1.0, 8.0];
/// Units that are wanted, where they are not too short or long: a variance of so many has a third of its size as its
/// standard deviation, and a law is certain at a level of 1e-4 where it stands out 6 times.
const WANTED: f64 = 10.0;

/// One unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::diagnosis) struct Unit {
    /// Motion that it is a part of.
    pub file: usize,
    /// Whether it belongs to the recording that is diagnosed.
    pub target: bool,
}

/// Rows of all joints, cut into units.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Units {
    pub units: Vec<Unit>,
    /// Rows of each joint in each unit: `[joint][unit]`.
    pub rows: Vec<Vec<Range<usize>>>,
    /// Neighbouring rows without a gap, never across the border of a unit: `[joint][..]`.
    pub stretches: Vec<Vec<Range<usize>>>,
    /// Mean duration of a unit of the baseline, or of the recording where there is none, s.
    pub duration: f64,
    /// Mean duration of a motion of the recording, s.
    pub target_duration: f64,
}

impl Units {
    /// Units of a design: as long as the recording's motions where there is a baseline, else about ten.
    pub fn of(design: &Design) -> Self {
        let files = design.segments.iter().map(|s| s.signal + 1).max().unwrap_or(0);
        let fresh: Vec<bool> =
            (0..files).map(|f| design.segments.iter().any(|s| s.signal == f && s.is_target)).collect();
        // First and last place of each motion, counted in rows.
        let mut spans = vec![(usize::MAX, 0); files];
        for row in &design.rows {
            let place = row.centre / design.spacing(row.signal);
            let span = &mut spans[row.signal];
            *span = (span.0.min(place), span.1.max(place));
        }
        let seconds = |f: usize| match spans[f] {
            (first, last) if first <= last => (last - first + 1) as f64 * design.step,
            _ => 0.0,
        };
        let sum = |target: bool| (0..files).filter(|&f| fresh[f] == target).map(seconds).sum::<f64>();
        let motions = fresh.iter().filter(|f| **f).count().max(1) as f64;
        let target_duration = sum(true) / motions;
        let change = fresh.iter().any(|f| !f);
        let wanted = if change {
            target_duration.min(sum(false) / WANTED).clamp(OF_BASELINE[0], OF_BASELINE[1])
        } else {
            (sum(true) / WANTED).clamp(OF_ITSELF[0], OF_ITSELF[1])
        };
        let mut units = Vec::new();
        let mut first_unit = vec![0; files];
        let mut counts = vec![1; files];
        for f in 0..files {
            first_unit[f] = units.len();
            counts[f] = if change && fresh[f] { 1 } else { (seconds(f) / wanted).round().max(1.0) as usize };
            units.extend(vec![Unit { file: f, target: fresh[f] }; counts[f]]);
        }
        let cut: Vec<usize> = (0..files).filter(|&f| fresh[f] != change).collect();
        let duration = cut.iter().map(|&f| seconds(f)).sum::<f64>()
            / cut.iter().map(|&f| counts[f]).sum::<usize>().max(1) as f64;
        let of = |r: usize| {
            let row = design.rows[r];
            let (first, last) = spans[row.signal];
            let place = row.centre / design.spacing(row.signal);
            let unit = first_unit[row.signal] + (place - first) * counts[row.signal] / (last - first + 1);
            (unit, place)
        };
        let (mut rows, mut stretches) = (Vec::new(), Vec::new());
        for j in 0..design.joints {
            let mut of_units = vec![0..0; units.len()];
            let mut of_joint: Vec<Range<usize>> = Vec::new();
            let mut before = None;
            for r in design.of_joint(j) {
                let (unit, place) = of(r);
                let range: &mut Range<usize> = &mut of_units[unit];
                let start = if range.end == 0 { r } else { range.start };
                *range = start..r + 1;
                match of_joint.last_mut() {
                    Some(last) if before == Some((unit, place.wrapping_sub(1))) => last.end = r + 1,
                    _ => of_joint.push(r..r + 1),
                }
                before = Some((unit, place));
            }
            rows.push(of_units);
            stretches.push(of_joint);
        }
        Self { units, rows, stretches, duration, target_duration }
    }

    /// Whether there is a baseline.
    pub fn change(&self) -> bool {
        self.units.iter().any(|u| !u.target)
    }
}
