//! The models before and after a diagnosis, on the recording and on a test recording.

use std::path::Path;

use dynid_runtime::diagnosis::{Diagnosis, Finding};
use dynid_runtime::effects::EffectKind;
use dynid_runtime::model::Model;
use dynid_runtime::prediction::{Evaluation, PredictionError, Predictor, Prepared, evaluate, row_states};
use dynid_runtime::report::percent;

use crate::arguments::DiagnosisOptions;
use crate::errors::prediction_failure;
use crate::failure::Failure;
use crate::pages::diagnosis::{Fitted, Tested};
use crate::recorded::Measured;

/// The errors on the recording itself, but for windows in which something pushed the robot. `None` where it is too
/// short for the rows of the comparison.
pub fn fitted(measured: &Measured, diagnosis: &Diagnosis, options: &DiagnosisOptions) -> Option<Fitted> {
    let model = measured.dynamics.model();
    let comparison = options.comparison(model.robot().joints());
    let prepared = comparison.prepare(&measured.trajectories).ok()?;
    let pushed = diagnosis.findings.iter().flat_map(|f| &f.contacts);
    let windows: Vec<(&str, [f64; 2])> = pushed.map(|w| (w.motion.as_str(), w.window)).collect();
    let evaluation = before_and_after(model, diagnosis, &prepared, &windows).ok()?;
    let states = row_states(model, &diagnosis.model.chi, &prepared.motions, &prepared.settings).ok()?;
    Some(Fitted { evaluation, states })
}

/// A test recording, ready to be predicted.
pub struct Test {
    measured: Measured,
    /// Its motions and how rows are sampled from them.
    pub prepared: Prepared,
}

impl Test {
    /// Prepares it.
    ///
    /// # Errors
    /// A band that is none, or motions that cannot be filtered.
    pub fn new(measured: Measured, path: &Path, options: &DiagnosisOptions) -> Result<Self, Failure> {
        let model = measured.dynamics.model();
        let refused = |error| prediction_failure(path, &error);
        let prepared =
            options.comparison(model.robot().joints()).prepare(&measured.trajectories).map_err(refused)?;
        // Whether it has rows to be judged on shows before the diagnosis, with any parameters.
        let any = vec![0.0; model.robot().base.len()];
        let nothing = Predictor { chi: &any, effects: &[], delay: 0.0 };
        evaluate(model, &[nothing], &prepared.motions, &prepared.settings, &[]).map_err(refused)?;
        Ok(Self { measured, prepared })
    }
}

/// The errors on a test recording.
///
/// # Errors
/// What the evaluator refuses, such as an effect that cannot be evaluated on it.
pub fn tested(test: &Test, path: &Path, diagnosis: &Diagnosis) -> Result<Tested, Failure> {
    let evaluation = before_and_after(test.measured.dynamics.model(), diagnosis, &test.prepared, &[])
        .map_err(|error| prediction_failure(path, &error))?;
    Ok(Tested { name: test.measured.title.clone(), evaluation })
}

/// What a test recording cannot judge, or that all findings together do not help on it, where that is so. Pushes belong to the recording that they were
/// seen in.
pub fn test_words(tested: &Tested, diagnosis: &Diagnosis) -> Option<String> {
    let errors: Vec<Option<f64>> =
        tested.evaluation.predictions.iter().map(|p| p.errors.relative_error).collect();
    let &[Some(before), Some(after)] = errors.as_slice() else { return None };
    // Zero torques would be as good.
    if before >= 1.0 && after >= 1.0 {
        return Some(
            "The motion of the test recording asks for parameters that this recording does not determine: its errors say \
             nothing of what was found. Record motions in which all joints move together."
                .into(),
        );
    }
    let is_push = |finding: &Finding| finding.term.effect == EffectKind::Contact;
    (!diagnosis.findings.iter().all(is_push) && after >= before).then(|| {
        format!(
            "On the test recording the error does not fall: it is {} before and {} after. Do not rely on what was found \
             before another recording shows it.",
            percent(before),
            percent(after)
        )
    })
}

/// The standard model and the model with the findings, on the same rows.
fn before_and_after(
    model: &dyn Model,
    diagnosis: &Diagnosis,
    prepared: &Prepared,
    windows: &[(&str, [f64; 2])],
) -> Result<Evaluation, PredictionError> {
    let terms = diagnosis.terms();
    evaluate(
        model,
        &Predictor::before_and_after(diagnosis, &terms),
        &prepared.motions,
        &prepared.settings,
        windows,
    )
}
