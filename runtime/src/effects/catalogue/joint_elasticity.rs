//! Compliance between motor and link (Spong 1987).

use crate::effects::{
    Abscissa, Compliance, Effect, Form, Properties, Quantities, SmoothingWindow, Sought, Transmission, Words,
};

/// What a person is told.
const WORDS: Words = Words {
    id: "joint_elasticity",
    name: "joint elasticity",
    what: "Motor and link are joined by a spring: the link swings while the encoder on the motor hardly sees it.",
    looks_like: "ringing of one frequency after every jerk, on the joint and on those it is coupled to",
    revealed_by: "frequency",
    experiment: "steps in acceleration with the arm folded and stretched out; an accelerometer on the link",
    source: "Spong 1987; Albu-Schaeffer and Hirzinger 2001",
    symbols: &[
        ("k", "stiffness of the transmission"),
        ("d", "damping of the transmission"),
        ("frequency", "frequency of the ringing with the motor held"),
    ],
    put_in: "a transmission that is a spring between motor and link",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Fast,
    sought: Sought::Always,
    follows_parameters: false,
    repeats: false,
    special_case: None,
    abscissa: Abscissa::Acceleration,
    along_motion: false,
    may_stand: true,
    is_factor: false,
};

/// The effect.
pub(super) struct JointElasticity;

impl Effect for JointElasticity {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Compliance(&JointElasticity)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("the transmission is a spring of {}, ringing at about {}", q.text("k"), q.text("frequency"))
    }

    fn formula(&self, q: &Quantities) -> String {
        format!("{}·x + {}·dx, x = motor - link", q.value("k"), q.value("d"))
    }
}

impl Compliance for JointElasticity {
    fn shapes(&self) -> Vec<[f64; 4]> {
        let mut shapes = Vec::new();
        for k in 0..18 {
            let frequency = 3.0 * 1.13_f64.powi(k);
            for damping in [0.05, 0.2] {
                for rotor in [0.0, 0.4, 0.8] {
                    shapes.push([frequency, damping, rotor, 0.0]);
                }
            }
        }
        shapes
    }

    fn describe(&self, t: &Transmission) -> Vec<(&'static str, f64, &'static str)> {
        let (k, d) = (t.kind.stiffness_unit(), t.kind.viscous_unit());
        vec![("k", t.stiffness, k), ("d", t.damping, d), ("frequency", t.frequency, "Hz")]
    }
}
