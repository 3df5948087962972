//! The table of a saved model as a robot YAML.

use std::fmt::Write as _;

use crate::model::{Between, Coupling, CouplingLaw, Frame, JointIndex, JointKind, Motion, Robot};

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
    for (key, friction) in [("friction", true), ("springs", false)] {
        let entries: Vec<&Coupling> =
            robot.couplings.iter().filter(|c| (c.law == CouplingLaw::Friction) == friction).collect();
        if !entries.is_empty() {
            let _ = writeln!(text, "{key}:");
        }
        for coupling in entries {
            let _ = writeln!(text, "  - {}", entry(coupling, number));
        }
    }
    let zero = robot.known.iter().map(|&k| (k, 0.0));
    let known: Vec<String> = zero
        .chain(robot.fixed.iter().copied())
        .filter_map(|(k, value)| Some(format!("{}: {value}", robot.standard.get(k)?.name)))
        .collect();
    if !known.is_empty() {
        let _ = writeln!(text, "known: {{{}}}", known.join(", "));
    }
    text
}

/// Friction between links or a spring.
fn entry(coupling: &Coupling, number: impl Fn(usize) -> usize) -> String {
    let joints: Vec<String> =
        coupling.terms.iter().map(|&(joint, c)| format!("q{}: {c}", number(joint))).collect();
    let rest = coupling.law.rest().map_or_else(String::new, |rest| format!(", rest: {rest}"));
    // A name that was given begins with an underscore.
    let name = coupling.name.strip_prefix('_').map_or_else(String::new, |name| format!(", name: {name}"));
    if let Some(Between { frames, points, .. }) = coupling.law.between() {
        let point = |k: usize| {
            let [x, y, z] = points[k];
            format!("{{frame: {}, point: [{x}, {y}, {z}]}}", frames[k].map_or(0, |frame| frame + 1))
        };
        return format!("{{between: [{}, {}]{rest}{name}}}", point(0), point(1));
    }
    format!("{{joints: {{{}}}{rest}{name}}}", joints.join(", "))
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
