//! Diagnoses of robots whose tables have known values.
#![allow(clippy::unwrap_used)]

mod common;

use std::sync::{Arc, LazyLock};

use common::{Hidden, SimulatedRobot, planar_that_knows};
use dynid_runtime::diagnosis::{Diagnosis, Reference, Settings, Silent, diagnose};
use dynid_runtime::effects::{EffectKind, Place};
use dynid_runtime::model::{Model, RecursiveModel};
use dynid_runtime::recording::Trajectory;

const KNOWN: &str = "known: {Ia2: 0.04, Fc1: 3, MX2: 0.4}";

static ROBOT: LazyLock<SimulatedRobot> = LazyLock::new(|| planar_that_knows(KNOWN));

fn record(hidden: &Hidden, seed: u64) -> Vec<Trajectory> {
    ROBOT.record(&ROBOT.motions(3, 4.5, seed), hidden, seed)
}

fn diagnosed(model: &RecursiveModel, recording: &[Trajectory], reference: Option<Reference>) -> Diagnosis {
    let mut settings = Settings::default();
    settings.threads = 1;
    settings.reference = reference.map(Arc::new);
    diagnose(model, recording, &[], &settings, &Silent).unwrap()
}

fn named(diagnosis: &Diagnosis) -> Vec<(&str, &[usize])> {
    diagnosis.findings.iter().map(|f| (f.effect.as_str(), f.joints.as_slice())).collect()
}

/// The same robot without known values.
fn free() -> RecursiveModel {
    let mut robot = ROBOT.model.robot().clone();
    robot.fixed = Vec::new().into();
    RecursiveModel::new(robot).unwrap()
}

/// Asserts that the model has the known values for certain.
fn assert_held(diagnosis: &Diagnosis) {
    let robot = ROBOT.model.robot();
    let fixed = robot.fixed_base();
    assert_eq!(fixed.len(), 3);
    for model in [&diagnosis.standard, &diagnosis.model] {
        for &(k, value) in &fixed {
            assert_eq!((model.chi[k], model.sigma[k]), (value, 0.0), "{}", robot.base[k].name);
        }
    }
}

#[test]
fn nothing_is_found_in_a_robot_that_is_as_its_table_knows_and_the_rest_is_more_certain() {
    let recording = record(&Hidden::nothing(), 1);
    let held = diagnosed(&ROBOT.model, &recording, None);
    assert_eq!(named(&held), []);
    assert_held(&held);
    let free = diagnosed(&free(), &recording, None);
    let truth = ROBOT.model.robot().base_from_standard(&ROBOT.standard);
    let mut narrower = 0;
    for (k, base) in ROBOT.model.robot().base.iter().enumerate() {
        let (value, sigma) = (held.model.chi[k], held.model.sigma[k]);
        assert!((value - truth[k]).abs() <= 5.0 * sigma, "{}: {value} ± {sigma}, {}", base.name, truth[k]);
        assert!(sigma < 1.02 * free.model.sigma[k], "{}: {sigma}", base.name);
        narrower += usize::from(sigma > 0.0 && sigma < 0.8 * free.model.sigma[k]);
    }
    assert!(narrower >= 2, "{narrower}");
    // Errors are relative to the whole torque: those of the robot that has to find the values itself.
    let errors = [&held, &free].map(|d| d.after.relative_error.unwrap());
    assert!((errors[0] / errors[1] - 1.0).abs() < 0.02, "{errors:?}");
}

#[test]
fn friction_that_is_hidden_beside_a_known_level_is_found() {
    let hidden = Hidden::effect(EffectKind::Stribeck, Place::Joint(0), &[0.3], &[2.5]);
    let found = diagnosed(&ROBOT.model, &record(&hidden, 1), None);
    assert_eq!(named(&found), [("stribeck", &[1][..])]);
    assert_held(&found);
    let [k] = ["Fc1"].map(|name| ROBOT.model.robot().base.iter().position(|b| b.name == name).unwrap());
    assert_eq!(found.model.chi[k], 3.0);
}

#[test]
fn against_a_reference_of_the_same_table_they_stay_and_a_law_that_came_is_found() {
    let before = diagnosed(&ROBOT.model, &record(&Hidden::nothing(), 1), None);
    let reference = || Reference::of(&before).unwrap();
    let same = diagnosed(&ROBOT.model, &record(&Hidden::nothing(), 7), Some(reference()));
    assert_eq!(named(&same), []);
    assert_held(&same);
    let hidden = Hidden::effect(EffectKind::Stribeck, Place::Joint(0), &[0.3], &[2.5]);
    let changed = diagnosed(&ROBOT.model, &record(&hidden, 7), Some(reference()));
    assert_eq!(named(&changed), [("stribeck", &[1][..])]);
    assert_held(&changed);
}
