//! Elastic torque in q: linear, or through a lever.

use crate::effects::closed_form::number;
use crate::effects::{
    Abscissa, At, AtRest, Effect, Form, JointLaw, Parameter, Properties, Quantities, Scale, SmoothingWindow,
    Sought, Step, Words,
};
use crate::model::JointKind;

/// What a person is told.
const WORDS: Words = Words {
    id: "spring",
    name: "spring",
    what: "An elastic torque pulls the joint towards a position: a hose package, a balancer, a cable.",
    looks_like: "a residual that is a function of the position alone, the same at every speed and in both directions",
    revealed_by: "joint position",
    experiment: "slow strokes over the full travel in both directions",
    source: "Khalil and Dombre 2002, section on balancing springs",
    symbols: &[
        ("k", "stiffness"),
        ("lever_x", "torque of the spring through a lever, in phase"),
        ("lever_y", "the same, a quarter turn on"),
        ("ratio", "length of the lever in parts of the distance to its anchor"),
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
    along_motion: false,
    may_stand: true,
    is_factor: false,
};

/// The effect.
pub(super) struct Spring;

impl Effect for Spring {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Joint(&Spring)
    }

    fn detail(&self, q: &Quantities) -> String {
        if q.has("k") {
            format!("a spring of {}", q.text("k"))
        } else {
            "a spring that acts through a lever".into()
        }
    }

    fn formula(&self, q: &Quantities) -> String {
        if q.has("k") { format!("{}·q", q.value("k")) } else { String::new() }
    }
}

impl JointLaw for Spring {
    /// The shape is empty for a linear spring; for a lever it is the ratio of the lever arms.
    fn amplitudes(&self, shape: &[f64]) -> usize {
        if shape.is_empty() { 1 } else { 2 }
    }

    fn shapes(&self, scale: &Scale) -> Vec<Vec<f64>> {
        let mut shapes = vec![vec![]];
        if scale.kind != JointKind::Prismatic {
            shapes.extend([1.5, 2.5, 5.0].map(|ratio| vec![ratio]));
        }
        shapes
    }

    /// A ratio between those of the grid bends the torque no otherwise.
    fn steps(&self, _: &Scale) -> Vec<Step> {
        Vec::new()
    }

    fn only_positive(&self) -> bool {
        false
    }

    /// A lever, and where it is at rest.
    fn is_form_of_many(&self, shape: &[f64]) -> bool {
        !shape.is_empty()
    }

    /// Through a lever the force acts along the line from a point at distance 1 from the axis to a point at distance
    /// `ratio`: of the torque k·(1 - l0/l(q))·sin the part without l0 is gravity-like, so the columns are the part
    /// with l0 for a lever that starts along x and along y.
    fn law(&self, _: &Scale, shape: &[f64], at: &At, _: f64, out: &mut [f64]) {
        let Some(&ratio) = shape.first() else {
            out[0] = at.q;
            return;
        };
        let (s, c) = at.q.sin_cos();
        out[0] = s / (1.0 + ratio * ratio - 2.0 * ratio * c).sqrt();
        out[1] = c / (1.0 + ratio * ratio + 2.0 * ratio * s).sqrt();
    }

    fn closed_form(&self, _: &Scale, shape: &[f64], amplitude: &[f64], j: usize) -> Option<String> {
        let first = number(*amplitude.first()?);
        let Some(&ratio) = shape.first() else { return Some(format!("{first}*q{j}")) };
        let [second, squares, twice] = [*amplitude.get(1)?, 1.0 + ratio * ratio, 2.0 * ratio].map(number);
        Some(format!(
            "{first}*sin(q{j})/sqrt({squares} - {twice}*cos(q{j})) + {second}*cos(q{j})/sqrt({squares} + {twice}*sin(q{j}))"
        ))
    }

    fn at_rest(&self, _: &[f64], _: &[f64]) -> AtRest {
        AtRest::Smooth
    }

    fn parameters(&self, scale: &Scale, shape: &[f64], a: &[f64], s: &[f64]) -> Vec<Parameter> {
        let unit = scale.kind.stiffness_unit();
        match shape.first() {
            None => vec![Parameter::new("k", a[0], s[0], unit)],
            Some(&ratio) => vec![
                Parameter::new("lever_x", a[0], s[0], scale.kind.torque_unit()),
                Parameter::new("lever_y", a[1], s[1], scale.kind.torque_unit()),
                Parameter::new("ratio", ratio, 0.0, "1"),
            ],
        }
    }
}
