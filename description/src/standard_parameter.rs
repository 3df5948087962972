//! A standard parameter of a robot.

use crate::{Coupling, JointKind, ParameterKind};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A standard parameter of a robot.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct StandardParameter {
    /// Kind and number of the frame: `ZZ1`, `Ia3`, `Fvm6`.
    pub name: Cow<'static, str>,
    /// What it is.
    pub kind: ParameterKind,
    /// Frame it belongs to, 0-based index in `Robot::frames`.
    pub frame: usize,
    /// What it is of, 0-based index in `Robot::couplings`, where it is of a combination of joints.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub coupling: Option<usize>,
}

impl StandardParameter {
    /// SI unit in a robot with these couplings, where its frame moves like this.
    pub fn unit(&self, kind: JointKind, couplings: &[Coupling]) -> &'static str {
        let law = self.coupling.and_then(|k| couplings.get(k)).map(|coupling| coupling.law);
        // What acts along a length is a force, whatever turns.
        let is_length = law.is_some_and(|law| law.between().is_some());
        self.kind.unit(if is_length { JointKind::Prismatic } else { kind })
    }
}
