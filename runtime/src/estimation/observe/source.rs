//! What is decimated: every column of W and Y at the full rate, a block of samples at a time.
//! Equation numbers are those of Gautier and Briot.

use std::ops::Range;

use super::block::BLOCK;
use super::error::ObserveError;
use super::settings::{Equations, ExtraColumns};
use crate::model::{JointIndex, LINE, Lanes, Line, Model, Robot, States};
use crate::signal::Motion;

/// Most joints that an observation can have.
const MAX_JOINTS: usize = 32;

/// Columns at the full rate.
pub(super) trait Source: Sync {
    /// How many are computed.
    fn width(&self) -> usize;

    /// Those to be filtered: a column that repeats another one is computed and not filtered.
    fn filtered(&self) -> &[usize];

    /// Writes the samples of a range, line by line: the i-th line of column c to `lines[i * width + c]`. At most
    /// [`BLOCK`] samples; `scratch` is for the source alone and is handed in again with the next range.
    fn fill(&self, range: Range<usize>, lines: &mut [Line], scratch: &mut Vec<f64>);

    /// For each equation, where its columns are among the filtered ones.
    fn equations(&self) -> Vec<EquationColumns>;
}

/// Where one equation finds its row.
#[derive(Debug, Clone)]
pub(super) struct EquationColumns {
    /// (place among the filtered columns, unknown), unknowns ascending.
    pub unknowns: Vec<(usize, usize)>,
    /// Place of Y among the filtered columns.
    pub y: usize,
}

/// From one column to the next where a source's parts are computed column by column: not a power of two, which would
/// send all columns to the same lines of the cache.
const STRIDE: usize = BLOCK + LINE;

/// Lays a column of at most [`BLOCK`] samples into the lines.
fn lay(column: &[f64], place: usize, width: usize, lines: &mut [Line]) {
    for (samples, line) in column.chunks(LINE).zip(lines.chunks_exact_mut(width)) {
        let mut all = [0.0; LINE];
        all[..samples.len()].copy_from_slice(samples);
        let [a, b, c, d, e, f, g, h] = all;
        line[place] = [Lanes::new([a, b, c, d]), Lanes::new([e, f, g, h])];
    }
}

pub(super) fn source<'a>(
    equations: Equations,
    model: &'a dyn Model,
    trajectory: usize,
    motion: &'a Motion,
    extra: Option<&'a dyn ExtraColumns>,
) -> Result<Box<dyn Source + 'a>, ObserveError> {
    let n = model.robot().joints();
    if n > MAX_JOINTS {
        return Err(ObserveError::TooManyJoints { found: n });
    }
    check_shape(model.robot(), motion)?;
    Ok(match equations {
        Equations::Torque => Box::new(Torque::new(model, trajectory, motion, extra, n)),
        Equations::Power { closed_form } => {
            let inertial = (0..model.robot().base.len())
                .map(|c| model.robot().standard[model.robot().base[c].standard].kind.is_load())
                .collect();
            let filtered = (0..=model.robot().base.len()).collect();
            Box::new(Power { model, motion, closed_form, inertial, filtered, n })
        }
    })
}

/// Whether a motion is one of this robot's, with channels of one length.
pub(super) fn check_shape(robot: &Robot, motion: &Motion) -> Result<(), ObserveError> {
    let n = robot.joints();
    let samples = motion.q.first().map_or(0, Vec::len);
    for channels in [&motion.q, &motion.dq, &motion.ddq, &motion.torque] {
        if channels.len() != n {
            return Err(ObserveError::Joints {
                motion: motion.name.clone(),
                found: channels.len(),
                expected: n,
            });
        }
        if channels.iter().any(|c| c.len() != samples) {
            return Err(ObserveError::Samples { motion: motion.name.clone() });
        }
    }
    if let Some(&joint) = motion.fixed.iter().find(|&&j| j >= n) {
        let joint = robot.joint_number(JointIndex(joint));
        return Err(ObserveError::FixedJoint { motion: motion.name.clone(), joint });
    }
    Ok(())
}

type Slices<'s> = [[&'s [f64]; MAX_JOINTS]; 3];

/// Positions, velocities and accelerations of a range of samples.
fn slices<'s>(motion: &'s Motion, range: &Range<usize>) -> Slices<'s> {
    let mut slices: Slices<'_> = [[&[]; MAX_JOINTS]; 3];
    for (of_all, signal) in slices.iter_mut().zip([&motion.q, &motion.dq, &motion.ddq]) {
        for (slice, of_joint) in of_all.iter_mut().zip(signal) {
            *slice = &of_joint[range.clone()];
        }
    }
    slices
}

fn states<'s>(slices: &'s Slices<'s>, n: usize) -> States<'s> {
    States { q: &slices[0][..n], dq: &slices[1][..n], ddq: &slices[2][..n] }
}

/// (4): the pattern's entries, then extra columns joint by joint, then the torques.
struct Torque<'a> {
    model: &'a dyn Model,
    trajectory: usize,
    motion: &'a Motion,
    extra: Option<&'a dyn ExtraColumns>,
    filtered: Vec<usize>,
    n: usize,
}

impl<'a> Torque<'a> {
    fn new(
        model: &'a dyn Model,
        trajectory: usize,
        motion: &'a Motion,
        extra: Option<&'a dyn ExtraColumns>,
        n: usize,
    ) -> Torque<'a> {
        let mut torque = Torque { model, trajectory, motion, extra, filtered: Vec::new(), n };
        let same_as = &model.pattern().same_as;
        let distinct = (0..same_as.len()).filter(|&e| same_as[e] == e);
        torque.filtered = distinct.chain(same_as.len()..torque.width()).collect();
        torque
    }

    fn extra_of(&self, joint: usize) -> &[usize] {
        self.extra.map_or(&[], |e| e.columns(joint))
    }

    /// Place of a column among those that are filtered.
    fn place(&self, column: usize) -> usize {
        let column = self.model.pattern().same_as.get(column).copied().unwrap_or(column);
        self.filtered.partition_point(|&c| c < column)
    }
}

impl Source for Torque<'_> {
    fn width(&self) -> usize {
        let extra: usize = (0..self.n).map(|j| self.extra_of(j).len()).sum();
        self.model.pattern().columns.len() + extra + self.n
    }

    fn filtered(&self) -> &[usize] {
        &self.filtered
    }

    fn fill(&self, range: Range<usize>, lines: &mut [Line], scratch: &mut Vec<f64>) {
        let slices = slices(self.motion, &range);
        let width = self.width();
        self.model.idm_lines(states(&slices, self.n), width, lines);
        let mut next = self.model.pattern().columns.len();
        if let Some(extra) = self.extra {
            for joint in 0..self.n {
                let count = extra.columns(joint).len();
                if count == 0 {
                    continue;
                }
                scratch.resize(scratch.len().max(count * STRIDE), 0.0);
                let own = &mut scratch[..count * STRIDE];
                extra.fill(self.trajectory, self.motion, range.clone(), joint, STRIDE, own);
                for column in own.chunks_exact(STRIDE) {
                    lay(&column[..range.len()], next, width, lines);
                    next += 1;
                }
            }
        }
        for torque in &self.motion.torque {
            lay(&torque[range.clone()], next, width, lines);
            next += 1;
        }
    }

    fn equations(&self) -> Vec<EquationColumns> {
        let pattern = self.model.pattern();
        let base = self.model.robot().base.len();
        let mut next = pattern.columns.len();
        let mut equations: Vec<EquationColumns> = (0..self.n)
            .map(|j| {
                let own = pattern.rows[j]..pattern.rows[j + 1];
                let mut unknowns: Vec<_> = own.map(|e| (self.place(e), pattern.columns[e])).collect();
                for &column in self.extra_of(j) {
                    unknowns.push((self.place(next), base + column));
                    next += 1;
                }
                EquationColumns { unknowns, y: 0 }
            })
            .collect();
        for (j, equation) in equations.iter_mut().enumerate() {
            equation.y = self.place(next + j);
        }
        equations
    }
}

/// (11): the columns of dh, then the power P = dqT tau (12).
struct Power<'a> {
    model: &'a dyn Model,
    motion: &'a Motion,
    closed_form: bool,
    /// Columns that have an energy; the others are friction.
    inertial: Vec<bool>,
    filtered: Vec<usize>,
    n: usize,
}

impl Source for Power<'_> {
    fn width(&self) -> usize {
        self.inertial.len() + 1
    }

    fn filtered(&self) -> &[usize] {
        &self.filtered
    }

    fn fill(&self, range: Range<usize>, lines: &mut [Line], scratch: &mut Vec<f64>) {
        let (nb, width) = (self.inertial.len(), self.width());
        let slices = slices(self.motion, &range);
        // The columns and the power; behind them the energies of one sample more on each side.
        scratch.resize((width + nb) * STRIDE, 0.0);
        let (columns, h) = scratch.split_at_mut(width * STRIDE);
        let (dh, power) = columns.split_at_mut(nb * STRIDE);
        self.model.power_block(states(&slices, self.n), STRIDE, dh);
        if !self.closed_form {
            self.differentiate(&range, dh, h);
        }
        for (t, p) in power[..range.len()].iter_mut().enumerate() {
            *p = (0..self.n).map(|j| slices[1][j][t] * self.motion.torque[j][range.start + t]).sum();
        }
        for (place, column) in columns.chunks_exact(STRIDE).enumerate() {
            lay(&column[..range.len()], place, width, lines);
        }
    }

    fn equations(&self) -> Vec<EquationColumns> {
        let nb = self.inertial.len();
        vec![EquationColumns { unknowns: (0..nb).map(|c| (c, c)).collect(), y: nb }]
    }
}

impl Power<'_> {
    /// Replaces the inertial columns by central differences of h(q, dq), as in the paper.
    fn differentiate(&self, range: &Range<usize>, dh: &mut [f64], h: &mut [f64]) {
        let samples = self.motion.q[0].len();
        let wide = range.start.saturating_sub(1)..(range.end + 1).min(samples);
        let slices = slices(self.motion, &wide);
        self.model.energy_block(states(&slices, self.n), STRIDE, h);
        let rate = self.motion.rate;
        let columns = h.chunks_exact(STRIDE).zip(dh.chunks_exact_mut(STRIDE)).zip(&self.inertial);
        for ((h, dh), _) in columns.filter(|&(_, &inertial)| inertial) {
            for (t, value) in dh[..range.len()].iter_mut().enumerate() {
                let centre = range.start + t - wide.start;
                let (before, after) = (centre.saturating_sub(1), (centre + 1).min(wide.len() - 1));
                *value = (h[after] - h[before]) * rate / (after - before) as f64;
            }
        }
    }
}
