//! The unmodelled residue that a real robot has: friction that falls as a joint starts, grows with the load and
//! varies with the angle, and gears that ripple.

use super::extra::{ExtraTorque, Instant};
use crate::model::{ParameterKind, Robot};

/// Mild physics beyond the standard model, one value a joint.
#[derive(Debug, Clone, PartialEq)]
pub struct Residue {
    /// Stribeck friction at rest beyond Coulomb friction, N.m or N: fs·exp(-(v/vs)²).
    pub stribeck: Vec<f64>,
    /// Its speed vs, rad/s or m/s.
    pub stribeck_speed: Vec<f64>,
    /// Dry friction for each N.m (or N) of transmitted torque.
    pub load: Vec<f64>,
    /// Amplitude of the variation of dry friction over a turn (or metre) of the joint, N.m or N.
    pub uneven: Vec<f64>,
    /// Amplitude of the torque ripple, N.m or N.
    pub ripple: Vec<f64>,
    /// Its order, cycles for each turn of the motor.
    pub ripple_order: Vec<f64>,
    /// Its phase, rad.
    pub ripple_phase: Vec<f64>,
    /// Motor turns for each rad or m of the joint.
    turns: Vec<f64>,
}

impl Residue {
    /// Share of the dry friction that the ripple of [`Residue::typical`] has at size 1.
    pub const TYPICAL_RIPPLE: f64 = 0.25;

    /// Residue of a stated size relative to the dry friction of each joint, its motor's included. At `size` 1:
    /// Stribeck friction of 30 % below 0.1 rad/s (or m/s), 6 % of the transmitted torque, friction uneven by 25 %
    /// over a turn, and ripple of 25 % once a motor turn. That leaves residuals of the size of those of the public
    /// TX-40 recording (0.06 of the torques; joint by joint 0.05 to 0.12). `size` 0 is none.
    pub fn typical(robot: &Robot, standard: &[f64], size: f64) -> Self {
        let joint_of = robot.joint_of_frame();
        let n = robot.joints();
        let mut dry = vec![0.0; n];
        for (parameter, &value) in robot.standard.iter().zip(standard) {
            if let (ParameterKind::Fc | ParameterKind::Fcm, Some(j)) =
                (parameter.kind, joint_of[parameter.frame])
            {
                dry[j] += value;
            }
        }
        let share = |x: f64| dry.iter().map(|level| x * size * level).collect::<Vec<f64>>();
        Self {
            stribeck: share(0.3),
            stribeck_speed: vec![0.1; n],
            load: vec![0.06 * size; n],
            uneven: share(0.25),
            ripple: share(Self::TYPICAL_RIPPLE),
            ripple_order: vec![1.0; n],
            ripple_phase: (0..n).map(|j| 0.7 * j as f64).collect(),
            turns: (0..n).map(|j| robot.drive.gear[j * n + j].abs() / std::f64::consts::TAU).collect(),
        }
    }

    /// As an effect for [`super::Plant::with_effects`].
    pub fn boxed(self) -> Box<dyn ExtraTorque> {
        Box::new(self)
    }

    /// Ripple of the given amplitudes (N.m or N) and orders (cycles a motor turn), and nothing else.
    pub fn ripple_only(robot: &Robot, amplitude: &[f64], order: &[f64]) -> Self {
        let mut residue = Self::typical(robot, &vec![0.0; robot.standard.len()], 0.0);
        residue.ripple = amplitude.to_vec();
        residue.ripple_order = order.to_vec();
        residue
    }
}

impl ExtraTorque for Residue {
    fn torque(&self, at: &Instant<'_>, out: &mut [f64]) {
        for j in 0..out.len() {
            let turn = std::f64::consts::TAU * self.turns[j] * at.q[j];
            out[j] += self.ripple[j] * (self.ripple_order[j] * turn + self.ripple_phase[j]).sin();
        }
    }

    fn dry_friction(&self, at: &Instant<'_>, levels: &mut [[f64; 2]]) {
        for j in 0..levels.len() {
            let v = at.dq[j] / self.stribeck_speed[j];
            let uneven = self.uneven[j] * (at.q[j] + self.ripple_phase[j]).sin();
            let more = self.stribeck[j] * (-v * v).exp() + self.load[j] * at.load[j].abs() + uneven;
            levels[j][0] += more;
            levels[j][1] += more;
        }
    }

    fn has_dry_friction(&self) -> bool {
        true
    }
}
