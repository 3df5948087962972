//! The load that losses in a gear are proportional to.
//!
//! Teeth and bearings are pressed by what passes through them. A rotor in front of the gear does not press them; where
//! the pressing has a slow part only, as by a preload that follows the weight, gravity alone counts (Hamon, Gautier and
//! Garrec 2011 compare the quasi-static load with the full one).

use super::joint_law::At;
use super::quantity::{Parameter, Quantities};

/// What a loss is proportional to; the shape of a law has one number for it, or none for [`GearLoad::Whole`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum GearLoad {
    /// Gravity alone.
    Gravity,
    /// Inertia and gravity, the rotor's inertia included.
    Whole,
    /// Inertia and gravity of the links.
    Links,
}

/// Shapes to try, the usual load in the middle.
pub(super) fn shapes() -> Vec<Vec<f64>> {
    [GearLoad::Gravity, GearLoad::Whole, GearLoad::Links].map(GearLoad::shape).to_vec()
}

impl GearLoad {
    /// The load that a shape means.
    pub(super) fn of(shape: &[f64]) -> Self {
        match shape.first() {
            None => Self::Whole,
            Some(x) if *x < 0.5 => Self::Gravity,
            Some(_) => Self::Links,
        }
    }

    /// The shape that means it.
    pub(super) fn shape(self) -> Vec<f64> {
        match self {
            Self::Gravity => vec![0.0],
            Self::Whole => Vec::new(),
            Self::Links => vec![1.0],
        }
    }

    /// Its value at an instant, N.m or N.
    pub(super) fn at(self, at: &At) -> f64 {
        match self {
            Self::Gravity => at.gravity,
            Self::Whole => at.load,
            Self::Links => at.link,
        }
    }

    const GRAVITY: &'static str = "load_of_gravity_alone";
    const LINKS: &'static str = "load_without_rotor";

    /// The quantity that says which load it is, where it is not the whole.
    pub(super) fn parameter(self) -> Option<Parameter> {
        let name = match self {
            Self::Whole => return None,
            Self::Gravity => Self::GRAVITY,
            Self::Links => Self::LINKS,
        };
        Some(Parameter::new(name, 1.0, 0.0, "1"))
    }

    /// The load that quantities tell of.
    pub(super) fn told(q: &Quantities) -> Self {
        if q.has(Self::GRAVITY) {
            Self::Gravity
        } else if q.has(Self::LINKS) {
            Self::Links
        } else {
            Self::Whole
        }
    }

    /// What a person calls it.
    pub(super) fn words(self) -> &'static str {
        match self {
            Self::Gravity => "the torque of gravity alone",
            Self::Whole => "the load torque",
            Self::Links => "the load torque without the rotor's inertia",
        }
    }

    /// Its name in a formula.
    pub(super) fn symbol(self) -> &'static str {
        match self {
            Self::Gravity => "gravity",
            Self::Whole => "load",
            Self::Links => "link load",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_shape_is_told_as_the_load_that_it_means() {
        let at = At { load: 3.0, link: 2.0, gravity: 1.0, ..At::default() };
        let values: Vec<f64> = shapes().iter().map(|shape| GearLoad::of(shape).at(&at)).collect();
        assert_eq!(values, [1.0, 3.0, 2.0]);
        for shape in shapes() {
            let load = GearLoad::of(&shape);
            assert_eq!(GearLoad::told(&Quantities::new(load.parameter().into_iter().collect())), load);
        }
    }
}
