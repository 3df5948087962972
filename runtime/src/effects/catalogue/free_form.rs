//! A torque that no other law of the catalogue describes, as curves over the variables that it depends on.

use crate::effects::{Abscissa, Effect, Form, Properties, Quantities, SmoothingWindow, Sought, Words};

/// What a person is told.
const WORDS: Words = Words {
    id: "free_form",
    name: "torque by no known law",
    what: "A torque that is a function of some variables and of no law of the catalogue.",
    looks_like: "a residual that one or two variables order, of this joint or of another",
    revealed_by: "the variables that it depends on",
    experiment: "motions in which the variables named go different ways: one held while the other sweeps its range",
    source: "Hastie and Tibshirani 1986; Eilers and Marx 1996 (additive models of splines)",
    symbols: &[("swing", "difference between the highest and the lowest torque of the curves")],
    put_in: "a torque of any law",
};

/// How it is looked for and drawn: after everything else, over its own variables.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::Separately,
    follows_parameters: true,
    repeats: true,
    special_case: None,
    abscissa: Abscissa::Position,
    along_motion: false,
    may_stand: true,
    is_factor: false,
};

/// The effect.
pub(super) struct FreeForm;

impl Effect for FreeForm {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Free
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("over what was seen it swings by {}", q.text("swing"))
    }

    fn formula(&self, _: &Quantities) -> String {
        String::new()
    }
}
