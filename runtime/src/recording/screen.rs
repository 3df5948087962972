//! Which rows cannot be right, and where a motion falls apart.

use std::ops::Range;

use super::Reason;
use super::reach::Reach;

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
    let mut rows = Screening { piece, good: vec![true; piece.time.len()], faults: Vec::new() };
    rows.leave_unreadable();
    rows.leave_out_of_reach(reach);
    rows.leave_out_of_order();
    let kept = rows.kept();
    let jumps = Jumps { piece, reach, speed_limits, step: typical_step(&piece.time, &kept) };
    rows.leave_short_runs(&kept, &jumps);
    let (kept, motions, cuts) = rows.leave_isolated(rows_cut(rows.kept(), &jumps));
    let mut faults = rows.faults;
    faults.sort_by_key(|f| f.row);
    Verdict { faults, kept, motions, cuts }
}

/// Rows that stay, unbroken motions as ranges of them, and what separates each motion from the next.
type Motions = (Vec<usize>, Vec<Range<usize>>, Vec<String>);

/// Cuts rows at gaps in time and at jumps.
fn rows_cut(kept: Vec<usize>, jumps: &Jumps<'_>) -> Motions {
    let (mut motions, mut cuts) = (Vec::new(), Vec::new());
    let mut start = 0;
    for k in 1..kept.len() {
        let gap = jumps.piece.time[kept[k]] - jumps.piece.time[kept[k - 1]];
        let what = if gap > longest_gap(jumps.step) {
            Some(format!("no rows for {} s, longer than may be interpolated", four_digits(gap)))
        } else {
            jumps.between(kept[k - 1], kept[k])
        };
        if let Some(what) = what {
            motions.push(start..k);
            cuts.push(what);
            start = k;
        }
    }
    motions.push(start..kept.len());
    (kept, motions, cuts)
}

/// Rows of a piece, and what is wrong with those that are left out.
struct Screening<'a> {
    piece: &'a Piece,
    good: Vec<bool>,
    faults: Vec<Fault>,
}

/// A column of speeds of which more than one row in so many is out of reach has no spikes but another unit: its rows are
/// as right as their positions, and the column is compared with these later. Judgement.
const SPIKES: usize = 20;

impl Screening<'_> {
    fn kept(&self) -> Vec<usize> {
        (0..self.good.len()).filter(|&row| self.good[row]).collect()
    }

    fn leave(&mut self, row: usize, reason: Reason, what: String) {
        self.leave_with(Fault { row, reason, what, elsewhere: None });
    }

    /// A row may be at fault in two files; it counts once.
    fn leave_with(&mut self, fault: Fault) {
        if std::mem::replace(&mut self.good[fault.row], false) {
            self.faults.push(fault);
        }
    }

    fn leave_unreadable(&mut self) {
        for fault in &self.piece.faults {
            self.leave_with(fault.clone());
        }
    }

    fn leave_out_of_reach(&mut self, reach: &Reach) {
        let piece = self.piece;
        for (j, [low, high]) in reach.position.iter().enumerate() {
            for (row, x) in
                piece.position[j].iter().enumerate().filter(|(_, x)| x.is_nan() || *x < low || *x > high)
            {
                let what = format!("position {} of joint {}", four_digits(*x), reach.joint[j]);
                self.leave(row, Reason::OutOfReach, what);
            }
        }
        let bounded =
            [(&piece.velocity, &reach.velocity, "velocity"), (&piece.torque, &reach.torque, "torque")];
        for (channel, bounds, quantity) in bounded {
            for (j, (values, bound)) in channel.iter().zip(bounds).enumerate() {
                let beyond = values.iter().filter(|x| x.abs() > *bound).count();
                if quantity == "velocity" && beyond * SPIKES > values.len() {
                    continue;
                }
                for (row, x) in values.iter().enumerate().filter(|(_, x)| x.is_nan() || x.abs() > *bound) {
                    let what = format!("{quantity} {} of joint {}", four_digits(*x), reach.joint[j]);
                    self.leave(row, Reason::OutOfReach, what);
                }
            }
        }
    }

    fn leave_out_of_order(&mut self) {
        for row in out_of_order(&self.piece.time, &self.good) {
            let what = format!("time {} s does not go forward", self.piece.time[row]);
            self.leave(row, Reason::TimeOrder, what);
        }
    }

    /// Runs between jumps: short ones are garbage, the rest are tied together again where nothing contradicts it.
    fn leave_short_runs(&mut self, kept: &[usize], jumps: &Jumps<'_>) {
        let mut runs: Vec<Range<usize>> = Vec::new();
        let mut between: Vec<String> = Vec::new();
        for k in 0..kept.len() {
            match (k > 0).then(|| jumps.between(kept[k - 1], kept[k])).flatten() {
                None if k > 0 => {
                    if let Some(run) = runs.last_mut() {
                        run.end = k + 1;
                    }
                }
                what => {
                    runs.push(k..k + 1);
                    between.extend(what);
                }
            }
        }
        if runs.len() < 2 {
            return;
        }
        for (r, run) in runs.iter().enumerate().filter(|(_, run)| run.len() < SHORTEST_RUN) {
            let what = &between[r.saturating_sub(1)];
            for &row in &kept[run.clone()] {
                self.leave(row, Reason::Jump, what.clone());
            }
        }
    }

    /// Leaves out motions that are too short for a filter, where there is more than one.
    fn leave_isolated(&mut self, (kept, motions, cuts): Motions) -> Motions {
        if motions.len() < 2 || motions.iter().all(|m| m.len() >= SHORTEST_MOTION) {
            return (kept, motions, cuts);
        }
        let (mut all, mut long, mut between) = (Vec::new(), Vec::new(), Vec::new());
        for (k, motion) in motions.into_iter().enumerate() {
            if motion.len() < SHORTEST_MOTION {
                for &row in &kept[motion.clone()] {
                    let what = format!("one of {} rows between two gaps, too few to filter", motion.len());
                    self.leave(row, Reason::Isolated, what);
                }
                continue;
            }
            let from = all.len();
            all.extend_from_slice(&kept[motion]);
            if from > 0 {
                between.push(cuts[k - 1].clone());
            }
            long.push(from..all.len());
        }
        (all, long, between)
    }
}

/// Steps that no joint can have made.
struct Jumps<'a> {
    piece: &'a Piece,
    reach: &'a Reach,
    /// Whether the reach in velocity is that of limits of the robot.
    speed_limits: bool,
    /// Typical step, s.
    step: f64,
}

impl Jumps<'_> {
    /// What is impossible about the step from row `a` to row `b`.
    fn between(&self, a: usize, b: usize) -> Option<String> {
        let time = &self.piece.time;
        // A stamp may be late or early by some rows' time, so that a short step may be a longer one.
        let dt = (time[b] - time[a]).max(self.step) + (5.0 * self.step).min(0.010);
        self.piece.position.iter().enumerate().find_map(|(j, q)| {
            let speed = (q[b] - q[a]).abs() / dt;
            (speed > self.reach.velocity[j]).then(|| {
                let known = match self.speed_limits {
                    true => "three times its speed limit",
                    false => "what a joint does (no limits.velocity)",
                };
                let (step, speed) = (four_digits(q[b] - q[a]), four_digits(speed));
                format!("joint {} jumps by {step}, {speed} a second: beyond {known}", self.reach.joint[j])
            })
        })
    }
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
fn four_digits(x: f64) -> String {
    if x != 0.0 && !(1e-3..1e5).contains(&x.abs()) { format!("{x:.3e}") } else { format!("{x:.4}") }
}

#[cfg(test)]
#[path = "screen_tests.rs"]
mod tests;
