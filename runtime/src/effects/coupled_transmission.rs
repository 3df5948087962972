//! A rotor that two joints drive: its speed is dq_b + ratio·dq_a.

use super::Words;

/// What a person is told.
pub(super) const WORDS: Words = Words {
    id: "coupled_transmission",
    title: "Coupled transmission",
    what: "A motor turns with two joints at once, so that its friction and inertia act on both.",
    looks_like: "friction of one joint that depends on the speed of its neighbour",
    revealed_by: "speed of the neighbouring joint",
    experiment: "move the two joints at the same time with all four combinations of directions",
    source: "Gautier and Briot 2012, equations (25) and (26)",
};

/// The coupling of joint b's motor to joint a.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CoupledTransmission {
    /// Ratio of the motor's speed to dq_a, in units of its ratio to dq_b.
    pub ratio: f64,
}

impl CoupledTransmission {
    /// Ratios to try.
    pub const RATIOS: [f64; 6] = [-1.0, -0.5, -0.25, 0.25, 0.5, 1.0];

    /// Columns for viscous friction, Coulomb friction and inertia of the rotor: `[on a, on b]` each.
    pub fn columns(&self, dq: [f64; 2], ddq: [f64; 2]) -> [[f64; 2]; 3] {
        let v = self.ratio * dq[0] + dq[1];
        let dv = self.ratio * ddq[0] + ddq[1];
        let sign = if v == 0.0 { 0.0 } else { v.signum() };
        [v, sign, dv].map(|x| [self.ratio * x, x])
    }
}
