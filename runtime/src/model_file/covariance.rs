//! How the numbers of a saved model vary together.

use super::error::FileError;
use crate::model::Robot;
use serde::{Deserialize, Serialize};

/// Covariance of a model's numbers.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Covariance {
    /// What it is of: names of base parameters, then `effects[i].amplitude[k]`.
    pub of: Vec<String>,
    /// Its upper triangle row by row, in the units of the numbers; a row of zeros is of a number that is not determined.
    pub upper: Vec<f64>,
}

impl Covariance {
    /// Of base parameters and of the amplitudes of effects, so many of each effect; `None` where the triangle has another
    /// number of entries.
    pub fn new(robot: &Robot, amplitudes: &[usize], upper: Vec<f64>) -> Option<Self> {
        let mut of: Vec<String> = robot.base.iter().map(|b| b.name.to_string()).collect();
        for (i, &count) in amplitudes.iter().enumerate() {
            of.extend((0..count).map(|k| amplitude_name(i, k)));
        }
        let entries = of.len() * (of.len() + 1) / 2;
        (upper.len() == entries && upper.iter().all(|x| x.is_finite())).then_some(Self { of, upper })
    }

    pub(super) fn entry(&self, i: usize, k: usize) -> f64 {
        let (i, k) = (i.min(k), i.max(k));
        self.upper[i * self.of.len() - i * (i + 1) / 2 + k]
    }

    /// Checks it.
    ///
    /// # Errors
    /// The field that cannot be, and why.
    pub(super) fn check(&self) -> Result<(), FileError> {
        let wrong = |field: &str, what: String| Err(FileError::new(format!("covariance.{field}"), &what));
        let (n, found) = (self.of.len(), self.upper.len());
        if found != n * (n + 1) / 2 {
            return wrong("upper", format!("{found} numbers, but {n} unknowns have {}", n * (n + 1) / 2));
        }
        if let Some(k) = self.upper.iter().position(|x| !x.is_finite()) {
            return wrong(&format!("upper[{k}]"), "it is not a finite number".to_owned());
        }
        if let Some(k) = (0..n).find(|&k| self.entry(k, k) < 0.0) {
            return wrong("upper", format!("the variance of {} is below zero", self.of[k]));
        }
        Ok(())
    }
}

/// Name of an amplitude of an effect.
pub(super) fn amplitude_name(effect: usize, k: usize) -> String {
    format!("effects[{effect}].amplitude[{k}]")
}
