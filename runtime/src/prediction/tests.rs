#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

use super::*;
use crate::estimation::observe::{Equations, ObserveSettings, observe};
use crate::model::{
    Drive, Frame, JointKind, Limits, Model, RecursiveModel, Robot, StateSlices, standard_parameters, torques,
};
use crate::recording::Trajectory;
use crate::signal::Motion;
use crate::testing::normal;
use rand::{RngExt, SeedableRng};

/// A planar arm of two joints, its standard parameters as base parameters.
fn arm() -> RecursiveModel {
    let row = |parent, d| Frame { parent, d, ..Frame::on_base(JointKind::Revolute) };
    let frames = vec![row(None, 0.0), row(Some(0), 0.5)];
    let drive = Drive { gear: vec![1.0, 0.0, 0.0, 1.0].into(), coupled_friction: vec![].into() };
    let robot = Robot::with_standard_as_base("arm", [0.0, -9.81, 0.0], frames, drive, Limits::default());
    assert_eq!(robot.base.len(), standard_parameters(&robot.frames, &[], &[]).len());
    RecursiveModel::new(robot).unwrap()
}

/// Base parameters with an inertia, a first moment, rotors and friction.
fn chi(model: &dyn Model) -> Vec<f64> {
    let value = |name: &str| match name {
        "ZZ1" | "ZZ2" => 0.4,
        "MX1" | "MX2" => 0.8,
        "Ia1" | "Ia2" => 0.3,
        "Fv1" | "Fv2" => 1.5,
        "Fc1" | "Fc2" => 2.0,
        _ => 0.0,
    };
    model.robot().base.iter().map(|b| value(&b.name)).collect()
}

const RATE: f64 = 500.0;

/// Joints that swing, with their exact derivatives, `late` seconds late torques and white noise.
fn swinging(model: &dyn Model, chi: &[f64], late: f64, noise: f64) -> Motion {
    let samples = 6000;
    let of = |f: &dyn Fn(f64) -> f64, shift: f64| -> Vec<f64> {
        (0..samples).map(|k| f(k as f64 / RATE - shift)).collect()
    };
    let signals = |shift: f64| -> [Vec<Vec<f64>>; 3] {
        let (a, b) = (2.1_f64, 3.4_f64);
        [
            vec![of(&|t| (a * t).sin(), shift), of(&|t| (b * t).cos(), shift)],
            vec![of(&|t| a * (a * t).cos(), shift), of(&|t| -b * (b * t).sin(), shift)],
            vec![of(&|t| -a * a * (a * t).sin(), shift), of(&|t| -b * b * (b * t).cos(), shift)],
        ]
    };
    let mut random = rand_pcg::Pcg64::seed_from_u64(3);
    let [q, dq, ddq] = signals(late);
    let mut torque = torques(model, chi, StateSlices::new(&q, &dq, &ddq).states());
    for value in torque.iter_mut().flatten() {
        *value += noise * normal(&mut random);
    }
    let [q, dq, ddq] = signals(0.0);
    Motion {
        name: "swing".into(),
        rate: RATE,
        start: 0.0,
        q,
        dq,
        ddq,
        torque,
        fixed: vec![],
        edge_samples: 20,
    }
}

fn settings(band: f64) -> ObserveSettings {
    ObserveSettings { band, ..ObserveSettings::default() }
}

fn standard(chi: &[f64]) -> Predictor<'_> {
    Predictor { chi, effects: &[], delay: 0.0 }
}

#[test]
fn the_figure_is_that_of_an_observation_of_the_same_rows() {
    let model = arm();
    let truth = chi(&model);
    let motions = [swinging(&model, &truth, 0.0, 0.2)];
    let other: Vec<f64> = truth.iter().map(|x| 1.1 * x).collect();
    let observed = observe(&model, &motions, Equations::Torque, None, &settings(25.0), None).unwrap();
    let evaluation = evaluate(&model, &[standard(&other)], &motions, &settings(25.0), &[]).unwrap();
    let (ours, theirs) = (&evaluation.predictions[0].errors, observed_errors(&observed, &other));
    let overall = [ours, &theirs].map(|errors| errors.relative_error.unwrap());
    approx::assert_relative_eq!(overall[0], overall[1], max_relative = 1e-9);
    for (a, b) in ours.per_joint.iter().zip(&theirs.per_joint) {
        approx::assert_relative_eq!(a.unwrap(), b.unwrap(), max_relative = 1e-9);
    }
    assert_eq!(evaluation.left_out, observed.left_out);
    assert_eq!(evaluation.band, 25.0);
}

#[test]
fn a_delay_that_is_known_leaves_no_error() {
    let model = arm();
    let truth = chi(&model);
    let motions = [swinging(&model, &truth, 0.006, 0.0)];
    let late = Predictor { delay: 0.006, ..standard(&truth) };
    let evaluation = evaluate(&model, &[standard(&truth), late], &motions, &settings(25.0), &[]).unwrap();
    let error = |k: usize| evaluation.predictions[k].errors.relative_error.unwrap();
    assert!(error(0) > 0.01, "{}", error(0));
    assert!(error(1) < 1e-4, "{}", error(1));
}

#[test]
fn white_noise_is_told_and_taken_away() {
    let model = arm();
    let truth = chi(&model);
    let (noise, band) = (1.0, 25.0);
    let motions = [swinging(&model, &truth, 0.0, noise)];
    let evaluation = evaluate(&model, &[standard(&truth)], &motions, &settings(band), &[]).unwrap();
    let prediction = &evaluation.predictions[0];
    let told = prediction.noise_matters().expect("there is nothing but noise").relative_error.unwrap();
    let error = prediction.errors.relative_error.unwrap();
    approx::assert_relative_eq!(told, error, max_relative = 0.15);
    assert!(prediction.above_noise().unwrap().relative_error.unwrap() < 0.6 * error);
    let clean = [swinging(&model, &truth, 0.0, 1e-3)];
    let half: Vec<f64> = truth.iter().map(|x| 0.5 * x).collect();
    let evaluation = evaluate(&model, &[standard(&half)], &clean, &settings(band), &[]).unwrap();
    assert_eq!(evaluation.predictions[0].noise_matters(), None);
}

#[test]
fn noise_that_is_rougher_above_the_band_is_told_as_no_more_than_the_error() {
    let model = arm();
    let truth = chi(&model);
    let mut motions = [swinging(&model, &truth, 0.0, 0.01)];
    // Differences of white noise: their density grows with the square of the frequency.
    let mut random = rand_pcg::Pcg64::seed_from_u64(9);
    for series in &mut motions[0].torque {
        let white: Vec<f64> = series.iter().map(|_| random.random_range(-1.0..1.0)).collect();
        series.iter_mut().zip(white.windows(2)).for_each(|(x, w)| *x += w[1] - w[0]);
    }
    let half: Vec<f64> = truth.iter().map(|x| 0.5 * x).collect();
    let models = [standard(&truth), standard(&half)];
    let evaluation = evaluate(&model, &models, &motions, &settings(25.0), &[]).unwrap();
    let [good, bad] = [0, 1].map(|k| &evaluation.predictions[k]);
    let noise = good.noise.as_ref().expect("the recording is long enough");
    assert_eq!(noise.relative_error, good.errors.relative_error);
    assert_eq!(good.above_noise().unwrap().relative_error, Some(0.0));
    assert!(bad.above_noise().unwrap().relative_error.unwrap() > 0.1);
}

#[test]
fn rows_that_reach_into_a_window_are_left_out_for_every_model() {
    let model = arm();
    let truth = chi(&model);
    let mut motion = swinging(&model, &truth, 0.0, 0.0);
    for k in 2000..2500 {
        motion.torque[1][k] += 30.0;
    }
    let motions = [motion];
    let all = evaluate(&model, &[standard(&truth)], &motions, &settings(25.0), &[]).unwrap();
    let windows = [("swing", [4.0, 5.0]), ("another motion", [0.0, 100.0])];
    let some = evaluate(&model, &[standard(&truth)], &motions, &settings(25.0), &windows).unwrap();
    assert!(all.predictions[0].errors.relative_error.unwrap() > 0.1);
    assert!(some.predictions[0].errors.relative_error.unwrap() < 1e-9);
    assert_eq!(all.used() - some.used(), some.excluded);
    assert!(some.excluded > 50);
    let everything = [("swing", [0.0, 100.0])];
    let refused = evaluate(&model, &[standard(&truth)], &motions, &settings(25.0), &everything).unwrap_err();
    assert!(refused.to_string().contains("window"), "{refused}");
}

#[test]
fn a_recording_is_not_compared_above_the_band_that_it_carries() {
    let time: Vec<f64> = (0..4000).map(|k| k as f64 / 100.0).collect();
    let swing: Vec<f64> = time.iter().map(|t| (2.0 * t).sin()).collect();
    let trajectory = Trajectory {
        name: "slow".into(),
        position: vec![swing.clone()],
        velocity: None,
        torque: vec![swing],
        fixed: vec![],
        time,
    };
    for (asked, expected) in [(None, 10.0), (Some(40.0), 10.0), (Some(4.0), 4.0)] {
        let prepared =
            Comparison { band: asked, ..Comparison::default() }.prepare(std::slice::from_ref(&trajectory));
        assert_eq!(prepared.unwrap().settings.band, expected, "{asked:?}");
    }
}

#[test]
fn parameters_of_another_model_are_an_error() {
    let model = arm();
    let motions = [swinging(&model, &chi(&model), 0.0, 0.0)];
    let few = [1.0, 2.0];
    let error = evaluate(&model, &[standard(&few)], &motions, &settings(25.0), &[]).unwrap_err();
    assert!(matches!(error, PredictionError::Parameters { found: 2, .. }), "{error}");
}

#[test]
fn what_is_said_of_a_model_does_not_depend_on_those_beside_it() {
    let model = arm();
    let truth = chi(&model);
    let motions = [swinging(&model, &truth, 0.0, 0.3)];
    let [better, worse] = [1.001, 1.1].map(|factor| truth.iter().map(|x| factor * x).collect::<Vec<f64>>());
    let evaluated = |models: &[Predictor<'_>]| {
        evaluate(&model, models, &motions, &settings(25.0), &[]).unwrap().predictions
    };
    let alone = evaluated(&[standard(&worse)]);
    assert_eq!(alone[0], evaluated(&[standard(&better), standard(&worse)])[1]);
    assert!(alone[0].noise.is_some());
}

#[test]
fn the_error_of_a_joint_without_torque_is_undefined() {
    let model = arm();
    let truth = chi(&model);
    let mut motions = [swinging(&model, &truth, 0.0, 0.0)];
    motions[0].torque[1].fill(0.0);
    let evaluation = evaluate(&model, &[standard(&truth)], &motions, &settings(25.0), &[]).unwrap();
    let errors = &evaluation.predictions[0].errors;
    assert!(errors.relative_error.is_some() && errors.per_joint[0].is_some());
    assert_eq!(errors.per_joint[1], None);
    assert_eq!(serde_json::to_value(errors).unwrap()["per_joint"][1], serde_json::Value::Null);
}

#[test]
fn states_stand_at_the_rows_of_an_evaluation_and_the_load_is_what_friction_leaves() {
    let model = arm();
    let truth = chi(&model);
    let motions = [swinging(&model, &truth, 0.0, 0.0)];
    let evaluation = evaluate(&model, &[standard(&truth)], &motions, &settings(25.0), &[]).unwrap();
    let states = row_states(&model, &truth, &motions, &settings(25.0)).unwrap();
    assert_eq!(states.len(), evaluation.rows.len());
    for (rows, state) in evaluation.rows.iter().zip(&states) {
        assert_eq!((rows.trajectory, rows.joint), (state.trajectory, state.joint));
        for (k, t) in rows.time.iter().enumerate() {
            let exact = [(2.1 * t).sin(), (3.4 * t).cos()][rows.joint];
            assert!((state.position[k] - exact).abs() < 1e-3, "{} {exact}", state.position[k]);
            let dry = 1.5 * state.speed[k] + 2.0 * state.speed[k].signum();
            let left = rows.measured[k] - state.load[k] - dry;
            // Next to a reversal the filter rings.
            assert!(!rows.used[k] || state.speed[k].abs() < 1.0 || left.abs() < 0.1, "{left}");
        }
    }
    assert!(row_states(&model, &[1.0], &motions, &settings(25.0)).is_err());
}
