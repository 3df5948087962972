//! A torque channel that hears a neighbour: k·(torque of the other joint).

use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, HEARD_JOINT, JointLaw, Parameter, Properties, Quantities, Scale,
    SmoothingWindow, Sought, Step, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "torque_crosstalk",
    name: "torque crosstalk",
    what: "The torque recorded on one joint holds a part of that of a neighbour: a sensor that is bent by other loads, or lines that hear each other.",
    looks_like: "a residual proportional to the torque of another joint, its friction included",
    revealed_by: "model torque of the other joint",
    experiment: "moving the neighbour alone, fast and slowly, while this joint stands still",
    source: "Khosla and Kanade 1985 on what a joint's torque may hold; sensors: Hirzinger et al. 2002",
    symbols: &[("k", "part of the other joint's torque"), ("heard_joint", "number of the other joint")],
    put_in: "a torque channel to which a part of another one is added",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::Always,
    follows_parameters: true,
    repeats: false,
    special_case: None,
    abscissa: Abscissa::HeardTorque,
    along_motion: false,
    may_stand: true,
    is_factor: true,
};

/// The effect.
pub(super) struct TorqueCrosstalk;

impl Effect for TorqueCrosstalk {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Heard(&TorqueCrosstalk)
    }

    fn detail(&self, q: &Quantities) -> String {
        let joint = q.number(HEARD_JOINT).unwrap_or(0.0);
        format!("it holds {} of the torque of joint {joint:.0}", q.text("k"))
    }

    fn formula(&self, q: &Quantities) -> String {
        let joint = q.number(HEARD_JOINT).unwrap_or(0.0);
        format!("{}·(model torque of joint {joint:.0})", q.value("k"))
    }
}

impl JointLaw for TorqueCrosstalk {
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
        vec![Parameter::new("k", a[0], s[0], "1")]
    }
}
