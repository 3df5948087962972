//! The rows of a diagnosis: torques and columns smoothed by one compact window, kept where a joint surely moves.
//!
//! The window is a Hann window with positive taps and exact support, so that a row knows nothing of what happens
//! outside of it: rows near a standstill, where sign(v) is noise, are left out without a trace. Torque and every
//! column go through the same window, which is the parallel decimation of the paper's IV.A.

use crate::diagnosis::rows::signals::{Signals, each_block};
use crate::model::Model;
use std::collections::BTreeSet;
use std::ops::Range;

/// Longest block of motion, s.
pub(in crate::diagnosis) const LONGEST_BLOCK: f64 = 0.5;
/// From this many blocks of that length on, their gains are compared.
const ENOUGH_BLOCKS: usize = 24;

/// One row.
#[derive(Debug, Clone, Copy)]
pub(in crate::diagnosis) struct RowAt {
    pub signal: usize,
    pub centre: usize,
}

/// A stretch of motion that is held back together.
#[derive(Debug, Clone, Copy)]
pub(in crate::diagnosis) struct Segment {
    pub signal: usize,
    pub fresh: bool,
}

/// Rows of all joints and their columns. Rows are sorted by joint, then segment, then time.
#[derive(Clone)]
pub(in crate::diagnosis) struct Design {
    pub joints: usize,
    /// Base parameters; columns beyond them are accepted effects and nuisances.
    pub parameters: usize,
    pub rows: Vec<RowAt>,
    /// `ranges[joint][segment]`.
    pub ranges: Vec<Vec<Range<usize>>>,
    pub segments: Vec<Segment>,
    /// One value per row.
    pub columns: Vec<Vec<f64>>,
    pub y: Vec<f64>,
    kernels: Vec<Vec<f64>>,
    /// From one row to the next in a motion, s.
    pub step: f64,
    /// Whether there are too few blocks of motion for gains to be compared block by block.
    pub short: bool,
    /// Inner products of the columns and, last, y: `gram[joint][segment]`, square and row-major.
    pub gram: Vec<Vec<Vec<f64>>>,
}

/// What decides where rows are.
pub(in crate::diagnosis) struct Plan<'a> {
    /// Half-width of the window, s.
    pub half: f64,
    /// Least speed per joint.
    pub slowest: &'a [f64],
    /// Linear forms of dq whose sign enters each joint's row.
    pub directions: &'a [Vec<Vec<f64>>],
    /// Segments per motion of the recording that is diagnosed, where there are few motions to hold back.
    pub chunks: usize,
    /// Times that no row may use, per signal: `[from, to]`.
    pub excluded: &'a [Vec<[f64; 2]>],
}

impl Design {
    pub fn new(model: &dyn Model, signals: &[Signals], plan: &Plan<'_>) -> Self {
        let n = model.robot().joints();
        let parameters = model.robot().base.len();
        let mut design = Self {
            joints: n,
            parameters,
            rows: Vec::new(),
            ranges: vec![Vec::new(); n],
            segments: Vec::new(),
            columns: vec![Vec::new(); parameters],
            y: Vec::new(),
            kernels: signals.iter().map(|s| hann((plan.half * s.rate).round().max(2.0) as usize)).collect(),
            step: plan.half,
            short: false,
            gram: Vec::new(),
        };
        let mut kept: Vec<Vec<Vec<RowAt>>> = vec![Vec::new(); n];
        for (k, s) in signals.iter().enumerate() {
            let half = design.kernels[k].len() / 2;
            let first = s.spoiled.max(half);
            let last = s.len().saturating_sub(first).max(first);
            let chunks = if s.fresh { plan.chunks.max(1) } else { 1 };
            let bounds: Vec<usize> = (0..=chunks).map(|c| first + (last - first) * c / chunks).collect();
            for c in 0..chunks {
                design.segments.push(Segment { signal: k, fresh: s.fresh });
                for (j, kept) in kept.iter_mut().enumerate() {
                    let centres =
                        (bounds[c]..bounds[c + 1]).filter(|t| (t - first).is_multiple_of(half.max(1)));
                    kept.push(
                        centres
                            .filter(|&t| moving(s, t, half, &plan.directions[j], plan.slowest))
                            .filter(|&t| {
                                let (a, b) = (s.time(t - half), s.time(t + half));
                                !plan.excluded[k].iter().any(|w| w[0] < b && w[1] > a)
                            })
                            .map(|t| RowAt { signal: k, centre: t })
                            .collect(),
                    );
                }
            }
        }
        for (j, kept) in kept.into_iter().enumerate() {
            for segment in kept {
                let start = design.rows.len();
                design.rows.extend(segment);
                design.ranges[j].push(start..design.rows.len());
            }
        }
        let fresh = design.rows.iter().filter(|r| signals[r.signal].fresh);
        let per_block = design.rows_within(LONGEST_BLOCK);
        let blocks: BTreeSet<(usize, usize)> = fresh.map(|&r| design.block(r, per_block)).collect();
        design.short = blocks.len() < ENOUGH_BLOCKS;
        design.fill(model, signals);
        design
    }

    fn fill(&mut self, model: &dyn Model, signals: &[Signals]) {
        let m = self.rows.len();
        self.y = vec![0.0; m];
        for column in &mut self.columns {
            *column = vec![0.0; m];
        }
        let pattern = model.pattern().clone();
        for (k, s) in signals.iter().enumerate() {
            // The full-rate rows of one motion, entry by entry.
            let mut full = vec![vec![0.0; s.len()]; pattern.columns.len()];
            each_block(model, s, |first, count, entries| {
                let stride = entries.len() / full.len().max(1);
                for (e, column) in full.iter_mut().enumerate() {
                    column[first..first + count].copy_from_slice(&entries[e * stride..e * stride + count]);
                }
            });
            for j in 0..self.joints {
                for (range, _) in self.of_signal(j, k) {
                    for r in range {
                        let centre = self.rows[r].centre;
                        self.y[r] = self.smooth(k, &s.torque[j], centre);
                        for e in pattern.rows[j]..pattern.rows[j + 1] {
                            let value = self.smooth(k, &full[e], centre);
                            self.columns[pattern.columns[e]][r] = value;
                        }
                    }
                }
            }
        }
        self.refresh();
    }

    /// Whether motions are held back in stretches.
    pub fn in_stretches(&self) -> bool {
        self.segments.windows(2).any(|s| s[0].signal == s[1].signal)
    }

    /// Ranges of a joint's rows in one motion, with their segments.
    pub fn of_signal(&self, joint: usize, signal: usize) -> Vec<(Range<usize>, usize)> {
        (0..self.segments.len())
            .filter(|&g| self.segments[g].signal == signal)
            .map(|g| (self.ranges[joint][g].clone(), g))
            .collect()
    }

    /// Samples from one row to the next in a motion.
    pub fn spacing(&self, signal: usize) -> usize {
        (self.kernels[signal].len() / 2).max(1)
    }

    /// Rows in a stretch of motion of this duration, s.
    pub fn rows_within(&self, duration: f64) -> usize {
        (duration / self.step).ceil() as usize
    }

    /// The block of motion that a row is in, where blocks are `rows` rows long: the same for all joints.
    pub fn block(&self, row: RowAt, rows: usize) -> (usize, usize) {
        (row.signal, row.centre / (self.spacing(row.signal) * rows.max(1)))
    }

    /// All rows of a joint.
    pub fn of_joint(&self, joint: usize) -> Range<usize> {
        let ranges = &self.ranges[joint];
        ranges.first().map_or(0, |r| r.start)..ranges.last().map_or(0, |r| r.end)
    }

    /// A full-rate series seen through the window at one row.
    #[inline]
    pub fn smooth(&self, signal: usize, series: &[f64], centre: usize) -> f64 {
        let kernel = &self.kernels[signal];
        let half = kernel.len() / 2;
        dot(kernel, &series[centre - half..=centre + half])
    }

    /// A full-rate series of one joint in one motion, appended to `out` at the joint's rows of that motion.
    pub fn sample(&self, joint: usize, signal: usize, series: &[f64], out: &mut Vec<f64>) {
        for (range, _) in self.of_signal(joint, signal) {
            out.extend(self.rows[range].iter().map(|r| self.smooth(signal, series, r.centre)));
        }
    }

    /// Leaves out columns that nothing determines.
    pub fn leave_out(&mut self, columns: &[usize]) {
        for &k in columns {
            self.columns[k].fill(0.0);
        }
        self.refresh();
    }

    /// Adds a column given per row.
    pub fn push(&mut self, column: Vec<f64>) {
        self.columns.push(column);
    }

    /// Recomputes the inner products.
    pub fn refresh(&mut self) {
        self.refresh_from(0);
    }

    /// Recomputes the inner products of y and of the columns from `first` on; those before have not changed.
    pub fn refresh_from(&mut self, first: usize) {
        let p = self.columns.len();
        let all: Vec<&[f64]> = self.columns.iter().map(Vec::as_slice).chain([self.y.as_slice()]).collect();
        let old = std::mem::take(&mut self.gram);
        self.gram = (0..self.joints)
            .map(|j| {
                (0..self.segments.len())
                    .map(|g| {
                        let range = self.ranges[j][g].clone();
                        let mut new = vec![0.0; (p + 1) * (p + 1)];
                        let before = old.get(j).and_then(|segments| segments.get(g));
                        let kept = before.map_or(0, |_| first);
                        if let Some(before) = before {
                            let width = before.len().isqrt();
                            for i in 0..kept {
                                new[i * (p + 1)..i * (p + 1) + kept]
                                    .copy_from_slice(&before[i * width..i * width + kept]);
                            }
                        }
                        let live: Vec<usize> =
                            (0..=p).filter(|&k| all[k][range.clone()].iter().any(|&x| x != 0.0)).collect();
                        for (a, &i) in live.iter().enumerate().filter(|(_, i)| **i >= kept) {
                            for &k in &live[..=a] {
                                let value = dot(&all[i][range.clone()], &all[k][range.clone()]);
                                new[i * (p + 1) + k] = value;
                                new[k * (p + 1) + i] = value;
                            }
                        }
                        new
                    })
                    .collect()
            })
            .collect();
    }

    /// Rows of a joint in all segments that `wanted` accepts.
    pub fn count(&self, joint: usize, wanted: impl Fn(usize) -> bool) -> usize {
        (0..self.segments.len()).filter(|&g| wanted(g)).map(|g| self.ranges[joint][g].len()).sum()
    }
}

/// Hann window of half-width `half`, its taps adding up to 1.
fn hann(half: usize) -> Vec<f64> {
    let n = 2 * half + 1;
    let taps: Vec<f64> =
        (0..n).map(|k| (std::f64::consts::PI * (k + 1) as f64 / (n + 1) as f64).sin().powi(2)).collect();
    let sum: f64 = taps.iter().sum();
    taps.iter().map(|t| t / sum).collect()
}

/// Whether every sign that enters the row is certain all over the window.
fn moving(s: &Signals, centre: usize, half: usize, directions: &[Vec<f64>], slowest: &[f64]) -> bool {
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

/// Inner product, in as many partial sums as keep the machine's vector units busy.
#[inline(always)]
pub(in crate::diagnosis) fn dot(a: &[f64], b: &[f64]) -> f64 {
    const SUMS: usize = 16;
    let mut sums = [0.0; SUMS];
    let (ca, cb) = (a.chunks_exact(SUMS), b.chunks_exact(SUMS));
    let tail: f64 = ca.remainder().iter().zip(cb.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in ca.zip(cb) {
        for k in 0..SUMS {
            sums[k] += x[k] * y[k];
        }
    }
    sums.iter().sum::<f64>() + tail
}
