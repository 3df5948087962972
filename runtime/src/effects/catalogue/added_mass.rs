//! A rigid body added to an inner link.

use crate::effects::{
    Abscissa, BODY_SYMBOLS, BodyOnLink, Effect, Form, Properties, Quantities, SmoothingWindow, Sought, Words,
    body_detail,
};
use crate::model::Robot;

/// What a person is told.
const WORDS: Words = Words {
    id: "added_mass",
    name: "added mass",
    what: "A body is attached to an inner link that the model does not know: a dress pack, a valve block, a camera.",
    looks_like: "gravity and inertia torques of the joints below that link only",
    revealed_by: "joint position",
    experiment: "slow and fast motions of the joint that carries it and of those below",
    source: "Khalil, Gautier and Lemoine 2007",
    symbols: BODY_SYMBOLS,
    put_in: "more mass, first moments and inertias of that link in `nominal: parameters` of the robot's YAML",
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
pub(super) struct AddedMass;

impl Effect for AddedMass {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Body(&AddedMass)
    }

    fn detail(&self, q: &Quantities) -> String {
        body_detail(q)
    }

    fn formula(&self, _: &Quantities) -> String {
        String::new()
    }
}

impl BodyOnLink for AddedMass {
    fn links(&self, robot: &Robot) -> Vec<usize> {
        let mut links: Vec<usize> =
            robot.joint_of_frame().iter().enumerate().filter(|(_, j)| j.is_some()).map(|(k, _)| k).collect();
        links.pop();
        links
    }

    /// The joint of the link that carries it.
    fn named_joint(&self, robot: &Robot, frame: usize) -> Option<usize> {
        robot.joint_of_frame().get(frame).copied().flatten()
    }
}
