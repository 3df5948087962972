//! Values for simulation.

use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Values for simulation.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Nominal {
    /// chi_st, in the order of `Robot::standard`.
    pub standard: Cow<'static, [f64]>,
    /// Proportional gain per joint, N.m/rad or N/m; empty where the YAML does not say.
    pub kp: Cow<'static, [f64]>,
    /// Derivative gain per joint, N.m.s/rad or N.s/m.
    pub kd: Cow<'static, [f64]>,
    /// Integral gain per joint.
    pub ki: Cow<'static, [f64]>,
    /// Encoder noise per joint, 1 sigma, rad or m at the joint.
    pub position_noise: Cow<'static, [f64]>,
    /// Torque noise per joint, 1 sigma, N.m or N.
    pub torque_noise: Cow<'static, [f64]>,
}
