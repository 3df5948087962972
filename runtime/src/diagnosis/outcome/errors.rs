//! How far model and recording differ: in sample, on motion that was held out, and what remains.

use super::drawn::Curve;
use serde::{Deserialize, Serialize};

/// Relative errors |Y - W chi| / |Y|; `None` where every torque Y is zero.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Errors {
    /// All joints together.
    pub relative_error: Option<f64>,
    /// Joint by joint.
    pub per_joint: Vec<Option<f64>>,
}

impl Errors {
    /// From the squares of residual and torque, per joint.
    pub(crate) fn of_squares(left: &[f64], whole: &[f64]) -> Self {
        let ratio = |a: f64, b: f64| (b > 0.0).then(|| (a / b).sqrt());
        Self {
            relative_error: ratio(left.iter().sum(), whole.iter().sum()),
            per_joint: left.iter().zip(whole).map(|(a, b)| ratio(*a, *b)).collect(),
        }
    }
}

/// Relative errors on motion that was held out.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct HeldOut {
    /// How motion was held out.
    pub how: String,
    /// Highest frequency of the rows, Hz.
    #[serde(default)]
    pub band: f64,
    /// Standard model.
    pub before: f64,
    /// With the findings.
    pub after: f64,
    /// Standard model, joint by joint; `None` where a joint has no torque.
    pub per_joint_before: Vec<Option<f64>>,
    /// With the findings, joint by joint.
    pub per_joint_after: Vec<Option<f64>>,
    /// The same for each motion or stretch that was held out: its name, before, after.
    pub by_motion: Vec<(String, f64, f64)>,
}

/// Where the standard model fails.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Mismatch {
    /// Number j of the joint.
    pub joint: usize,
    /// Share of all unexplained torque beyond the noise floor, in units of each joint's noise.
    pub share: f64,
    /// In words.
    #[serde(rename = "where")]
    pub where_: String,
}

/// What nothing explains.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Unexplained {
    /// Share of the remaining held-out squares that is not noise, over all joints.
    pub share: f64,
    /// The same joint by joint.
    pub per_joint: Vec<f64>,
    /// Remaining residual of each joint over its speed.
    pub curves: Vec<Curve>,
    /// The joint on which most of it is, the share that it has, and what orders it there.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub most: Option<Mismatch>,
}
