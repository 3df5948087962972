//! A length of the table that is wrong: the derivative of the model with respect to d or r of a frame.

use crate::effects::{
    Abscissa, Effect, Form, Properties, Quantities, Seeds, Sensitivity, SmoothingWindow, Sought, Variant,
    Words,
};
use crate::model::Robot;

/// What a person is told.
const WORDS: Words = Words {
    id: "geometry_error",
    name: "geometry error",
    what: "A length in the table of the robot is not the real one.",
    looks_like: "gravity and inertia coupling of the joints on both sides of the length",
    revealed_by: "joint position",
    experiment: "motions that fold and stretch the arm at different speeds",
    source: "Hollerbach, Khalil and Gautier 2016",
    symbols: &[
        ("error_d", "real length less the d of the table"),
        ("error_r", "real length less the r of the table"),
    ],
    put_in: "another d or r in the robot's YAML than in the one that the recording names",
};

/// How it is looked for and drawn.
const PROPERTIES: Properties = Properties {
    window: SmoothingWindow::Slow,
    sought: Sought::NeverAgainstBaseline,
    follows_parameters: false,
    repeats: false,
    special_case: None,
    abscissa: Abscissa::Position,
    along_motion: false,
    may_stand: false,
    is_factor: false,
};

/// The effect.
pub(super) struct GeometryError;

impl Effect for GeometryError {
    fn words(&self) -> &'static Words {
        &WORDS
    }

    fn properties(&self) -> &'static Properties {
        &PROPERTIES
    }

    fn form(&self) -> Form {
        Form::Sensitivity(&GeometryError)
    }

    fn detail(&self, q: &Quantities) -> String {
        format!("a length of the table is off by {}{}", q.text("error_d"), q.text("error_r"))
    }

    fn formula(&self, q: &Quantities) -> String {
        if q.has("error_d") {
            format!("d {}", q.added("error_d"))
        } else {
            format!("r {}", q.added("error_r"))
        }
    }
}

impl Sensitivity for GeometryError {
    /// The lengths that the table has: a row that says 0 is taken to be 0.
    fn variants(&self, robot: &Robot) -> Vec<Variant> {
        let mut variants = Vec::new();
        let motions = robot.motions();
        for (k, frame) in robot.frames.iter().enumerate() {
            let joint = named_joint(robot, k);
            if frame.d != 0.0 {
                variants.push(Variant { joint: Some(joint), index: 2 * k, name: "error_d", unit: "m" });
            }
            if frame.r != 0.0 && motions[k].kind != crate::model::JointKind::Prismatic {
                variants.push(Variant { joint: Some(joint), index: 2 * k + 1, name: "error_r", unit: "m" });
            }
        }
        variants
    }

    fn together(&self) -> bool {
        false
    }

    fn seed(&self, variant: &Variant, seeds: &mut Seeds<'_>) {
        let row = &mut seeds.rows[variant.index / 2];
        if variant.index.is_multiple_of(2) { row.d.slope = 1.0 } else { row.r.slope = 1.0 }
    }
}

/// The joint that a length of a row is named on: the last one up to this row; in a table with bars, the last one that moves
/// the row or, where nothing does, what carries it.
fn named_joint(robot: &Robot, frame: usize) -> usize {
    if robot.dependent.is_empty() {
        return robot.joint_of_frame()[..=frame].iter().flatten().last().copied().unwrap_or(0);
    }
    let motions = robot.motions();
    let mut at = Some(frame);
    while let Some(k) = at {
        if let Some(&(joint, _)) = motions[k].terms.last() {
            return joint;
        }
        at = robot.frames[k].parent;
    }
    0
}
