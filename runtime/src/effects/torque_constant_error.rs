//! Recorded torque that is off by a factor on one joint.

use super::{At, JointLaw, Parameter, Scale, Words};

/// What a person is told.
pub(super) const WORDS: Words = Words {
    id: "torque_constant_error",
    title: "Torque constant error",
    what: "The torque recorded on one joint is off by a factor: a wrong drive gain or torque constant.",
    looks_like: "a residual proportional to the whole torque of the joint, friction and inertia alike",
    revealed_by: "model torque",
    experiment: "the same motion with a known load, or with a payload of known mass",
    source: "Gautier and Briot 2014 on drive gains",
};

/// The law.
pub(super) struct TorqueConstantError;

impl JointLaw for TorqueConstantError {
    fn amplitudes(&self, _: &[f64]) -> usize {
        1
    }

    fn shapes(&self, _: &Scale) -> Vec<Vec<f64>> {
        vec![vec![]]
    }

    fn law(&self, _: &Scale, _: &[f64], at: &At, _: f64, out: &mut [f64]) {
        out[0] = at.torque;
    }

    fn parameters(&self, _: &Scale, _: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        vec![Parameter::new("factor", 1.0 + a[0], s[0], "1")]
    }
}
