#![allow(clippy::unwrap_used)]
use super::*;
use crate::estimation::observe::{Equations, ObserveSettings, Standstill, observe};
use crate::estimation::{EstimateSettings, estimate};
use crate::model::{Model, RecursiveModel};
use crate::signal::Motion;

/// A pendulum about a horizontal axis; every standard parameter is an unknown.
fn pendulum() -> RecursiveModel {
    crate::simulation::testing::pendulum(0.0, 0.0, 0.0, 0.0).0
}

/// Fits a swing whose torque is `zz` ddq + `weight` sin q + friction(dq): the free estimate and the physical one.
fn fitted(zz: f64, weight: f64, friction: impl Fn(f64) -> f64) -> (Estimate, PhysicalFit) {
    fitted_on([0.0, 20.0], zz, weight, friction)
}

/// The same of a swing that goes on by `turning` rad/s besides, for so many seconds.
fn fitted_on(
    [turning, seconds]: [f64; 2],
    zz: f64,
    weight: f64,
    friction: impl Fn(f64) -> f64,
) -> (Estimate, PhysicalFit) {
    let model = pendulum();
    let rate = 200.0;
    let samples = (seconds * rate) as usize;
    let time = |k: usize| k as f64 / rate;
    // Two frequencies, so that inertia, weight and friction are told apart; a torque noise that never repeats.
    let wave = |t: f64, power: i32| {
        let (a, b) = (1.7_f64, 5.3_f64);
        [a.powi(power) * 1.1, b.powi(power) * 0.4].into_iter().zip([a * t, b * t])
    };
    let q = |k: usize| turning * time(k) + wave(time(k), 0).map(|(s, x)| s * x.sin()).sum::<f64>();
    let dq = |k: usize| turning + wave(time(k), 1).map(|(s, x)| s * x.cos()).sum::<f64>();
    let (q, dq): (Vec<f64>, Vec<f64>) = ((0..samples).map(q).collect(), (0..samples).map(dq).collect());
    let ddq: Vec<f64> = (0..samples).map(|k| wave(time(k), 2).map(|(s, x)| -s * x.sin()).sum()).collect();
    let torque = (0..samples)
        .map(|k| zz * ddq[k] + weight * q[k].sin() + friction(dq[k]) + 0.05 * (37.7 * time(k).powi(2)).sin())
        .collect();
    let motion = Motion {
        name: "swing".to_owned(),
        rate,
        start: 0.0,
        q: vec![q],
        dq: vec![dq],
        ddq: vec![ddq],
        torque: vec![torque],
        fixed: Vec::new(),
        edge_samples: 0,
    };
    let settings = ObserveSettings { band: 20.0, standstill: Standstill::Keep, ..ObserveSettings::default() };
    let observation = observe(&model, &[motion], Equations::Torque, None, &settings, None).unwrap();
    let free = estimate(&observation, &EstimateSettings::default());
    let fit = physical_fit(model.robot(), &observation, &free).unwrap();
    (free, fit)
}

fn value(fit: &PhysicalFit, names: &[&str]) -> f64 {
    let robot = pendulum();
    let of = |name: &&str| robot.robot().base.iter().position(|b| b.name == **name).unwrap();
    names.iter().map(|name| fit.chi[of(name)]).sum()
}

#[test]
fn a_real_body_costs_nothing_and_keeps_its_parameters() {
    let (free, fit) = fitted(0.6, 7.0, |v| 0.8 * v + 0.5 * v.signum());
    assert!(free.relative_error.unwrap() < 0.02);
    assert!((0.98..1.05).contains(&fit.strain), "{}", fit.strain);
    assert!((value(&fit, &["ZZ1", "Ia1"]) - 0.6).abs() < 0.02);
    assert!((value(&fit, &["MY1"]).abs() + value(&fit, &["MX1"]).abs() - 7.0 / 9.81).abs() < 0.03);
    assert!((value(&fit, &["Fv1"]) - 0.8).abs() < 0.03);
}

#[test]
fn a_torque_of_the_wrong_sign_cannot_be_explained() {
    let (free, fit) = fitted(-0.6, -7.0, |v| -0.8 * v - 0.5 * v.signum());
    assert!(free.relative_error.unwrap() < 0.02);
    assert!(fit.strain > 100.0);
    // A weight may pull either way; inertia and friction may not.
    assert!(fit.relative_error.unwrap() > 0.7, "{:?}", fit.relative_error);
}

#[test]
fn friction_that_falls_with_speed_dissipates_and_is_possible() {
    let (free, fit) = fitted(0.6, 0.0, |v| v.signum() * (1.0 + 3.0 * (-v.abs() / 2.0).exp()));
    let viscous = free.parameters.iter().find(|p| p.name == "Fv1").unwrap();
    assert!(viscous.value < -0.1, "the line falls: {}", viscous.value);
    assert!(fit.strain < 1.05, "{}", fit.strain);
}

#[test]
fn what_a_weight_needs_of_inertia_is_demanded() {
    // 50 N.m of weight on a body of next to no inertia about the axis: m l^2 >= (m l)^2 / m for a mass of any size,
    // so one body alone can; it cannot with a negative inertia.
    let (_, possible) = fitted(0.05, 5.0, |v| 0.8 * v);
    assert!(possible.strain < 1.05, "{}", possible.strain);
    let (free, impossible) = fitted(-0.3, 5.0, |v| 0.8 * v);
    assert!(
        impossible.strain > 10.0 && impossible.relative_error.unwrap() > 2.0 * free.relative_error.unwrap()
    );
}

#[test]
fn a_friction_that_only_the_end_of_a_motion_tells_from_an_offset_leaves_no_more_than_a_free_one() {
    // Forwards all the time but for its last hundredths of a second, in which friction does not turn round.
    let (free, fit) = fitted_on([3.9, 1.935], 0.6, 7.0, |v| 0.8 * v + 0.5 * (v + 0.1).signum());
    let value = |name: &str| free.parameters.iter().find(|p| p.name == name).unwrap().value;
    assert!(value("Fc1") < -1.0 && value("off1") > 2.0, "{} and {}", value("Fc1"), value("off1"));
    let [free, fit] = [free.relative_error, fit.relative_error].map(Option::unwrap);
    assert!(fit < 0.85 * free, "{fit} and {free}");
}

#[test]
fn an_observation_of_another_robot_has_no_fit() {
    let (free, _) = fitted(0.6, 7.0, |v| v);
    let model = pendulum();
    let mut robot = model.robot().clone();
    robot.base = robot.base[..3].to_vec().into();
    let motion = Motion {
        name: "rest".to_owned(),
        rate: 100.0,
        start: 0.0,
        q: vec![vec![0.0; 400]],
        dq: vec![vec![0.0; 400]],
        ddq: vec![vec![0.0; 400]],
        torque: vec![vec![0.0; 400]],
        fixed: Vec::new(),
        edge_samples: 0,
    };
    let settings = ObserveSettings { band: 20.0, standstill: Standstill::Keep, ..ObserveSettings::default() };
    let observation = observe(&model, &[motion], Equations::Torque, None, &settings, None).unwrap();
    assert_eq!(physical_fit(&robot, &observation, &free), None);
}
