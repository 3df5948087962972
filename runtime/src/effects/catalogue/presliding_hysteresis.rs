//! Friction that builds up over a displacement after a reversal (Dahl).

use crate::effects::joint_law::geometric;
use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Moved, Parameter, Properties, Quantities, Scale,
    SmoothingWindow, Sought, Step, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "presliding_hysteresis",
    name: "presliding hysteresis",
    what: "After a reversal friction does not jump: it builds up over a small displacement, as contacts bend before they slide.",
    looks_like: "a residual after every reversal that dies out over a distance, whatever the speed",
    revealed_by: "distance since reversal",
    experiment: "small slow reversals of growing amplitude around several positions",
    source: "Dahl 1968; Canudas de Wit et al. 1995; Al-Bender, Lampaert and Swevers 2005",
    symbols: &[
        ("level", "part of the Coulomb friction that builds up"),
        ("distance", "travel after a reversal over which it does"),
    ],
    put_in: "the law as a torque of the joint",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::Always,
    follows_parameters: false,
    repeats: false,
    special_case: None,
    abscissa: Abscissa::SinceReversal,
    along_motion: false,
    may_stand: true,
    is_factor: false,
};

/// From this part of its top speed on a joint moves. Mechanics: slower ones may creep, or be noise of a joint at rest.
const MOVES: f64 = 0.05;

/// The effect.
pub(super) struct PreslidingHysteresis;

impl Effect for PreslidingHysteresis {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&PreslidingHysteresis)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("{} of the friction builds up over {} after a reversal", q.text("level"), q.text("distance"))
    }

    fn formula(&self, q: &Quantities) -> String {
        format!("-2·{}·exp(-(distance since reversal) / {})·sign(dq)", q.value("level"), q.value("distance"))
    }
}

impl JointLaw for PreslidingHysteresis {
    fn amplitudes(&self, _: &[f64]) -> usize {
        1
    }

    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        geometric(0.002, 0.08, 8).iter().map(|x| vec![x * scale.range]).collect()
    }

    fn steps(&self, _: &Scale) -> Vec<Step> {
        vec![Step::Times(1.6)]
    }

    fn only_positive(&self) -> bool {
        true
    }

    /// The memory z in [-1, 1] is the fraction of the friction that has built up; sign v is taken off because the
    /// standard model has it, so that the column is what builds up late.
    fn law(&self, _: &Scale, _: &[f64], at: &At, memory: f64, out: &mut [f64]) {
        out[0] = memory - at.sign;
    }

    /// A joint that moves when the recording begins has moved before.
    fn memory_at_start(&self, scale: &Scale, dq: f64) -> f64 {
        if dq.abs() > MOVES * scale.speed { dq.signum() } else { 0.0 }
    }

    fn has_memory(&self) -> bool {
        true
    }

    fn advance(&self, _: &Scale, shape: &[f64], memory: f64, moved: Moved) -> f64 {
        let toward = if moved.travel > 0.0 { 1.0 } else { -1.0 };
        toward + (memory - toward) * (-moved.travel.abs() / shape[0]).exp()
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::BuildsUp
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new("level", a[0], s[0], scale.kind.torque_unit()),
            Parameter::new("distance", shape[0], 0.0, scale.kind.position_unit()),
        ]
    }
}
