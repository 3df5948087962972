//! Friction that changes with time as the joint warms up: (viscous, Coulomb)·exp(-t/tau).

use super::{At, JointLaw, Parameter, Scale, Words};

/// What a person is told.
pub(super) const WORDS: Words = Words {
    id: "friction_drift",
    title: "Friction drift",
    what: "Friction changes in the course of the motion: the joint warms up and its lubricant thins.",
    looks_like: "a residual proportional to friction that fades with time in every motion",
    revealed_by: "time",
    experiment: "the same motion repeated for several minutes from a cold start",
    source: "Bittencourt et al. 2010; Simoni et al. 2015",
};

/// The law.
pub(super) struct FrictionDrift;

impl JointLaw for FrictionDrift {
    /// The first shape parameter says what drifts: 0 viscous, 1 Coulomb, 2 both.
    fn amplitudes(&self, shape: &[f64]) -> usize {
        if shape[0] > 1.5 { 2 } else { 1 }
    }

    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let times = [0.2, 0.4, 0.8, 1.5, 4.0];
        [0.0, 1.0, 2.0]
            .iter()
            .flat_map(|&what| times.iter().map(move |t| vec![what, t * scale.duration]))
            .collect()
    }

    fn refinement(&self) -> &'static [f64] {
        &[1.0, 1.6]
    }

    fn law(&self, scale: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        let faded = (-at.time / shape[1]).exp();
        let viscous = at.dq / scale.speed * faded;
        let coulomb = at.sign * faded;
        if shape[0] < 0.5 {
            out[0] = viscous;
        } else if shape[0] < 1.5 {
            out[0] = coulomb;
        } else {
            out[0] = viscous;
            out[1] = coulomb;
        }
    }

    fn is_dry(&self, _: &[f64], _: &[f64]) -> bool {
        true
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let unit = if scale.prismatic { "N.s/m" } else { "N.m.s/rad" };
        let mut out = Vec::new();
        if shape[0] < 0.5 || shape[0] > 1.5 {
            out.push(Parameter::new("viscous", a[0] / scale.speed, s[0] / scale.speed, unit));
        }
        if shape[0] > 0.5 {
            let last = a.len() - 1;
            out.push(Parameter::new("coulomb", a[last], s[last], scale.torque_unit()));
        }
        out.push(Parameter::new("tau", shape[1], 0.0, "s"));
        out
    }
}
