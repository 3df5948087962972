//! Torque constant that droops at high current: a·tau·|tau/tau_max|^(p-1), or beyond a knee k only:
//! a·tau·(max(|tau/tau_max| - k, 0) / (1 - k))^(p-1).

use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, Step, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "torque_saturation",
    name: "torque saturation",
    what: "At high current the motor gives less torque than the recording says: its iron saturates.",
    looks_like: "a residual that bends with the torque of the joint and matters only at high torque",
    revealed_by: "model torque",
    experiment: "strokes with the highest accelerations, and the same motion at a third of them",
    source: "Krishnan 2010",
    symbols: &[
        ("droop_at_most_torque", "part of the largest torque that is missing there"),
        ("most_torque", "largest torque of the recording"),
        ("exponent", "power of the torque with which it droops"),
        ("knee", "part of the largest torque from which it droops"),
        ("torque", "torque of the drive: of the standard model and of the other laws of the joint"),
    ],
    put_in: "the law as a torque of the joint",
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
    is_factor: false,
};

/// A knee leaves at least this part of the torque beyond it.
const LEAST_BEYOND: f64 = 0.02;

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
        let knee = if q.has("knee") {
            format!(", and by nothing below {} of it", q.text("knee"))
        } else {
            String::new()
        };
        format!(
            "the torque constant is off by {} at the highest torque{knee}",
            q.text("droop_at_most_torque")
        )
    }

    fn formula(&self, q: &Quantities) -> String {
        if q.has("knee") {
            let (most, knee) = (q.value("most_torque"), q.value("knee"));
            return format!(
                "{}·torque·max(|torque / {most}| - {knee}, 0) / (1 - {knee})",
                q.value("droop_at_most_torque")
            );
        }
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
        // Beyond a knee the droop grows with the torque.
        let bent = |p: f64| vec![p];
        let beyond = |knee: f64| vec![2.0, knee];
        vec![bent(2.0), beyond(0.35), beyond(0.5), bent(3.0), beyond(0.65), beyond(0.8), bent(5.0)]
    }

    /// Exponents between those of the grid are not told apart.
    fn steps(&self, _: &Scale) -> Vec<Step> {
        vec![Step::Keep, Step::Times(1.15)]
    }

    fn only_positive(&self) -> bool {
        true
    }

    fn looks_at_torque(&self) -> bool {
        true
    }

    fn law(&self, scale: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        let relative = at.torque / scale.torque;
        out[0] = match shape.get(1) {
            None => scale.torque * relative.abs().powf(shape[0]) * relative.signum(),
            Some(&knee) => {
                let beyond = (relative.abs() - knee).max(0.0) / (1.0 - knee).max(LEAST_BEYOND);
                at.torque * beyond.powf(shape[0] - 1.0)
            }
        };
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Smooth
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let last = match shape.get(1) {
            None => Parameter::new("exponent", shape[0], 0.0, "1"),
            Some(&knee) => Parameter::new("knee", knee, 0.0, "1"),
        };
        vec![
            Parameter::new("droop_at_most_torque", a[0], s[0], "1"),
            Parameter::new("most_torque", scale.torque, 0.0, scale.kind.torque_unit()),
            last,
        ]
    }
}
