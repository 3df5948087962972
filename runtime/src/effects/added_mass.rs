//! A rigid body added to an inner link.

use super::{BodyOnLink, Words};
use crate::model::Robot;

/// What a person is told.
pub(super) const WORDS: Words = Words {
    id: "added_mass",
    title: "Added mass",
    what: "A body is attached to an inner link that the model does not know: a dress pack, a valve block, a camera.",
    looks_like: "gravity and inertia torques of the joints below that link only",
    revealed_by: "joint position",
    experiment: "slow and fast motions of the joint that carries it and of those below",
    source: "Khalil, Gautier and Lemoine 2007",
};

/// The law.
pub(super) struct AddedMass;

impl BodyOnLink for AddedMass {
    fn links(&self, robot: &Robot) -> Vec<usize> {
        let mut links: Vec<usize> =
            robot.joint_of_frame().iter().enumerate().filter(|(_, j)| j.is_some()).map(|(k, _)| k).collect();
        links.pop();
        links
    }
}
