//! A declared time base that is wrong: the derivative of the model with respect to the scale of time.

use super::{Seeds, Sensitivity, Variant, Words};
use crate::model::Robot;

/// What a person is told.
pub(super) const WORDS: Words = Words {
    id: "wrong_sample_rate",
    title: "Wrong sample rate",
    what: "The time base is wrong: speeds and accelerations are off by a factor and its square while gravity is not.",
    looks_like: "inertia and gravity torques that do not agree on one scale of time",
    revealed_by: "acceleration",
    experiment: "slow and fast runs of one path; a stopwatch",
    source: "Khalil and Dombre 2002",
};

/// The law.
pub(super) struct WrongSampleRate;

impl Sensitivity for WrongSampleRate {
    fn variants(&self, _: &Robot) -> Vec<Variant> {
        vec![Variant { joint: None, index: 0, name: "rate_error", unit: "1" }]
    }

    /// The true rate is (1 + e) times the declared one: dq (1 + e), ddq (1 + e)².
    fn seed(&self, _: &Variant, seeds: &mut Seeds<'_>) {
        for j in 0..seeds.q.len() {
            seeds.dq[j].slope = seeds.dq[j].value;
            seeds.ddq[j].slope = 2.0 * seeds.ddq[j].value;
        }
    }
}
