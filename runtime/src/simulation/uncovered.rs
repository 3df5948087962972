//! Torques of parameters that a robot as it is in its table hides, and an error of the table uncovers.

use super::extra::{ExtraTorque, Instant};
use crate::effects::Sensitivity;
use crate::model::Robot;

/// The columns that an error uncovers, with their amplitudes, as torques of a simulated robot.
pub(super) struct UncoveredTorque<'a> {
    pub law: &'static dyn Sensitivity,
    /// The robot as it is in its table.
    pub robot: &'a Robot,
    pub amplitude: &'a [f64],
}

impl ExtraTorque for UncoveredTorque<'_> {
    fn torque(&self, at: &Instant<'_>, out: &mut [f64]) {
        let q: Vec<Vec<f64>> = at.q.iter().map(|q| vec![*q]).collect();
        for ((joint, column), a) in self.law.uncovered(self.robot, &q).iter().zip(self.amplitude) {
            out[*joint] += a * column[0];
        }
    }
}
