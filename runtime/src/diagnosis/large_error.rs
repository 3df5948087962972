//! Numbers of joints that are far off, scanned over values before anything else.

use super::motions::Motions;
use super::rows::design::Design;
use super::rows::fit::Fit;
use super::rules::{ERROR_REFINED, GAIN_STEP, GAIN_STEPS, ZERO_ANGLES};
use crate::effects::{EffectKind, Place, corrected_at};
use crate::far_off::{AS_LITTLE, Descent, INSTANTS, Instants, LEAST, LEAVES, Number, Wrong, Zeros, zeros};
use crate::model::{JointKind, Model, RecursiveModel};
use crate::parallel;
use crate::statistics::golden;
use std::collections::BTreeMap;
use std::convert::Infallible;
use std::f64::consts::TAU;

/// Numbers of joints that are far off.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct LargeError {
    /// Each with how far, and others that leave as little in its place: of two joints with common parameters, one may record twice
    /// its torque or the other half.
    pub numbers: Vec<(Number, f64, Vec<Number>)>,
    /// Logarithm of the part of the squares that the standard model leaves with them, in the mean over joints.
    pub left: f64,
}

impl Number {
    /// The law of its error.
    pub fn law(&self) -> (EffectKind, Place) {
        match self.wrong {
            Wrong::Zero => (EffectKind::PositionOffset, Place::Variant(self.joint)),
            Wrong::Gain => (EffectKind::TorqueConstantError, Place::Joint(self.joint)),
        }
    }

    /// Values that are tried, and their distance.
    fn values(self) -> (Vec<f64>, f64) {
        match self.wrong {
            Wrong::Zero => {
                let step = TAU / ZERO_ANGLES as f64;
                ((1..ZERO_ANGLES).map(|k| step * k as f64).collect(), step)
            }
            Wrong::Gain => {
                let larger = (1..=GAIN_STEPS).map(|k| GAIN_STEP * f64::from(k));
                (larger.flat_map(|by| [by, -by]).collect(), GAIN_STEP)
            }
        }
    }
}

/// The numbers with which the standard model leaves least, where that is less than half of what it leaves of any joint without, and
/// of no joint more: one number, or several zeros each of which does that beside the others. Beside a baseline, and where a
/// reference knows them, the parameters are known; then it must leave less than other parameters do. `before` is the fit to a
/// baseline.
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
    let threads = motions.settings().threads;
    let mut instants = instants(motions, (design, fit), known);
    let plain = instants.residual(model, &[])?;
    // What a robot carries, and friction that changed, are other parameters: an error must leave less than all of them together.
    let free = if is_known {
        let known = std::mem::replace(&mut instants.known, design.known.clone());
        let free = instants.residual(model, &[]);
        instants.known = known;
        free.map_or(0.0, |free| Descent::new(&instants, &plain).sum(&free))
    } else {
        0.0
    };
    if instants.are_few() {
        return None;
    }
    let descent = Descent::new(&instants, &plain);
    let mean = |sum: f64| sum / design.joints.max(1) as f64;
    let one = one_number(model, (&instants, &descent), threads).filter(|one| one.sum < free);
    let least = one.as_ref().map_or(0.0, |one| one.sum) + LEAVES.ln();
    let several = zeros(model, &instants, threads)
        .filter(|zeros| zeros.of.len() > 1 && zeros.sum < least.min(free))
        .filter(|zeros| zeros.sum < of_table(model, (&instants, &descent), threads) + LEAVES.ln());
    if let Some(Zeros { of, sum, rivals }) = several {
        let zero = |joint: usize| Number { joint, wrong: Wrong::Zero };
        let number = |((joint, by), rivals): ((usize, f64), Vec<usize>)| {
            (zero(joint), by, rivals.into_iter().map(zero).collect())
        };
        return Some(LargeError {
            numbers: of.into_iter().zip(rivals).map(number).collect(),
            left: mean(sum),
        });
    }
    one.map(|One { number, by, sum, rivals }| LargeError {
        numbers: vec![(number, by, rivals)],
        left: mean(sum),
    })
}

/// A number of one joint, with the sum of logarithms that it leaves.
struct One {
    number: Number,
    by: f64,
    sum: f64,
    rivals: Vec<Number>,
}

/// The number of one joint that leaves least over all its values.
fn one_number(
    model: &dyn Model,
    (instants, descent): (&Instants, &Descent<'_>),
    threads: usize,
) -> Option<One> {
    let sum = |number: Number, by: f64| {
        instants.residual(model, &[(number, by)]).map_or(0.0, |residual| descent.sum(&residual))
    };
    let kinds = model.robot().joint_kinds();
    let number = |wrong: Wrong| move |joint: usize| Number { joint, wrong };
    let zeros = (0..kinds.len()).filter(|&j| kinds[j] == JointKind::Revolute).map(number(Wrong::Zero));
    let numbers: Vec<Number> = zeros.chain((0..kinds.len()).map(number(Wrong::Gain))).collect();
    // Of each number the value that leaves least: the sum of logarithms with it comes first.
    let mut tried: Vec<(f64, f64, Number)> = parallel::map(threads, numbers.len(), |k| {
        let (values, step) = numbers[k].values();
        let each = values.into_iter().map(|by| (sum(numbers[k], by), by));
        let near = each.min_by(|a, b| a.0.total_cmp(&b.0)).map_or(0.0, |(_, by)| by);
        let value = |by: f64| Ok::<f64, Infallible>(sum(numbers[k], by));
        let Ok(by) = golden::least([near - step, near + step], ERROR_REFINED, value);
        (sum(numbers[k], by), by, numbers[k])
    });
    tried.sort_by(|a, b| a.0.total_cmp(&b.0));
    let &(sum, by, number) = tried.first()?;
    let worsens_none = descent.worsens_none(&instants.residual(model, &[(number, by)])?);
    let by = if number.wrong == Wrong::Zero && by > 0.5 * TAU { by - TAU } else { by };
    let certain = sum < LEAVES.ln() && worsens_none && by.abs() > LEAST;
    let rivals = tried.iter().skip(1).filter(|other| other.0 - sum < AS_LITTLE).map(|other| other.2);
    certain.then(|| One { number, by, sum, rivals: rivals.collect() })
}

/// The least sum that a wrong length of the table leaves, or a base that is tilted: several zeros imitate a part of what these do.
fn of_table(model: &dyn Model, (instants, descent): (&Instants, &Descent<'_>), threads: usize) -> f64 {
    let robot = model.robot();
    let laws = [EffectKind::GeometryError, EffectKind::BaseTilt]
        .into_iter()
        .filter_map(|effect| effect.form().sensitivity());
    let numbers: Vec<_> = laws
        .flat_map(|law| {
            let all = law.variants(robot).len();
            let (places, each) = if law.together() { (1, all) } else { (all, 1) };
            (0..places).map(move |v| (law, v, each))
        })
        .collect();
    let sums = parallel::map(threads, numbers.len(), |k| {
        let (law, v, each) = numbers[k];
        let residual = |errors: &[f64]| {
            let there = corrected_at(robot, law, v, errors)?;
            instants.residual(&RecursiveModel::new(there.robot).ok()?, &[])
        };
        descent.settled(vec![0.0; each], &residual).1
    });
    sums.into_iter().fold(0.0, f64::min)
}

/// Some instants of the recording that is diagnosed; `chi` are the base parameters where they are known.
fn instants(motions: &Motions, (design, fit): (&Design, &Fit), chi: Option<Vec<f64>>) -> Instants {
    let mut rows: BTreeMap<(usize, usize), Vec<(usize, f64)>> = BTreeMap::new();
    for joint in 0..design.joints {
        let own = design.of_joint(joint).map(|r| (design.rows[r], design.torque(r)));
        for (row, torque) in own.filter(|(row, _)| motions.signals[row.signal].is_target) {
            rows.entry((row.signal, row.centre)).or_default().push((joint, torque));
        }
    }
    let every = rows.len().div_ceil(INSTANTS).max(1);
    let kept: Vec<_> = rows.into_iter().step_by(every).collect();
    let of = |k: usize, j: usize| -> Vec<f64> {
        let at = |&((signal, centre), _): &((usize, usize), _)| {
            let s = &motions.signals[signal];
            design.smooth(signal, [&s.q, &s.dq, &s.ddq][k][j].as_slice(), centre)
        };
        kept.iter().map(at).collect()
    };
    Instants {
        states: [0, 1, 2].map(|k| (0..design.joints).map(|j| of(k, j)).collect()),
        known: chi.map_or_else(|| design.known.clone(), |chi| chi.into_iter().enumerate().collect()),
        torques: kept.into_iter().map(|(_, t)| t).collect(),
        sigma: fit.sigma.clone(),
        parameters: design.parameters,
    }
}
