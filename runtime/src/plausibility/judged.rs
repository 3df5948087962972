//! What is judged.

use crate::estimation::observe::{Observation, ObserveSettings};
use crate::estimation::{Estimate, EstimateSettings, estimate};
use crate::model::Model;
use crate::signal::Motion;

/// A recording as one of a robot.
#[derive(Clone, Copy)]
pub struct Judged<'a> {
    /// The robot that it names.
    pub model: &'a dyn Model,
    /// Its motions; of a long one those of its beginning.
    pub motions: &'a [Motion],
    /// How equations are sampled from it.
    pub settings: &'a ObserveSettings,
    /// Whether it was recorded on the motors' side of the gear.
    pub motor_side: bool,
}

/// The free weighted estimate that another explanation of the recording is judged by: values and errors alone.
pub(super) fn free_estimate(observation: &Observation) -> Estimate {
    let settings = EstimateSettings {
        r_sigma: None,
        block_sigmas: false,
        lasting_noise: false,
        ..EstimateSettings::default()
    };
    estimate(observation, &settings)
}
