//! Recordings judged against a model of the same robot from before it changed.
#![allow(clippy::unwrap_used)]

mod common;

use std::sync::{Arc, LazyLock};

use common::{Hidden, SimulatedRobot, term};
use dynid_runtime::diagnosis::{Diagnosis, Reference, Settings, Silent, diagnose};
use dynid_runtime::effects::{EffectKind, EffectTerm, Place};
use dynid_runtime::model::Model;
use dynid_runtime::model_file::{Covariance, EvaluatedRows, Identified, NamedParameter};
use dynid_runtime::prediction::Errors;
use dynid_runtime::recording::Trajectory;
use dynid_runtime::simulation::World;

/// Load friction of the first joint and a spring on the second, which the robot has from the start.
const MU: f64 = 0.12;
const STIFFNESS: f64 = 2.0;

fn law(effect: EffectKind, joint: usize, shape: &[f64], amplitude: &[f64]) -> EffectTerm {
    term(effect, Place::Joint(joint), shape, amplitude)
}

/// The robot with its own laws, its load friction being `mu`, and with what `more` adds.
fn with_laws(mu: f64, more: impl Fn(&mut World<'_>) + 'static) -> Hidden {
    Hidden::in_robot(move |world| {
        world.put(&law(EffectKind::LoadDependentFriction, 0, &[], &[mu]));
        world.put(&law(EffectKind::Spring, 1, &[], &[STIFFNESS, 0.0]));
        more(world);
    })
}

/// The robot with its laws and a point of this mass on its last link.
fn carrying(mass: f64) -> Hidden {
    let x: f64 = 0.4;
    let about = mass * x * x;
    let inertial = [0.0, 0.0, 0.0, about, 0.0, about, mass * x, 0.0, 0.0, mass];
    let payload = law(EffectKind::Payload, 1, &[], &inertial);
    let body = EffectTerm { place: Place::Link(1), scale: None, ..payload };
    with_laws(MU, move |world| world.put(&body))
}

fn record(robot: &SimulatedRobot, hidden: &Hidden, seed: u64) -> Vec<Trajectory> {
    robot.record(&robot.motions(3, 4.5, seed), hidden, seed)
}

fn settings(reference: Option<Reference>) -> Settings {
    let mut settings = Settings::default();
    settings.threads = 1;
    settings.reference = reference.map(Arc::new);
    settings
}

/// The robot, and what a diagnosis says of it before anything changes.
static BEFORE: LazyLock<(SimulatedRobot, Diagnosis)> = LazyLock::new(|| {
    let robot = common::planar();
    let recording = record(&robot, &with_laws(MU, |_| ()), 1);
    let found = diagnose(&robot.model, &recording, &[], &settings(None), &Silent).unwrap();
    (robot, found)
});

fn against(reference: Reference, hidden: &Hidden) -> Diagnosis {
    let recording = record(&BEFORE.0, hidden, 7);
    let found = diagnose(&BEFORE.0.model, &recording, &[], &settings(Some(reference)), &Silent).unwrap();
    for f in &found.findings {
        eprintln!("{} {:?} {:?}", f.effect, f.joints, f.parameters);
    }
    found
}

fn reference() -> Reference {
    Reference::of(&BEFORE.1).unwrap()
}

fn named(diagnosis: &Diagnosis) -> Vec<(&str, &[usize])> {
    diagnosis.findings.iter().map(|f| (f.effect.as_str(), f.joints.as_slice())).collect()
}

#[test]
fn laws_that_the_reference_has_stand_and_are_no_news() {
    let mut before = named(&BEFORE.1);
    before.sort_unstable();
    assert_eq!(before, [("load_dependent_friction", &[1][..]), ("spring", &[2][..])]);
    let found = against(reference(), &with_laws(MU, |_| ()));
    assert_eq!(named(&found), []);
    let mut standing: Vec<_> = found.standing.iter().map(|s| (s.effect.as_str(), s.joints.clone())).collect();
    standing.sort_unstable();
    assert_eq!(standing, [("load_dependent_friction", vec![1]), ("spring", vec![2])]);
    // They stay part of the model.
    assert_eq!(found.terms().len(), 2);
}

#[test]
fn friction_that_differs_from_motion_to_motion_anyway_is_no_news() {
    let robot = &BEFORE.0;
    let of_level = |more: f64| {
        let term = law(EffectKind::FrictionLevelChange, 0, &[], &[more]);
        with_laws(MU, move |world: &mut World<'_>| world.put(&term))
    };
    let motions = robot.motions(6, 3.0, 11);
    let of_motion = |(k, more): (usize, &f64)| robot.record(&motions[k..=k], &of_level(*more), 20 + k as u64);
    let levels = [0.16, -0.12, 0.02, -0.2, 0.2, -0.06];
    let before: Vec<Trajectory> = levels.iter().enumerate().flat_map(of_motion).collect();
    let found = diagnose(&robot.model, &before, &[], &settings(None), &Silent).unwrap();
    let knowing = Reference::of(&found).unwrap();
    let now = robot.record(&robot.motions(2, 4.5, 31), &of_level(0.25), 31);
    let against = |reference: Reference| {
        diagnose(&robot.model, &now, &[], &settings(Some(reference)), &Silent).unwrap()
    };
    // Who does not know how much it differs believes it.
    let unaware = against(knowing.clone().differing_by(Vec::new()));
    assert_eq!(named(&unaware), [("friction_level_change", &[1][..])]);
    assert_eq!(named(&against(knowing)), []);
}

#[test]
fn of_a_law_that_changed_the_change_is_told() {
    let found = against(reference(), &with_laws(MU + 0.08, |_| ()));
    assert_eq!(named(&found), [("load_dependent_friction", &[1][..])]);
    let mu = &found.findings[0].parameters["mu"];
    assert!((mu.value - 0.08).abs() < 4.0 * mu.sigma + 0.005, "{mu:?}");
}

#[test]
fn a_law_that_came_is_told_and_a_body_is_weighed() {
    let stribeck = |world: &mut World<'_>| world.put(&law(EffectKind::Stribeck, 1, &[0.3], &[2.0]));
    assert_eq!(named(&against(reference(), &with_laws(MU, stribeck))), [("stribeck", &[2][..])]);
    let found = against(reference(), &carrying(0.3));
    assert_eq!(named(&found), [("payload", &[][..])]);
    let weighed = &found.findings[0].parameters["mass"];
    assert!((weighed.value - 0.3).abs() < 4.0 * weighed.sigma, "{weighed:?}");
}

#[test]
fn load_friction_that_stands_follows_a_body_that_is_news() {
    let found = against(reference(), &carrying(3.0));
    assert_eq!(named(&found), [("payload", &[][..])]);
    let weighed = &found.findings[0].parameters["mass"];
    assert!((weighed.value - 3.0).abs() < 4.0 * weighed.sigma, "{weighed:?}");
    let share = found.held_out.after / found.held_out.before;
    assert!(share < 0.02, "{share}: {:?}", found.held_out);
    // Nor is the torque of the body taken for a skew.
    assert!(found.delay.abs() < 2e-4, "{}", found.delay);
}

#[test]
fn a_file_with_standard_deviations_alone_still_is_a_reference_and_that_is_said() {
    let found = &BEFORE.1;
    let robot = BEFORE.0.model.robot();
    let named_parameters = robot.base.iter().enumerate().map(|(k, base)| NamedParameter {
        name: base.name.to_string(),
        value: found.model.chi[k],
        sigma: Some(found.model.sigma[k]),
        relative_sigma_percent: None,
        doubt: None,
        sigma_white: None,
        correction: None,
        sigma_blocks: None,
        unit: base.unit.to_string(),
    });
    let rows = EvaluatedRows {
        samples: 1,
        rows_left_out: None,
        equations: Vec::new(),
        band: 20.0,
        errors: Errors { relative_error: None, per_joint: vec![None; 2] },
        noise: None,
    };
    let mut saved = Identified {
        effects: found.terms(),
        delay: found.delay,
        ..Identified::with_parameters(robot, "planar", "diagnosis", rows, named_parameters.collect())
    };
    let alone = saved.reference(robot).unwrap();
    assert!(alone.is_diagonal());
    let told = against(alone, &with_laws(MU, |_| ()));
    assert!(told.findings.is_empty());
    assert!(told.verdict.iter().any(|line| line.contains("no covariance")), "{:?}", told.verdict);
    // With the covariance of its file it is the model itself.
    let amplitudes: Vec<usize> = found.terms().iter().map(|t| t.amplitude.len()).collect();
    saved.standstill = Some(found.sampling.standstill_speeds.clone());
    saved.covariance = Covariance::new(robot, &amplitudes, found.covariance.clone().unwrap());
    saved.between_motions = found.between_motions.clone();
    saved.delay_sigma = Some(found.delay_sigma);
    assert_eq!(saved.reference(robot).unwrap(), reference());
}

#[test]
fn beside_its_motions_a_change_is_judged_by_how_much_they_differ() {
    let robot = &BEFORE.0;
    // Six motions in which the gain of a drive differs by a few percent, as it does from day to day.
    let motions = robot.motions(6, 12.0, 11);
    let gains = [0.03, -0.02, 0.0, -0.04, 0.04, -0.01];
    let recorded = |(k, gain): (usize, &f64)| {
        let mut one = robot.record(&motions[k..=k], &with_laws(MU, |_| ()), 20 + k as u64);
        one.iter_mut().for_each(|t| t.torque[0].iter_mut().for_each(|x| *x *= 1.0 + gain));
        one
    };
    let before: Vec<Trajectory> = gains.iter().enumerate().flat_map(recorded).collect();
    let found = diagnose(&robot.model, &before, &[], &settings(None), &Silent).unwrap();
    let mut now = robot.record(&robot.motions(1, 20.0, 31), &with_laws(MU, |_| ()), 31);
    now.iter_mut().for_each(|t| t.torque[0].iter_mut().for_each(|x| *x *= 1.04));
    let against = |reference: Reference, baseline: &[Trajectory]| {
        diagnose(&robot.model, &now, baseline, &settings(Some(reference)), &Silent).unwrap()
    };
    let knowing = Reference::of(&found).unwrap();
    let unaware = against(knowing.clone().differing_by(Vec::new()), &[]);
    assert_ne!(named(&unaware), [], "who does not know how much it differs believes it");
    assert_eq!(named(&against(knowing, &before)), []);
}

#[test]
fn friction_that_bends_now_where_it_was_viscous_is_one_law() {
    // The table's viscous friction of joint 2 is 1.2 N.m.s/rad.
    let bent = |world: &mut World<'_>| {
        world.put(&law(EffectKind::NonlinearViscous, 1, &[0.5, 1.0], &[3.0, -1.2]));
    };
    let found = against(reference(), &with_laws(MU, bent));
    assert_eq!(named(&found), [("nonlinear_viscous", &[2][..])]);
    let numbers = &found.findings[0].parameters;
    let (power, viscous) = (&numbers["p"], &numbers["viscous_change"]);
    assert!((power.value - 0.5).abs() < 4.0 * power.sigma + 0.01, "{power:?}");
    assert!((viscous.value + 1.2).abs() < 4.0 * viscous.sigma + 0.02, "{viscous:?}");
}
