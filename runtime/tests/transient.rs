//! Friction that fades at the beginning of the only motion: for all that is known something that happened then. It is not
//! named, it is part of the model, and the parameters are those of the motion after it.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Hidden, planar, term};
use dynid_runtime::diagnosis::{Diagnosis, Estimated, Settings, Silent, diagnose};
use dynid_runtime::effects::{EffectKind, EffectTerm, Place};
use dynid_runtime::model::Model;

const SEED: u64 = 5;
/// Coulomb friction of joint 1 that fades, N.m, and its time constant, s.
const FADES: f64 = 1.5;
const TAU: f64 = 0.3;
/// That which stays, N.m.
const COULOMB: f64 = 3.0;

fn diagnosed(motions: u64, length: f64, hidden: Vec<EffectTerm>) -> Diagnosis {
    let robot = planar();
    let hidden = Hidden::in_robot(move |world| hidden.iter().for_each(|term| world.put(term)));
    let motions = robot.record(&robot.motions(motions, length, SEED), &hidden, SEED);
    let mut settings = Settings::default();
    settings.threads = 1;
    let diagnosis = diagnose(&robot.model, &motions, &[], &settings, &Silent).unwrap();
    for f in &diagnosis.findings {
        eprintln!("{}", f.sentence);
    }
    for t in &diagnosis.transients {
        eprintln!("transient: {t:?}");
    }
    diagnosis
}

fn bends() -> EffectTerm {
    term(EffectKind::NonlinearViscous, Place::Joint(1), &[0.5], &[4.0])
}

fn fades() -> EffectTerm {
    term(EffectKind::FrictionDrift, Place::Joint(0), &[1.0, TAU], &[FADES])
}

fn named(diagnosis: &Diagnosis) -> Vec<(&str, &[usize])> {
    diagnosis.findings.iter().map(|f| (f.effect.as_str(), f.joints.as_slice())).collect()
}

#[test]
fn friction_that_fades_within_the_first_second_is_kept_apart_and_not_named() {
    let diagnosis = diagnosed(1, 4.5, vec![bends(), fades()]);
    assert_eq!(named(&diagnosis), [("nonlinear_viscous", [2].as_slice())]);
    let [transient] = diagnosis.transients.as_slice() else { panic!("{:?}", diagnosis.transients) };
    assert_eq!((transient.effect.as_str(), transient.joints.as_slice()), ("friction_drift", [1].as_slice()));
    assert!(transient.faded_after < 4.5 * 0.25, "{transient:?}");
    // What is saved: other motion does not have the transient.
    assert_eq!(diagnosis.terms(), [diagnosis.findings[0].term.clone()]);
    // The Coulomb friction of the motion after it, which the standard model takes for more.
    let off = |fitted: &Estimated| {
        let k = planar().model.robot().base.iter().position(|p| p.name == "Fc1").unwrap();
        (fitted.chi[k] - COULOMB) / fitted.sigma[k]
    };
    assert!(off(&diagnosis.model).abs() < 3.0, "{}", off(&diagnosis.model));
    assert!(off(&diagnosis.standard) > 2.0, "{}", off(&diagnosis.standard));
}

#[test]
fn the_same_friction_in_every_motion_is_a_drift() {
    let diagnosis = diagnosed(6, 3.0, vec![bends(), fades()]);
    assert!(named(&diagnosis).contains(&("friction_drift", &[1])), "{:?}", named(&diagnosis));
    assert!(diagnosis.transients.is_empty());
}

#[test]
fn where_nothing_fades_nothing_is_kept_apart() {
    let diagnosis = diagnosed(1, 4.5, vec![bends()]);
    assert_eq!(named(&diagnosis), [("nonlinear_viscous", [2].as_slice())]);
    assert!(diagnosis.transients.is_empty());
}
