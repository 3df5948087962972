//! Hidden torques that the catalogue's own joint laws do not make in a simulation.

use dynid_runtime::effects::unit_force_torques;
use dynid_runtime::model::{Link, Robot};
use dynid_runtime::simulation::{ExtraTorque, Instant};

/// Part of a joint's dry friction that builds up over a distance after a reversal (Dahl 1968).
pub struct Dahl {
    /// 0-based joint.
    pub joint: usize,
    /// The part of the friction level, N.m or N.
    pub level: f64,
    /// rad or m.
    pub distance: f64,
    /// Built-up fraction, -1 to 1.
    pub state: f64,
    /// Position at the last step.
    pub last: Option<f64>,
}

impl ExtraTorque for Dahl {
    fn torque(&self, _: &Instant<'_>, out: &mut [f64]) {
        out[self.joint] += self.level * self.state;
    }

    fn dry_friction(&self, _: &Instant<'_>, levels: &mut [[f64; 2]]) {
        for level in &mut levels[self.joint] {
            *level -= self.level;
        }
    }

    fn has_dry_friction(&self) -> bool {
        true
    }

    fn advance(&mut self, at: &Instant<'_>, _: f64) {
        let q = at.q[self.joint];
        let travel = q - self.last.unwrap_or(q);
        let toward = if travel < 0.0 { -1.0 } else { 1.0 };
        self.state = toward + (self.state - toward) * (-travel.abs() / self.distance).exp();
        self.last = Some(q);
    }
}

/// Friction of a rotor that turns with two joints, its speed being ratio·dq_a + dq_b.
pub struct CoupledRotor {
    /// 0-based joints a and b.
    pub joints: [usize; 2],
    /// Share of the speed of a.
    pub ratio: f64,
    /// N.m.s/rad.
    pub viscous: f64,
    /// N.m.
    pub coulomb: f64,
}

/// Speed over which the sign of the rotor's velocity turns, rad/s: it must not chatter at rest.
const ROUNDING: f64 = 0.01;

impl ExtraTorque for CoupledRotor {
    fn torque(&self, at: &Instant<'_>, out: &mut [f64]) {
        let [a, b] = self.joints;
        let speed = self.ratio * at.dq[a] + at.dq[b];
        let friction = self.viscous * speed + self.coulomb * (speed / ROUNDING).tanh();
        out[a] += self.ratio * friction;
        out[b] += friction;
    }
}

/// A force on the last link in a time window.
pub struct Push<'m> {
    /// The robot.
    pub robot: &'m Robot,
    /// Its links.
    pub links: Vec<Link<f64>>,
    /// 0-based frame at whose origin the force acts.
    pub frame: usize,
    /// Largest force in frame 0, N.
    pub force: [f64; 3],
    /// From, to, s.
    pub window: [f64; 2],
}

impl ExtraTorque for Push<'_> {
    fn torque(&self, at: &Instant<'_>, out: &mut [f64]) {
        let [from, to] = self.window;
        if at.time <= from || at.time >= to {
            return;
        }
        let height = (std::f64::consts::PI * (at.time - from) / (to - from)).sin().powi(2);
        let mut unit = [Vec::new(), Vec::new(), Vec::new()];
        unit_force_torques(self.robot, &self.links, self.frame, at.q, &mut unit);
        for (axis, force) in unit.iter().zip(self.force) {
            for (torque, column) in out.iter_mut().zip(axis) {
                *torque += height * force * column;
            }
        }
    }
}
