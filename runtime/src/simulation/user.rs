//! A law that the user wrote down as a torque of a simulated robot.

use super::extra::{ExtraTorque, Instant};
use crate::effects::{EffectTerm, UserLaw, Variable};
use crate::model::Robot;

/// The law as a torque.
pub(super) struct UserTorque {
    law: UserLaw,
    variables: Vec<Variable>,
    /// The variable that is the speed of its joint, where the law has its sign: what jumps with it is dry friction.
    own_speed: Option<usize>,
    shape: Vec<f64>,
    amplitude: Vec<f64>,
}

impl UserTorque {
    /// From a term; `None` where it does not fit the robot, and where the law looks at an acceleration, which follows from
    /// the torques.
    pub(super) fn new(robot: &Robot, term: &EffectTerm) -> Option<Self> {
        let law = term.place.law()?;
        let variables = law.variables(robot).ok()?;
        let sound = law.joint() < robot.joints()
            && law.has_shape(&term.shape)
            && law.constants().len() == term.amplitude.len()
            && !law.is_of_acceleration();
        let own = variables.iter().position(|v| *v == Variable::Speed(law.joint()));
        sound.then(|| Self {
            law,
            own_speed: own.filter(|k| law.has_sign_of(*k)),
            variables,
            shape: term.shape.clone(),
            amplitude: term.amplitude.clone(),
        })
    }

    /// The torque; where the sign of the joint's speed is in the law, if the joint moves in the direction `sign`.
    fn toward(&self, at: &Instant<'_>, sign: f64) -> f64 {
        let mut values = [0.0; UserLaw::MOST_VARIABLES];
        for (value, variable) in values.iter_mut().zip(&self.variables) {
            *value = match *variable {
                Variable::Position(j) => at.q[j],
                Variable::Speed(j) => at.dq[j],
                Variable::Load(j) => at.load[j],
                Variable::Time => at.time,
                // No law of a user has these; [`Self::new`] leaves accelerations out.
                Variable::Acceleration(_)
                | Variable::Torque(_)
                | Variable::TimeSinceReversal(_)
                | Variable::TravelSinceReversal(_) => 0.0,
            };
        }
        let mut columns = [0.0; UserLaw::MOST_CONSTANTS];
        let columns = &mut columns[..self.amplitude.len()];
        let direction = self.own_speed.map(|k| (k, sign));
        self.law.columns(&values[..self.variables.len()], &self.shape, direction, columns);
        columns.iter().zip(&self.amplitude).map(|(c, a)| c * a).sum()
    }
}

impl ExtraTorque for UserTorque {
    fn torque(&self, at: &Instant<'_>, out: &mut [f64]) {
        out[self.law.joint()] += self.toward(at, 0.0);
    }

    fn dry_friction(&self, at: &Instant<'_>, levels: &mut [[f64; 2]]) {
        if self.own_speed.is_none() {
            return;
        }
        let smooth = self.toward(at, 0.0);
        levels[self.law.joint()][0] -= self.toward(at, -1.0) - smooth;
        levels[self.law.joint()][1] += self.toward(at, 1.0) - smooth;
    }

    fn has_dry_friction(&self) -> bool {
        self.own_speed.is_some()
    }
}
