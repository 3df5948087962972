//! Friction level that varies with the joint angle: (c·cos kq + s·sin kq)·sign v.

use crate::effects::closed_form::number;
use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, Step, Words,
};
use crate::model::JointKind;

/// What a person is told.
const WORDS: Words = Words {
    id: "position_dependent_friction",
    name: "position-dependent friction",
    what: "The friction level is not the same all along the travel: a worn section, a misaligned gear, an uneven preload.",
    looks_like: "a residual with the sign of the speed that depends on where the joint is",
    revealed_by: "joint position",
    experiment: "slow strokes over the full travel in both directions",
    source: "Armstrong-Helouvry 1991; Bittencourt and Gunnarsson 2012",
    symbols: &[
        ("amplitude", "half of the swing of the friction level"),
        ("wave_number", "waves per unit of position, times 2 pi"),
        ("phase", "where the level is highest"),
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
    abscissa: Abscissa::Position,
    along_motion: true,
    may_stand: true,
    is_factor: false,
};

/// The effect.
pub(super) struct PositionDependentFriction;

impl Effect for PositionDependentFriction {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&PositionDependentFriction)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("the friction level swings by {} along the travel", q.text("amplitude"))
    }

    fn formula(&self, q: &Quantities) -> String {
        format!("{}·cos({}·q - {})·sign(dq)", q.value("amplitude"), q.value("wave_number"), q.value("phase"))
    }
}

impl JointLaw for PositionDependentFriction {
    fn amplitudes(&self, _: &[f64]) -> usize {
        2
    }

    /// Waves along the travel: at least half a wave, at most six; whole orders of the joint where it turns.
    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let half_wave = std::f64::consts::PI / scale.range.max(1e-9);
        let mut orders: Vec<f64> =
            [1.0, 1.5, 2.0, 3.0, 4.0, 6.0, 8.0, 12.0].iter().map(|k| k * half_wave).collect();
        if scale.kind != JointKind::Prismatic {
            orders.extend([1.0, 2.0, 3.0, 4.0].iter().filter(|&&k| k > half_wave));
        }
        orders.into_iter().map(|k| vec![k]).collect()
    }

    fn steps(&self, _: &Scale) -> Vec<Step> {
        vec![Step::Times(1.2)]
    }

    fn only_positive(&self) -> bool {
        false
    }

    fn law(&self, _: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        let (s, c) = (shape[0] * at.q).sin_cos();
        out[0] = c * at.sign;
        out[1] = s * at.sign;
    }

    fn closed_form(&self, _: &Scale, shape: &[f64], amplitude: &[f64], j: usize) -> Option<String> {
        let [order, c, s] = [*shape.first()?, *amplitude.first()?, *amplitude.get(1)?].map(number);
        Some(format!("({c}*cos({order}*q{j}) + {s}*sin({order}*q{j}))*sign(dq{j})"))
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Dry
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let per = scale.kind.wave_unit();
        vec![
            Parameter::new("amplitude", a[0].hypot(a[1]), s[0].max(s[1]), scale.kind.torque_unit()),
            Parameter::new("wave_number", shape[0], 0.0, per),
            Parameter::new("phase", a[1].atan2(a[0]), 0.0, "rad"),
        ]
    }
}
