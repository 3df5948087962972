//! Encoder zero that is off on a joint: the derivative of the model with respect to q.

use crate::effects::{
    Abscissa, Effect, Form, Properties, Quantities, Seeds, Sensitivity, SmoothingWindow, Sought, Variant,
    Words,
};
use crate::model::Robot;

/// What a person is told.
const WORDS: Words = Words {
    id: "position_offset",
    name: "position offset",
    what: "The zero of an encoder, or of the table, is off: the joint is not where the recording says.",
    looks_like: "gravity and coupling torques of several joints that are turned by a constant angle",
    revealed_by: "joint position",
    experiment: "slow motion of the joints below and above it, with the arm stretched out",
    source: "Hollerbach, Khalil and Gautier 2016",
    symbols: &[("offset", "real position less the recorded one")],
    put_in: "`position: {offset: [...]}` in the recording YAML",
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
    may_stand: false,
    is_factor: false,
};

/// The effect.
pub(super) struct PositionOffset;

impl Effect for PositionOffset {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Sensitivity(&PositionOffset)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("its real position is the recorded one plus {}", q.text("offset"))
    }

    fn formula(&self, q: &Quantities) -> String {
        format!("q {}", q.added("offset"))
    }
}

impl Sensitivity for PositionOffset {
    fn variants(&self, robot: &Robot) -> Vec<Variant> {
        let units = robot.joint_kinds().into_iter().map(|kind| kind.position_unit());
        units.enumerate().map(|(j, unit)| Variant::joint(j, "offset", unit)).collect()
    }

    fn together(&self) -> bool {
        false
    }

    /// Half a turn.
    fn largest_error(&self) -> f64 {
        std::f64::consts::PI
    }

    fn seed(&self, variant: &Variant, seeds: &mut Seeds<'_>) {
        seeds.q[variant.index].slope = 1.0;
    }
}
