//! Friction that differs between two recordings by a factor.

use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, Step, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "friction_level_change",
    title: "Friction level change",
    what: "Friction has changed since the baseline by one factor while inertias have not: other temperature, other lubricant, wear.",
    looks_like: "a residual proportional to the friction of the baseline",
    revealed_by: "friction torque of the baseline",
    experiment: "repeat the baseline motion at the same temperature",
    source: "Bittencourt and Gunnarsson 2012",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::OnlyAgainstBaseline,
    follows_parameters: true,
    repeats: false,
    special_case: None,
    abscissa: Abscissa::ModelTorque,
    along_motion: false,
};

/// The effect.
pub(super) struct FrictionLevelChange;

impl Effect for FrictionLevelChange {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&FrictionLevelChange)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("friction is {} times that of the baseline", q.text("factor"))
    }

    fn formula(&self, q: &Quantities) -> String {
        format!("({} - 1)·(Fv·dq + Fc·sign(dq))", q.value("factor"))
    }
}

impl JointLaw for FrictionLevelChange {
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
        out[0] = at.friction;
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Dry
    }

    fn parameters(&self, _: &Scale, _: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        vec![Parameter::new("factor", 1.0 + a[0], s[0], "1")]
    }
}
