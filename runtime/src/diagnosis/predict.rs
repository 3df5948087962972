//! Accepted effects as part of a model: their torques on any motion.

use super::error::DiagnosisError;
use super::reference::Reference;
use super::rows::additions::Additions;
use super::rows::context::Context;
use super::rows::free::beyond;
use super::rows::scales::scales;
use super::rows::series::add_to;
use super::rows::signals::Signals;
use crate::effects::{EffectTerm, Scale, intervals_by_joint};
use crate::model::Model;
use crate::signal::Motion;

/// How fast, how far and how hard each joint moves in motions, with the base parameters `chi`: what the shapes of laws are
/// multiples of.
pub fn joint_scales(model: &dyn Model, motions: &[Motion], chi: &[f64]) -> Vec<Scale> {
    let signals: Vec<Signals> = motions.iter().map(Signals::of_motion).collect();
    scales(model, &signals, chi)
}

/// Torques of terms on a motion, to be added to those of the standard model: `[j][t]`, N.m or N.
///
/// What is wrong with a recording rather than with the robot adds nothing: it changes the motion that the model is
/// evaluated on, see [`crate::prediction::Predictor`].
///
/// `chi` are the base parameters that were identified together with the terms; laws that follow the load feel the bodies
/// among these, and those that follow or hear the torque of a drive the other laws of that drive, too. Contacts belong to the recording they
/// were seen in and add nothing.
///
/// # Errors
/// Terms or motions that do not fit the robot.
pub fn term_torques(
    model: &dyn Model,
    chi: &[f64],
    terms: &[EffectTerm],
    motion: &Motion,
) -> Result<Vec<Vec<f64>>, DiagnosisError> {
    let signals = [Signals::of_motion(motion)];
    let mut all = torques_on(model, chi, terms, &signals)?;
    Ok(all.pop().unwrap_or_default())
}

/// The same for several motions: `[motion][j][t]`.
pub(super) fn torques_on(
    model: &dyn Model,
    chi: &[f64],
    terms: &[EffectTerm],
    signals: &[Signals],
) -> Result<Vec<Vec<Vec<f64>>>, DiagnosisError> {
    let n = model.robot().joints();
    let mut out: Vec<Vec<Vec<f64>>> = signals.iter().map(|s| vec![vec![0.0; s.len()]; n]).collect();
    if terms.is_empty() {
        return Ok(out);
    }
    let mut context = Context::new(model, signals, scales(model, signals, chi), chi.to_vec())?;
    context.take(Additions::among(model.robot(), terms));
    for term in terms.iter().filter(|t| t.distortion().is_none()) {
        if let (Some(j), Some(scale)) = (term.place.law_of(), term.scale)
            && j < n
        {
            context.scales[j] = scale.into();
        }
        let mut amplitude = term.amplitude.clone();
        if let Some((j, known)) = term.transmission() {
            context.transmissions = vec![(j, known)];
            amplitude = vec![1.0];
        }
        for (k, torque) in out.iter_mut().enumerate() {
            add_to(torque, &context.series(k, term.effect, term.place, &term.shape), &amplitude);
        }
    }
    Ok(out)
}

impl Reference {
    /// Torques of its laws on motions: `[motion][j][t]`.
    pub(super) fn torques(
        &self,
        model: &dyn Model,
        signals: &[Signals],
    ) -> Result<Vec<Vec<Vec<f64>>>, DiagnosisError> {
        torques_on(model, self.chi(), self.effects(), signals)
    }

    /// Samples beyond the values that its curves were fitted to, of motions of the recording that is diagnosed: how a curve goes on
    /// there is no news. `[motion][j][t]`; those of a motion are empty where it has none. Where most of a joint's motion is beyond,
    /// its curves go on as they end.
    pub(super) fn unknown(
        &self,
        model: &dyn Model,
        signals: &[Signals],
    ) -> Result<Vec<Vec<Vec<bool>>>, DiagnosisError> {
        let n = model.robot().joints();
        let mut unknown = vec![Vec::new(); signals.len()];
        let curves = intervals_by_joint(self.effects(), n);
        if curves.iter().all(Vec::is_empty) {
            return Ok(unknown);
        }
        let scales = scales(model, signals, self.chi());
        let mut context = Context::new(model, signals, scales, self.chi().to_vec())?;
        context.take(Additions::among(model.robot(), self.effects()));
        let targets: Vec<usize> = (0..signals.len()).filter(|&k| signals[k].is_target).collect();
        let mut all: Vec<Vec<Vec<bool>>> = (targets.iter())
            .map(|&k| curves.iter().map(|axes| beyond(&context, k, axes)).collect())
            .collect();
        for j in 0..n {
            let samples = || all.iter().flat_map(|motion| &motion[j]);
            if 2 * samples().filter(|beyond| **beyond).count() > samples().count() {
                all.iter_mut().for_each(|motion| motion[j].fill(false));
            }
        }
        targets.into_iter().zip(all).for_each(|(k, beyond)| unknown[k] = beyond);
        Ok(unknown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::effects::{Axis, EffectKind, FreeLaw, Place, Variable};
    use crate::model::Robot;
    use crate::simulation::testing::arm;
    use nalgebra::DMatrix;

    /// What a reference with a curve of joint 1 over the position of joint 2, up to `half` from 0, knows of a motion in which that
    /// goes from -1 to 1.
    fn unknown(half: f64, is_target: bool) -> Vec<Vec<bool>> {
        let (model, standard) = arm();
        let robot: &Robot = model.robot();
        let n = robot.joints();
        let axis = Axis { variable: Variable::Position(1), centre: 0.0, half };
        let law = FreeLaw::one(axis);
        let curve = EffectTerm {
            effect: EffectKind::FreeForm,
            place: Place::Joint(0),
            joints: vec![1],
            shape: law.shape(),
            amplitude: vec![0.0; law.amplitudes()],
            sigma: vec![0.0; law.amplitudes()],
            scale: None,
            wrenches: Vec::new(),
        };
        let chi = robot.base_from_standard(&standard);
        let size = chi.len() + law.amplitudes();
        let reference = Reference::new(chi, vec![curve], 0.0, DMatrix::identity(size, size), false)
            .expect("a covariance of the right size");
        let ramp: Vec<f64> = (0..201).map(|t| -1.0 + 0.01 * f64::from(t)).collect();
        let still = vec![vec![0.1; ramp.len()]; n];
        let mut q = still.clone();
        q[1] = ramp;
        let mut signals = Signals::without_torque("m", 100.0, 0.0, [q, still.clone(), still]);
        signals.is_target = is_target;
        reference.unknown(&model, &[signals]).expect("a motion of the robot").swap_remove(0)
    }

    #[test]
    fn beyond_what_a_curve_was_fitted_to_nothing_is_known_of_its_joint() {
        let beyond = unknown(0.755, true);
        let here = |j: usize| beyond[j].iter().filter(|x| **x).count();
        assert_eq!((here(0), here(1)), (50, 0));
        assert!(beyond[0][0] && !beyond[0][100] && beyond[0][200]);
    }

    #[test]
    fn a_baseline_is_where_it_was_fitted_and_a_curve_over_little_of_a_motion_goes_on_as_it_ends() {
        assert!(unknown(0.755, false).is_empty());
        assert!(unknown(0.2, true).iter().flatten().all(|x| !x));
    }
}
