//! Limits of the joints.

use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// `[low, high]` per joint, SI; empty where the YAML does not say.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Limits {
    /// rad or m.
    pub position: Cow<'static, [[f64; 2]]>,
    /// rad/s or m/s.
    pub velocity: Cow<'static, [[f64; 2]]>,
    /// rad/s2 or m/s2.
    pub acceleration: Cow<'static, [[f64; 2]]>,
    /// N.m or N.
    pub torque: Cow<'static, [[f64; 2]]>,
}
