//! Errors of models on a recording, in words.

use std::path::Path;

use dynid_runtime::estimation::observe::ObserveError;
use dynid_runtime::prediction::{Comparison, Evaluation, Prediction, PredictionError, Prepared};
use dynid_runtime::report::{percent, significant};

use crate::failure::Failure;
use crate::recorded::observe_failure;

/// What an evaluation refuses, as the end of a command.
pub fn prediction_failure(recording: &Path, error: &PredictionError) -> Failure {
    match error {
        PredictionError::Observe(error) => observe_failure(recording, error),
        PredictionError::Signal(error) => observe_failure(recording, &ObserveError::Signal(error.clone())),
        other => Failure::Data(format!("{}: {other}", recording.display())),
    }
}

/// How many rows in which band, and why this one.
pub fn band_words(evaluation: &Evaluation, prepared: &Prepared, asked: Option<f64>) -> String {
    let band = prepared.settings.band;
    let wanted = asked.unwrap_or(Comparison::BAND);
    let mut text = format!(
        "{} equations of {} Hz bandwidth, {} left out where the joint hardly moves",
        evaluation.used(),
        significant(band, 3),
        evaluation.standing()
    );
    if band < wanted {
        text.push_str(&format!(
            " (the recording carries no more than {} Hz, {} {})",
            significant(band, 3),
            significant(wanted, 3),
            if asked.is_some() { "were asked for" } else { "are usual" }
        ));
    }
    text
}

/// What noise may make of the errors, and what of them is above it, where noise matters for one of the models.
pub fn noise_words(evaluation: &Evaluation) -> Option<String> {
    evaluation.predictions.iter().find_map(Prediction::noise_matters)?;
    let each = |value: fn(&Prediction) -> Option<f64>| -> Vec<String> {
        evaluation.predictions.iter().map(|p| percent(value(p))).collect()
    };
    let mut noise = each(|p| p.noise.as_ref()?.relative_error);
    noise.dedup();
    Some(format!(
        "noise of the torques in this band {}; error above the noise {}",
        noise.join(" -> "),
        each(|p| p.above_noise()?.relative_error).join(" -> ")
    ))
}
