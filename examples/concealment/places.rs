//! Joints on which an effect can show at all.

use dynid_runtime::model::{JointKind, Model, ParameterKind, Robot};

/// Where an effect can be hidden.
pub enum Places {
    /// It is the whole robot's.
    Robot,
    /// One of these joints, 0-based.
    Joints(Vec<usize>),
}

/// Any joint.
pub fn every(model: &dyn Model) -> Places {
    Places::Joints((0..model.robot().joints()).collect())
}

/// No joint in particular.
pub fn whole_robot(_: &dyn Model) -> Places {
    Places::Robot
}

/// The last joint.
pub fn flange(model: &dyn Model) -> Places {
    Places::Joints(vec![model.robot().joints() - 1])
}

/// Joints between the first and the last.
pub fn inner_links(model: &dyn Model) -> Places {
    Places::Joints((1..model.robot().joints() - 1).collect())
}

/// Revolute joints between the first and the last: turning about the first axis, or the last link about its own, is
/// turning the frames.
pub fn between_others(model: &dyn Model) -> Places {
    let revolute = revolute(model.robot());
    Places::Joints((1..model.robot().joints() - 1).filter(|&j| revolute[j]).collect())
}

/// Joints with a length that acts on the torques.
pub fn with_lengths(model: &dyn Model) -> Places {
    Places::Joints(lengths(model.robot()).into_iter().map(|l| l.joint).collect())
}

/// Revolute joints after a revolute joint, whose motors turn with one joint.
pub fn neighbours(model: &dyn Model) -> Places {
    let robot = model.robot();
    let revolute = revolute(robot);
    let apart = |&j: &usize| revolute[j - 1] && revolute[j] && !coupled(robot, j);
    Places::Joints((1..robot.joints()).filter(apart).collect())
}

/// Revolute joints whose link is heavy enough to swing.
pub fn swinging(model: &dyn Model) -> Places {
    let robot = model.robot();
    let revolute = revolute(robot);
    let swing = |&j: &usize| revolute[j] && !coupled(robot, j) && swings(model, j);
    Places::Joints((0..robot.joints()).filter(swing).collect())
}

fn revolute(robot: &Robot) -> Vec<bool> {
    robot
        .frames
        .iter()
        .filter(|f| f.kind != JointKind::Fixed)
        .map(|f| f.kind == JointKind::Revolute)
        .collect()
}

/// Whether a motor turns with this joint and another.
fn coupled(robot: &Robot, joint: usize) -> bool {
    let n = robot.joints();
    let gear = |motor: usize, joint: usize| robot.drive.gear.get(motor * n + joint).copied().unwrap_or(0.0);
    (0..n).any(|other| other != joint && (gear(joint, other) != 0.0 || gear(other, joint) != 0.0))
}

/// Rotor and link inertia of a joint in the zero position, kg.m2.
pub fn inertias(model: &dyn Model, joint: usize) -> [f64; 2] {
    let robot = model.robot();
    let n = robot.joints();
    let Some(nominal) = &robot.nominal else { return [0.0; 2] };
    let chi = robot.base_from_standard(&nominal.standard);
    let (rest, mut mass, mut bias) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n]);
    model.mass_and_bias(&chi, &rest, &rest, &mut mass, &mut bias);
    let rotor = of_joint(robot, ParameterKind::Ia, joint).map_or(0.0, |k| nominal.standard[k]);
    [rotor, mass[joint * (n + 1)] - rotor]
}

/// Behind a spring, a link that is light beside its rotor is not felt.
fn swings(model: &dyn Model, joint: usize) -> bool {
    let [rotor, link] = inertias(model, joint);
    rotor > 0.0 && link > 0.3 * rotor
}

/// A joint's own parameter in chi_st.
pub fn of_joint(robot: &Robot, kind: ParameterKind, joint: usize) -> Option<usize> {
    let joint_of = robot.joint_of_frame();
    (0..robot.standard.len())
        .find(|&k| robot.standard[k].kind == kind && joint_of[robot.standard[k].frame] == Some(joint))
}

/// A length of the table whose error acts on the torques.
#[derive(Debug, Clone, Copy)]
pub struct Length {
    /// Frame, 0-based.
    pub frame: usize,
    /// Whether it is d; otherwise r.
    pub is_d: bool,
    /// Joint that it is named on.
    pub joint: usize,
}

/// Lengths between axes. Those along the first axis and along the last only move the frames.
pub fn lengths(robot: &Robot) -> Vec<Length> {
    let joint_of = robot.joint_of_frame();
    let last = joint_of.iter().rposition(Option::is_some).unwrap_or(0);
    let mut all = Vec::new();
    for (frame, row) in robot.frames.iter().enumerate().take(last + 1).skip(1) {
        let Some(joint) = joint_of[frame] else { continue };
        if row.d != 0.0 {
            all.push(Length { frame, is_d: true, joint });
        }
        if row.r != 0.0 && frame < last && row.kind == JointKind::Revolute {
            all.push(Length { frame, is_d: false, joint });
        }
    }
    all
}
