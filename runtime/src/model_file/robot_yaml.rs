//! The table of a saved model as a robot YAML.

use std::fmt::Write as _;

use crate::model::{Frame, JointIndex, JointKind, Robot};

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
    for (k, f) in robot.frames.iter().enumerate() {
        let _ = writeln!(text, "  - {}", row(k + 1, f));
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
    text
}

fn row(j: usize, frame: &Frame) -> String {
    let with = |constant: f64, moves: bool| match (moves, constant) {
        (false, c) => c.to_string(),
        (true, 0.0) => format!("q{j}"),
        (true, c) if c < 0.0 => format!("q{j} - {}", -c),
        (true, c) => format!("q{j} + {c}"),
    };
    let sigma = match frame.kind {
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
        with(frame.theta, frame.kind == JointKind::Revolute),
        with(frame.r, frame.kind == JointKind::Prismatic)
    )
}
