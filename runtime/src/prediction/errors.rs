//! Relative errors and noise.

use crate::diagnosis::Errors;
use crate::estimation::observe::Observation;
use crate::estimation::{per_equation, relative_error};

/// Squares that differ by less than this fraction are equal up to rounding.
const ROUNDING: f64 = 1e-12;

/// What is left of errors when the squares of others, those that noise makes, are taken away.
///
/// Never below zero: 0 says that the error is not known to be anything but noise.
pub fn above_noise(errors: &Errors, noise: &Errors) -> Errors {
    let above = |error: Option<f64>, noise: Option<f64>| {
        let error = error?;
        let left = error.powi(2) - noise?.powi(2);
        Some(if left > ROUNDING * error.powi(2) { left.sqrt() } else { 0.0 })
    };
    Errors {
        relative_error: above(errors.relative_error, noise.relative_error),
        per_joint: errors.per_joint.iter().zip(&noise.per_joint).map(|(e, n)| above(*e, *n)).collect(),
    }
}

/// The errors of base parameters on the observation that they were identified from, without its rows: of a recording
/// that is too long to be held. The same figures as [`super::evaluate`]'s on the same rows.
pub fn observed_errors(observation: &Observation, chi: &[f64]) -> Errors {
    Errors { relative_error: relative_error(observation, chi), per_joint: per_equation(observation, chi) }
}
