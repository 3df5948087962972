//! An outside force in time windows.

use crate::effects::{Abscissa, Effect, Form, Properties, Quantities, SmoothingWindow, Sought, Words};

/// What a person is told.
const WORDS: Words = Words {
    id: "contact",
    name: "contact",
    what: "Something pushed the robot for a while.",
    looks_like: "several joints jump together, in the ratio that one force on one link has, and come back",
    revealed_by: "time",
    experiment: "move the same path without the obstacle",
    source: "De Luca and Mattone 2005; Haddadin, De Luca and Albu-Schaeffer 2017",
    symbols: &[("largest_force", "largest force")],
    put_in: "nothing of the robot: it belongs to one recording",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::Separately,
    follows_parameters: false,
    repeats: false,
    special_case: None,
    abscissa: Abscissa::Time,
    along_motion: false,
    may_stand: false,
    is_factor: false,
};

/// The effect.
pub(super) struct Contact;

impl Effect for Contact {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Window
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("something pushed the robot with up to {}", q.text("largest_force"))
    }

    fn formula(&self, _: &Quantities) -> String {
        String::new()
    }
}
