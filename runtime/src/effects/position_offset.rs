//! Encoder zero that is off on a joint: the derivative of the model with respect to q.

use super::{Seeds, Sensitivity, Variant, Words};
use crate::model::Robot;

/// What a person is told.
pub(super) const WORDS: Words = Words {
    id: "position_offset",
    title: "Position offset",
    what: "The zero of an encoder is off: the joint is not where the recording says.",
    looks_like: "gravity and coupling torques of several joints that are turned by a constant angle",
    revealed_by: "joint position",
    experiment: "slow motion of the joints below and above it, with the arm stretched out",
    source: "Hollerbach, Khalil and Gautier 2016",
};

/// The law.
pub(super) struct PositionOffset;

impl Sensitivity for PositionOffset {
    fn variants(&self, robot: &Robot) -> Vec<Variant> {
        (0..robot.joints()).map(|j| Variant::joint(j, "offset", "rad or m")).collect()
    }

    fn seed(&self, variant: &Variant, seeds: &mut Seeds<'_>) {
        seeds.q[variant.index].slope = 1.0;
    }
}
