//! Physics that no law of the catalogue describes: told as a torque over the right variables on the right joint, saved,
//! simulated, and held constant beyond what was seen.
//!
//! `cargo test -p dynid-runtime --test free_form -- --nocapture` prints what was found.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Hidden, SimulatedRobot, planar, scara};
use dynid_runtime::diagnosis::{Diagnosis, Finding, Settings, Silent, diagnose, term_torques};
use dynid_runtime::effects::EffectTerm;
use dynid_runtime::model::Model;
use dynid_runtime::recording::Trajectory;
use dynid_runtime::signal::Motion;

const SEED: u64 = 7;

fn diagnosed(robot: &SimulatedRobot, hidden: &Hidden) -> Diagnosis {
    diagnosed_from(robot, hidden, 6.0)
}

/// The diagnosis of three motions of so many seconds.
fn diagnosed_from(robot: &SimulatedRobot, hidden: &Hidden, seconds: f64) -> Diagnosis {
    let motions = robot.record(&robot.motions(3, seconds, SEED), hidden, SEED);
    let mut settings = Settings::default();
    settings.threads = 1;
    let diagnosis = diagnose(&robot.model, &motions, &[], &settings, &Silent).unwrap();
    for f in &diagnosis.findings {
        eprintln!("{}", f.sentence);
    }
    for c in &diagnosis.cannot_tell {
        eprintln!("  cannot tell {}", c.sides().join(" and "));
    }
    diagnosis
}

/// The one finding on a joint that is a law over any variables.
fn over<'d>(diagnosis: &'d Diagnosis, joint: usize, variables: &[&str]) -> &'d Finding {
    let all: Vec<_> = diagnosis.findings.iter().map(|f| (&f.effect, &f.joints, &f.variables)).collect();
    let found = diagnosis.findings.iter().find(|f| f.effect == "free_form" && f.joints == [joint]);
    let found = found.unwrap_or_else(|| panic!("no free_form on joint {joint}: {all:?}"));
    let mut named = found.variables.clone();
    named.sort();
    assert_eq!(named, variables, "{all:?}");
    found
}

/// What was found, with its joints.
fn named(diagnosis: &Diagnosis) -> Vec<(&str, Vec<usize>)> {
    diagnosis.findings.iter().map(|f| (f.effect.as_str(), f.joints.clone())).collect()
}

/// Direction of a joint over 20 ms: wide enough for the noise of its encoder.
fn direction(motion: &Trajectory, joint: usize, t: usize) -> f64 {
    let q = &motion.position[joint];
    (q[(t + 5).min(q.len() - 1)] - q[t.saturating_sub(5)]).signum()
}

fn by_angle_of_another(motion: &mut Trajectory) {
    for t in 0..motion.time.len() {
        motion.torque[0][t] += 1.5 * direction(motion, 0, t) * (2.0 * motion.position[1][t]).cos();
    }
}

fn hears_joint_1(motion: &mut Trajectory) {
    for t in 0..motion.time.len() {
        motion.torque[2][t] += 0.3 * motion.torque[0][t];
    }
}

fn cable(motion: &mut Trajectory) {
    for t in 0..motion.time.len() {
        let pull = 2.0 * (motion.position[0][t] - motion.position[1][t]);
        motion.torque[0][t] += pull;
        motion.torque[1][t] -= pull;
    }
}

/// A hose along two parallel axes: it is bent by the direction of the second link in space, in more than one wave.
fn hose(motion: &mut Trajectory) {
    for t in 0..motion.time.len() {
        let pull = 1.5 * (3.0 * (motion.position[0][t] + motion.position[1][t])).sin();
        motion.torque[0][t] += pull;
        motion.torque[1][t] += pull;
    }
}

/// A step in the casting that a seal of the first joint passes where the second one stands at an angle.
fn bump_over_another_angle(motion: &mut Trajectory) {
    for t in 0..motion.time.len() {
        motion.torque[0][t] += 4.0 * (-((motion.position[1][t] - 0.3) / 0.15).powi(2)).exp();
    }
}

fn magnet(motion: &mut Trajectory) {
    for t in 0..motion.time.len() {
        motion.torque[1][t] += 2.0 * (-(motion.position[1][t] / 0.4).powi(2)).exp();
    }
}

fn balancer_that_gives_way(motion: &mut Trajectory) {
    for t in 0..motion.time.len() {
        motion.torque[1][t] += 2.0 * (2.0 * motion.position[1][t]).tanh();
    }
}

fn soft_spring(motion: &mut Trajectory) {
    for t in 0..motion.time.len() {
        let q = motion.position[1][t];
        motion.torque[1][t] += 1.5 * (q - 0.25 * q.powi(3));
    }
}

#[test]
fn a_torque_channel_that_hears_a_joint_farther_away_depends_on_that_joints_torque() {
    let diagnosis = diagnosed(&scara(), &Hidden::in_recording(hears_joint_1));
    let found = over(&diagnosis, 3, &["torque1"]);
    assert_eq!(diagnosis.findings.len(), 1);
    assert!(found.held_out_after < 0.7 * found.held_out_before, "{}", found.sentence);
    // A line, said with its slope.
    assert!(found.proposal.as_deref().is_some_and(|p| p.contains("·torque1")), "{:?}", found.proposal);
    let curve = found.curve.as_ref().unwrap();
    assert_eq!((curve.variable.as_str(), curve.band.len()), ("torque of joint 1, N.m", curve.x.len()));
    assert!(curve.band.iter().all(|b| *b > 0.0 && *b < 2.0), "{:?}", curve.band);
}

#[test]
fn friction_that_depends_on_the_angle_of_another_joint_names_both_variables() {
    let diagnosis = diagnosed(&planar(), &Hidden::in_recording(by_angle_of_another));
    let found = over(&diagnosis, 1, &["dq1", "q2"]);
    assert_eq!(diagnosis.findings.len(), 1);
    assert_eq!(found.more_curves.len(), 1);
    assert!((found.parameters["swing"].value - 3.0).abs() < 1.0, "{:?}", found.parameters);
}

#[test]
fn a_cable_over_two_joints_is_told_on_both_with_the_other_ones_angle() {
    let diagnosis = diagnosed(&planar(), &Hidden::in_recording(cable));
    // Neither as a spring over one of them with something over the other beside it.
    for joint in [1, 2] {
        let found = over(&diagnosis, joint, &["q1", "q2"]);
        assert!(found.held_out_after < 0.05 * found.held_out_before, "{}", found.sentence);
        let formula = found.proposal.as_deref().unwrap();
        assert!(formula.contains("q1") && formula.contains("q2"), "{formula}");
    }
    assert_eq!(diagnosis.findings.len(), 2);
}

#[test]
fn a_hose_that_is_bent_by_the_sum_of_two_angles_is_told_over_their_sum() {
    let diagnosis = diagnosed_from(&planar(), &Hidden::in_recording(hose), 8.0);
    for joint in [1, 2] {
        let found = over(&diagnosis, joint, &["q1", "q2"]);
        assert!(found.held_out_after < 0.2 * found.held_out_before, "{}", found.sentence);
        let sum = "sum of the position of joint 1 and the position of joint 2";
        assert!(found.sentence.contains(&format!("depends on the {sum}, and")), "{}", found.sentence);
        assert_eq!(found.curve.as_ref().unwrap().variable, format!("{sum}, rad"));
    }
    assert_eq!(diagnosis.findings.len(), 2);
}

#[test]
fn a_magnet_under_a_joint_depends_on_its_own_position_whatever_it_is_called() {
    let diagnosis = diagnosed(&planar(), &Hidden::in_recording(magnet));
    let of_position = |f: &Finding| {
        f.effect == "position_dependent_torque" || (f.effect == "free_form" && f.variables == ["q2"])
    };
    assert!(diagnosis.findings.iter().any(|f| f.joints == [2] && of_position(f)));
    assert!(diagnosis.findings.iter().all(|f| f.joints == [2] && of_position(f)));
}

#[test]
fn what_comes_back_with_the_angle_of_another_joint_is_a_law_and_no_row_of_pushes() {
    let diagnosis = diagnosed_from(&planar(), &Hidden::in_recording(bump_over_another_angle), 12.0);
    assert_eq!(named(&diagnosis), [("free_form", vec![1])]);
    over(&diagnosis, 1, &["q2"]);
}

#[test]
fn a_curve_that_a_lever_imitates_is_a_curve_until_a_motion_tells_them_apart() {
    let diagnosis = diagnosed(&planar(), &Hidden::in_recording(balancer_that_gives_way));
    assert_eq!(named(&diagnosis), [("position_dependent_torque", vec![2])]);
    assert_eq!(diagnosis.cannot_tell.len(), 1);
    assert_eq!(diagnosis.cannot_tell[0].between, ["position_dependent_torque", "spring"]);
}

#[test]
fn where_one_motion_alone_goes_what_a_curve_leaves_is_no_push() {
    // One of the motions goes farther than the others for two thirds of a second: set aside as a push, it would be one for
    // ever, because the curve that is fitted to the rest ends there.
    let diagnosis = diagnosed(&planar(), &Hidden::in_recording(soft_spring));
    assert_eq!(named(&diagnosis), [("position_dependent_torque", vec![2])]);
}

#[test]
fn what_was_found_is_found_again_in_the_robot_that_is_simulated_with_it() {
    let robot = planar();
    let diagnosis = diagnosed(&robot, &Hidden::in_recording(by_angle_of_another));
    let term = over(&diagnosis, 1, &["dq1", "q2"]).term.clone();
    let simulated = diagnosed(&robot, &Hidden::in_robot(move |world| world.put(&term)));
    over(&simulated, 1, &["dq1", "q2"]);
    assert_eq!(simulated.findings.len(), 1);
}

#[test]
fn a_saved_law_stands_alone_and_is_constant_beyond_what_was_seen() {
    let robot = scara();
    let diagnosis = diagnosed(&robot, &Hidden::in_recording(hears_joint_1));
    let term = over(&diagnosis, 3, &["torque1"]).term.clone();
    let saved: EffectTerm = serde_json::from_str(&serde_json::to_string(&term).unwrap()).unwrap();
    assert_eq!(saved, term);
    assert_eq!(saved.check(robot.model.robot()), Ok(()));
    let mut wrong = term.clone();
    wrong.shape[2] = 9.0;
    assert_eq!(wrong.check(robot.model.robot()).unwrap_err().field, "shape");
    wrong = term.clone();
    wrong.amplitude.pop();
    assert_eq!(wrong.check(robot.model.robot()).unwrap_err().field, "amplitude");

    // Joint 1 at accelerations that ask for torques inside, at the end of and beyond what was seen.
    let chi = robot.model.robot().base_from_standard(&robot.standard);
    let at = |acceleration: f64| {
        let still = || vec![vec![0.0; 4]; 3];
        let mut ddq = still();
        ddq[0] = vec![acceleration; 4];
        let motion = Motion {
            name: String::new(),
            rate: 100.0,
            start: 0.0,
            q: still(),
            dq: still(),
            ddq,
            torque: still(),
            edge_samples: 0,
            fixed: Vec::new(),
        };
        term_torques(&robot.model, &chi, std::slice::from_ref(&saved), &motion).unwrap()[2][1]
    };
    assert!((at(20.0) - at(0.0)).abs() > 0.5);
    assert!((at(1e4) - at(1e5)).abs() < 1e-9);
}
