//! Stribeck friction: the level falls as the joint leaves rest. fs·exp(-(v/vs)²)·sign v.

use super::{At, JointLaw, Parameter, Scale, Words};

/// What a person is told.
pub(super) const WORDS: Words = Words {
    id: "stribeck",
    title: "Stribeck friction",
    what: "Friction is higher close to rest and falls as the joint gathers speed, because a lubricant film builds up.",
    looks_like: "a peak of the residual on both sides of zero speed, with the sign of the speed",
    revealed_by: "joint speed",
    experiment: "slow constant-speed strokes in both directions at several speeds between a hundredth and a fifth of the top speed",
    source: "Stribeck 1902; Armstrong-Helouvry, Dupont and Canudas de Wit 1994",
};

/// The law.
pub(super) struct Stribeck;

impl JointLaw for Stribeck {
    fn amplitudes(&self, _: &[f64]) -> usize {
        1
    }

    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        super::joint_law::geometric(0.012, 0.35, 10).iter().map(|x| vec![x * scale.speed]).collect()
    }

    fn refinement(&self) -> &'static [f64] {
        &[1.45]
    }

    fn only_positive(&self) -> bool {
        true
    }

    fn law(&self, _: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        out[0] = (-(at.dq / shape[0]).powi(2)).exp() * at.sign;
    }

    fn is_dry(&self, _: &[f64], _: &[f64]) -> bool {
        true
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new("fs", a[0], s[0], scale.torque_unit()),
            Parameter::new("vs", shape[0], 0.0, scale.speed_unit()),
        ]
    }
}
