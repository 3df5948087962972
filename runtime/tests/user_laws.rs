//! Laws that a user wrote down, in simulated recordings: what is there is named with its numbers, what is not there is not.
#![allow(clippy::unwrap_used)]

mod common;

use std::sync::LazyLock;

use common::{Hidden, SimulatedRobot};
use dynid_runtime::diagnosis::{Diagnosis, Settings, Silent, diagnose};
use dynid_runtime::effects::{EffectKind, EffectTerm, Place, UserLaw};
use dynid_runtime::simulation::excitation::ExcitingMotion;

/// A robot with its motions.
type Bench = (SimulatedRobot, Vec<ExcitingMotion>);

static PLANAR: LazyLock<Bench> = LazyLock::new(|| with_motions(common::planar()));
static SCARA: LazyLock<Bench> = LazyLock::new(|| with_motions(common::scara()));

fn with_motions(robot: SimulatedRobot) -> Bench {
    let motions = robot.motions(3, 4.5, 1);
    (robot, motions)
}

/// A law of the second joint.
fn law(id: &str, text: &str, shapes: &[(&str, [f64; 2])]) -> UserLaw {
    let shapes = shapes.iter().map(|(name, range)| ((*name).to_owned(), *range)).collect();
    UserLaw::new(id, 1, text, &shapes).unwrap()
}

fn magnet() -> UserLaw {
    law("magnet", "k1*sin(2*q2) + k2*cos(2*q2)", &[])
}

fn diagnosed((robot, motions): &Bench, hidden: &Hidden, laws: &[UserLaw]) -> Diagnosis {
    let mut settings = Settings::default();
    settings.threads = 1;
    settings.laws = laws.to_vec();
    let recorded = robot.record(motions, hidden, 1);
    let diagnosis = diagnose(&robot.model, &recorded, &[], &settings, &Silent).unwrap();
    for f in &diagnosis.findings {
        eprintln!("{}\n  {:?}", f.sentence, f.formula());
    }
    eprintln!("{:#?} {:?}", diagnosis.verdict, diagnosis.cannot_tell);
    diagnosis
}

fn named(diagnosis: &Diagnosis) -> Vec<(&str, &[usize])> {
    diagnosis.findings.iter().map(|f| (f.effect.as_str(), f.joints.as_slice())).collect()
}

fn assert_within_four_sigma(diagnosis: &Diagnosis, name: &str, truth: f64) {
    let found = &diagnosis.findings[0].parameters[name];
    let off = (found.value - truth).abs();
    assert!(found.sigma > 0.0 && off < 4.0 * found.sigma, "{name}: {} +- {}", found.value, found.sigma);
    assert!(found.sigma < 0.2 * truth.abs(), "{name}: {} +- {}", found.value, found.sigma);
}

/// The torque that a law makes, by hand: the law's own code has no part in it.
fn with_a_magnet() -> Hidden {
    Hidden::in_recording(|recorded| {
        let positions = recorded.position[1].clone();
        for (torque, q) in recorded.torque[1].iter_mut().zip(positions) {
            *torque += 2.0 * (2.0 * q).sin() - 1.5 * (2.0 * q).cos();
        }
    })
}

#[test]
fn a_law_that_is_there_is_named_with_its_constants_and_nothing_else_is() {
    let diagnosis = diagnosed(&PLANAR, &with_a_magnet(), &[magnet()]);
    assert_eq!(named(&diagnosis), [("magnet", &[2][..])]);
    assert_within_four_sigma(&diagnosis, "k1", 2.0);
    assert_within_four_sigma(&diagnosis, "k2", -1.5);
    let finding = &diagnosis.findings[0];
    assert_eq!(finding.curve.as_ref().unwrap().variable, "position of joint 2, rad");
    assert!(finding.sentence.contains("k1*sin(2*q2)"), "{}", finding.sentence);
    let saved = serde_json::to_string(&finding.term).unwrap();
    assert_eq!(serde_json::from_str::<EffectTerm>(&saved).unwrap(), finding.term);
}

#[test]
fn a_law_in_a_plant_is_found_again_with_its_shape() {
    let sag = law("sag", "k*abs(dq2)^p*sign(dq2)*cos(q2)", &[("p", [0.3, 3.0])]);
    let term = EffectTerm {
        effect: EffectKind::UserLaw,
        place: Place::Law(sag),
        joints: vec![2],
        shape: vec![0.5],
        amplitude: vec![4.0],
        sigma: vec![0.0],
        scale: None,
        wrenches: Vec::new(),
    };
    let diagnosis = diagnosed(&PLANAR, &Hidden::in_robot(move |world| world.put(&term)), &[sag, magnet()]);
    assert_eq!(named(&diagnosis), [("sag", &[2][..])]);
    assert_within_four_sigma(&diagnosis, "k", 4.0);
    assert_within_four_sigma(&diagnosis, "p", 0.5);
}

#[test]
fn laws_that_are_not_there_are_not_named_and_their_user_is_told() {
    let own = law("own", "a*dq2 + b*sin(3*q2)", &[]);
    for bench in [&*PLANAR, &*SCARA] {
        let diagnosis = diagnosed(bench, &Hidden::nothing(), &[magnet(), own]);
        assert_eq!(named(&diagnosis), []);
        let told = |what: &str| diagnosis.verdict.iter().any(|line| line.contains(what));
        assert!(told("Your law magnet on joint 2 was tried and is not named"), "{:?}", diagnosis.verdict);
        assert!(told("Your law own on joint 2 was not tried"), "the standard model has viscous friction");
    }
}

#[test]
fn a_law_beside_the_physics_that_is_there_takes_no_part() {
    let hidden = Hidden::effect(EffectKind::Stribeck, Place::Joint(1), &[0.3], &[3.0]);
    let diagnosis = diagnosed(&PLANAR, &hidden, &[magnet()]);
    assert_eq!(named(&diagnosis), [("stribeck", &[2][..])]);
}

#[test]
fn at_equal_evidence_the_law_of_the_user_is_named_and_the_other_one_told() {
    let sag = law("sag", "k*abs(dq2)^p*sign(dq2)", &[("p", [0.3, 3.0])]);
    for (p, f) in [(0.5, 4.0), (1.6, 1.0)] {
        // The catalogue has the same law.
        let hidden = Hidden::effect(EffectKind::NonlinearViscous, Place::Joint(1), &[p], &[f]);
        for bench in [&*PLANAR, &*SCARA] {
            let diagnosis = diagnosed(bench, &hidden, &[sag]);
            assert_eq!(named(&diagnosis), [("sag", &[2][..])]);
            assert_within_four_sigma(&diagnosis, "k", f);
            assert_within_four_sigma(&diagnosis, "p", p);
            assert_eq!(diagnosis.cannot_tell[0].between, ["sag", "nonlinear_viscous"]);
        }
    }
}
