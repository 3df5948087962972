//! Torque and position channels that are not simultaneous: the derivative of the model with respect to time.

use super::{Seeds, Sensitivity, Variant, Words};
use crate::model::Robot;

/// What a person is told.
pub(super) const WORDS: Words = Words {
    id: "time_delay",
    title: "Time delay",
    what: "Torque and position were not recorded at the same instant.",
    looks_like: "a residual proportional to the rate of change of the torque, on every joint",
    revealed_by: "rate of change of the torque",
    experiment: "any fast motion; compare with a tap on the arm seen in both channels",
    source: "Janot, Vandanjon and Gautier 2014",
};

/// The law.
pub(super) struct TimeDelay;

impl Sensitivity for TimeDelay {
    fn variants(&self, _: &Robot) -> Vec<Variant> {
        vec![Variant { joint: None, index: 0, name: "delay", unit: "s" }]
    }

    /// torque(t - delay) = torque(t) - delay · d torque / dt.
    fn seed(&self, _: &Variant, seeds: &mut Seeds<'_>) {
        for j in 0..seeds.q.len() {
            seeds.q[j].slope = -seeds.dq[j].value;
            seeds.dq[j].slope = -seeds.ddq[j].value;
            seeds.ddq[j].slope = -seeds.jerk[j];
        }
    }
}
