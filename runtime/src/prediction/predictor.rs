//! What predicts: parameters, effects, and how late the torques are.

use crate::diagnosis::{Diagnosis, DiagnosisError, term_torques};
use crate::effects::{Distortion, EffectTerm, times_faster};
use crate::estimation::observe::ObserveError;
use crate::model::{Model, torques};
use crate::signal::{Motion, SignalError};

/// A model that predicts torques.
#[derive(Debug, Clone, Copy)]
pub struct Predictor<'a> {
    /// Base parameters, in the model's order.
    pub chi: &'a [f64],
    /// Effects beyond the standard model, identified together with `chi`.
    pub effects: &'a [EffectTerm],
    /// By how much the torque channel is later than the positions, s.
    pub delay: f64,
}

/// Why nothing can be predicted.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PredictionError {
    /// The recording cannot be sampled.
    #[error(transparent)]
    Observe(#[from] ObserveError),
    /// A signal cannot be prepared.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// The torques of an effect cannot be evaluated.
    #[error(transparent)]
    Effect(#[from] DiagnosisError),
    /// Parameters of another model.
    #[error("{found} parameters: the model has {expected}")]
    Parameters {
        /// Parameters given.
        found: usize,
        /// Base parameters of the model.
        expected: usize,
    },
}

impl<'a> Predictor<'a> {
    /// The standard model and the model with the findings of a diagnosis, whose terms are `terms`. A skew that was taken
    /// out of the recording belongs to both where it is too small to be a finding, and so do the laws of a reference.
    pub fn before_and_after(diagnosis: &'a Diagnosis, terms: &'a [EffectTerm]) -> [Self; 2] {
        let standing = terms.get(diagnosis.findings.len()..).unwrap_or_default();
        let named = |t: &&EffectTerm| t.distortion() == Some(Distortion::Skew);
        let skew: f64 = terms.iter().filter(named).flat_map(|t| t.amplitude.first()).sum();
        let delay = diagnosis.delay - skew;
        [
            Self { chi: &diagnosis.standard.chi, effects: standing, delay },
            Self { chi: &diagnosis.model.chi, effects: terms, delay: diagnosis.delay },
        ]
    }

    /// Torques on a motion at its full rate, as the torque channel would have recorded them: `[j][t]`, N.m or N.
    ///
    /// Where the times of the recording are wrong, the motion that the model sees is faster than they say. Contacts belong to the recording they were seen in and add
    /// nothing.
    ///
    /// # Errors
    /// Where `chi` is of another model, or an effect cannot be evaluated.
    pub fn torques(&self, model: &dyn Model, motion: &Motion) -> Result<Vec<Vec<f64>>, PredictionError> {
        let expected = model.robot().base.len();
        if self.chi.len() != expected {
            return Err(PredictionError::Parameters { found: self.chi.len(), expected });
        }
        let factor = times_faster(self.effects);
        let corrected = (factor != 1.0).then(|| motion.faster(factor));
        let motion = corrected.as_ref().unwrap_or(motion);
        let mut all = torques(model, self.chi, motion.state_slices().states());
        if !self.effects.is_empty() {
            let added = term_torques(model, self.chi, self.effects, motion)?;
            for (torque, effect) in all.iter_mut().flatten().zip(added.iter().flatten()) {
                *torque += effect;
            }
        }
        if self.delay != 0.0 {
            all.iter_mut().for_each(|torque| *torque = later(torque, self.delay * motion.rate));
        }
        Ok(all)
    }
}

/// A signal `samples` later: linear interpolation, the ends held.
fn later(x: &[f64], samples: f64) -> Vec<f64> {
    let Some(last) = x.len().checked_sub(1) else { return Vec::new() };
    (0..x.len())
        .map(|k| {
            let at = (k as f64 - samples).clamp(0.0, last as f64);
            let low = at.floor() as usize;
            let high = (low + 1).min(last);
            x[low] + (at - low as f64) * (x[high] - x[low])
        })
        .collect()
}
