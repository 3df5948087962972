//! What is judged.

use crate::estimation::observe::ObserveSettings;
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
