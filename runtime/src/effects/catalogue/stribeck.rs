//! Stribeck friction: the level falls as the joint leaves rest. fs·exp(-(v/vs)²)·sign v, or by the first power, as Tustin (1947)
//! has it: it then falls at once.

use crate::effects::closed_form::number;
use crate::effects::joint_law::geometric;
use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, Step, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "stribeck",
    name: "Stribeck friction",
    what: "Friction is higher close to rest and falls as the joint gathers speed, because a lubricant film builds up.",
    looks_like: "a peak of the residual on both sides of zero speed, with the sign of the speed",
    revealed_by: "joint speed",
    experiment: "slow constant-speed strokes in both directions at several speeds between a hundredth and a fifth of the top speed",
    source: "Stribeck 1902; Tustin 1947; Armstrong-Helouvry, Dupont and Canudas de Wit 1994",
    symbols: &[
        ("fs", "friction at rest beyond the Coulomb level"),
        ("vs", "speed at which a third of it is left"),
        ("delta", "power of the speed that it falls with, 2 where it is not told"),
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
    abscissa: Abscissa::Speed,
    along_motion: false,
    may_stand: true,
    is_factor: false,
};

/// Marked by one more number.
const FIRST_POWER: f64 = 1.0;

/// The effect.
pub(super) struct Stribeck;

impl Effect for Stribeck {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&Stribeck)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("{} more friction close to rest, gone above about {}", q.text("fs"), q.text("vs"))
    }

    fn formula(&self, q: &Quantities) -> String {
        if q.has("delta") {
            format!("{}·exp(-|dq / {}|^{})·sign(dq)", q.value("fs"), q.value("vs"), q.value("delta"))
        } else {
            format!("{}·exp(-(dq / {})²)·sign(dq)", q.value("fs"), q.value("vs"))
        }
    }
}

impl JointLaw for Stribeck {
    fn amplitudes(&self, _: &[f64]) -> usize {
        1
    }

    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let each = |x: &f64| [vec![x * scale.speed], vec![x * scale.speed, FIRST_POWER]];
        geometric(0.012, 0.35, 10).iter().flat_map(each).collect()
    }

    fn steps(&self, _: &Scale) -> Vec<Step> {
        vec![Step::Times(1.45), Step::Keep]
    }

    fn only_positive(&self) -> bool {
        true
    }

    fn law(&self, _: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        let part = (at.dq / shape[0]).abs();
        out[0] = (-shape.get(1).map_or(part * part, |&power| part.powf(power))).exp() * at.sign;
    }

    fn closed_form(&self, _: &Scale, shape: &[f64], amplitude: &[f64], j: usize) -> Option<String> {
        let [fs, vs] = [amplitude.first()?, shape.first()?].map(|x| number(*x));
        Some(match shape.get(1) {
            Some(&power) => format!("{fs}*exp(-(abs(dq{j})/{vs})^{})*sign(dq{j})", number(power)),
            None => format!("{fs}*exp(-(dq{j}/{vs})^2)*sign(dq{j})"),
        })
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Dry
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let mut parameters = vec![
            Parameter::new("fs", a[0], s[0], scale.kind.torque_unit()),
            Parameter::new("vs", shape[0], 0.0, scale.kind.speed_unit()),
        ];
        parameters.extend(shape.get(1).map(|&power| Parameter::new("delta", power, 0.0, "1")));
        parameters
    }
}
