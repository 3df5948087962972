//! Bodies that a robot carries: consistent ones are weighed, of those whose mass does not show the moment is told, and what
//! no body can be is none.
#![allow(clippy::unwrap_used)]

mod common;

use common::Hidden;
use dynid_runtime::diagnosis::{Diagnosis, Settings, Silent, diagnose, term_torques};
use dynid_runtime::effects::{EffectKind, EffectTerm, Place};
use dynid_runtime::model::Model;
use dynid_runtime::recording::Trajectory;
use dynid_runtime::signal::{Preparation, prepare};
use dynid_runtime::simulation::excitation::{ExcitationSettings, ExcitingMotion, MotionKind, excite};

/// XX XY XZ YY YZ ZZ MX MY MZ M of a point on x.
fn point(mass: f64, x: f64) -> [f64; 10] {
    let about = mass * x * x;
    [0.0, 0.0, 0.0, about, 0.0, about, mass * x, 0.0, 0.0, mass]
}

fn diagnosed(motions: &[Trajectory], baseline: &[Trajectory]) -> Diagnosis {
    let mut settings = Settings::default();
    settings.threads = 2;
    let found = diagnose(&common::planar().model, motions, baseline, &settings, &Silent).unwrap();
    found.findings.iter().for_each(|f| eprintln!("{} {:?} {:?}", f.effect, f.joints, f.parameters));
    found
}

fn body(place: usize, inertial: [f64; 10]) -> Hidden {
    let effect = if place == 1 { EffectKind::Payload } else { EffectKind::AddedMass };
    Hidden::effect(effect, Place::Link(place), &[], &inertial)
}

#[test]
fn of_a_body_whose_mass_does_not_show_the_moment_about_the_axis_is_told() {
    let robot = common::planar();
    let baseline = robot.record(&robot.motions(3, 4.5, 51), &Hidden::nothing(), 51);
    // Only the second joint moves: what it feels of a mass is its moments about the joint's axis.
    let chi = robot.model.robot().base_from_standard(&robot.standard);
    let alone = |seed: u64| -> Vec<ExcitingMotion> {
        let kind = MotionKind::Fourier { harmonics: 5, period: 4.5, periods: 1 };
        let settings = ExcitationSettings { kind, sets: 2, seed, share: 0.8, ..Default::default() };
        excite(&robot.model, Some(&chi), &settings, &|_| {}).unwrap().motions.split_off(1)
    };
    let motions: Vec<ExcitingMotion> = (1..4).flat_map(alone).collect();
    let (mass, x) = (0.15, 0.4);
    let mut recording = robot.record(&motions, &body(1, point(mass, x)), 1);
    recording.iter_mut().for_each(|motion| motion.fixed = vec![0]);
    let found = diagnosed(&recording, &baseline);
    let named: Vec<&str> = found.findings.iter().map(|f| f.effect.as_str()).collect();
    assert_eq!(named, ["payload"]);
    let told = &found.findings[0].parameters;
    let moment = &told["moment"];
    assert!((moment.value - mass * x).abs() < 4.0 * moment.sigma + 0.002, "{moment:?}");
    assert_eq!(told["axis"].value, 2.0);
    assert!(!told.contains_key("mass"), "{told:?}");
    assert!(found.findings[0].sentence.contains("kg.m about axis 2"), "{}", found.findings[0].sentence);
}

#[test]
fn what_would_have_less_than_no_mass_is_no_body() {
    let robot = common::planar();
    let (before, after) = (robot.motions(3, 4.5, 51), robot.motions(3, 4.5, 1));
    let with_tool = robot.record(&before, &body(1, point(0.15, 0.4)), 51);
    let payloads = |d: &Diagnosis| d.findings.iter().filter(|f| f.effect == "payload").count();
    let found = diagnosed(&robot.record(&after, &Hidden::nothing(), 1), &with_tool);
    assert_eq!(payloads(&found), 0);
    assert!(found.findings.iter().all(|f| f.parameters.get("mass").is_none_or(|m| m.value > 0.0)));
    let heavier = robot.record(&after, &body(1, point(0.3, 0.4)), 1);
    assert_eq!(payloads(&diagnosed(&heavier, &with_tool)), 1);
}

#[test]
fn one_body_is_told_once_with_what_it_weighs() {
    let robot = common::planar();
    let baseline = robot.record(&robot.motions(3, 4.5, 51), &Hidden::nothing(), 51);
    for (place, name) in [(1, "payload"), (0, "added_mass")] {
        let (mass, x) = (0.6, 0.3);
        let recording = robot.record(&robot.motions(3, 4.5, 1), &body(place, point(mass, x)), 1);
        let found = diagnosed(&recording, &baseline);
        let named: Vec<&str> = found.findings.iter().map(|f| f.effect.as_str()).collect();
        assert_eq!(named, [name]);
        let told = &found.findings[0].parameters;
        assert_eq!(told["physically_consistent"].value, 1.0);
        // The first link turns about its own origin: no motion shows what a body there weighs.
        let (quantity, truth) = if place == 1 { ("mass", mass) } else { ("moment", mass * x) };
        let told = &told[quantity];
        assert!((told.value - truth).abs() < 4.0 * told.sigma + 0.02 * truth, "{told:?}");
    }
}

#[test]
fn a_law_that_follows_the_load_feels_the_body_that_was_found() {
    let robot = common::planar();
    let model: &dyn Model = &robot.model;
    let chi = model.robot().base_from_standard(&robot.standard);
    let inertial = point(2.0, 0.3);
    let payload = common::term(EffectKind::Payload, Place::Link(1), &[], &inertial);
    let friction = common::term(EffectKind::LoadDependentFriction, Place::Joint(0), &[], &[0.1]);
    let recording = robot.record(&robot.motions(1, 4.5, 3), &Hidden::nothing(), 3);
    let motion = prepare(&recording[0], &Preparation::default()).unwrap();
    let torques = |chi: &[f64], terms: &[EffectTerm]| term_torques(model, chi, terms, &motion).unwrap();
    let together = torques(&chi, &[payload.clone(), friction.clone()]);
    let body = torques(&chi, &[payload]);
    // The same robot with the body as a part of its last link.
    let carried = model.robot().base_of_body(1, &inertial).unwrap();
    let heavier: Vec<f64> = chi.iter().zip(&carried).map(|(x, more)| x + more).collect();
    let felt = torques(&heavier, std::slice::from_ref(&friction));
    let unloaded = torques(&chi, &[friction]);
    for j in 0..2 {
        for t in 0..motion.q[j].len() {
            approx::assert_relative_eq!(together[j][t] - body[j][t], felt[j][t], epsilon = 1e-9);
        }
    }
    let largest = |x: &[f64]| x.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
    assert!(largest(&felt[0]) > 1.5 * largest(&unloaded[0]));
}

#[test]
fn a_body_that_joints_weigh_with_gains_of_their_own_is_a_body_and_no_gain_is_named() {
    let robot = common::planar();
    let (mass, x) = (0.6, 0.3);
    let mut inertial = point(mass, x);
    // It has an extent.
    [0, 3, 5].into_iter().for_each(|k| inertial[k] += 0.01);
    let gains: fn(&mut Trajectory) = |motion| {
        motion.torque[0].iter_mut().for_each(|t| *t *= 1.015);
        motion.torque[1].iter_mut().for_each(|t| *t *= 0.985);
    };
    let with_gains = |hidden: Hidden| Hidden { distort: gains, ..hidden };
    let baseline = robot.record(&robot.motions(3, 4.5, 51), &with_gains(Hidden::nothing()), 51);
    let found =
        diagnosed(&robot.record(&robot.motions(3, 4.5, 1), &with_gains(body(1, inertial)), 1), &baseline);
    let named: Vec<&str> = found.findings.iter().map(|f| f.effect.as_str()).collect();
    assert_eq!(named, ["payload"]);
    let told = &found.findings[0].parameters["mass"];
    assert!(told.sigma > 0.002 * mass && told.sigma < 0.05 * mass, "{told:?}");
    assert!((told.value - mass).abs() < 3.0 * told.sigma, "{told:?}");
}
