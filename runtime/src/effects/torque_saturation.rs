//! Torque constant that droops at high current: a·tau·|tau/tau_max|^(p-1).

use super::{At, JointLaw, Parameter, Scale, Words};

/// What a person is told.
pub(super) const WORDS: Words = Words {
    id: "torque_saturation",
    title: "Torque saturation",
    what: "At high current the motor gives less torque than the recording says: its iron saturates.",
    looks_like: "a residual that bends with the torque of the joint and matters only at high torque",
    revealed_by: "model torque",
    experiment: "strokes with the highest accelerations, and the same motion at a third of them",
    source: "Krishnan 2010",
};

/// The law.
pub(super) struct TorqueSaturation;

impl JointLaw for TorqueSaturation {
    fn amplitudes(&self, _: &[f64]) -> usize {
        1
    }

    fn shapes(&self, _: &Scale) -> Vec<Vec<f64>> {
        [2.0, 3.0, 5.0].iter().map(|&p| vec![p]).collect()
    }

    fn law(&self, scale: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        let relative = at.torque / scale.torque;
        out[0] = scale.torque * relative.abs().powf(shape[0]) * relative.signum();
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new("droop_at_most_torque", a[0], s[0], "1"),
            Parameter::new("most_torque", scale.torque, 0.0, scale.torque_unit()),
            Parameter::new("exponent", shape[0], 0.0, "1"),
        ]
    }
}
