//! Friction that differs from that of a baseline: which of the laws that make it differ is named. A small robot, three random
//! motions of 4.5 s in closed loop before and after, 500 Hz, nominal noise.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Hidden, SimulatedRobot};
use dynid_runtime::diagnosis::{Diagnosis, Settings, Silent, diagnose};
use dynid_runtime::effects::{EffectKind, Place};

fn since_baseline(robot: &SimulatedRobot, [before, now]: [&Hidden; 2]) -> Diagnosis {
    let recorded = |hidden, seed| robot.record(&robot.motions(3, 4.5, seed), hidden, seed);
    diagnose(&robot.model, &recorded(now, 1), &recorded(before, 51), &Settings::default(), &Silent).unwrap()
}

fn named(diagnosis: &Diagnosis) -> Vec<(&str, &[usize])> {
    diagnosis.findings.iter().map(|f| (f.effect.as_str(), f.joints.as_slice())).collect()
}

/// Friction of the first joint that bends with the root of the speed, N.m at its scale.
fn bent(amplitude: f64) -> Hidden {
    Hidden::effect(EffectKind::NonlinearViscous, Place::Joint(0), &[0.5], &[amplitude])
}

fn not_told_apart(diagnosis: &Diagnosis) -> Vec<Vec<&str>> {
    diagnosis.cannot_tell.iter().map(|c| c.between.iter().map(String::as_str).collect()).collect()
}

#[test]
fn friction_that_bends_since_the_baseline_is_named_and_no_other_level_of_it() {
    let diagnosis = since_baseline(&common::planar(), [&Hidden::nothing(), &bent(1.2)]);
    assert_eq!(named(&diagnosis), [("nonlinear_viscous", &[1][..])]);
    assert!(not_told_apart(&diagnosis).is_empty(), "{:?}", diagnosis.cannot_tell);
}

#[test]
fn a_bend_that_another_level_explains_as_well_cannot_be_told_from_it() {
    let diagnosis = since_baseline(&common::planar(), [&Hidden::nothing(), &bent(0.3)]);
    assert_eq!(named(&diagnosis), [("friction_level_change", &[1][..])]);
    assert_eq!(not_told_apart(&diagnosis), [["friction_level_change", "nonlinear_viscous"]]);
}

#[test]
fn friction_that_bends_before_and_now_has_changed_its_level() {
    let bend =
        |amplitude: f64| common::term(EffectKind::NonlinearViscous, Place::Joint(0), &[0.5], &[amplitude]);
    let before = Hidden::in_robot(move |world| world.put(&bend(1.2)));
    let now = Hidden::in_robot(move |world| {
        world.scale_friction(0, 1.4);
        world.put(&bend(1.4 * 1.2));
    });
    let diagnosis = since_baseline(&common::planar(), [&before, &now]);
    assert_eq!(named(&diagnosis), [("friction_level_change", &[1][..])]);
    assert!(diagnosis.standing.iter().any(|s| s.effect == "nonlinear_viscous"), "{:?}", named(&diagnosis));
}
