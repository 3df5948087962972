//! A rigid body added at the flange.

use crate::effects::{
    Abscissa, BODY_SYMBOLS, BodyOnLink, Effect, Form, Properties, Quantities, SmoothingWindow, Sought, Words,
    body_detail,
};
use crate::model::Robot;

/// What a person is told.
const WORDS: Words = Words {
    id: "payload",
    name: "payload",
    what: "A rigid body is attached to the flange that the model does not know.",
    looks_like: "gravity and inertia torques of all joints as of one body at the flange",
    revealed_by: "joint position",
    experiment: "slow and fast motions of the last three joints with the arm stretched out",
    source: "Khalil, Gautier and Lemoine 2007; Swevers, Verdonck and De Schutter 2007",
    symbols: BODY_SYMBOLS,
    put_in: "more mass, first moments and inertias of the last link in `nominal: parameters` of the robot's YAML",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::OnlyAgainstBaseline,
    follows_parameters: false,
    repeats: false,
    special_case: None,
    abscissa: Abscissa::Position,
    along_motion: false,
    may_stand: false,
    is_factor: false,
};

/// The effect.
pub(super) struct Payload;

impl Effect for Payload {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Body(&Payload)
    }

    fn detail(&self, q: &Quantities) -> String {
        body_detail(q)
    }

    fn formula(&self, _: &Quantities) -> String {
        String::new()
    }
}

impl BodyOnLink for Payload {
    fn links(&self, robot: &Robot) -> Vec<usize> {
        robot.joint_of_frame().iter().rposition(Option::is_some).into_iter().collect()
    }

    /// It is the whole robot's: there is one flange.
    fn named_joint(&self, _: &Robot, _: usize) -> Option<usize> {
        None
    }
}
