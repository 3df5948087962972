//! What a report draws: curves, order spectra, torques over time.

use serde::{Deserialize, Serialize};

/// The residual against the variable that reveals an effect, with the fitted law over it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Curve {
    /// Variable, with its unit.
    pub variable: String,
    /// Torque unit.
    pub unit: String,
    /// Middle of each bin.
    pub x: Vec<f64>,
    /// Mean of the residual that the effect has to explain.
    pub residual: Vec<f64>,
    /// Standard error of that mean.
    pub error: Vec<f64>,
    /// Mean of the fitted law.
    pub law: Vec<f64>,
    /// Twice the standard deviation of the law itself; empty where it was not worked out.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub band: Vec<f64>,
    /// The law drawn finely; nothing where the law is its means.
    #[serde(default, skip_serializing_if = "FineLaw::is_empty")]
    pub fine: FineLaw,
}

/// A law over the variable that reveals it, as finely as a picture shows.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct FineLaw {
    /// Variable.
    pub x: Vec<f64>,
    /// Torque of the law there.
    pub torque: Vec<f64>,
}

impl FineLaw {
    /// Whether nothing is drawn.
    pub fn is_empty(&self) -> bool {
        self.x.is_empty()
    }
}

/// Amplitude over order of a joint's residual: periods per radian (or metre) times 2 pi.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct OrderSpectrum {
    /// Number j of the joint.
    pub joint: usize,
    /// Order: angle of the wave per angle of the joint.
    pub order: Vec<f64>,
    /// Order per motor turn is order divided by this.
    pub gear: f64,
    /// Amplitude, N.m or N.
    pub amplitude: Vec<f64>,
}

/// Torques of one joint in one motion.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct TorqueSeries {
    /// Motion.
    pub motion: String,
    /// Number j of the joint.
    pub joint: usize,
    /// s.
    pub time: Vec<f64>,
    /// Measured.
    pub measured: Vec<f64>,
    /// Standard model, refitted without the findings.
    pub before: Vec<f64>,
    /// With the findings.
    pub after: Vec<f64>,
}
