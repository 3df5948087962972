//! The rows of a diagnosis: torques and columns smoothed by one compact window, kept where a joint surely moves.
//!
//! The window is a Hann window with positive taps and exact support, so that a row knows nothing of what happens
//! outside of it: rows near a standstill, where sign(v) is noise, are left out without a trace. Torque and every
//! column go through the same window, which is the parallel decimation of the paper's IV.A.

use crate::diagnosis::rows::gram::{Gram, dot};
use crate::diagnosis::rows::prior::Prior;
use crate::diagnosis::rows::selection::{RowSelection, hann};
use crate::diagnosis::rows::signals::{Signals, each_block};
use crate::diagnosis::rules::{CURVE_RIDGE, ENOUGH_BLOCKS, FIT_RIDGE, LONGEST_BLOCK};
use crate::model::Model;
use std::collections::BTreeSet;
use std::ops::Range;
use std::sync::Arc;

/// One row.
#[derive(Debug, Clone, Copy)]
pub(in crate::diagnosis) struct RowAt {
    pub signal: usize,
    pub centre: usize,
}

/// A stretch of motion that is held out together.
#[derive(Debug, Clone, Copy)]
pub(in crate::diagnosis) struct Segment {
    pub signal: usize,
    /// Whether it belongs to the recording that is diagnosed; otherwise to the baseline.
    pub is_target: bool,
    /// Its number among the segments of its motion.
    pub part: usize,
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
    /// Whether segments with one number are held out together.
    pub together: bool,
    /// Whether a single motion is predicted forward in time.
    pub forward: bool,
    /// Joints and segments whose torques what is not held out with them does not tell.
    pub untold: Arc<BTreeSet<(usize, usize)>>,
    /// One value per row.
    pub columns: Vec<Vec<f64>>,
    /// Columns of curves, whose amplitudes are kept from what no motion determines.
    pub shrunk: Vec<Range<usize>>,
    /// Torques, less those of parameters whose values are known, and of what terms have taken out of them.
    pub y: Vec<f64>,
    /// Base parameters whose values are known beforehand, ascending: their columns are zero, and a fit has these values.
    pub known: Vec<(usize, f64)>,
    /// The whole torques, in the order of the rows; empty where `y` has all of them.
    whole: Vec<f64>,
    /// What is known of columns beforehand.
    pub prior: Option<Arc<Prior>>,
    kernels: Vec<Vec<f64>>,
    /// From one row to the next in a motion, s.
    pub step: f64,
    /// Whether there are too few blocks of motion for gains to be compared block by block.
    pub short: bool,
    /// Inner products of the columns and y: `[joint][segment]`.
    grams: Vec<Vec<Gram>>,
    /// The same over all segments of a joint.
    sums: Vec<Gram>,
}

impl Design {
    /// Rows of all motions as `selection` has them, with the columns of the standard model.
    pub fn new(model: &dyn Model, signals: &[Signals], selection: &RowSelection<'_>) -> Self {
        let parameters = model.robot().base.len();
        let kernel = |s: &Signals| {
            // A window longer than the motion has no rows, however much longer.
            hann((selection.half * s.rate).round().clamp(2.0, 2.0 + s.len() as f64) as usize)
        };
        let mut design = Self {
            joints: model.robot().joints(),
            parameters,
            rows: Vec::new(),
            ranges: Vec::new(),
            segments: Vec::new(),
            together: selection.cut.together,
            forward: selection.cut.forward,
            untold: Arc::default(),
            columns: vec![Vec::new(); parameters],
            shrunk: Vec::new(),
            y: Vec::new(),
            known: model.robot().fixed_base(),
            whole: Vec::new(),
            prior: None,
            kernels: signals.iter().map(kernel).collect(),
            step: selection.half,
            short: false,
            grams: Vec::new(),
            sums: Vec::new(),
        };
        design.select(signals, selection);
        let targets = design.rows.iter().filter(|r| signals[r.signal].is_target);
        let per_block = design.rows_within(LONGEST_BLOCK);
        let blocks: BTreeSet<(usize, usize)> = targets.map(|&r| design.block(r, per_block)).collect();
        design.short = blocks.len() < ENOUGH_BLOCKS;
        design.fill(model, signals);
        design
    }

    /// Cuts the motions into segments and keeps the instants of each that the selection accepts.
    fn select(&mut self, signals: &[Signals], selection: &RowSelection<'_>) {
        let mut kept: Vec<Vec<Vec<RowAt>>> = vec![Vec::new(); self.joints];
        for (k, s) in signals.iter().enumerate() {
            let half = self.kernels[k].len() / 2;
            let first = s.edge_samples.max(half);
            let last = s.len().saturating_sub(first).max(first);
            let count = if s.is_target { selection.cut.segments.max(1) } else { 1 };
            let bounds: Vec<usize> = (0..=count).map(|c| first + (last - first) * c / count).collect();
            for (part, bound) in bounds.windows(2).enumerate() {
                self.segments.push(Segment { signal: k, is_target: s.is_target, part });
                for (j, kept) in kept.iter_mut().enumerate() {
                    let rows = (bound[0]..bound[1])
                        .filter(|t| (t - first).is_multiple_of(half.max(1)))
                        .filter(|&t| selection.accepts(j, k, s, t, half))
                        .map(|t| RowAt { signal: k, centre: t });
                    kept.push(rows.collect());
                }
            }
        }
        for kept in kept {
            let mut ranges = Vec::with_capacity(kept.len());
            for segment in kept {
                let start = self.rows.len();
                self.rows.extend(segment);
                ranges.push(start..self.rows.len());
            }
            self.ranges.push(ranges);
        }
    }

    /// Torques and columns of the standard model at the rows.
    fn fill(&mut self, model: &dyn Model, signals: &[Signals]) {
        self.columns = self.columns_of(model, signals);
        self.y = vec![0.0; self.rows.len()];
        for (k, s) in signals.iter().enumerate() {
            for j in 0..self.joints {
                for r in self.of_signal(j, k).into_iter().flat_map(|(range, _)| range) {
                    self.y[r] = self.smooth(k, &s.torque[j], self.rows[r].centre);
                }
            }
        }
        self.take_out_known();
        self.refresh();
    }

    /// Columns of a model's base parameters at the rows, with these signals of the motions.
    pub fn columns_of(&self, model: &dyn Model, signals: &[Signals]) -> Vec<Vec<f64>> {
        let mut columns = vec![vec![0.0; self.rows.len()]; self.parameters];
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
                        for e in pattern.rows[j]..pattern.rows[j + 1] {
                            columns[pattern.columns[e]][r] = self.smooth(k, &full[e], centre);
                        }
                    }
                }
            }
        }
        columns
    }

    /// Takes the torques of known parameters from the torques, and their columns from the unknowns.
    fn take_out_known(&mut self) {
        if self.known.is_empty() {
            return;
        }
        self.whole.clone_from(&self.y);
        for &(k, value) in &self.known {
            for (y, x) in self.y.iter_mut().zip(&mut self.columns[k]) {
                *y -= value * std::mem::take(x);
            }
        }
    }

    /// Takes these for the whole torques, of which `y` may be a part.
    pub fn is_part_of(&mut self, whole: &[f64]) {
        self.whole = if self.y == whole { Vec::new() } else { whole.to_vec() };
    }

    /// The whole torque of a row, that of known parameters with it: what errors are relative to.
    pub fn torque(&self, row: usize) -> f64 {
        self.whole.get(row).copied().unwrap_or(self.y[row])
    }

    /// Squares of the whole torques of a joint in one segment.
    pub fn torque_squares(&self, joint: usize, segment: usize) -> f64 {
        match self.whole.is_empty() {
            true => self.gram(joint, segment).y_squares(),
            false => self.ranges[joint][segment].clone().map(|r| self.torque(r).powi(2)).sum(),
        }
    }

    /// Whether motions are held out in stretches.
    pub fn in_stretches(&self) -> bool {
        self.segments.windows(2).any(|s| s[0].signal == s[1].signal)
    }

    /// Whether all segments are stretches of one motion.
    pub fn is_single_motion(&self) -> bool {
        self.segments.windows(2).all(|s| s[0].signal == s[1].signal)
    }

    /// Whether it is a single motion that is predicted forward in time.
    pub fn is_forward(&self) -> bool {
        self.forward && self.is_single_motion()
    }

    /// Segments of the recording that is diagnosed, those that are held out together in one list.
    pub fn held_out_together(&self) -> Vec<Vec<usize>> {
        let targets = self.target_segments();
        if !self.together {
            return targets.into_iter().map(|g| vec![g]).collect();
        }
        let parts = self.segments.iter().map(|s| s.part + 1).max().unwrap_or(0);
        (0..parts)
            .map(|k| targets.iter().copied().filter(|&g| self.segments[g].part == k).collect())
            .collect()
    }

    /// Whether the motion that is not held out with a segment shows the parameters that predict a joint's torques in it. What
    /// is left of them tells of laws then, and of those parameters otherwise.
    pub fn is_told(&self, joint: usize, segment: usize) -> bool {
        !self.untold.contains(&(joint, segment))
    }

    /// Segments of the recording that is diagnosed.
    pub fn target_segments(&self) -> Vec<usize> {
        (0..self.segments.len()).filter(|&g| self.segments[g].is_target).collect()
    }

    /// Inner products on the rows of one joint in one segment.
    pub fn gram(&self, joint: usize, segment: usize) -> &Gram {
        &self.grams[joint][segment]
    }

    /// Inner products on all rows of one joint.
    pub fn gram_of_joint(&self, joint: usize) -> &Gram {
        &self.sums[joint]
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

    /// Where a row is on the grid of its motion, in rows.
    pub fn place(&self, row: usize) -> usize {
        let RowAt { signal, centre, .. } = self.rows[row];
        centre / self.spacing(signal)
    }

    /// The places of each motion from its first row to its last, over all joints; an empty range where it has none.
    pub fn spans(&self) -> Vec<Range<usize>> {
        let motions = self.segments.iter().map(|s| s.signal + 1).max().unwrap_or(0);
        let mut spans = vec![0..0; motions];
        for (r, row) in self.rows.iter().enumerate() {
            let (place, span) = (self.place(r), &mut spans[row.signal]);
            let start = if span.end == 0 { place } else { span.start.min(place) };
            *span = start..span.end.max(place + 1);
        }
        spans
    }

    /// The motions of the recording that is diagnosed, each with its places from its first row to its last.
    pub fn target_spans(&self) -> Vec<(usize, Range<usize>)> {
        let is_target = |motion: usize| self.segments.iter().any(|s| s.signal == motion && s.is_target);
        let spans = self.spans().into_iter().enumerate();
        spans.filter(|(motion, span)| !span.is_empty() && is_target(*motion)).collect()
    }

    /// Rows in a stretch of motion of this duration, s.
    pub fn rows_within(&self, duration: f64) -> usize {
        (duration / self.step).ceil() as usize
    }

    /// The block of motion that a row is in, where blocks are `rows` rows long: the same for all joints.
    pub fn block(&self, row: RowAt, rows: usize) -> (usize, usize) {
        (row.signal, row.centre / self.spacing(row.signal).saturating_mul(rows.max(1)))
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

    /// How many rows of a joint are in one motion.
    pub fn rows_in(&self, joint: usize, signal: usize) -> usize {
        self.of_signal(joint, signal).iter().map(|(range, _)| range.len()).sum()
    }

    /// Leaves out columns that nothing determines.
    pub fn leave_out(&mut self, columns: &[usize]) {
        for &k in columns {
            self.columns[k].fill(0.0);
        }
        self.refresh();
    }

    /// Ridge of a column in a fit, relative to its squares, given the squares of all columns: that of a curve's steps is
    /// the same for all of them, so that a step which hardly shows stays small.
    pub fn ridge(&self, column: usize, squares: impl Fn(usize) -> f64) -> f64 {
        match self.shrunk.iter().find(|r| r.contains(&column)) {
            Some(range) => {
                let largest = range.clone().map(&squares).fold(0.0, f64::max);
                FIT_RIDGE + CURVE_RIDGE * largest / squares(column).max(f64::MIN_POSITIVE)
            }
            None => FIT_RIDGE,
        }
    }

    /// Adds a column given per row.
    pub fn push(&mut self, column: Vec<f64>) {
        self.columns.push(column);
    }

    /// Lets every base parameter be another one in the motions that are wanted; inner products are not recomputed.
    pub fn free_in(&mut self, wanted: impl Fn(usize) -> bool) {
        for c in 0..self.parameters {
            let at = |(x, row): (&f64, &RowAt)| if wanted(row.signal) { *x } else { 0.0 };
            let own = self.columns[c].iter().zip(&self.rows).map(at).collect();
            self.push(own);
        }
    }

    /// Recomputes the inner products.
    pub fn refresh(&mut self) {
        self.refresh_from(0);
    }

    /// Recomputes the inner products of y and of the columns from `first` on; those before have not changed.
    pub fn refresh_from(&mut self, first: usize) {
        let before = std::mem::take(&mut self.grams);
        let gram = |j: usize, g: usize| {
            let range = self.ranges[j][g].clone();
            let columns: Vec<&[f64]> = self.columns.iter().map(|c| &c[range.clone()]).collect();
            let before = before.get(j).and_then(|segments| segments.get(g)).map(|gram| (gram, first));
            Gram::new(&columns, &self.y[range], before)
        };
        let of_joint = |j: usize| (0..self.segments.len()).map(|g| gram(j, g)).collect();
        self.grams = (0..self.joints).map(of_joint).collect();
        self.sums = self.grams.iter().map(|of_joint| Gram::sum(self.columns.len(), of_joint)).collect();
    }

    /// Rows of a joint in all segments that `wanted` accepts.
    pub fn count(&self, joint: usize, wanted: impl Fn(usize) -> bool) -> usize {
        (0..self.segments.len()).filter(|&g| wanted(g)).map(|g| self.ranges[joint][g].len()).sum()
    }
}

#[cfg(test)]
impl Design {
    /// A design without a robot: every joint has `rows` rows in each segment (signal, is_target); columns and y are
    /// given over all rows, sorted by joint, then segment.
    pub fn made_up(
        joints: usize,
        segments: &[(usize, bool)],
        rows: usize,
        columns: Vec<Vec<f64>>,
        y: Vec<f64>,
    ) -> Self {
        let signals = segments.iter().map(|s| s.0 + 1).max().unwrap_or(0);
        let mut design = Self {
            joints,
            parameters: columns.len(),
            rows: Vec::new(),
            ranges: vec![Vec::new(); joints],
            segments: Vec::new(),
            together: false,
            forward: true,
            untold: Arc::default(),
            columns,
            shrunk: Vec::new(),
            y,
            known: Vec::new(),
            whole: Vec::new(),
            prior: None,
            kernels: vec![hann(1); signals],
            step: 0.02,
            short: false,
            grams: Vec::new(),
            sums: Vec::new(),
        };
        for &(signal, is_target) in segments {
            let part = design.segments.iter().filter(|s| s.signal == signal).count();
            design.segments.push(Segment { signal, is_target, part });
        }
        for j in 0..joints {
            let mut next = vec![0; signals];
            for &(signal, _) in segments {
                let start = design.rows.len();
                design
                    .rows
                    .extend((next[signal]..next[signal] + rows).map(|centre| RowAt { signal, centre }));
                next[signal] += rows;
                design.ranges[j].push(start..start + rows);
            }
        }
        design.refresh();
        design
    }
}

#[cfg(test)]
#[path = "known_tests.rs"]
mod known_tests;
