//! How motion was held out, in words.

use crate::diagnosis::judging::hull::Curve;
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::model::{JointIndex, Robot};
use std::collections::BTreeSet;

/// What predicts the motion that was held out, and what of it is left out: rows `within_pushes` are predicted in their own way, and
/// `curves` say nothing of values that they were not fitted to.
pub(super) fn how(model: &ExtendedModel<'_>, within_pushes: bool, curves: &[Curve]) -> String {
    let robot = model.context.model.robot();
    let of_pushes = if within_pushes { "; within pushes, from the instants beside" } else { "" };
    let bent = joints(robot, curves.iter().map(|curve| curve.joint));
    let of_curves = match bent.as_slice() {
        [] => String::new(),
        [one] => format!("; joint {one} only where its curve was fitted"),
        several => format!("; joints {} only where their curves were fitted", several.join(" and ")),
    };
    let untold = joints(robot, model.slow.design.untold.iter().map(|&(joint, _)| joint));
    let of_untold = match untold.as_slice() {
        [] => String::new(),
        [one] => format!("; joint {one} only where the others show what predicts it"),
        several => {
            format!("; joints {} only where the others show what predicts them", several.join(" and "))
        }
    };
    [predicted_from(model), of_pushes, &of_curves, &of_untold].concat()
}

/// Numbers of joints as a person counts them, each once.
fn joints(robot: &Robot, joints: impl Iterator<Item = usize>) -> Vec<String> {
    let numbers: BTreeSet<usize> = joints.map(|j| robot.joint_number(JointIndex(j)).0).collect();
    numbers.iter().map(usize::to_string).collect()
}

fn predicted_from(model: &ExtendedModel<'_>) -> &'static str {
    let design = &model.slow.design;
    let mut targets = design.segments.iter().filter(|s| s.is_target).map(|s| s.signal);
    let first = targets.next();
    let one_motion = targets.all(|s| Some(s) == first);
    let only_reference = model.context.reference.is_some() && model.context.is_alone();
    if only_reference {
        match (one_motion, design.together) {
            (true, _) => "every stretch of the motion predicted from the reference and its other stretches",
            (_, true) => "every stretch of the motions predicted from the reference and the other stretches",
            _ => "every motion predicted from the reference and the other motions",
        }
    } else if model.change {
        match (one_motion, design.together) {
            (true, _) => {
                "every stretch of the new motion predicted from the baseline and its other stretches"
            }
            (_, true) => {
                "every stretch of the new motions predicted from the baseline and the other stretches"
            }
            _ => "every new motion predicted from the baseline and the other new motions",
        }
    } else if design.is_forward() {
        "forward in time"
    } else if design.is_single_motion() {
        "every stretch of the motion predicted from the others"
    } else if design.together {
        "every stretch of the motions predicted from the others"
    } else {
        "every motion predicted from the others"
    }
}
