//! Friction that differs by direction beyond a constant offset: f·|v|.

use super::{At, JointLaw, Parameter, Scale, Words};

/// What a person is told.
pub(super) const WORDS: Words = Words {
    id: "asymmetric_friction",
    title: "Asymmetric friction",
    what: "Friction rises differently with speed in the two directions of motion.",
    looks_like: "a residual that is even in the speed: the two branches of the friction curve have different slopes",
    revealed_by: "joint speed",
    experiment: "constant-speed strokes at several speeds, the same in both directions",
    source: "Armstrong-Helouvry 1991",
};

/// The law.
pub(super) struct AsymmetricFriction;

impl JointLaw for AsymmetricFriction {
    fn amplitudes(&self, _: &[f64]) -> usize {
        1
    }

    fn shapes(&self, _: &Scale) -> Vec<Vec<f64>> {
        vec![vec![]]
    }

    fn law(&self, _: &Scale, _: &[f64], at: &At, _: f64, out: &mut [f64]) {
        out[0] = at.dq * at.sign;
    }

    fn parameters(&self, scale: &Scale, _: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let unit = if scale.prismatic { "N.s/m" } else { "N.m.s/rad" };
        vec![Parameter::new("half_difference", a[0], s[0], unit)]
    }
}
