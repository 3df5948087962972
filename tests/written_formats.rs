//! What is written of robots as URDF and MJCF: the files are those beside which Pinocchio and MuJoCo have their torques
//! (`benches/peers/written_reference.py`), dynid has these torques too, and a URDF comes back as the same robot.
//!
//! After a wanted change of the files: `UPDATE=1 cargo test --test written_formats`, then the script again.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

use std::path::{Path, PathBuf};

use dynid_codegen::base::base_set;
use dynid_codegen::numeric_robot;
use dynid_codegen::robot::parse;
use dynid_runtime::model::{ParameterKind, RecursiveModel, Robot, torques_at};
use dynid_urdf::{ImportOptions, Skeleton, import, read, write_mjcf, write_urdf};

/// A chain with a prismatic joint, parallelograms with bars and a balancer, friction between links with multiples of joints.
const ROBOTS: [&str; 4] = ["scara4", "palletiser", "parallelogram6", "tethered"];

fn beside(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/formats").join(name)
}

fn robot_of(yaml: &str) -> Robot {
    let table = parse("arm.yaml", yaml.as_bytes()).unwrap_or_else(|mistakes| panic!("{mistakes:?}\n{yaml}"));
    numeric_robot(&table, &base_set(&table))
}

fn robot(name: &str) -> Robot {
    let shipped = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("robots/{name}.yaml"));
    let path = if shipped.is_file() { shipped } else { beside(&format!("{name}.yaml")) };
    robot_of(&std::fs::read_to_string(path).unwrap())
}

fn skeleton(robot: &Robot) -> Skeleton {
    Skeleton::of_table(robot, &robot.nominal.as_ref().unwrap().standard)
}

/// Nominal parameters of these kinds.
fn kept(robot: &Robot, kinds: &dyn Fn(ParameterKind) -> bool) -> Vec<f64> {
    let nominal = robot.nominal.as_ref().unwrap();
    let standard: Vec<f64> = robot
        .standard
        .iter()
        .zip(nominal.standard.iter())
        .map(|(p, x)| if kinds(p.kind) { *x } else { 0.0 })
        .collect();
    robot.base_from_standard(&standard)
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    assert_eq!(found.len(), expected.len(), "{what}");
    let largest = expected.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < tolerance * largest, "{what}: {found} and {expected}");
    }
}

#[test]
fn files_are_those_that_other_tools_were_asked_about() {
    for name in ROBOTS {
        let skeleton = skeleton(&robot(name));
        for (ending, text) in [("urdf", write_urdf(&skeleton)), ("xml", write_mjcf(&skeleton))] {
            let path = beside(&format!("{name}.{ending}"));
            if std::env::var_os("UPDATE").is_some() {
                std::fs::write(&path, &text).unwrap();
            }
            assert!(
                std::fs::read_to_string(&path).unwrap() == text,
                "{} is written otherwise",
                path.display()
            );
        }
    }
}

#[test]
fn pinocchio_and_mujoco_have_the_torques_of_robots_with_bars_and_tendons() {
    for name in ROBOTS {
        let robot = robot(name);
        let text = std::fs::read_to_string(beside(&format!("{name}.json"))).unwrap();
        let reference: serde_json::Value = serde_json::from_str(&text).unwrap();
        let states: Vec<[Vec<f64>; 3]> = serde_json::from_value(reference["states"].clone()).unwrap();
        assert!(states.len() >= 5);
        let bodies = |kind: ParameterKind| kind <= ParameterKind::M;
        // An offset has no place in MJCF.
        let all = |kind: ParameterKind| kind != ParameterKind::Off;
        let model = RecursiveModel::new(robot.clone()).unwrap();
        for (tool, chi) in [("pinocchio", kept(&robot, &bodies)), ("mujoco", kept(&robot, &all))] {
            let torques: Vec<Vec<f64>> = serde_json::from_value(reference[tool].clone()).unwrap();
            assert_eq!(torques.len(), states.len());
            for ([q, dq, ddq], expected) in states.iter().zip(&torques) {
                let what = format!("{name} by {tool}");
                assert_close(&torques_at(&model, &chi, q, dq, ddq), expected, 1e-10, &what);
            }
        }
    }
}

#[test]
fn a_robot_with_bars_comes_back_from_its_urdf_with_the_same_base_parameters() {
    for name in ROBOTS {
        let before = robot(name);
        let size = before.gravity.iter().map(|g| g * g).sum::<f64>().sqrt();
        let options = ImportOptions { gravity: [0.0, 0.0, -size], ..ImportOptions::default() };
        let text = write_urdf(&skeleton(&before));
        let urdf = read(text.as_bytes(), options.snap).unwrap_or_else(|mistakes| panic!("{mistakes:?}"));
        let again = robot_of(&import(&urdf, "arm.urdf", &options).unwrap_or_else(|m| panic!("{m:?}")).yaml);
        let inertial = |robot: &Robot| {
            let of = |p: &&dynid_runtime::model::BaseParameter| {
                robot.standard[p.standard].kind <= ParameterKind::M
            };
            robot.base.iter().filter(of).count()
        };
        assert_eq!(inertial(&again), inertial(&before), "{name}");
        assert_eq!(again.joints(), before.joints(), "{name}");
        // Frames between the joints of one sum have numbers too, so that other parameters may be kept: torques tell.
        let bodies = |kind: ParameterKind| kind <= ParameterKind::M;
        let (chi, back) = (kept(&before, &bodies), kept(&again, &bodies));
        let states: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(beside(&format!("{name}.json"))).unwrap()).unwrap();
        let states: Vec<[Vec<f64>; 3]> = serde_json::from_value(states["states"].clone()).unwrap();
        let (ours, theirs) = (RecursiveModel::new(before).unwrap(), RecursiveModel::new(again).unwrap());
        for [q, dq, ddq] in &states {
            let expected = torques_at(&ours, &chi, q, dq, ddq);
            assert_close(&torques_at(&theirs, &back, q, dq, ddq), &expected, 1e-12, name);
        }
    }
}
