//! A rotor that two joints drive: its speed is dq_b + ratio·dq_a.

use crate::effects::{Abscissa, Effect, Form, Properties, Quantities, SmoothingWindow, Sought, Words};

/// What a person is told.
const WORDS: Words = Words {
    id: "coupled_transmission",
    name: "coupled transmission",
    what: "A motor turns with two joints at once, so that its friction and inertia act on both.",
    looks_like: "friction of one joint that depends on the speed of another",
    revealed_by: "speed of the other joint",
    experiment: "move the two joints at the same time with all four combinations of directions",
    source: "Gautier and Briot 2012, equations (25) and (26)",
    symbols: &[
        ("ratio", "turns of the motor per turn of joint a"),
        ("viscous", "viscous friction of the motor at the joint's side"),
        ("coulomb", "Coulomb friction of the motor"),
        ("inertia", "inertia of the rotor"),
        ("v", "speed of the motor"),
    ],
    put_in: "`coupled_friction` in the robot's YAML, which the one that the recording names has not",
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
pub(super) struct CoupledTransmission;

impl Effect for CoupledTransmission {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Coupled
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("its motor also turns with the other one, ratio {}", q.text("ratio"))
    }

    fn formula(&self, q: &Quantities) -> String {
        format!(
            "{}·v + {}·sign(v) + {}·dv, v = dq_b + {}·dq_a",
            q.value("viscous"),
            q.value("coulomb"),
            q.value("inertia"),
            q.value("ratio")
        )
    }
}
