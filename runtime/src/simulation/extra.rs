//! How physics beyond the standard model enters a simulated robot.

/// What the robot does at one instant, joint by joint.
#[derive(Debug, Clone, Copy)]
pub struct Instant<'a> {
    /// Time since the start of the motion, s.
    pub time: f64,
    /// Positions of the joints on the motor side, rad or m: what an encoder sees. They differ from the links'
    /// only across an elastic joint.
    pub q: &'a [f64],
    /// Velocities on the motor side.
    pub dq: &'a [f64],
    /// Accelerations of the joints at the last step.
    pub ddq: &'a [f64],
    /// Torque that each joint transmits to the links (inertia and gravity, no friction) at the last step,
    /// N.m or N.
    pub load: &'a [f64],
    /// The same without the rotors whose inertias are parameters of their own.
    pub link: &'a [f64],
    /// What of it gravity asks for; zero where no effect says that it needs it.
    pub gravity: &'a [f64],
    /// Torque, dry friction included, of the effects that do not look at it themselves, N.m or N; zero for those.
    pub effects: &'a [f64],
}

/// An effect in a simulated robot. Every method has a default that does nothing.
///
/// Laws that change the sign with the direction of motion belong to [`ExtraTorque::dry_friction`], so that they
/// hold the joint at rest; everything else to [`ExtraTorque::torque`].
pub trait ExtraTorque: Send {
    /// Adds to `out[j]` the torque that drive j must provide beyond the standard model, N.m or N. Called several
    /// times a step: it must depend on nothing but `at` and the state that [`ExtraTorque::advance`] keeps.
    fn torque(&self, at: &Instant<'_>, out: &mut [f64]) {
        let _ = (at, out);
    }

    /// Adds to the dry friction level of each joint, `[in negative, in positive direction]`, N.m or N. The level
    /// may depend on the speed: with exp(-(v/vs)²) it is Stribeck friction. Levels below zero count as zero.
    fn dry_friction(&self, at: &Instant<'_>, levels: &mut [[f64; 2]]) {
        let _ = (at, levels);
    }

    /// Whether [`ExtraTorque::dry_friction`] is used.
    fn has_dry_friction(&self) -> bool {
        false
    }

    /// Whether [`Instant::effects`] is used: such an effect comes after all others.
    fn looks_at_effects(&self) -> bool {
        false
    }

    /// Whether [`Instant::gravity`] is used.
    fn needs_gravity(&self) -> bool {
        false
    }

    /// The robot has moved on by `step` seconds and is at `at`: update inner states.
    fn advance(&mut self, at: &Instant<'_>, step: f64) {
        let _ = (at, step);
    }
}
