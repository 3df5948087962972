//! What a robot had before, however small it is, is no change; what it has more of now is one.
#![allow(clippy::unwrap_used)]

mod common;

use std::sync::{Arc, LazyLock};

use common::{Hidden, SimulatedRobot};
use dynid_runtime::diagnosis::{Diagnosis, Reference, Settings, Silent, diagnose};
use dynid_runtime::effects::{EffectKind, Place};
use dynid_runtime::recording::Trajectory;

static ROBOT: LazyLock<SimulatedRobot> = LazyLock::new(common::planar);

fn record(hidden: &Hidden, seed: u64) -> Vec<Trajectory> {
    ROBOT.record(&ROBOT.motions(3, 4.5, seed), hidden, seed)
}

/// A wave of the first motor, of cosine and sine, N.m.
fn wave(cosine: f64, sine: f64) -> Hidden {
    Hidden::effect(EffectKind::TorqueRipple, Place::Joint(0), &[50.0], &[cosine, sine])
}

fn diagnosed(now: &[Trajectory], before: &[Trajectory]) -> Diagnosis {
    let mut settings = Settings::default();
    settings.threads = 1;
    diagnose(&ROBOT.model, now, before, &settings, &Silent).unwrap()
}

fn named(diagnosis: &Diagnosis) -> Vec<(&str, &[usize])> {
    diagnosis.findings.iter().map(|f| (f.effect.as_str(), f.joints.as_slice())).collect()
}

#[test]
fn a_wave_is_a_change_where_it_grew_by_more_than_its_phase_can_explain() {
    let before = diagnosed(&record(&wave(0.8, 0.6), 1), &[]);
    assert_eq!(named(&before), [("torque_ripple", &[1][..])]);
    let against = |now: &Hidden| {
        let mut settings = Settings::default();
        settings.threads = 1;
        settings.reference = Some(Arc::new(Reference::of(&before).unwrap()));
        diagnose(&ROBOT.model, &record(now, 7), &[], &settings, &Silent).unwrap()
    };
    assert_eq!(named(&against(&wave(0.6, -0.8))), []);
    let grown = against(&wave(3.2, 2.4));
    assert_eq!(named(&grown), [("torque_ripple", &[1][..])]);
    // What is told is what came: 4 N.m where 1 N.m was.
    let amplitude = &grown.findings[0].parameters["amplitude"];
    assert!((amplitude.value - 3.0).abs() < 4.0 * amplitude.sigma, "{amplitude:?}");
}

#[test]
fn a_curve_that_a_short_baseline_does_not_show_is_no_change() {
    let cable = || {
        let shape = [0.0, 1.0];
        let swing = [0.0, 0.03, 0.0, -0.03, 0.0];
        Hidden::effect(EffectKind::PositionDependentTorque, Place::Joint(1), &shape, &swing)
    };
    let before = ROBOT.record(&ROBOT.motions(2, 4.5, 1), &cable(), 1);
    assert_eq!(named(&diagnosed(&before, &[])), []);
    for seed in 8..11 {
        let now = ROBOT.record(&ROBOT.motions(6, 4.5, seed), &cable(), seed);
        assert_eq!(named(&diagnosed(&now, &before)), [], "seed {seed}");
    }
}

/// Friction whose viscous part bends, of an exponent that no law of the catalogue begins with.
fn bent() -> Hidden {
    Hidden::effect(EffectKind::NonlinearViscous, Place::Joint(0), &[2.0], &[0.3])
}

#[test]
fn friction_that_bends_in_a_slow_baseline_too_is_no_bend_that_came() {
    for seed in 2..5 {
        let before = ROBOT.record(&ROBOT.motions_within(0.3, 2, 6.0, seed), &bent(), seed);
        let now = ROBOT.record(&ROBOT.motions(3, 4.5, seed + 20), &bent(), seed + 20);
        assert_eq!(named(&diagnosed(&now, &before)), [], "seed {seed}");
    }
}

#[test]
fn friction_that_bends_since_a_baseline_of_the_same_speeds_is_named_without_a_change_of_its_level() {
    let before = ROBOT.record(&ROBOT.motions(3, 4.5, 2), &Hidden::nothing(), 2);
    let now = ROBOT.record(&ROBOT.motions(3, 4.5, 22), &bent(), 22);
    assert_eq!(named(&diagnosed(&now, &before)), [("nonlinear_viscous", &[1][..])]);
}
