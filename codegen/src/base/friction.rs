//! Which friction parameters of coupled motors are independent of those of the joints.

use super::regroup::Regrouping;
use crate::exact::{Form, Number, Span, decimal};
use crate::robot::RobotTable;
use dynid_description::{ParameterKind, StandardParameter};

/// Regroups the viscous and Coulomb friction of motors.
///
/// Viscous friction at speed s = N dq / N_mm has the torque NT N dq, a symmetric matrix; matrices are compared entry
/// by entry. Coulomb friction is NT sign(N dq): two of them are independent unless the motors turn with the same
/// combination of joints, and a regular gear lets that be only a motor that turns with its own joint alone.
pub(super) fn regroup_friction(
    robot: &RobotTable,
    standard: &[StandardParameter],
    regrouping: &mut Regrouping,
) {
    let joint_frames = robot.joint_frames();
    let joints = joint_frames.len();
    let joint_of = |frame: usize| joint_frames.iter().position(|&f| f == frame);
    let index = |kind: ParameterKind, joint: usize| {
        standard.iter().position(|p| p.kind == kind && p.frame == joint_frames[joint])
    };
    let motor_row = |m: usize| -> Vec<Number> {
        let own = decimal(robot.drive.gear[m][m]);
        robot.drive.gear[m].iter().map(|&x| (decimal(x) / &own).into()).collect()
    };

    for (column, parameter) in standard.iter().enumerate() {
        let Some(joint) = joint_of(parameter.frame) else { continue };
        if parameter.kind == ParameterKind::Fcm {
            let alone = motor_row(joint).iter().enumerate().all(|(k, x)| k == joint || x.is_zero());
            if let (true, Some(kept)) = (alone, index(ParameterKind::Fc, joint)) {
                regrouping.insert(column, vec![(kept, Form::one())]);
            }
        }
    }

    // Off-diagonal entries decide which motors are independent; the diagonal can always be made up by the joints' Fv.
    let mut kept: Vec<(usize, Vec<Number>)> = Vec::new();
    let mut space = Span::default();
    for (column, parameter) in standard.iter().enumerate() {
        let (ParameterKind::Fvm, Some(joint)) = (parameter.kind, joint_of(parameter.frame)) else { continue };
        let row = motor_row(joint);
        let entries: Vec<Number> = row.iter().flat_map(|x| row.iter().map(move |y| *x * *y)).collect();
        let mut mixed = entries.clone();
        (0..joints).for_each(|k| mixed[k * joints + k] = Number::ZERO);
        if space.insert(mixed) {
            kept.push((column, entries));
            continue;
        }
        let mut rest = entries;
        let mut taken = Vec::new();
        for (other, factor) in combination(&kept, &rest, joints) {
            for (x, y) in rest.iter_mut().zip(&kept[other].1) {
                *x = *x - *y * factor;
            }
            taken.push((kept[other].0, Form::number(factor)));
        }
        for k in 0..joints {
            let share = rest[k * joints + k];
            if let (false, Some(fv)) = (share.is_zero(), index(ParameterKind::Fv, k)) {
                taken.push((fv, Form::number(share)));
            }
        }
        regrouping.insert(column, taken);
    }
}

/// The factors of the kept matrices that make up the off-diagonal entries of `target`, which depends on them.
fn combination(kept: &[(usize, Vec<Number>)], target: &[Number], joints: usize) -> Vec<(usize, Number)> {
    let count = kept.len();
    // One equation per off-diagonal entry: the kept entries, then the target's.
    let mut equations = Span::default();
    for k in (0..joints * joints).filter(|k| k / joints != k % joints) {
        let mut equation: Vec<Number> = kept.iter().map(|(_, entries)| entries[k]).collect();
        equation.push(target[k]);
        equations.insert(equation);
    }
    let order: Vec<usize> = (0..=count).collect();
    let solved = equations.reduced(&order).into_iter().filter(|(unknown, _)| *unknown < count);
    solved.map(|(unknown, row)| (unknown, row[count])).filter(|(_, x)| !x.is_zero()).collect()
}
