//! Diagnoses of simulated recordings whose hidden physics is known.
#![allow(clippy::unwrap_used)]

mod common;

use std::time::Instant;

use common::{Hidden, SimulatedRobot, planar, scara};
use dynid_runtime::diagnosis::{Diagnosis, DiagnosisError, Settings, Silent, diagnose};
use dynid_runtime::effects::EffectKind;
use dynid_runtime::simulation::ElasticJoint;

fn seed() -> u64 { std::env::var("SEED").ok().and_then(|s| s.parse().ok()).unwrap_or(1) }
fn size() -> f64 { std::env::var("SIZE").ok().and_then(|s| s.parse().ok()).unwrap_or(1.0) }

/// Diagnoses three motions; with `baseline`, against three others of the robot without what is hidden.
fn found(robot: &SimulatedRobot, hidden: &Hidden, baseline: bool) -> Diagnosis {
    let before = Instant::now();
    let motions = robot.record(&robot.motions(3, seed()), hidden, seed());
    let old = if baseline { robot.record(&robot.motions(3, seed() + 50), &Hidden::default(), seed() + 50) } else { Vec::new() };
    let simulated = before.elapsed().as_secs_f64();
    let settings = Settings { threads: 1, ..Settings::default() };
    let diagnosis = diagnose(&robot.model, &motions, &old, &settings, &Silent).unwrap();
    let name = std::thread::current().name().unwrap_or_default().to_owned();
    eprintln!("{name}: {simulated:.1} s simulation, {:.1} s in all", before.elapsed().as_secs_f64());
    for f in &diagnosis.findings {
        eprintln!("{name}:   {} {:?} {:?} {:?}", f.effect, f.joints, f.parameters.iter().map(|(n, p)| format!("{n} {:.4}+-{:.4}", p.value, p.sigma)).collect::<Vec<_>>(), f.significance);
    }
    diagnosis
}

/// Asserts that an effect on a joint (number j) is all that was found, and that its quantities are within four of
/// their standard deviations.
fn assert_only(diagnosis: &Diagnosis, effect: EffectKind, joint: &[usize], quantities: &[(&str, f64)]) {
    let named: Vec<_> = diagnosis.findings.iter().map(|f| (f.effect.as_str(), f.joints.as_slice())).collect();
    assert_eq!(named, [(effect.id(), joint)]);
    for (name, truth) in quantities {
        let found = &diagnosis.findings[0].parameters[*name];
        let off = (found.value - truth) / found.sigma;
        assert!(off.abs() < 4.0, "{name}: {} +- {}, truth {truth}: {off:.1} sigma", found.value, found.sigma);
    }
}

#[test]
fn stribeck_planar() {
    let robot = planar();
    let hidden = Hidden::law(EffectKind::Stribeck, 1, &[0.2], &[1.5 * size()]);
    assert_only(&found(&robot, &hidden, false), EffectKind::Stribeck, &[2], &[("fs", 1.5 * size()), ("vs", 0.2)]);
}

#[test]
fn load_planar() {
    let robot = planar();
    let hidden = Hidden::law(EffectKind::LoadDependentFriction, 0, &[], &[0.1 * size()]);
    assert_only(&found(&robot, &hidden, false), EffectKind::LoadDependentFriction, &[1], &[("mu", 0.1 * size())]);
}

#[test]
fn viscous_scara() {
    let robot = scara();
    let hidden = Hidden::law(EffectKind::NonlinearViscous, 1, &[0.5], &[4.0 * size()]);
    assert_only(&found(&robot, &hidden, false), EffectKind::NonlinearViscous, &[2], &[("p", 0.5)]);
}

#[test]
fn spring_planar() {
    let robot = planar();
    let hidden = Hidden::law(EffectKind::Spring, 1, &[], &[2.0 * size()]);
    assert_only(&found(&robot, &hidden, false), EffectKind::Spring, &[2], &[("k", 2.0 * size())]);
}

#[test]
fn spring_scara_slide() {
    let robot = scara();
    let hidden = Hidden::law(EffectKind::Spring, 2, &[], &[100.0 * size()]);
    assert_only(&found(&robot, &hidden, false), EffectKind::Spring, &[3], &[("k", 100.0 * size())]);
}

#[test]
fn ripple_planar() {
    let robot = planar();
    let hidden = Hidden::law(EffectKind::TorqueRipple, 0, &[50.0], &[0.8 * size(), 0.6 * size()]);
    assert_only(&found(&robot, &hidden, false), EffectKind::TorqueRipple, &[1], &[("amplitude", size())]);
}

#[test]
fn position_friction_scara() {
    let robot = scara();
    let hidden = Hidden::law(EffectKind::PositionDependentFriction, 0, &[2.0], &[1.2 * size(), 0.9 * size()]);
    assert_only(&found(&robot, &hidden, false), EffectKind::PositionDependentFriction, &[1], &[("amplitude", 1.5 * size())]);
}

#[test]
fn asymmetric_planar() {
    let robot = planar();
    let hidden = Hidden::law(EffectKind::AsymmetricFriction, 0, &[], &[0.5 * size()]);
    assert_only(&found(&robot, &hidden, false), EffectKind::AsymmetricFriction, &[1], &[("half_difference", 0.5 * size())]);
}

#[test]
fn payload_planar() {
    let robot = planar();
    let m = 0.15 * size();
    let x = 0.4;
    let hidden = Hidden { added: vec![("M2", m), ("MX2", m * x), ("ZZ2", m * x * x), ("YY2", m * x * x)], ..Hidden::default() };
    assert_only(&found(&robot, &hidden, true), EffectKind::Payload, &[2], &[("mass", m)]);
}

#[test]
fn tilt_scara() {
    let robot = scara();
    let hidden = Hidden { tilt: Some([0.1 * size(), 0.05 * size()]), ..Hidden::default() };
    assert_only(&found(&robot, &hidden, true), EffectKind::BaseTilt, &[], &[("tilt_1", 0.1 * size()), ("tilt_2", 0.05 * size())]);
}

#[test]
fn friction_level_scara() {
    let robot = scara();
    let more = 0.25 * size();
    let hidden = Hidden { added: vec![("Fv2", 2.2 * more), ("Fc2", 3.0 * more)], ..Hidden::default() };
    assert_only(&found(&robot, &hidden, true), EffectKind::FrictionLevelChange, &[2], &[("factor", 1.0 + more)]);
}

#[test]
fn constant_planar() {
    let robot = planar();
    let hidden = Hidden { distortion: Some(|m| m.torque[0].iter_mut().for_each(|x| *x *= 1.1)), ..Hidden::default() };
    assert_only(&found(&robot, &hidden, true), EffectKind::TorqueConstantError, &[1], &[("factor", 1.1)]);
}

#[test]
fn rate_planar() {
    let robot = planar();
    let hidden = Hidden { distortion: Some(|m| m.time.iter_mut().for_each(|x| *x *= 1.1)), ..Hidden::default() };
    assert_only(&found(&robot, &hidden, false), EffectKind::WrongSampleRate, &[], &[("rate_error", 0.1)]);
}

#[test]
fn delay_planar() {
    let robot = planar();
    let hidden = Hidden { distortion: Some(|m| for x in &mut m.torque { x.rotate_right(4) }), ..Hidden::default() };
    assert_only(&found(&robot, &hidden, false), EffectKind::TimeDelay, &[], &[("delay", 0.008)]);
}

#[test]
fn elastic_planar() {
    let robot = planar();
    let joint = ElasticJoint { joint: 0, stiffness: 2000.0 / size(), damping: 4.0, play: 0.0 };
    let hidden = Hidden { elastic: vec![joint], ..Hidden::default() };
    assert_only(&found(&robot, &hidden, false), EffectKind::JointElasticity, &[1], &[("k", 2000.0 / size())]);
}

#[test]
fn clean_planar() {
    assert!(found(&planar(), &Hidden::default(), false).findings.is_empty());
}

#[test]
fn clean_scara() {
    assert!(found(&scara(), &Hidden::default(), false).findings.is_empty());
}

#[test]
fn clean_baseline_scara() {
    assert!(found(&scara(), &Hidden::default(), true).findings.is_empty());
}

#[test]
fn clean_baseline_planar() {
    assert!(found(&planar(), &Hidden::default(), true).findings.is_empty());
}

#[test]
fn refusal() {
    let robot = scara();
    let mut motions = robot.record(&robot.motions(1, 1), &Hidden::default(), 1);
    for motion in &mut motions {
        motion.time.truncate(200);
        for signal in motion.position.iter_mut().chain(&mut motion.torque) {
            signal.truncate(200);
        }
    }
    let refused = diagnose(&robot.model, &motions, &[], &Settings::default(), &Silent).unwrap_err();
    eprintln!("{refused}");
    assert!(matches!(refused, DiagnosisError::TooLittleMotion { .. }), "{refused}");
}
