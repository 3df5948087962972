//! A motion that shows little beside one that shows much hides no law: what predicts the other is not held out.
#![allow(clippy::unwrap_used)]

mod common;

use std::sync::LazyLock;

use common::{Hidden, SimulatedRobot};
use dynid_runtime::diagnosis::{Diagnosis, Settings, Silent, diagnose};
use dynid_runtime::effects::{EffectKind, Place};
use dynid_runtime::recording::Trajectory;

static ROBOT: LazyLock<SimulatedRobot> = LazyLock::new(common::planar);

/// One motion that shows all parameters, and one so slow that it shows friction and gravity.
fn record(hidden: &Hidden, seed: u64) -> Vec<Trajectory> {
    let mut motions = ROBOT.motions(1, 10.0, seed);
    motions.extend(ROBOT.motions_within(0.04, 1, 10.0, seed + 1));
    ROBOT.record(&motions, hidden, seed)
}

fn diagnosed(now: &[Trajectory], before: &[Trajectory]) -> Diagnosis {
    let mut settings = Settings::default();
    settings.threads = 1;
    diagnose(&ROBOT.model, now, before, &settings, &Silent).unwrap()
}

fn named(diagnosis: &Diagnosis) -> Vec<&str> {
    diagnosis.findings.iter().map(|f| f.effect.as_str()).collect()
}

#[test]
fn stretches_of_both_motions_are_held_out() {
    let diagnosis = diagnosed(&record(&Hidden::nothing(), 1), &[]);
    assert_eq!(named(&diagnosis), [""; 0]);
    assert_eq!(diagnosis.held_out.how, "every stretch of the motions predicted from the others");
    let alike = diagnosed(&ROBOT.record(&ROBOT.motions(2, 10.0, 1), &Hidden::nothing(), 1), &[]);
    assert_eq!(alike.held_out.how, "every motion predicted from the others");
}

#[test]
fn a_law_is_named_beside_a_slow_motion() {
    for seed in [3, 5, 7] {
        let stribeck = Hidden::effect(EffectKind::Stribeck, Place::Joint(0), &[0.15], &[1.0]);
        let diagnosis = diagnosed(&record(&stribeck, seed), &[]);
        assert_eq!(named(&diagnosis), ["stribeck"], "seed {seed}");
    }
}

#[test]
fn a_payload_is_weighed_beside_a_slow_motion() {
    let before = record(&Hidden::nothing(), 11);
    // A point of 0.15 kg on x of the last link.
    let body = [0.0, 0.0, 0.0, 0.024, 0.0, 0.024, 0.06, 0.0, 0.0, 0.15];
    for seed in [13, 15, 17] {
        let payload = Hidden::effect(EffectKind::Payload, Place::Link(1), &[], &body);
        let diagnosis = diagnosed(&record(&payload, seed), &before);
        assert_eq!(named(&diagnosis), ["payload"], "seed {seed}");
        let mass = &diagnosis.findings[0].parameters["mass"];
        assert!((mass.value - 0.15).abs() < 4.0 * mass.sigma, "{mass:?}");
    }
}

#[test]
fn a_slow_baseline_is_not_asked_to_predict_what_it_does_not_show() {
    let before = ROBOT.record(&ROBOT.motions_within(0.03, 1, 8.0, 4), &Hidden::nothing(), 4);
    let cable = {
        let swing = [0.0, 3.0, 0.0, -3.0, 0.0];
        Hidden::effect(EffectKind::PositionDependentTorque, Place::Joint(1), &[0.0, 1.0], &swing)
    };
    let diagnosis = diagnosed(&ROBOT.record(&ROBOT.motions(2, 6.0, 34), &cable, 34), &before);
    let fitted = diagnosis.before.relative_error.unwrap();
    assert!(diagnosis.held_out.before < 1.5 * fitted, "{} beside {fitted}", diagnosis.held_out.before);
}
