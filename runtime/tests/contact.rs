//! Recordings of robots that are pushed while they move.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Hidden, SimulatedRobot, planar, scara, term};
use dynid_runtime::diagnosis::{Diagnosis, Finding, Settings, Silent, diagnose};
use dynid_runtime::effects::{ContactForce, EffectKind, JointTorque, Place};
use dynid_runtime::recording::Trajectory;

/// Two motions of 8 s of the planar robot, pushed.
fn recorded(robot: &SimulatedRobot, pushes: Vec<ContactForce>, seed: u64) -> Vec<Trajectory> {
    let hidden = Hidden::in_robot(move |world| pushes.iter().for_each(|p| world.put_push(p.clone())));
    robot.record(&robot.motions(2, 8.0, 5), &hidden, seed)
}

fn diagnosed(robot: &SimulatedRobot, motions: &[Trajectory], baseline: &[Trajectory]) -> Diagnosis {
    let mut settings = Settings::default();
    settings.threads = 1;
    diagnose(&robot.model, motions, baseline, &settings, &Silent).unwrap()
}

fn push(motion: &str, window: [f64; 2]) -> ContactForce {
    ContactForce { motion: motion.into(), window, link: 2, ..ContactForce::default() }
}

/// A push that one joint (number j) feels, N.m.
fn on_joint(motion: &str, window: [f64; 2], joint: usize, largest: f64) -> ContactForce {
    let torque = JointTorque { joint, mean: 0.5 * largest, largest, sigma: 0.0 };
    ContactForce { joint_torques: vec![torque], ..push(motion, window) }
}

fn contact(diagnosis: &Diagnosis) -> &Finding {
    assert_eq!(diagnosis.findings.len(), 1, "{:?}", diagnosis.verdict);
    assert_eq!(diagnosis.findings[0].effect, "contact");
    &diagnosis.findings[0]
}

/// Mean of a squared sine over a window, as a part of its height.
fn mean_height(push: [f64; 2], window: [f64; 2]) -> f64 {
    let at = |k: u32| window[0] + (window[1] - window[0]) * f64::from(k) / 999.0;
    let height = |t: f64| (std::f64::consts::PI * (t - push[0]) / (push[1] - push[0])).sin().powi(2);
    let inside = (0..1000).map(at).filter(|t| (push[0]..push[1]).contains(t));
    inside.map(height).sum::<f64>() / 1000.0
}

#[test]
fn pushes_on_single_joints_are_found_with_their_windows_and_torques() {
    let robot = planar();
    let motions = recorded(&robot, vec![], 1);
    let names: Vec<String> = motions.iter().map(|m| m.name.clone()).collect();
    let truth = [(0, [3.0, 3.6], 1, 1.2), (1, [5.0, 5.4], 2, -0.8)];
    let pushes = truth.map(|(m, window, joint, largest)| on_joint(&names[m], window, joint, largest));
    let diagnosis = diagnosed(&robot, &recorded(&robot, pushes.to_vec(), 1), &[]);
    let finding = contact(&diagnosis);
    assert_eq!(finding.contacts.len(), 2, "{:?}", finding.contacts);
    for (motion, window, joint, largest) in truth {
        let seen = finding.contacts.iter().find(|w| w.motion == names[motion]).unwrap();
        let covered = seen.window[1].min(window[1]) - seen.window[0].max(window[0]);
        assert!(covered > 0.5 * (window[1] - window[0]), "{seen:?}");
        assert!(seen.window[0] > window[0] - 0.15 && seen.window[1] < window[1] + 0.15, "{seen:?}");
        assert_eq!(seen.joint_torques.iter().map(|t| t.joint).collect::<Vec<_>>(), [joint], "{seen:?}");
        let (felt, mean) = (&seen.joint_torques[0], largest * mean_height(window, seen.window));
        assert!((felt.mean - mean).abs() < 4.0 * felt.sigma, "{felt:?}, truth {mean}");
        assert!(felt.sigma < 0.2 * mean.abs(), "{felt:?}");
        assert_eq!(seen.force, [0.0; 3]);
    }
}

#[test]
fn a_push_that_lasts_as_long_as_a_stroke_is_no_law_over_its_state() {
    let robot = planar();
    let name = recorded(&robot, vec![], 1)[0].name.clone();
    for (window, joint, largest) in [([2.6, 4.2], 2, 0.8), ([4.0, 5.5], 1, -1.5)] {
        let pushed = on_joint(&name, window, joint, largest);
        let diagnosis = diagnosed(&robot, &recorded(&robot, vec![pushed], 3), &[]);
        let seen = &contact(&diagnosis).contacts[0];
        assert!(seen.window[0] < window[1] && seen.window[1] > window[0], "{seen:?}");
    }
}

#[test]
fn joints_that_feel_one_push_are_told_together() {
    let robot = planar();
    let name = recorded(&robot, vec![], 1)[0].name.clone();
    let (window, force) = ([3.0, 3.5], [4.0, 3.0, 0.0]);
    // A hand beyond the last frame's origin is felt by both joints, a force at the origin by the first alone.
    let hand = [on_joint(&name, window, 1, 1.5), on_joint(&name, window, 2, 1.0)];
    let diagnosis = diagnosed(&robot, &recorded(&robot, hand.to_vec(), 2), &[]);
    let seen = &contact(&diagnosis).contacts[0];
    let joints: Vec<usize> = seen.joint_torques.iter().map(|t| t.joint).collect();
    assert_eq!(joints, [1, 2], "{seen:?}");
    let plain = ContactForce { force, mean_force: force, ..push(&name, window) };
    let diagnosis = diagnosed(&robot, &recorded(&robot, vec![plain], 3), &[]);
    let seen = &contact(&diagnosis).contacts[0];
    // That it is no accident; that it is a push and nothing else is less sure.
    let no_accident = seen.confidence.unwrap();
    assert!(no_accident >= 0.99 && contact(&diagnosis).confidence < no_accident);
    assert_eq!(seen.joint_torques.iter().map(|t| t.joint).collect::<Vec<_>>(), [1], "{seen:?}");
}

#[test]
fn how_sure_a_contact_is_follows_from_how_far_it_stands_out() {
    let robot = planar();
    let name = recorded(&robot, vec![], 1)[0].name.clone();
    let confidence = |largest: f64| {
        let pushes = vec![on_joint(&name, [3.0, 3.5], 2, largest)];
        let diagnosis = diagnosed(&robot, &recorded(&robot, pushes, 1), &[]);
        diagnosis.findings.iter().find(|f| f.effect == "contact").map(|f| f.confidence)
    };
    let all: Vec<Option<f64>> = [0.05, 0.1, 0.15, 0.2, 0.3, 0.6].map(confidence).to_vec();
    eprintln!("{all:?}");
    assert!(all[0].is_none() && all[5].is_some_and(|c| c > 0.93), "{all:?}");
    let told: Vec<f64> = all.into_iter().flatten().collect();
    assert!(told.windows(2).all(|c| c[0] <= c[1]), "{told:?}");
}

#[test]
fn errors_before_and_after_a_push_was_found_are_of_the_same_rows() {
    let robot = planar();
    let name = recorded(&robot, vec![], 1)[0].name.clone();
    let push = on_joint(&name, [3.0, 3.5], 2, 0.6);
    let diagnosis = diagnosed(&robot, &recorded(&robot, vec![push], 1), &[]);
    let held = &diagnosis.held_out;
    assert_eq!(contact(&diagnosis).contacts.len(), 1);
    assert_eq!(held.band, diagnosis.sampling.slow_band);
    assert!(held.after < 0.95 * held.before, "{held:?}");
    let falls = held.by_motion.iter().filter(|(_, before, after)| after < before);
    let most = falls.max_by(|a, b| (a.1 - a.2).total_cmp(&(b.1 - b.2))).map(|(motion, _, _)| motion);
    assert_eq!(most, Some(&name), "{held:?}");
}

#[test]
fn a_push_before_the_change_is_no_news() {
    let robot = planar();
    let name = recorded(&robot, vec![], 1)[0].name.clone();
    let before =
        recorded(&robot, vec![on_joint(&name, [3.0, 3.6], 1, 6.0), on_joint(&name, [3.0, 3.6], 2, 4.0)], 7);
    let diagnosis = diagnosed(&robot, &recorded(&robot, vec![], 8), &before);
    assert!(diagnosis.findings.iter().all(|f| f.effect != "contact"), "{:?}", diagnosis.verdict);
}

#[test]
fn an_arm_with_a_slide_that_nothing_pushes_shows_no_contact() {
    let robot = scara();
    let diagnosis = diagnosed(&robot, &recorded(&robot, vec![], 9), &[]);
    assert!(diagnosis.findings.iter().all(|f| f.effect != "contact"), "{:?}", diagnosis.verdict);
}

#[test]
fn what_friction_remembers_of_before_a_recording_is_no_push() {
    let robot = planar();
    let presliding = term(EffectKind::PreslidingHysteresis, Place::Joint(1), &[0.15], &[1.0]);
    let hidden = Hidden::in_robot(move |world| world.put(&presliding));
    for seed in [3, 4, 5] {
        let recorded = robot.record(&robot.motions(3, 7.0, seed), &hidden, seed);
        // The recording begins when the robot has long been moving.
        let later = |motion: &Trajectory| motion.within([motion.time[0] + 1.0, f64::INFINITY]).unwrap();
        let motions: Vec<Trajectory> = recorded.iter().map(later).collect();
        let diagnosis = diagnosed(&robot, &motions, &[]);
        let found: Vec<&str> = diagnosis.findings.iter().map(|f| f.effect.as_str()).collect();
        assert_eq!(found, ["presliding_hysteresis"], "seed {seed}: {:?}", diagnosis.verdict);
    }
}
