//! Coulomb friction that grows with the transmitted torque: mu·|load|·sign v.

use super::{At, JointLaw, Parameter, Scale, Words};

/// What a person is told.
pub(super) const WORDS: Words = Words {
    id: "load_dependent_friction",
    title: "Load-dependent friction",
    what: "The friction level grows with the torque that the joint transmits: gear teeth and bearings are pressed harder.",
    looks_like: "a residual with the sign of the speed whose size follows the load torque",
    revealed_by: "load torque",
    experiment: "the same strokes at low speed with the arm stretched out and folded, or with and without a payload",
    source: "Gogoussis and Donath 1988; Hamon, Gautier and Garrec 2011",
};

/// The law.
pub(super) struct LoadDependentFriction;

impl JointLaw for LoadDependentFriction {
    fn amplitudes(&self, _: &[f64]) -> usize {
        1
    }

    fn shapes(&self, _: &Scale) -> Vec<Vec<f64>> {
        vec![vec![]]
    }

    fn only_positive(&self) -> bool {
        true
    }

    fn law(&self, _: &Scale, _: &[f64], at: &At, _: f64, out: &mut [f64]) {
        out[0] = at.load.abs() * at.sign;
    }

    fn is_dry(&self, _: &[f64], _: &[f64]) -> bool {
        true
    }

    fn parameters(&self, _: &Scale, _: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        vec![Parameter::new("mu", a[0], s[0], "1")]
    }
}
