//! Which rows cannot be right, and where a motion falls apart.

use std::ops::Range;

use super::Reason;
use crate::model::{JointIndex, JointKind, JointNumber, Robot};

/// What a joint can do, generously: beyond it a value is garbage, not motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// Per joint, its number in the table.
    pub numbers: Vec<JointNumber>,
    /// Per joint, rad or m.
    pub position: Vec<[f64; 2]>,
    /// Per joint, magnitude, rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Per joint, magnitude, N.m or N.
    pub torque: Vec<f64>,
}

impl Reach {
    /// Twice the range of the position limits about its middle, three times the velocity limit, ten times the
    /// torque limit; where the robot states none: 100 rad or 100 m, 30 rad/s or 20 m/s, 1e5 N.m or N.
    pub fn of(robot: &Robot) -> Self {
        let kinds = robot.joint_kinds();
        let magnitude = |limits: &[[f64; 2]], j: usize| {
            limits.get(j).map(|[low, high]| low.abs().max(high.abs())).filter(|m| m.is_finite() && *m > 0.0)
        };
        let position = |j: usize| match robot.limits.position.get(j) {
            Some([low, high]) if low.is_finite() && high.is_finite() && low < high => {
                let (middle, range) = (0.5 * (low + high), high - low);
                [middle - range, middle + range]
            }
            _ => [-100.0, 100.0],
        };
        let velocity = |(j, kind): (usize, &JointKind)| {
            let unknown = if *kind == JointKind::Prismatic { 20.0 } else { 30.0 };
            magnitude(&robot.limits.velocity, j).map_or(unknown, |v| 3.0 * v)
        };
        Self {
            numbers: (0..kinds.len()).map(|j| robot.joint_number(JointIndex(j))).collect(),
            position: (0..kinds.len()).map(position).collect(),
            velocity: kinds.iter().enumerate().map(velocity).collect(),
            torque: (0..kinds.len())
                .map(|j| magnitude(&robot.limits.torque, j).map_or(1e5, |t| 10.0 * t))
                .collect(),
        }
    }
}

/// Rows of one window, on the joint side, in SI.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Piece {
    pub time: Vec<f64>,
    pub position: Vec<Vec<f64>>,
    pub velocity: Vec<Vec<f64>>,
    pub torque: Vec<Vec<f64>>,
    /// Line of each row in the file of the positions.
    pub lines: Vec<u64>,
    /// Rows at fault already: row, why, what, and the file and line if they are not those of the positions.
    pub faults: Vec<Fault>,
}

/// A row that cannot be right.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Fault {
    pub row: usize,
    pub reason: Reason,
    pub what: String,
    pub elsewhere: Option<(String, u64)>,
}

/// What is left of a piece.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct Verdict {
    /// Rows left out.
    pub faults: Vec<Fault>,
    /// Rows that stay.
    pub kept: Vec<usize>,
    /// Unbroken motions, as ranges of `kept`.
    pub motions: Vec<Range<usize>>,
    /// What separates motion k from motion k + 1.
    pub cuts: Vec<String>,
}

/// Runs of fewer rows than this between two impossible jumps are garbage.
const SHORTEST_RUN: usize = 10;
/// A motion of fewer rows is not worth a filter.
const SHORTEST_MOTION: usize = 32;

/// Steps beyond which nothing is interpolated: five typical steps, and no less than 20 ms.
fn longest_gap(step: f64) -> f64 {
    (5.0 * step).max(0.020)
}

/// Finds the rows that cannot be right, and cuts at gaps in time and at jumps.
///
/// The order matters: unreadable rows, rows out of reach, then stamps (the largest set of rows whose time goes
/// forward stays), then runs of a few rows that no joint could have jumped to and back from.
pub(super) fn screen(piece: &Piece, reach: &Reach, speed_limits: bool) -> Verdict {
    let rows = piece.time.len();
    let mut faults = Vec::new();
    let mut good = vec![true; rows];
    for fault in &piece.faults {
        // A row may be at fault in two files; it counts once.
        if std::mem::replace(&mut good[fault.row], false) {
            faults.push(fault.clone());
        }
    }
    let mut leave = |good: &mut [bool], row: usize, reason: Reason, what: String| {
        if std::mem::replace(&mut good[row], false) {
            faults.push(Fault { row, reason, what, elsewhere: None });
        }
    };
    for (j, [low, high]) in reach.position.iter().enumerate() {
        for (row, x) in
            piece.position[j].iter().enumerate().filter(|(_, x)| x.is_nan() || *x < low || *x > high)
        {
            let what = format!("position {} of joint {}", short(*x), reach.numbers[j]);
            leave(&mut good, row, Reason::OutOfReach, what);
        }
    }
    let bounded = [(&piece.velocity, &reach.velocity, "velocity"), (&piece.torque, &reach.torque, "torque")];
    for (channel, bounds, quantity) in bounded {
        for (j, (values, bound)) in channel.iter().zip(bounds).enumerate() {
            for (row, x) in values.iter().enumerate().filter(|(_, x)| x.is_nan() || x.abs() > *bound) {
                let what = format!("{quantity} {} of joint {}", short(*x), reach.numbers[j]);
                leave(&mut good, row, Reason::OutOfReach, what);
            }
        }
    }
    for row in out_of_order(&piece.time, &good) {
        let what = format!("time {} s does not go forward", piece.time[row]);
        leave(&mut good, row, Reason::TimeOrder, what);
    }
    let kept: Vec<usize> = (0..rows).filter(|&row| good[row]).collect();
    let step = typical_step(&piece.time, &kept);
    let jump = |a: usize, b: usize| -> Option<String> {
        // A stamp may be late or early by some rows' time, so that a short step may be a longer one.
        let dt = (piece.time[b] - piece.time[a]).max(step) + (5.0 * step).min(0.010);
        piece.position.iter().enumerate().find_map(|(j, q)| {
            let speed = (q[b] - q[a]).abs() / dt;
            let bound = reach.velocity[j];
            (speed > bound).then(|| {
                let known = if speed_limits {
                    "three times its speed limit"
                } else {
                    "what a joint does (no limits.velocity)"
                };
                format!(
                    "joint {} jumps by {}, {} a second: beyond {known}",
                    reach.numbers[j],
                    short(q[b] - q[a]),
                    short(speed)
                )
            })
        })
    };
    // Runs between jumps; short ones are garbage, the rest are tied together again where nothing contradicts it.
    let mut runs: Vec<Range<usize>> = Vec::new();
    let mut jumps: Vec<String> = Vec::new();
    for k in 0..kept.len() {
        match (k > 0).then(|| jump(kept[k - 1], kept[k])).flatten() {
            None if k > 0 => {
                if let Some(run) = runs.last_mut() {
                    run.end = k + 1;
                }
            }
            what => {
                runs.push(k..k + 1);
                jumps.extend(what);
            }
        }
    }
    if runs.len() > 1 {
        for (r, run) in runs.iter().enumerate().filter(|(_, run)| run.len() < SHORTEST_RUN) {
            let what = &jumps[if r > 0 { r - 1 } else { 0 }];
            for &row in &kept[run.clone()] {
                leave(&mut good, row, Reason::Jump, what.clone());
            }
        }
    }
    let mut kept: Vec<usize> = kept.into_iter().filter(|&row| good[row]).collect();
    let (mut motions, mut cuts) = (Vec::new(), Vec::new());
    let mut start = 0;
    for k in 1..kept.len() {
        let gap = piece.time[kept[k]] - piece.time[kept[k - 1]];
        let what = if gap > longest_gap(step) {
            Some(format!("no rows for {} s, longer than may be interpolated", short(gap)))
        } else {
            jump(kept[k - 1], kept[k])
        };
        if let Some(what) = what {
            motions.push(start..k);
            cuts.push(what);
            start = k;
        }
    }
    motions.push(start..kept.len());
    if motions.len() > 1 && motions.iter().any(|m| m.len() < SHORTEST_MOTION) {
        for motion in motions.iter().filter(|m| m.len() < SHORTEST_MOTION) {
            for &row in &kept[motion.clone()] {
                let what = format!("one of {} rows between two gaps, too few to filter", motion.len());
                leave(&mut good, row, Reason::Isolated, what);
            }
        }
        let mut all = Vec::new();
        (motions, cuts) = motions.into_iter().enumerate().filter(|(_, m)| m.len() >= SHORTEST_MOTION).fold(
            (Vec::new(), Vec::new()),
            |(mut kept_motions, mut kept_cuts), (k, m)| {
                let from = all.len();
                all.extend_from_slice(&kept[m]);
                if from > 0 {
                    kept_cuts.push(cuts[k - 1].clone());
                }
                kept_motions.push(from..all.len());
                (kept_motions, kept_cuts)
            },
        );
        kept = all;
    }
    faults.sort_by_key(|f| f.row);
    Verdict { faults, kept, motions, cuts }
}

/// The rows to leave out so that time goes strictly forward: all but a longest increasing subsequence
/// (Fredman 1975) of the good rows.
fn out_of_order(time: &[f64], good: &[bool]) -> Vec<usize> {
    let rows: Vec<usize> = (0..time.len()).filter(|&row| good[row]).collect();
    if rows.windows(2).all(|w| time[w[0]] < time[w[1]]) {
        return Vec::new();
    }
    // tails[l]: the row with the smallest time that ends an increasing sequence of length l + 1.
    let mut tails: Vec<usize> = Vec::new();
    let mut before: Vec<Option<usize>> = vec![None; time.len()];
    for &row in &rows {
        let length = tails.partition_point(|&tail| time[tail] < time[row]);
        before[row] = length.checked_sub(1).map(|l| tails[l]);
        match tails.get_mut(length) {
            // The first of equal stamps stays.
            Some(tail) if time[row] < time[*tail] => *tail = row,
            Some(_) => {}
            None => tails.push(row),
        }
    }
    let mut stays = vec![false; time.len()];
    let mut at = tails.last().copied();
    while let Some(row) = at {
        stays[row] = true;
        at = before[row];
    }
    rows.into_iter().filter(|&row| !stays[row]).collect()
}

fn typical_step(time: &[f64], kept: &[usize]) -> f64 {
    let mut steps: Vec<f64> = kept.windows(2).map(|w| time[w[1]] - time[w[0]]).collect();
    if steps.is_empty() {
        return 0.0;
    }
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}

/// Four significant digits.
fn short(x: f64) -> String {
    if x != 0.0 && !(1e-3..1e5).contains(&x.abs()) { format!("{x:.3e}") } else { format!("{x:.4}") }
}

#[cfg(test)]
#[path = "screen_tests.rs"]
mod tests;
