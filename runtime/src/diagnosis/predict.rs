//! Accepted effects as part of a model: their torques on any motion.

use super::contact::silent::Silent;
use super::error::DiagnosisError;
use super::reference::Reference;
use super::rows::additions::Additions;
use super::rows::context::Context;
use super::rows::scales::scales;
use super::rows::series::add_to;
use super::rows::signals::Signals;
use crate::effects::{EffectTerm, Scale};
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
        if self.effects().iter().all(|term| term.intervals(n).is_empty()) {
            return Ok(unknown);
        }
        let scales = scales(model, signals, self.chi());
        let mut context = Context::new(model, signals, scales, self.chi().to_vec())?;
        context.take(Additions::among(model.robot(), self.effects()));
        let silent = Silent::of(self.effects(), n);
        let targets: Vec<usize> = (0..signals.len()).filter(|&k| signals[k].is_target).collect();
        let mut beyond: Vec<Vec<Vec<bool>>> = (targets.iter())
            .map(|&k| (0..n).map(|j| silent.beyond_curves(&context, j, k)).collect())
            .collect();
        for j in 0..n {
            let samples = beyond.iter().flat_map(|motion| &motion[j]);
            let (beyond_here, all) = samples.fold((0, 0), |(b, n), x| (b + usize::from(*x), n + 1));
            if 2 * beyond_here > all {
                beyond.iter_mut().for_each(|motion| motion[j].fill(false));
            }
        }
        targets.into_iter().zip(beyond).for_each(|(k, beyond)| unknown[k] = beyond);
        Ok(unknown)
    }
}
