//! The table of a saved model as a robot YAML.

use std::fmt::Write as _;

use crate::model::{Frame, JointIndex, JointKind, Motion, Robot};

/// A robot as the YAML that it could have been read from: numbers in the place of expressions and constants. Limits and
/// nominal values are not written.
pub fn to_yaml(robot: &Robot) -> String {
    let quoted = |text: &str| serde_json::Value::from(text).to_string();
    let mut text = String::from("# Written from the table of a saved model.\n");
    // Writing to a String cannot fail.
    let _ = writeln!(text, "name: {}", quoted(&robot.name));
    if !robot.description.is_empty() {
        let _ = writeln!(text, "description: {}", quoted(&robot.description));
    }
    let [x, y, z] = robot.gravity;
    let _ = writeln!(text, "gravity: [{x}, {y}, {z}]\nframes:");
    let number = |joint: usize| robot.joint_number(JointIndex(joint)).0;
    for (k, (f, motion)) in robot.frames.iter().zip(&robot.motions()).enumerate() {
        let _ = writeln!(text, "  - {}", row(k + 1, f, motion, number));
    }
    let n = robot.joints();
    let gear: Vec<String> = robot
        .drive
        .gear
        .chunks(n.max(1))
        .map(|row| format!("[{}]", row.iter().map(f64::to_string).collect::<Vec<_>>().join(", ")))
        .collect();
    let _ = writeln!(text, "drive:\n  gear: [{}]", gear.join(", "));
    if !robot.drive.coupled_friction.is_empty() {
        let motors: Vec<String> = robot
            .drive
            .coupled_friction
            .iter()
            .map(|motor| robot.joint_number(JointIndex(*motor)).to_string())
            .collect();
        let _ = writeln!(text, "  coupled_friction: [{}]", motors.join(", "));
    }
    if !robot.known.is_empty() {
        let known = robot.known.iter().filter_map(|&k| robot.standard.get(k));
        let zero: Vec<String> = known.map(|p| format!("{}: 0", p.name)).collect();
        let _ = writeln!(text, "known: {{{}}}", zero.join(", "));
    }
    text
}

fn row(j: usize, frame: &Frame, motion: &Motion, number: impl Fn(usize) -> usize) -> String {
    let with = |constant: f64, moves: JointKind| {
        if motion.kind == moves { motion.entry(&number, &constant.to_string()) } else { constant.to_string() }
    };
    let sigma = match motion.kind {
        JointKind::Revolute => 0,
        JointKind::Prismatic => 1,
        JointKind::Fixed => 2,
    };
    let parent = frame.parent.map_or(0, |p| p + 1);
    let branch = if frame.gamma == 0.0 && frame.b == 0.0 {
        String::new()
    } else {
        format!("gamma: {}, b: {}, ", frame.gamma, frame.b)
    };
    format!(
        "{{j: {j}, parent: {parent}, sigma: {sigma}, {branch}alpha: {}, d: {}, theta: {}, r: {}}}",
        frame.alpha,
        frame.d,
        with(frame.theta, JointKind::Revolute),
        with(frame.r, JointKind::Prismatic)
    )
}
