//! Friction of a rotor that two joints drive, in a simulated robot.

use super::extra::{ExtraTorque, Instant};
use crate::effects::CoupledRotor;

/// Friction of a rotor that turns with two joints, its speed being ratio·dq_a + dq_b.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CoupledFriction {
    /// 0-based joints a and b.
    pub(super) joints: [usize; 2],
    /// Share of the speed of a.
    pub(super) ratio: f64,
    /// N.m.s/rad.
    pub(super) viscous: f64,
    /// N.m.
    pub(super) coulomb: f64,
}

impl ExtraTorque for CoupledFriction {
    fn torque(&self, at: &Instant<'_>, out: &mut [f64]) {
        let [a, b] = self.joints;
        let speed = self.ratio * at.dq[a] + at.dq[b];
        let friction = self.viscous * speed + self.coulomb * CoupledRotor::direction(speed);
        out[a] += self.ratio * friction;
        out[b] += friction;
    }
}
