//! Recorded torque that is off by a factor on one joint.

use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, Step, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "torque_constant_error",
    name: "torque constant error",
    what: "The torque recorded on one joint is off by a factor: a wrong drive gain or torque constant.",
    looks_like: "a residual proportional to the whole torque of the joint, friction and inertia alike",
    revealed_by: "model torque",
    experiment: "the same motion with a known load, or with a payload of known mass",
    source: "Gautier and Briot 2014 on drive gains",
    symbols: &[("factor", "recorded torque in multiples of the real one")],
    put_in: "`torque: {gain: [...]}` in the recording YAML",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::Always,
    follows_parameters: true,
    repeats: false,
    special_case: None,
    abscissa: Abscissa::ModelTorque,
    along_motion: false,
    may_stand: false,
    is_factor: true,
};

/// The effect.
pub(super) struct TorqueConstantError;

impl Effect for TorqueConstantError {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&TorqueConstantError)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("the recorded torque is {} times the real one", q.text("factor"))
    }

    fn formula(&self, q: &Quantities) -> String {
        format!("({} - 1)·(model torque)", q.value("factor"))
    }
}

impl JointLaw for TorqueConstantError {
    fn amplitudes(&self, _: &[f64]) -> usize {
        1
    }

    fn shapes(&self, _: &Scale) -> Vec<Vec<f64>> {
        vec![vec![]]
    }

    fn steps(&self, _: &Scale) -> Vec<Step> {
        Vec::new()
    }

    fn only_positive(&self) -> bool {
        false
    }

    fn looks_at_torque(&self) -> bool {
        true
    }

    fn law(&self, _: &Scale, _: &[f64], at: &At, _: f64, out: &mut [f64]) {
        out[0] = at.torque;
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Smooth
    }

    fn parameters(&self, _: &Scale, _: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        vec![Parameter::new("factor", 1.0 + a[0], s[0], "1")]
    }
}
