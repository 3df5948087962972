//! The part of a recording that the diagnosis never sees.

use dynid_runtime::diagnosis::Diagnosis;
use dynid_runtime::model::Model;
use dynid_runtime::prediction::{Comparison, Evaluation, Predictor, evaluate};
use dynid_runtime::recording::Trajectory;

use crate::Failure;

/// The standard model as `dynid identify` has it, the standard model of the diagnosis, and the model with the findings,
/// on the same rows of a recording.
pub fn compared(
    model: &dyn Model,
    identified: &[f64],
    found: &Diagnosis,
    test: &[Trajectory],
) -> Result<Evaluation, Failure> {
    let prepared = Comparison::default().prepare(test)?;
    let terms = found.terms();
    let [before, after] = Predictor::before_and_after(found, &terms);
    let models = [Predictor { chi: identified, effects: &[], delay: 0.0 }, before, after];
    Ok(evaluate(model, &models, &prepared.motions, &prepared.settings, &[])?)
}
