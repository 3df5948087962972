//! Torque constant that droops at high current: a·tau·|tau/tau_max|^(p-1).

use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, Step, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "torque_saturation",
    title: "Torque saturation",
    what: "At high current the motor gives less torque than the recording says: its iron saturates.",
    looks_like: "a residual that bends with the torque of the joint and matters only at high torque",
    revealed_by: "model torque",
    experiment: "strokes with the highest accelerations, and the same motion at a third of them",
    source: "Krishnan 2010",
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
    standing_friction: false,
};

/// The effect.
pub(super) struct TorqueSaturation;

impl Effect for TorqueSaturation {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&TorqueSaturation)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("the torque constant is off by {} at the highest torque", q.text("droop_at_most_torque"))
    }

    fn formula(&self, q: &Quantities) -> String {
        format!(
            "{}·{}·|torque / {1}|^{}·sign(torque)",
            q.value("droop_at_most_torque"),
            q.value("most_torque"),
            q.value("exponent")
        )
    }
}

impl JointLaw for TorqueSaturation {
    fn amplitudes(&self, _: &[f64]) -> usize {
        1
    }

    fn shapes(&self, _: &Scale) -> Vec<Vec<f64>> {
        [2.0, 3.0, 5.0].iter().map(|&p| vec![p]).collect()
    }

    /// Exponents between those of the grid are not told apart.
    fn steps(&self, _: &Scale) -> Vec<Step> {
        Vec::new()
    }

    fn only_positive(&self) -> bool {
        false
    }

    fn law(&self, scale: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        let relative = at.torque / scale.torque;
        out[0] = scale.torque * relative.abs().powf(shape[0]) * relative.signum();
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Smooth
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        vec![
            Parameter::new("droop_at_most_torque", a[0], s[0], "1"),
            Parameter::new("most_torque", scale.torque, 0.0, scale.torque_unit()),
            Parameter::new("exponent", shape[0], 0.0, "1"),
        ]
    }
}
