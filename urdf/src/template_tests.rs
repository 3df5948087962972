//! Templates whose joints mimic others: the file keeps them, and its bodies are those that were identified.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::{import, read, write_urdf};
use dynid_codegen::base::base_set;
use dynid_codegen::numeric_robot;
use dynid_codegen::robot::parse;
use dynid_description::ParameterKind;

const WINCH: &str = include_str!("../../tests/urdf/winch.urdf");

fn table(yaml: &str) -> Robot {
    let table = parse("arm.yaml", yaml.as_bytes()).unwrap();
    numeric_robot(&table, &base_set(&table))
}

fn imported(urdf: &str) -> Robot {
    let urdf = read(urdf.as_bytes(), 1e-8).unwrap();
    table(&import(&urdf, "arm.urdf", &ImportOptions::default()).unwrap().yaml)
}

fn shipped(name: &str) -> Robot {
    let path = format!("{}/../robots/{name}.yaml", env!("CARGO_MANIFEST_DIR"));
    table(&std::fs::read_to_string(path).unwrap())
}

/// Heavier and longer bodies than the nominal ones, other friction, and nothing that a URDF cannot hold.
fn other(robot: &Robot) -> Vec<f64> {
    let nominal = robot.nominal.as_ref().unwrap().standard.iter();
    let value = |(p, x): (&dynid_description::StandardParameter, &f64)| match p.kind {
        ParameterKind::Fv => 1.5 * x + 0.5,
        ParameterKind::Fc => 0.7 * x + 1.0,
        ParameterKind::M => 1.25 * x,
        ParameterKind::MX | ParameterKind::MY | ParameterKind::MZ => 1.25 * 1.1 * x,
        kind if kind <= ParameterKind::ZZ => 1.25 * 1.21 * x,
        _ => 0.0,
    };
    robot.standard.iter().zip(nominal).map(value).collect()
}

fn frictions(robot: &Robot, standard: &[f64]) -> Vec<JointFriction> {
    let joints = robot.joint_of_frame();
    let own = (0..joints.len()).filter(|&f| joints[f].is_some());
    let value = |frame, kind| crate::value(robot, standard, frame, kind);
    own.map(|f| JointFriction { damping: value(f, ParameterKind::Fv), friction: value(f, ParameterKind::Fc) })
        .collect()
}

/// A template with other values, and the base parameters that are then read from it.
fn patched(urdf: &str, robot: &Robot, standard: &[f64]) -> (String, Vec<f64>) {
    let document = read(urdf.as_bytes(), 1e-8).unwrap();
    let template = Template::new(&document, robot, &ImportOptions::default()).unwrap();
    let text = template.patched(urdf.as_bytes(), robot, standard, &frictions(robot, standard)).unwrap();
    let again = imported(&text);
    let chi = again.base_from_standard(&again.nominal.as_ref().unwrap().standard);
    (text, chi)
}

fn assert_close(found: &[f64], expected: &[f64]) {
    assert_eq!(found.len(), expected.len());
    let largest = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    for (k, (a, b)) in found.iter().zip(expected).enumerate() {
        assert!((a - b).abs() < 1e-10 * largest, "{k}: {a} and {b}");
    }
}

/// A file without what is written into it.
fn rest(urdf: &str) -> String {
    let mut out = String::new();
    let mut text = urdf;
    while let Some(start) = text.find("<inertial>") {
        out.push_str(&text[..start]);
        text = &text[start + text[start..].find("</inertial>").unwrap()..];
    }
    out.push_str(text);
    let lines = out.lines().map(|line| match (line.find("<dynamics"), line.find("/>")) {
        (Some(start), _) => {
            let end = start + line[start..].find("/>").unwrap() + 2;
            format!("{}{}", &line[..start], &line[end..])
        }
        _ => line.to_owned(),
    });
    lines.filter(|line| !line.trim().is_empty()).collect::<Vec<_>>().join("\n")
}

#[test]
fn bodies_on_joints_that_mimic_are_written_into_the_file_and_the_joints_stay() {
    let robot = imported(WINCH);
    assert_eq!((robot.joints(), robot.dependent.len()), (2, 4));
    let standard = other(&robot);
    let (text, chi) = patched(WINCH, &robot, &standard);
    assert_close(&chi, &robot.base_from_standard(&standard));
    assert_eq!(rest(&text), rest(WINCH));
    assert!(text.contains("<mimic joint=\"hoist\" multiplier=\"-1\" offset=\"0.5\"/>"));
    // Only joints with a variable have friction.
    assert_eq!(text.matches("<dynamics").count(), 2);
    let document = read(WINCH.as_bytes(), 1e-8).unwrap();
    let template = Template::new(&document, &robot, &ImportOptions::default()).unwrap();
    assert_eq!(template.joints(), ["turn", "lift"]);
    let frames: Vec<usize> = template.bodies().iter().map(|body| body.frame).collect();
    assert_eq!(frames.len(), 6);
    let skeleton = template.skeleton(&robot, &standard);
    assert_eq!(skeleton.segments.iter().filter(|s| s.mimic.is_some()).count(), 4);
}

#[test]
fn a_file_with_several_joints_about_an_axis_takes_the_bodies_of_frames_that_move_with_sums() {
    for name in ["palletiser", "parallelogram6"] {
        let robot = shipped(name);
        let nominal = robot.nominal.as_ref().unwrap().standard.to_vec();
        let urdf = write_urdf(&Skeleton::of_table(&robot, &nominal));
        let standard = other(&robot);
        let (text, chi) = patched(&urdf, &robot, &standard);
        // As if it had been written of the table.
        let own = imported(&write_urdf(&Skeleton::of_table(&robot, &standard)));
        assert_close(&chi, &own.base_from_standard(&own.nominal.as_ref().unwrap().standard));
        assert_eq!(rest(&text), rest(&urdf));
        let document = read(urdf.as_bytes(), 1e-8).unwrap();
        let template = Template::new(&document, &robot, &ImportOptions::default()).unwrap();
        let skeleton = template.skeleton(&robot, &standard);
        assert_eq!(skeleton.segments.len(), Skeleton::of_table(&robot, &standard).segments.len());
        assert!(skeleton.segments.iter().any(|s| !s.further.is_empty()), "{name}");
    }
}

#[test]
fn a_template_whose_joints_mimic_others_is_refused() {
    let robot = imported(WINCH);
    for (from, to) in [
        (
            "<mimic joint=\"lift\" multiplier=\"-1\" offset=\"0.3\"/>",
            "<mimic joint=\"turn\" offset=\"0.3\"/>",
        ),
        (
            "<mimic joint=\"lift\" multiplier=\"0.15\" offset=\"0.2\"/>",
            "<mimic joint=\"lift\" multiplier=\"0.25\" offset=\"0.2\"/>",
        ),
        ("<mimic joint=\"hoist\" multiplier=\"-1\" offset=\"0.5\"/>", ""),
    ] {
        let text = WINCH.replace(from, to);
        assert_ne!(text, WINCH);
        let document = read(text.as_bytes(), 1e-8).unwrap();
        let found = Template::new(&document, &robot, &ImportOptions::default());
        let words = found.unwrap_err().unwrap().to_string();
        assert!(words.contains("mimic"), "{words}");
    }
    // An offset that is another one puts the axis or the frame elsewhere.
    let text = WINCH.replace("multiplier=\"-1\" offset=\"0.5\"", "multiplier=\"-1\" offset=\"0.6\"");
    let document = read(text.as_bytes(), 1e-8).unwrap();
    let template = Template::new(&document, &robot, &ImportOptions::default()).unwrap();
    let last = template.in_link.last().unwrap().translation.norm();
    assert!((last - 0.1).abs() < 1e-9, "{last}");
}
