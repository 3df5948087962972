//! Friction that differs by direction beyond a constant offset: f·|v|.

use crate::effects::closed_form::number;
use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, Step, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "asymmetric_friction",
    name: "asymmetric friction",
    what: "Friction rises differently with speed in the two directions of motion.",
    looks_like: "a residual that is even in the speed: the two branches of the friction curve have different slopes",
    revealed_by: "joint speed",
    experiment: "constant-speed strokes at several speeds, the same in both directions",
    source: "Armstrong-Helouvry 1991",
    symbols: &[(
        "half_difference",
        "half of the difference between the viscous friction of the two directions",
    )],
    put_in: "the law as a torque of the joint",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::Always,
    follows_parameters: false,
    repeats: false,
    special_case: None,
    abscissa: Abscissa::Speed,
    along_motion: false,
    may_stand: true,
    is_factor: false,
};

/// The effect.
pub(super) struct AsymmetricFriction;

impl Effect for AsymmetricFriction {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&AsymmetricFriction)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("viscous friction differs by direction, half the difference is {}", q.text("half_difference"))
    }

    fn formula(&self, q: &Quantities) -> String {
        format!("{}·|dq|", q.value("half_difference"))
    }
}

impl JointLaw for AsymmetricFriction {
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

    fn law(&self, _: &Scale, _: &[f64], at: &At, _: f64, out: &mut [f64]) {
        out[0] = at.dq * at.sign;
    }

    fn closed_form(&self, _: &Scale, _: &[f64], amplitude: &[f64], j: usize) -> Option<String> {
        Some(format!("{}*abs(dq{j})", number(*amplitude.first()?)))
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Smooth
    }

    fn parameters(&self, scale: &Scale, _: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let unit = scale.kind.viscous_unit();
        vec![Parameter::new("half_difference", a[0], s[0], unit)]
    }
}
