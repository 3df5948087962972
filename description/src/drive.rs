//! Motors and transmission.

use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// Motors and transmission: motor speed = gear * joint speed, joint torque = gearT * motor torque.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// n x n, row-major (row = motor, column = joint).
    pub gear: Cow<'static, [f64]>,
    /// Motors (0-based) whose viscous and Coulomb friction also act at motor speed (Fvm, Fcm).
    pub coupled_friction: Cow<'static, [usize]>,
}
