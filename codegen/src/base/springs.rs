//! What springs have where their combination of joints is 0: a constant torque.

use super::regroup::Regrouping;
use crate::exact::Form;
use crate::robot::RobotTable;
use dynid_description::{ParameterKind, StandardParameter};
use std::collections::BTreeMap;

/// Whether every joint that a spring of unknown rest acts on has an offset that is not known: then KR is part of offsets.
pub(super) fn have_offsets(robot: &RobotTable, standard: &[StandardParameter]) -> bool {
    let of_springs =
        standard.iter().enumerate().filter(|(k, p)| p.kind == ParameterKind::KR && !robot.is_known(*k));
    of_springs.flat_map(|(_, p)| offsets(robot, standard, p)).all(|(offset, _)| !robot.is_known(offset))
}

/// KR has the torques -c: those of offsets of -c. The stiffness of a spring has a potential that is quadratic in joint
/// positions, as no body has in a chain whose frames move with a joint each; the table says that stiffnesses are independent.
pub(super) fn regroup_into_offsets(
    robot: &RobotTable,
    standard: &[StandardParameter],
    regrouping: &mut Regrouping,
) {
    for (column, parameter) in standard.iter().enumerate() {
        if parameter.kind != ParameterKind::KR || robot.is_known(column) {
            continue;
        }
        let mut sum: BTreeMap<usize, Form> = BTreeMap::new();
        for (offset, share) in offsets(robot, standard, parameter) {
            let kept = regrouping.get(&offset).cloned().unwrap_or_else(|| vec![(offset, Form::one())]);
            for (kept, factor) in kept {
                let entry = sum.entry(kept).or_default();
                *entry = entry.plus(&factor.times(&share));
            }
        }
        regrouping.insert(column, sum.into_iter().filter(|(_, factor)| !factor.is_zero()).collect());
    }
}

/// The offsets of the joints of a spring, by index, with their share in its KR.
fn offsets(
    robot: &RobotTable,
    standard: &[StandardParameter],
    parameter: &StandardParameter,
) -> Vec<(usize, Form)> {
    let frames = robot.joint_frames();
    let offset =
        |joint: usize| standard.iter().position(|p| p.kind == ParameterKind::Off && p.frame == frames[joint]);
    let terms = robot.acts_on(parameter).into_iter().enumerate();
    terms
        .filter_map(|(joint, c)| Some((offset(joint)?, Form::number((-c).into()))))
        .filter(|(_, share)| !share.is_zero())
        .collect()
}
