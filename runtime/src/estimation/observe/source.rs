//! What is decimated: every column of W and Y at the full rate, a block of samples at a time.

use std::ops::Range;

use super::{Equations, ExtraColumns, ObserveError};
use crate::model::{Model, ParameterKind, States};
use crate::signal::Motion;

/// Most joints that an observation can have.
const MAX_JOINTS: usize = 32;

/// Columns at the full rate.
pub(super) trait Source: Sync {
    /// How many.
    fn columns(&self) -> usize;

    /// Writes sample `range.start + t` of column c to `out[c * stride + t]`. At most 254 samples; `scratch` is for
    /// the source alone and is handed in again with the next range.
    fn fill(&self, range: Range<usize>, stride: usize, out: &mut [f64], scratch: &mut Vec<f64>);

    /// For each equation, the columns of the source and the unknowns they belong to, ascending, and the column
    /// of Y.
    fn equations(&self) -> Vec<EquationColumns>;
}

/// Where one equation finds its row.
#[derive(Debug, Clone)]
pub(super) struct EquationColumns {
    /// (column of the source, unknown).
    pub unknowns: Vec<(usize, usize)>,
    /// Column of the source that is Y.
    pub y: usize,
}

pub(super) fn source<'a>(
    equations: Equations,
    model: &'a dyn Model,
    trajectory: usize,
    motion: &'a Motion,
    extra: Option<&'a dyn ExtraColumns>,
) -> Result<Box<dyn Source + 'a>, ObserveError> {
    let n = model.robot().joints();
    check(n, motion)?;
    let signals = Signals::new(motion, n);
    Ok(match equations {
        Equations::Torque => Box::new(Torque { model, trajectory, signals, extra, n }),
        Equations::Power { closed_form } => {
            let inertial = (0..model.robot().base.len())
                .map(|c| model.robot().standard[model.robot().base[c].standard].kind <= ParameterKind::Ia)
                .collect();
            Box::new(Power { model, signals, closed_form, inertial, n })
        }
    })
}

fn check(n: usize, motion: &Motion) -> Result<(), ObserveError> {
    if n > MAX_JOINTS {
        return Err(ObserveError::TooManyJoints { found: n });
    }
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
        return Err(ObserveError::FixedJoint { motion: motion.name.clone(), joint: joint + 1 });
    }
    Ok(())
}

/// A motion in which joints that are said to stand still have no speed.
struct Signals<'a> {
    motion: &'a Motion,
    fixed: Vec<bool>,
    zeros: Vec<f64>,
}

type Slices<'s> = [[&'s [f64]; MAX_JOINTS]; 3];

impl<'a> Signals<'a> {
    fn new(motion: &'a Motion, n: usize) -> Signals<'a> {
        let fixed = (0..n).map(|j| motion.fixed.contains(&j)).collect();
        Signals { motion, fixed, zeros: vec![0.0; 256] }
    }

    /// Positions, velocities and accelerations of a range of at most 256 samples.
    fn slices(&self, range: &Range<usize>) -> Slices<'_> {
        let mut slices: Slices<'_> = [[&[]; MAX_JOINTS]; 3];
        for (j, &fixed) in self.fixed.iter().enumerate() {
            slices[0][j] = &self.motion.q[j][range.clone()];
            slices[1][j] = if fixed { &self.zeros[..range.len()] } else { &self.motion.dq[j][range.clone()] };
            slices[2][j] =
                if fixed { &self.zeros[..range.len()] } else { &self.motion.ddq[j][range.clone()] };
        }
        slices
    }
}

fn states<'s>(slices: &'s Slices<'s>, n: usize) -> States<'s> {
    States { q: &slices[0][..n], dq: &slices[1][..n], ddq: &slices[2][..n] }
}

/// (4): the pattern's entries, then extra columns joint by joint, then the torques.
struct Torque<'a> {
    model: &'a dyn Model,
    trajectory: usize,
    signals: Signals<'a>,
    extra: Option<&'a dyn ExtraColumns>,
    n: usize,
}

impl Torque<'_> {
    fn extra_of(&self, joint: usize) -> &[usize] {
        self.extra.map_or(&[], |e| e.columns(joint))
    }
}

impl Source for Torque<'_> {
    fn columns(&self) -> usize {
        let extra: usize = (0..self.n).map(|j| self.extra_of(j).len()).sum();
        self.model.pattern().columns.len() + extra + self.n
    }

    fn fill(&self, range: Range<usize>, stride: usize, out: &mut [f64], _: &mut Vec<f64>) {
        let slices = self.signals.slices(&range);
        let (entries, mut rest) = out.split_at_mut(self.model.pattern().columns.len() * stride);
        self.model.idm_block(states(&slices, self.n), stride, entries);
        if let Some(extra) = self.extra {
            for joint in 0..self.n {
                let (own, others) = rest.split_at_mut(extra.columns(joint).len() * stride);
                if !own.is_empty() {
                    extra.fill(self.trajectory, self.signals.motion, range.clone(), joint, stride, own);
                }
                rest = others;
            }
        }
        for (torque, out) in self.signals.motion.torque.iter().zip(rest.chunks_exact_mut(stride)) {
            out[..range.len()].copy_from_slice(&torque[range.clone()]);
        }
    }

    fn equations(&self) -> Vec<EquationColumns> {
        let pattern = self.model.pattern();
        let base = self.model.robot().base.len();
        let mut next = pattern.columns.len();
        let mut equations: Vec<EquationColumns> = (0..self.n)
            .map(|j| {
                let own = pattern.rows[j]..pattern.rows[j + 1];
                let mut unknowns: Vec<_> = own.map(|e| (e, pattern.columns[e])).collect();
                for &column in self.extra_of(j) {
                    unknowns.push((next, base + column));
                    next += 1;
                }
                EquationColumns { unknowns, y: 0 }
            })
            .collect();
        for (j, equation) in equations.iter_mut().enumerate() {
            equation.y = next + j;
        }
        equations
    }
}

/// (11): the columns of dh, then the power P = dqT tau (12).
struct Power<'a> {
    model: &'a dyn Model,
    signals: Signals<'a>,
    closed_form: bool,
    /// Columns that have an energy; the others are friction.
    inertial: Vec<bool>,
    n: usize,
}

impl Source for Power<'_> {
    fn columns(&self) -> usize {
        self.inertial.len() + 1
    }

    fn fill(&self, range: Range<usize>, stride: usize, out: &mut [f64], scratch: &mut Vec<f64>) {
        let nb = self.inertial.len();
        let slices = self.signals.slices(&range);
        let (dh, power) = out.split_at_mut(nb * stride);
        self.model.power_block(states(&slices, self.n), stride, dh);
        if !self.closed_form {
            self.differentiate(&range, stride, dh, scratch);
        }
        for (t, p) in power[..range.len()].iter_mut().enumerate() {
            *p = (0..self.n).map(|j| slices[1][j][t] * self.signals.motion.torque[j][range.start + t]).sum();
        }
    }

    fn equations(&self) -> Vec<EquationColumns> {
        let nb = self.inertial.len();
        vec![EquationColumns { unknowns: (0..nb).map(|c| (c, c)).collect(), y: nb }]
    }
}

impl Power<'_> {
    /// Replaces the inertial columns by central differences of h(q, dq), as in the paper.
    fn differentiate(&self, range: &Range<usize>, stride: usize, dh: &mut [f64], h: &mut Vec<f64>) {
        let samples = self.signals.motion.q[0].len();
        let wide = range.start.saturating_sub(1)..(range.end + 1).min(samples);
        let slices = self.signals.slices(&wide);
        let nb = self.inertial.len();
        let width = wide.len();
        h.resize(nb * width, 0.0);
        self.model.energy_block(states(&slices, self.n), width, h);
        let rate = self.signals.motion.rate;
        for (c, column) in h.chunks_exact(width).enumerate().filter(|&(c, _)| self.inertial[c]) {
            for (t, value) in dh[c * stride..][..range.len()].iter_mut().enumerate() {
                let centre = range.start + t - wide.start;
                let (before, after) = (centre.saturating_sub(1), (centre + 1).min(width - 1));
                *value = (column[after] - column[before]) * rate / (after - before) as f64;
            }
        }
    }
}
