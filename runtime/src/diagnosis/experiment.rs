//! How far apart a motion puts laws of one joint: a T-optimality criterion.
//!
//! Where law A is true, the rows of a diagnosis hold its torque. What the standard parameters, the nuisances and a rival B
//! with any amplitude and shape cannot make of it is what B would leave; its length in multiples of the rows' noise is how
//! surely B is refuted, the root of the noncentrality of the test (Atkinson and Fedorov 1975). A motion is as good as the
//! smallest of these distances.

use super::candidates::nuisances::always_there;
use super::candidates::trial::{dense_columns, term_columns};
use super::error::DiagnosisError;
use super::rows::context::Context;
use super::rows::design::Design;
use super::rows::fit::Fit;
use super::rows::scales::{scales, top_speeds};
use super::rows::selection::{Cut, RowSelection, hann};
use super::rows::signals::{Signals, directions};
use super::rules::{FAST_STANDSTILL_DIVISOR, FAST_WINDOW, STANDSTILL};
use crate::effects::{EffectKind, EffectTerm, Form, Place, TermScale};
use crate::model::{JointIndex, Model};
use crate::signal::Motion;

/// What is asked of a motion.
#[derive(Clone, Copy)]
pub struct Question<'a> {
    /// The robot.
    pub model: &'a dyn Model,
    /// Its base parameters.
    pub chi: &'a [f64],
    /// Noise of each joint's torque at the motion's rate, 1 sigma, N.m or N.
    pub noise: &'a [f64],
    /// The laws that are to be told apart as they may be in the robot ([`typical_laws`]), all of one joint.
    pub laws: &'a [EffectTerm],
}

/// How far apart a motion puts laws.
#[derive(Debug, Clone, PartialEq)]
pub struct Distances {
    /// `apart[a][b]`: the part of law a that law b cannot make, in multiples of the noise; on the diagonal the part that the
    /// standard model cannot make. `None` where b contains a, so that no motion puts them apart.
    pub apart: Vec<Vec<Option<f64>>>,
}

impl Distances {
    /// The smallest of them: what the motion is worth.
    pub fn least(&self) -> f64 {
        self.apart.iter().flatten().flatten().copied().fold(f64::INFINITY, f64::min)
    }
}

/// Laws of a joint (0-based) as they may be: the middle of their grids of shapes for what the joint does in `usual`, and as
/// large there as `size`, N.m or N. `None` for an effect that is no law of a joint, or whose torque is nothing there.
///
/// # Errors
/// [`DiagnosisError`] where the motion does not fit the robot.
pub fn typical_laws(
    (model, chi): (&dyn Model, &[f64]),
    joint: usize,
    effects: &[EffectKind],
    size: f64,
    usual: &Motion,
) -> Result<Vec<Option<EffectTerm>>, DiagnosisError> {
    let signals = [Signals::of_motion(usual)];
    let context = Context::new(model, &signals, scales(model, &signals, chi), chi.to_vec())?;
    let place = Place::Joint(joint);
    let typical = |effect: &EffectKind| {
        let Form::Joint(law) = effect.form() else { return None };
        let scale: TermScale = (*context.scales.get(joint)?).into();
        let shapes = law.shapes(&context.scales[joint]);
        let shape = shapes.get(shapes.len() / 2)?.clone();
        // A law of several numbers has them fall off, so that none of them is all of it.
        let amplitude: Vec<f64> = (0..law.amplitudes(&shape)).map(|k| 0.8_f64.powi(k as i32)).collect();
        let term = EffectTerm {
            effect: *effect,
            place,
            joints: vec![model.robot().joint_number(JointIndex(joint)).0],
            sigma: vec![0.0; amplitude.len()],
            shape,
            amplitude,
            scale: Some(scale),
            wrenches: Vec::new(),
        };
        let mut torque = vec![0.0; signals[0].len()];
        for (column, a) in context.series_of_term(0, &term).iter().zip(&term.amplitude) {
            let own = column.iter().filter(|(j, _)| *j == joint).flat_map(|(_, values)| values);
            torque.iter_mut().zip(own).for_each(|(t, v)| *t += a * v);
        }
        let largest = torque.iter().fold(0.0_f64, |most, t| most.max(t.abs()));
        let factor = size / largest;
        factor
            .is_finite()
            .then(|| EffectTerm { amplitude: term.amplitude.iter().map(|a| a * factor).collect(), ..term })
    };
    Ok(effects.iter().map(typical).collect())
}

/// Distances of laws on a motion, on the rows that a diagnosis of it has.
///
/// # Errors
/// [`DiagnosisError`] where the motion does not fit the robot, or its rows have no fit.
pub fn distances(question: &Question<'_>, motion: &Motion) -> Result<Distances, DiagnosisError> {
    let Question { model, chi, .. } = *question;
    let robot = model.robot();
    let signals = [Signals::of_motion(motion)];
    let (limits, forms) = (standstills(&signals, robot.joints()), directions(robot));
    let selection = RowSelection {
        half: FAST_WINDOW,
        slowest: &limits,
        directions: &forms,
        cut: Cut::NOT,
        excluded: &[vec![]],
    };
    let mut design = Design::new(model, &signals, &selection);
    let context = Context::new(model, &signals, scales(model, &signals, chi), chi.to_vec())?;
    for column in always_there(&context, &design, false) {
        design.push(column);
    }
    design.refresh();
    let taps = hann((FAST_WINDOW * motion.rate).round().max(2.0) as usize);
    let factor = taps.iter().map(|t| t * t).sum::<f64>().sqrt();
    let sigma: Vec<f64> = question.noise.iter().map(|noise| factor * noise).collect();
    let on_rows = |law: &EffectTerm| {
        let mut torque = vec![0.0; design.rows.len()];
        for (column, a) in term_columns(&context, &design, law).iter().zip(&law.amplitude) {
            torque.iter_mut().zip(column).for_each(|(t, c)| *t += a * c);
        }
        torque
    };
    let truths: Vec<Vec<f64>> = question.laws.iter().map(on_rows).collect();
    let laws = question.laws.iter().enumerate();
    let apart = laws.map(|(a, law)| {
        let of = |(b, rival): (usize, &EffectTerm)| {
            if a == b {
                return left(&mut design.clone(), &sigma, &truths[a], &[]).map(Some);
            }
            if rival.effect.special_cases().any(|simpler| simpler == law.effect) {
                return Ok(None);
            }
            let grid = rival.effect.form().shapes(rival.place, &context.scales);
            let rivals: Vec<Vec<Vec<f64>>> = grid
                .iter()
                .map(|shape| dense_columns(&context, &design, rival.effect, rival.place, shape, false))
                .collect();
            left(&mut design.clone(), &sigma, &truths[a], &rivals).map(Some)
        };
        question.laws.iter().enumerate().map(of).collect()
    });
    Ok(Distances { apart: apart.collect::<Result<_, DiagnosisError>>()? })
}

/// Speeds of standstill of the fast rows, as a diagnosis has them; joints that do not move have no rows.
fn standstills(signals: &[Signals], joints: usize) -> Vec<f64> {
    let top = top_speeds(signals.iter(), joints);
    let of = |v: f64| if v > 0.0 { STANDSTILL * v / FAST_STANDSTILL_DIVISOR } else { f64::INFINITY };
    top.into_iter().map(of).collect()
}

/// What the design with the best of some sets of columns, or with none, leaves of a torque, in multiples of the noise.
fn left(
    design: &mut Design,
    sigma: &[f64],
    torque: &[f64],
    rivals: &[Vec<Vec<f64>>],
) -> Result<f64, DiagnosisError> {
    let first = design.columns.len();
    design.y = torque.to_vec();
    let mut least = f64::INFINITY;
    let alone = vec![Vec::new()];
    for columns in if rivals.is_empty() { &alone } else { rivals } {
        design.columns.truncate(first);
        for column in columns {
            design.push(column.clone());
        }
        design.refresh_from(first);
        least = least.min(Fit::whole(design, sigma)?.weighted_squares(design).sqrt());
    }
    Ok(least)
}
