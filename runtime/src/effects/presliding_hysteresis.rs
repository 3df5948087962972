//! Friction that builds up over a displacement after a reversal (Dahl).

use super::{At, JointLaw, Parameter, Scale, Words};

/// What a person is told.
pub(super) const WORDS: Words = Words {
    id: "presliding_hysteresis",
    title: "Presliding hysteresis",
    what: "After a reversal friction does not jump: it builds up over a small displacement, as contacts bend before they slide.",
    looks_like: "a residual after every reversal that dies out over a distance, whatever the speed",
    revealed_by: "distance since reversal",
    experiment: "small slow reversals of growing amplitude around several positions",
    source: "Dahl 1968; Canudas de Wit et al. 1995; Al-Bender, Lampaert and Swevers 2005",
};

/// The law.
pub(super) struct PreslidingHysteresis;

impl JointLaw for PreslidingHysteresis {
    fn amplitudes(&self, _: &[f64]) -> usize {
        1
    }

    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        super::joint_law::geometric(0.002, 0.08, 8).iter().map(|x| vec![x * scale.range]).collect()
    }

    fn refinement(&self) -> &'static [f64] {
        &[1.6]
    }

    fn only_positive(&self) -> bool {
        true
    }

    /// The memory z in [-1, 1] is the fraction of the friction that has built up; sign v is taken off because the
    /// standard model has it, so that the column is what builds up late.
    fn law(&self, _: &Scale, _: &[f64], at: &At, memory: f64, out: &mut [f64]) {
        out[0] = memory - at.sign;
    }

    fn advance(&self, shape: &[f64], memory: f64, travel: f64) -> f64 {
        let toward = if travel > 0.0 { 1.0 } else { -1.0 };
        toward + (memory - toward) * (-travel.abs() / shape[0]).exp()
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new("level", a[0], s[0], scale.torque_unit()),
            Parameter::new("distance", shape[0], 0.0, scale.position_unit()),
        ]
    }
}
