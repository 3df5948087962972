use super::*;
use crate::model::{Drive, Frame, JointKind, Limits};

/// Two revolute joints and a prismatic one.
fn robot() -> Robot {
    let frames = vec![
        Frame::on_base(JointKind::Revolute),
        Frame::on_base(JointKind::Revolute),
        Frame::on_base(JointKind::Prismatic),
    ];
    let drive = Drive {
        gear: vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0].into(),
        coupled_friction: vec![].into(),
    };
    Robot::with_standard_as_base("arm", [0.0, 0.0, -9.81], frames, drive, Limits::default())
}

fn mistake(text: &str) -> String {
    match parse("laws.yaml", text.as_bytes(), &robot()) {
        Ok(laws) => panic!("{text}: {laws:?}"),
        Err(error) => error.to_string(),
    }
}

#[test]
fn laws_are_read_with_the_joint_that_the_table_numbers() {
    let text = "# mine\n- {id: magnet, joint: 2, law: \"k1*sin(2*q2) + k2*cos(2*q2)\", unit: N.m}\n- id: sag\n  joint: 3\n  law: k*abs(dq3)^p*sign(dq3)\n  unit: N\n  shapes: {p: [0.3, 3]}\n";
    let laws = parse("laws.yaml", text.as_bytes(), &robot()).expect("both are laws");
    assert_eq!(laws.iter().map(|l| (l.id(), l.joint())).collect::<Vec<_>>(), [("magnet", 1), ("sag", 2)]);
    assert_eq!(laws[1].shapes().collect::<Vec<_>>(), ["p"]);
}

#[test]
fn a_mistake_is_told_with_its_line_and_column() {
    for (text, start, what) in [
        ("", "laws.yaml:1:1: ", "the file is empty"),
        ("id: a", "laws.yaml:1:1: ", "expected a list of laws"),
        ("[]", "laws.yaml:1:1: ", "the list is empty"),
        ("- {id: a, joint: 2, law: k*sin(p*q2)}", "laws.yaml:1:32: ", "shapes: {p: [0.1, 10]}"),
        ("- {id: a, joint: 2, law: \"k*sin(p*q2)\"}", "laws.yaml:1:33: ", "'p' does not enter linearly"),
        ("- id: a\n  joint: 2\n  law: k*sin(q2\n", "laws.yaml:3:16: ", "expected ')'"),
        ("- id: a\n  joint: 2\n  law: |\n    k*sin(q2\n", "laws.yaml:", "expected ')'"),
        ("- {id: a, joint: 2, law: k*q7}", "laws.yaml:1:28: ", "q7: arm has no such joint"),
        ("- {id: a, joint: 4, law: k*q1}", "laws.yaml:1:18: ", "its joints are 1, 2, 3"),
        ("- {id: stribeck, joint: 1, law: k*q1}", "laws.yaml:1:8: ", "effect of the catalogue"),
        ("- {id: A b, joint: 1, law: k*q1}", "laws.yaml:1:8: ", "lower-case"),
        ("- {id: a, joint: 3, law: k*q1, unit: N.m}", "laws.yaml:1:38: ", "is in N"),
        ("- {id: a, joint: 1, law: k*q1, shapes: {p: [1, 2]}}", "laws.yaml:1:40: ", "not in the law"),
        ("- {id: a, joint: 1, law: k*q1^p, shapes: {p: [2, 1]}}", "laws.yaml:1:42: ", "low < high"),
        ("- {id: a, joint: 1, law: k*q1}\n- {id: a, joint: 2, law: k*q1}", "laws.yaml:2:8: ", "there twice"),
        ("- {id: a, joint: 1, law: k*q1, color: red}", "laws.yaml:1:", "unknown field"),
        ("- {id: a, law: k*q1}", "laws.yaml:1:", "missing field `joint`"),
        ("- {id: a, joint: 1, law: k*q1", "laws.yaml:", "not YAML"),
    ] {
        let said = mistake(text);
        assert!(said.starts_with(start) && said.contains(what), "{text}: {said}");
    }
}
