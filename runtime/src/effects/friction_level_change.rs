//! Friction that differs between two recordings by a factor.

use super::{At, JointLaw, Parameter, Scale, Words};

/// What a person is told.
pub(super) const WORDS: Words = Words {
    id: "friction_level_change",
    title: "Friction level change",
    what: "Friction has changed since the baseline by one factor while inertias have not: other temperature, other lubricant, wear.",
    looks_like: "a residual proportional to the friction of the baseline",
    revealed_by: "friction torque of the baseline",
    experiment: "repeat the baseline motion at the same temperature",
    source: "Bittencourt and Gunnarsson 2012",
};

/// The law.
pub(super) struct FrictionLevelChange;

impl JointLaw for FrictionLevelChange {
    fn amplitudes(&self, _: &[f64]) -> usize {
        1
    }

    fn shapes(&self, _: &Scale) -> Vec<Vec<f64>> {
        vec![vec![]]
    }

    fn law(&self, _: &Scale, _: &[f64], at: &At, _: f64, out: &mut [f64]) {
        out[0] = at.friction;
    }

    fn is_dry(&self, _: &[f64], _: &[f64]) -> bool {
        true
    }

    fn parameters(&self, _: &Scale, _: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        vec![Parameter::new("factor", 1.0 + a[0], s[0], "1")]
    }
}
