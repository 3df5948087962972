//! Recordings in which joints, or the whole robot, hold still.
#![allow(clippy::unwrap_used)]

mod common;

use std::sync::Arc;

use common::{Hidden, SimulatedRobot, planar, scara};
use dynid_runtime::diagnosis::{Diagnosis, DiagnosisError, Reference, Settings, Silent, diagnose};
use dynid_runtime::effects::{EffectKind, Place};
use dynid_runtime::model::Model;
use dynid_runtime::recording::Trajectory;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// Samples a second.
const RATE: f64 = 500.0;

/// A motion by inverse dynamics: `state(t)` are q, dq, ddq per joint, `outside(t)` what is added to the torques.
fn recorded(
    robot: &SimulatedRobot,
    seconds: f64,
    seed: u64,
    state: impl Fn(f64) -> [Vec<f64>; 3],
    outside: impl Fn(f64) -> Vec<f64>,
) -> Trajectory {
    let model = &robot.model;
    let chi = model.robot().base_from_standard(&robot.standard);
    let pattern = model.pattern().clone();
    let joints = model.robot().joints();
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut entries = vec![0.0; pattern.columns.len()];
    let (mut time, mut position, mut torque) =
        (Vec::new(), vec![Vec::new(); joints], vec![Vec::new(); joints]);
    for k in 0..(seconds * RATE) as usize {
        let t = k as f64 / RATE;
        let [q, dq, ddq] = state(t);
        model.idm(&q, &dq, &ddq, &mut entries);
        let outside = outside(t);
        time.push(t);
        for j in 0..joints {
            let row = pattern.rows[j]..pattern.rows[j + 1];
            let ideal: f64 = row.map(|e| entries[e] * chi[pattern.columns[e]]).sum();
            position[j].push(q[j] + 1e-6 * rng.random_range(-1.0..1.0));
            torque[j].push(ideal + outside[j] + 0.2 * rng.random_range(-1.0..1.0));
        }
    }
    Trajectory { name: format!("seed {seed}"), time, position, velocity: None, torque, fixed: vec![] }
}

fn diagnosed(
    robot: &SimulatedRobot,
    recording: Trajectory,
    baseline: &[Trajectory],
) -> Result<Diagnosis, DiagnosisError> {
    let mut settings = Settings::default();
    settings.threads = 1;
    diagnose(&robot.model, &[recording], baseline, &settings, &Silent)
}

/// The pose at which the planar robot holds still.
const POSE: [f64; 2] = [0.4, 0.5];

/// The planar robot holding still with part of its static friction, and `more`, in its motors, and pushes: (joint, instant,
/// height).
fn at_rest(robot: &SimulatedRobot, pushes: &[(usize, f64, f64)], more: [f64; 2]) -> Trajectory {
    let rest = |_: f64| [POSE.to_vec(), vec![0.0; 2], vec![0.0; 2]];
    let outside = |t: f64| {
        let mut torque = vec![1.5 + more[0], -0.8 + more[1]];
        for &(joint, from, height) in pushes {
            if (0.0..1.0).contains(&(t - from)) {
                torque[joint] += height * (std::f64::consts::PI * (t - from)).sin();
            }
        }
        torque
    };
    recorded(robot, 10.0, 1, rest, outside)
}

/// The same beside a baseline in which it moves.
fn standing(pushes: &[(usize, f64, f64)]) -> Diagnosis {
    let robot = planar();
    let baseline = robot.record(&robot.motions(2, 8.0, 51), &Hidden::nothing(), 51);
    diagnosed(&robot, at_rest(&robot, pushes, [0.0; 2]), &baseline).unwrap()
}

/// Of a spring on joint 2, N.m/rad.
const STIFFNESS: f64 = 12.0;

/// The same beside a model of the robot, which has the spring.
fn standing_beside_a_model(pushes: &[(usize, f64, f64)]) -> Diagnosis {
    let robot = planar();
    let spring = Hidden::effect(EffectKind::Spring, Place::Joint(1), &[], &[STIFFNESS, 0.0]);
    let moving = robot.record(&robot.motions(3, 8.0, 51), &spring, 51);
    let mut settings = Settings::default();
    settings.threads = 1;
    let before = diagnose(&robot.model, &moving, &[], &settings, &Silent).unwrap();
    assert_eq!(before.findings.iter().map(|f| f.effect.as_str()).collect::<Vec<_>>(), ["spring"]);
    settings.reference = Reference::of(&before).map(Arc::new);
    let recording = at_rest(&robot, pushes, [0.0, STIFFNESS * POSE[1]]);
    diagnose(&robot.model, &[recording], &[], &settings, &Silent).unwrap()
}

#[test]
fn pushes_against_a_robot_that_holds_still_are_found_at_their_times() {
    // Coulomb friction is 3 and 1.5 N.m.
    let diagnosis = standing(&[(0, 2.0, 9.0), (1, 6.0, -6.0)]);
    assert_eq!(diagnosis.findings.len(), 1, "{:?}", diagnosis.verdict);
    let contact = &diagnosis.findings[0];
    assert_eq!(contact.effect, "contact");
    assert_eq!(contact.contacts.len(), 2, "{:?}", contact.contacts);
    for (seen, (joint, from)) in contact.contacts.iter().zip([(1, 2.0), (2, 6.0)]) {
        assert!(seen.window[0] < from + 0.4 && seen.window[1] > from + 0.6, "{seen:?}");
        assert!(seen.window[0] > from - 0.2 && seen.window[1] < from + 1.2, "{seen:?}");
        assert_eq!(seen.joint_torques.iter().map(|t| t.joint).collect::<Vec<_>>(), [joint]);
    }
    assert!(contact.confidence > 0.93);
    assert_eq!(diagnosis.not_judged.len(), 2);
}

#[test]
fn a_robot_that_holds_still_within_its_friction_shows_nothing() {
    let diagnosis = standing(&[(0, 2.0, 1.5)]);
    assert!(diagnosis.findings.is_empty(), "{:?}", diagnosis.verdict);
    assert!(diagnosis.cannot_tell.is_empty());
}

#[test]
fn a_robot_that_holds_still_is_judged_against_a_model_with_its_laws() {
    let nothing = standing_beside_a_model(&[(0, 2.0, 1.5)]);
    assert!(nothing.findings.is_empty(), "{:?}", nothing.verdict);
    // The spring of the model holds 6 N.m, four times what friction does: without it there would be another load.
    assert!(nothing.cannot_tell.is_empty(), "{:?}", nothing.verdict);
    let pushed = standing_beside_a_model(&[(1, 6.0, -6.0)]);
    assert_eq!(pushed.findings.iter().map(|f| f.effect.as_str()).collect::<Vec<_>>(), ["contact"]);
    assert_eq!(pushed.findings[0].contacts.len(), 1);
    assert!(pushed.held_out.how.contains("reference"));
}

#[test]
fn what_a_law_that_is_found_holds_at_rest_is_no_push() {
    let robot = planar();
    let spring = Hidden::effect(EffectKind::Spring, Place::Joint(1), &[], &[STIFFNESS, 0.0]);
    let mut recording = robot.record(&robot.motions(3, 8.0, 52), &spring, 52);
    let mut settings = Settings::default();
    settings.threads = 1;
    let mut named = |pushes: &[(usize, f64, f64)]| -> Vec<String> {
        recording.truncate(3);
        recording.push(at_rest(&robot, pushes, [0.0, STIFFNESS * POSE[1]]));
        let diagnosis = diagnose(&robot.model, &recording, &[], &settings, &Silent).unwrap();
        diagnosis.findings.into_iter().map(|f| f.effect).collect()
    };
    assert_eq!(named(&[]), ["spring"]);
    assert_eq!(named(&[(0, 4.0, 9.0)]), ["contact", "spring"]);
}

#[test]
fn without_a_baseline_a_robot_that_holds_still_is_refused_in_words() {
    let robot = planar();
    let rest = |_: f64| [vec![0.4, 0.5], vec![0.0; 2], vec![0.0; 2]];
    let refused = diagnosed(&robot, recorded(&robot, 10.0, 2, rest, |_| vec![0.0; 2]), &[]).unwrap_err();
    assert!(matches!(refused, DiagnosisError::NothingMoves { .. }), "{refused}");
}

/// Strokes of one joint of the SCARA, four waves, with a spring of this stiffness on the second one, N.m/rad; the others hold
/// still.
fn strokes_of(joint: usize, seconds: f64, stiffness: f64, seed: u64) -> Trajectory {
    const WAVES: [[f64; 3]; 4] = [[0.5, 1.7, 0.3], [0.25, 3.1, 1.9], [0.15, 4.9, 4.0], [0.1, 6.6, 5.1]];
    let size = [1.0, 1.0, 0.1][joint];
    let stroke = move |t: f64| {
        let sum = |of: fn([f64; 3], f64) -> f64| size * WAVES.iter().map(|&wave| of(wave, t)).sum::<f64>();
        let alone = |rest: [f64; 3], moving: f64| -> Vec<f64> {
            (0..3).map(|j| if j == joint { moving } else { rest[j] }).collect()
        };
        let q = sum(|[a, w, p], t| a * (w * t + p).sin());
        let dq = sum(|[a, w, p], t| a * w * (w * t + p).cos());
        let ddq = sum(|[a, w, p], t| -a * w * w * (w * t + p).sin());
        [alone([0.3, 0.2, 0.05], q), alone([0.0; 3], dq), alone([0.0; 3], ddq)]
    };
    let spring = |t: f64| vec![0.0, stiffness * stroke(t)[0][1], 0.0];
    recorded(&scara(), seconds, seed, stroke, spring)
}

fn strokes(stiffness: f64, seed: u64) -> Diagnosis {
    diagnosed(&scara(), strokes_of(1, 24.0, stiffness, seed), &[]).unwrap()
}

#[test]
fn strokes_of_one_joint_name_what_that_joint_has_and_say_that_the_others_are_not_judged() {
    for (seed, stiffness) in [(3, 2.0), (4, 4.0), (5, 8.0)] {
        let diagnosis = strokes(stiffness, seed);
        let named: Vec<_> =
            diagnosis.findings.iter().map(|f| (f.effect.as_str(), f.joints.as_slice())).collect();
        assert_eq!(named, [("spring", &[2][..])], "{stiffness} N.m/rad: {:?}", diagnosis.verdict);
        let k = &diagnosis.findings[0].parameters["k"];
        assert!((k.value - stiffness).abs() < 4.0 * k.sigma + 0.02 * stiffness, "{stiffness}: {k:?}");
        let not_judged: Vec<usize> = diagnosis.not_judged.iter().map(|j| j.joint).collect();
        assert_eq!(not_judged, [1, 3]);
    }
    let nothing = strokes(0.0, 6);
    assert!(nothing.findings.is_empty(), "{:?}", nothing.verdict);
}

#[test]
fn motions_that_move_a_joint_each_are_held_out_in_stretches() {
    let mut settings = Settings::default();
    settings.threads = 1;
    let diagnosed = |stiffness: f64| {
        let motions: Vec<Trajectory> =
            (0..3).map(|j| strokes_of(j, 10.0, stiffness, 60 + j as u64)).collect();
        diagnose(&scara().model, &motions, &[], &settings, &Silent).unwrap()
    };
    let found = diagnosed(2.0);
    let named: Vec<_> = found.findings.iter().map(|f| (f.effect.as_str(), f.joints.as_slice())).collect();
    assert_eq!(named, [("spring", &[2][..])], "{:?}", found.verdict);
    assert_eq!(found.held_out.how, "every stretch of the motions predicted from the others");
    assert!(found.held_out.after < 0.1, "{}", found.held_out.after);
    let nothing = diagnosed(0.0);
    assert!(nothing.findings.is_empty(), "{:?}", nothing.verdict);
}
