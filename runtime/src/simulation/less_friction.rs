//! Friction parameters that came out below zero.

use super::extra::{ExtraTorque, Instant};
use crate::model::{ParameterKind, Robot};

/// Friction parameters below zero, as torques beside a plant without them.
pub(super) struct LessFriction {
    viscous: Vec<f64>,
    dry: Vec<f64>,
}

impl LessFriction {
    /// Takes them out of base parameters.
    pub(super) fn taken_from(robot: &Robot, chi: &mut [f64]) -> Self {
        let joint_of = robot.joint_of_frame();
        let mut less = Self { viscous: vec![0.0; robot.joints()], dry: vec![0.0; robot.joints()] };
        for (base, value) in robot.base.iter().zip(chi) {
            let standard = &robot.standard[base.standard];
            let Some(joint) = joint_of[standard.frame].filter(|_| *value < 0.0) else { continue };
            match standard.kind {
                ParameterKind::Fv => less.viscous[joint] = std::mem::take(value),
                ParameterKind::Fc => less.dry[joint] = std::mem::take(value),
                _ => {}
            }
        }
        less
    }
}

impl ExtraTorque for LessFriction {
    fn torque(&self, at: &Instant<'_>, out: &mut [f64]) {
        for (out, (f, dq)) in out.iter_mut().zip(self.viscous.iter().zip(at.dq)) {
            *out += f * dq;
        }
    }

    fn dry_friction(&self, _: &Instant<'_>, levels: &mut [[f64; 2]]) {
        for (level, less) in levels.iter_mut().zip(&self.dry) {
            level.iter_mut().for_each(|x| *x += less);
        }
    }

    /// Laws know the friction of the standard model with this part of it: it is not among the effects that they look at.
    fn looks_at_effects(&self) -> bool {
        true
    }

    fn has_dry_friction(&self) -> bool {
        self.dry.iter().any(|x| *x != 0.0)
    }
}
