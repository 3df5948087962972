//! A rigid body added at the flange.

use super::{BodyOnLink, Words};
use crate::model::Robot;

/// What a person is told.
pub(super) const WORDS: Words = Words {
    id: "payload",
    title: "Payload",
    what: "A rigid body is attached to the flange that the model does not know.",
    looks_like: "gravity and inertia torques of all joints as of one body at the flange",
    revealed_by: "joint position",
    experiment: "slow and fast motions of the last three joints with the arm stretched out",
    source: "Khalil, Gautier and Lemoine 2007; Swevers, Verdonck and De Schutter 2007",
};

/// The law.
pub(super) struct Payload;

impl BodyOnLink for Payload {
    fn links(&self, robot: &Robot) -> Vec<usize> {
        robot.joint_of_frame().iter().rposition(Option::is_some).into_iter().collect()
    }
}
