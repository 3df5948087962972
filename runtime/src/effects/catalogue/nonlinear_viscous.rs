//! Viscous friction that is not proportional to speed: f·|v/v0|^p·sign v beside the linear term, or, where it has come since a
//! baseline, in the place of a part of it.

use crate::effects::closed_form::number;
use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, Step, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "nonlinear_viscous",
    name: "non-linear viscous friction",
    what: "The friction curve bends with speed: the lubricant shears, warms up and thins, so that friction grows less (or more) than in proportion.",
    looks_like: "a residual that is odd in the speed and bends over its whole range",
    revealed_by: "joint speed",
    experiment: "constant-speed strokes at eight or more speeds up to the limit, both directions, on a warmed-up joint",
    source: "Waiboer, Aarts and Jonker 2005; Simoni et al. 2015",
    symbols: &[
        ("f", "friction at the speed v0 beyond the linear part"),
        ("v0", "top speed of the recording"),
        ("p", "power of the speed"),
        (
            "viscous_change",
            "change of the viscous friction whose place it takes, where it has come since a baseline",
        ),
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

/// The effect.
pub(super) struct NonlinearViscous;

impl Effect for NonlinearViscous {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&NonlinearViscous)
    }

    fn detail(&self, q: &Quantities) -> String {
        let instead = if q.has("viscous_change") {
            format!(", in the place of viscous friction, which has changed by {}", q.text("viscous_change"))
        } else {
            String::new()
        };
        format!("friction bends with speed to the power {}{instead}", q.text("p"))
    }

    fn formula(&self, q: &Quantities) -> String {
        let bent = format!("{}·|dq / {}|^{}·sign(dq)", q.value("f"), q.value("v0"), q.value("p"));
        if q.has("viscous_change") { format!("{bent} {}·dq", q.added("viscous_change")) } else { bent }
    }
}

impl JointLaw for NonlinearViscous {
    fn amplitudes(&self, shape: &[f64]) -> usize {
        if shape.len() == 2 { 2 } else { 1 }
    }

    /// Marked by one more number.
    fn in_place_of_viscous(&self, shape: &[f64]) -> Option<Vec<f64>> {
        if let &[power] = shape { Some(vec![power, 1.0]) } else { None }
    }

    fn shapes(&self, _: &Scale) -> Vec<Vec<f64>> {
        [0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 1.3, 1.6, 2.0, 2.5, 3.0].iter().map(|&p| vec![p]).collect()
    }

    fn steps(&self, _: &Scale) -> Vec<Step> {
        vec![Step::Times(1.2), Step::Keep]
    }

    fn only_positive(&self) -> bool {
        false
    }

    fn law(&self, scale: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        out[0] = (at.dq / scale.speed).abs().powf(shape[0]) * at.sign;
        if let Some(viscous) = out.get_mut(1) {
            *viscous = at.dq;
        }
    }

    fn closed_form(&self, scale: &Scale, shape: &[f64], amplitude: &[f64], j: usize) -> Option<String> {
        let [f, v0, p] = [*amplitude.first()?, scale.speed, *shape.first()?].map(number);
        let bent = format!("{f}*(abs(dq{j})/{v0})^{p}*sign(dq{j})");
        Some(match amplitude.get(1) {
            Some(&viscous) => format!("{bent} + {}*dq{j}", number(viscous)),
            None => bent,
        })
    }

    /// A power below 1 rises from rest so steeply that it sticks; what bends upwards, or takes off, is smooth there.
    fn at_rest(&self, shape: &[f64], amplitude: &[f64]) -> AtRest {
        if shape[0] < 1.0 && amplitude[0] > 0.0 { AtRest::Dry } else { AtRest::Smooth }
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let mut parameters = vec![
            Parameter::new("f", a[0], s[0], scale.kind.torque_unit()),
            Parameter::new("v0", scale.speed, 0.0, scale.kind.speed_unit()),
            Parameter::new("p", shape[0], 0.0, "1"),
        ];
        if let ([_, viscous], [_, sigma]) = (a, s) {
            parameters.push(Parameter::new("viscous_change", *viscous, *sigma, scale.kind.viscous_unit()));
        }
        parameters
    }
}
