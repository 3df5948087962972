//! Diagnoses of recordings in which the recorder, not the robot, is wrong: times that run at another rate, torques that
//! are late, a drive gain. Two small robots, three random motions of 4.5 s in closed loop, 500 Hz, nominal noise.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Hidden, SimulatedRobot};
use dynid_runtime::diagnosis::{Diagnosis, Settings, Silent, diagnose};
use dynid_runtime::effects::EffectKind;
use dynid_runtime::prediction::{Comparison, Predictor, evaluate};
use dynid_runtime::recording::Trajectory;

fn recorded(robot: &SimulatedRobot, seed: u64, distort: fn(&mut Trajectory)) -> Vec<Trajectory> {
    robot.record(&robot.motions(3, 4.5, seed), &Hidden::in_recording(distort), seed)
}

fn diagnosed(robot: &SimulatedRobot, motions: &[Trajectory], baseline: &[Trajectory]) -> Diagnosis {
    diagnose(&robot.model, motions, baseline, &Settings::default(), &Silent).unwrap()
}

fn named(diagnosis: &Diagnosis) -> Vec<(&str, &[usize])> {
    diagnosis.findings.iter().map(|f| (f.effect.as_str(), f.joints.as_slice())).collect()
}

/// Relative errors on the recording before and after what was found.
fn errors(robot: &SimulatedRobot, motions: &[Trajectory], diagnosis: &Diagnosis) -> [f64; 2] {
    let prepared = Comparison::default().prepare(motions).unwrap();
    let terms = diagnosis.terms();
    let models = Predictor::before_and_after(diagnosis, &terms);
    let evaluation = evaluate(&robot.model, &models, &prepared.motions, &prepared.settings, &[]).unwrap();
    [0, 1].map(|k| evaluation.predictions[k].errors.relative_error.unwrap())
}

fn assert_rate(factor: f64, distort: fn(&mut Trajectory)) {
    let robot = common::planar();
    let motions = recorded(&robot, 1, distort);
    let diagnosis = diagnosed(&robot, &motions, &[]);
    assert_eq!(named(&diagnosis), [("wrong_sample_rate", &[][..])]);
    let rate = &diagnosis.findings[0].parameters["rate_error"];
    let off = (rate.value - (factor - 1.0)).abs();
    assert!(off < 4.0 * rate.sigma && rate.sigma < 0.05 * factor, "{} +- {}", rate.value, rate.sigma);
    let [before, after] = errors(&robot, &motions, &diagnosis);
    assert!(after < 0.7 * before, "{before} to {after}");
}

#[test]
fn times_that_run_half_as_fast_are_found_with_their_factor() {
    assert_rate(2.0, |motion| motion.time.iter_mut().for_each(|t| *t *= 2.0));
}

#[test]
fn milliseconds_that_were_read_as_seconds_are_found_with_their_factor() {
    assert_rate(1000.0, |motion| motion.time.iter_mut().for_each(|t| *t *= 1000.0));
}

#[test]
fn a_delay_that_is_named_is_taken_out_once_and_the_error_before_is_with_it() {
    let robot = common::planar();
    let motions = recorded(&robot, 1, |motion| motion.torque.iter_mut().for_each(|t| t.rotate_right(15)));
    let diagnosis = diagnosed(&robot, &motions, &[]);
    assert_eq!(named(&diagnosis), [("time_delay", &[][..])]);
    let [before, after] = errors(&robot, &motions, &diagnosis);
    let noise =
        errors(&robot, &recorded(&robot, 1, |_| ()), &diagnosed(&robot, &recorded(&robot, 1, |_| ()), &[]))
            [0];
    assert!(after < 1.3 * noise, "{after}, noise {noise}");
    assert!(before > 3.0 * after, "{before} to {after}");
    assert!(diagnosis.held_out.before > 2.0 * diagnosis.held_out.after);
}

#[test]
fn a_drive_gain_on_a_joint_of_little_but_friction_is_no_change_of_friction() {
    let robot = common::scara();
    let wrong = |motion: &mut Trajectory| motion.torque[1].iter_mut().for_each(|x| *x *= 1.08);
    let baseline = recorded(&robot, 51, |_| ());
    let diagnosis = diagnosed(&robot, &recorded(&robot, 1, wrong), &baseline);
    assert_eq!(named(&diagnosis), [(EffectKind::TorqueConstantError.id(), &[2][..])]);
}

#[test]
fn friction_that_changed_by_less_than_is_named_is_told_as_small() {
    let robot = common::scara();
    let grown = Hidden::in_robot(|world| world.scale_friction(1, 1.03));
    let motions = robot.record(&robot.motions(3, 4.5, 1), &grown, 1);
    let diagnosis = diagnosed(&robot, &motions, &recorded(&robot, 51, |_| ()));
    assert_eq!(named(&diagnosis), []);
    let small: Vec<_> = diagnosis.small.iter().map(|s| (s.effect.as_str(), s.joints.as_slice())).collect();
    assert_eq!(small, [("friction_level_change", &[2][..])]);
}
