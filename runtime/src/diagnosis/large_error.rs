//! Numbers of one joint that are far off, scanned over values before anything else: the zero of an encoder, as where a table has
//! another convention, and the factor of a drive's torques.
//!
//! The derivative by an angle says where a small one leads, and of a quarter of a turn next to nothing. The model is linear in its
//! parameters at every value, so that each is one fit. A scan needs neither all instants nor the mean of a column over a window:
//! over the width of a window a column bends far less than it differs from that of another angle.

use super::motions::Motions;
use super::rows::design::Design;
use super::rows::fit::Fit;
use super::rules::{
    AS_LITTLE, ERROR_LEAVES, ERROR_REFINED, ERROR_WORSENS, FIT_RIDGE, GAIN_STEP, GAIN_STEPS, LEAST_SCANNED,
    SCANNED_INSTANTS, ZERO_ANGLES,
};
use crate::effects::{EffectKind, Place};
use crate::model::{JointKind, Model, States};
use crate::parallel;
use crate::statistics::golden;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::f64::consts::TAU;

/// Which number of a joint is wrong.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Wrong {
    /// The joint is beyond where its encoder sees it, rad.
    Zero,
    /// Its torques are recorded larger than they are: the logarithm of the factor.
    Gain,
}

/// A number of a joint that is far off.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LargeError {
    pub number: Number,
    pub by: f64,
    /// Logarithm of the part of the squares that the standard model leaves with it, in the mean over joints.
    pub left: f64,
    /// Others that leave as little: of two joints with common parameters, one may record twice its torque or the other half.
    pub rivals: Vec<Number>,
}

/// A number of a joint (0-based).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Number {
    pub joint: usize,
    pub wrong: Wrong,
}

impl Number {
    /// The law of its error.
    pub fn law(&self) -> (EffectKind, Place) {
        match self.wrong {
            Wrong::Zero => (EffectKind::PositionOffset, Place::Variant(self.joint)),
            Wrong::Gain => (EffectKind::TorqueConstantError, Place::Joint(self.joint)),
        }
    }
}

impl Wrong {
    /// Values that are tried, and their distance.
    fn values(self) -> (Vec<f64>, f64) {
        match self {
            Self::Zero => {
                let step = TAU / ZERO_ANGLES as f64;
                ((1..ZERO_ANGLES).map(|k| step * k as f64).collect(), step)
            }
            Self::Gain => {
                let larger = (1..=GAIN_STEPS).map(|k| GAIN_STEP * f64::from(k));
                (larger.flat_map(|by| [by, -by]).collect(), GAIN_STEP)
            }
        }
    }
}

/// The number of one joint with which the standard model leaves least, where that is less than half of what it leaves of any joint
/// without, and of no joint more. Beside a baseline, and where a reference knows them, the parameters are known; then it must leave
/// less than other parameters do. `before` is the fit to a baseline.
pub(super) fn large_error(
    model: &dyn Model,
    motions: &Motions,
    (design, fit): (&Design, &Fit),
    before: Option<&Fit>,
) -> Option<LargeError> {
    let reference = motions.settings().reference.as_ref();
    let known = match before {
        Some(before) => Some(before.chi.iter().take(design.parameters).copied().collect()),
        None => reference.map(|reference| reference.chi().to_vec()),
    };
    let is_known = known.is_some();
    let mut instants = Instants::of(motions, design, known);
    let nothing = (Number { joint: 0, wrong: Wrong::Zero }, 0.0);
    let plain = instants.left(model, fit, nothing)?;
    // Sum of the joints' logarithms, and whether no joint is left with more.
    let beside_plain = |left: &[f64]| -> (f64, bool) {
        let ratios: Vec<f64> =
            left.iter().zip(&plain).filter(|(_, p)| **p > 0.0).map(|(l, p)| l / p).collect();
        let sum: f64 = ratios.iter().map(|r| r.max(f64::MIN_POSITIVE).ln()).sum();
        (sum, ratios.iter().all(|r| *r < ERROR_WORSENS))
    };
    // What a robot carries, and friction that changed, are other parameters: an error must leave less than all of them together.
    let free = if is_known {
        let known = std::mem::replace(&mut instants.known, design.known.clone());
        let free = instants.left(model, fit, nothing).map_or(0.0, |left| beside_plain(&left).0);
        instants.known = known;
        free
    } else {
        0.0
    };
    if instants.are_few() {
        return None;
    }
    let gain = |number: Number, by: f64| -> (f64, bool) {
        instants.left(model, fit, (number, by)).map_or((0.0, false), |left| beside_plain(&left))
    };
    let kinds = model.robot().joint_kinds();
    let number = |wrong: Wrong| move |joint: usize| Number { joint, wrong };
    let zeros = (0..kinds.len()).filter(|&j| kinds[j] == JointKind::Revolute).map(number(Wrong::Zero));
    let numbers: Vec<Number> = zeros.chain((0..kinds.len()).map(number(Wrong::Gain))).collect();
    // Of each number the value that leaves least: the sum of logarithms with it comes first.
    let mut tried: Vec<(f64, f64, Number)> = parallel::map(motions.settings().threads, numbers.len(), |k| {
        let (values, step) = numbers[k].wrong.values();
        let each = values.into_iter().map(|by| (gain(numbers[k], by).0, by));
        let near = each.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, by)| by);
        let sum = |by: f64| Ok::<f64, Infallible>(gain(numbers[k], by).0);
        let Ok(by) = golden::least([near - step, near + step], ERROR_REFINED, sum);
        (gain(numbers[k], by).0, by, numbers[k])
    });
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let &(sum, by, number) = tried.first()?;
    let no_joint_worse = gain(number, by).1;
    let by = if number.wrong == Wrong::Zero && by > 0.5 * TAU { by - TAU } else { by };
    let certain = sum < ERROR_LEAVES.ln().min(free) && no_joint_worse && by.abs() > LEAST_SCANNED;
    let left = sum / plain.len().max(1) as f64;
    let rivals = tried.iter().skip(1).filter(|other| other.0 - sum < AS_LITTLE).map(|other| other.2);
    certain.then(|| LargeError { number, by, left, rivals: rivals.collect() })
}

/// Some instants of the recording that is diagnosed.
struct Instants {
    /// q, dq and ddq, `[j][instant]`.
    states: [Vec<Vec<f64>>; 3],
    /// For each instant the joints that have a row there, with their torques.
    torques: Vec<Vec<(usize, f64)>>,
    joints: usize,
    parameters: usize,
    /// Base parameters whose values are known, all of them where the robot is.
    known: Vec<(usize, f64)>,
}

impl Instants {
    /// `chi` are the base parameters where they are known.
    fn of(motions: &Motions, design: &Design, chi: Option<Vec<f64>>) -> Self {
        let mut rows: BTreeMap<(usize, usize), Vec<(usize, f64)>> = BTreeMap::new();
        for joint in 0..design.joints {
            let own = design.of_joint(joint).map(|r| (design.rows[r], design.torque(r)));
            for (row, torque) in own.filter(|(row, _)| motions.signals[row.signal].is_target) {
                rows.entry((row.signal, row.centre)).or_default().push((joint, torque));
            }
        }
        let every = rows.len().div_ceil(SCANNED_INSTANTS).max(1);
        let kept: Vec<_> = rows.into_iter().step_by(every).collect();
        let of = |k: usize, j: usize| -> Vec<f64> {
            let at = |&((signal, centre), _): &((usize, usize), _)| {
                let s = &motions.signals[signal];
                design.smooth(signal, [&s.q, &s.dq, &s.ddq][k][j].as_slice(), centre)
            };
            kept.iter().map(at).collect()
        };
        let states = [0, 1, 2].map(|k| (0..design.joints).map(|j| of(k, j)).collect());
        let known = chi.map_or_else(|| design.known.clone(), |chi| chi.into_iter().enumerate().collect());
        let (joints, parameters) = (design.joints, design.parameters);
        Self { states, torques: kept.into_iter().map(|(_, t)| t).collect(), joints, parameters, known }
    }

    /// Whether every value would leave next to nothing.
    fn are_few(&self) -> bool {
        let rows: usize = self.torques.iter().map(Vec::len).sum();
        rows < 2 * (self.parameters - self.known.len())
    }

    /// Mean squares of what is left of each joint's torques, where a number of a joint is so far off; 0 for a joint without rows,
    /// `None` where there is no fit.
    fn left(&self, model: &dyn Model, fit: &Fit, error: (Number, f64)) -> Option<Vec<f64>> {
        let (x, mut y) = self.rows(model, fit, error);
        let mut chi = DVector::zeros(self.parameters);
        self.known.iter().for_each(|&(k, value)| chi[k] = value);
        y -= &x * &chi;
        let free: Vec<usize> =
            (0..self.parameters).filter(|k| !self.known.iter().any(|(known, _)| known == k)).collect();
        if !free.is_empty() {
            let x = x.select_columns(&free);
            let mut squares = x.tr_mul(&x);
            for i in 0..free.len() {
                squares[(i, i)] += FIT_RIDGE * squares[(i, i)] + f64::MIN_POSITIVE;
            }
            y -= &x * squares.cholesky()?.solve(&x.tr_mul(&y));
        }
        let mut left = vec![(0.0, 0.0); self.joints];
        for (r, (j, _)) in self.torques.iter().flatten().enumerate() {
            left[*j] = (left[*j].0 + y[r] * y[r], left[*j].1 + 1.0);
        }
        Some(left.into_iter().map(|(sum, count)| if count > 0.0 { sum / count } else { 0.0 }).collect())
    }

    /// Columns and torques in units of the noise of each joint.
    fn rows(
        &self,
        model: &dyn Model,
        fit: &Fit,
        (Number { joint, wrong }, by): (Number, f64),
    ) -> (DMatrix<f64>, DVector<f64>) {
        let pattern = model.pattern();
        let count = self.torques.len();
        let mut states = self.states.clone();
        if wrong == Wrong::Zero {
            states[0][joint].iter_mut().for_each(|q| *q += by);
        }
        let factor = |j: usize| if wrong == Wrong::Gain && j == joint { by.exp() } else { 1.0 };
        let mut entries = vec![0.0; pattern.columns.len() * count];
        let [q, dq, ddq] = [0, 1, 2].map(|k| states[k].iter().map(Vec::as_slice).collect::<Vec<_>>());
        model.idm_block(States { q: &q, dq: &dq, ddq: &ddq }, count, &mut entries);
        let rows = self.torques.iter().map(Vec::len).sum();
        let (mut x, mut y) = (DMatrix::zeros(rows, self.parameters), DVector::zeros(rows));
        let at =
            self.torques.iter().enumerate().flat_map(|(t, torques)| torques.iter().map(move |own| (t, own)));
        for (r, (t, &(j, torque))) in at.enumerate() {
            let weight = 1.0 / fit.sigma[j].max(f64::MIN_POSITIVE);
            y[r] = weight * torque;
            for e in pattern.rows[j]..pattern.rows[j + 1] {
                x[(r, pattern.columns[e])] = weight * factor(j) * entries[e * count + t];
            }
        }
        (x, y)
    }
}
