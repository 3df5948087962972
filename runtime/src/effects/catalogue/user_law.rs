//! A law that the user wrote down. Its text and its numbers are those of its place.

use crate::effects::{Abscissa, Effect, Form, Properties, Quantities, SmoothingWindow, Sought, Words};

/// What a person is told, where the law itself is not at hand.
const WORDS: Words = Words {
    id: "user_law",
    name: "law of the user",
    what: "A torque by a law that the user wrote down.",
    looks_like: "the law's own course over its variables",
    revealed_by: "the variables of the law",
    experiment: "motions that sweep the variables of the law, one held while the other goes its range",
    source: "the user",
    symbols: &[],
    put_in: "the law as a torque of the joint",
};

/// How it is looked for and drawn: where the user says so, over its own first variable.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::Separately,
    follows_parameters: true,
    repeats: false,
    special_case: None,
    abscissa: Abscissa::Position,
    along_motion: false,
    may_stand: true,
    is_factor: false,
};

/// The effect.
pub(super) struct UserLaw;

impl Effect for UserLaw {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::User
    }

    fn detail(&self, q: &Quantities) -> String {
        q.all()
    }

    fn formula(&self, _: &Quantities) -> String {
        String::new()
    }
}
