//! Gains of drives and payloads of robots whose tables have known values.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

use dynid_codegen::base::base_set;
use dynid_codegen::numeric_robot;
use dynid_codegen::robot::parse;
use dynid_runtime::estimation::observe::{Equations, Observation, ObserveSettings, observe};
use dynid_runtime::estimation::{
    DriveGain, DriveGains, EstimateSettings, KnownPayload, ReferenceModel, drive_gains, estimate, payload_of,
};
use dynid_runtime::model::{Model, ParameterKind, RecursiveModel, Robot, StateSlices, torques};
use dynid_runtime::signal::Motion;
use nalgebra::DMatrix;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

const ARM: &str = "
name: weighed
gravity: [0, -9.81, 0]
frames:
  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}
  - {j: 2, sigma: 0, alpha: 0, d: 0.5, theta: q2, r: 0}
nominal:
  parameters: {XX1: 0.3, YY1: 0.45, ZZ1: 0.6, MX1: 1, M1: 4, Ia1: 0.4, Fv1: 2, Fc1: 1.5, XX2: 0.1, YY2: 0.22, ZZ2: 0.25,
    MX2: 0.7, M2: 3, Ia2: 0.3, Fv2: 1, Fc2: 1}
";
const GAINS: [f64; 2] = [20.0, 5.0];
const RATE: f64 = 100.0;

/// The arm with what is known of it.
fn arm(known: &str) -> RecursiveModel {
    let table = parse("arm", ARM.replace("nominal:", &format!("{known}\nnominal:")).as_bytes()).unwrap();
    RecursiveModel::new(numeric_robot(&table, &base_set(&table))).unwrap()
}

/// The same without the columns of what is known, and their places.
fn less(model: &RecursiveModel) -> (RecursiveModel, Vec<usize>) {
    let robot = model.robot();
    let known: Vec<usize> = robot.fixed_base().into_iter().map(|(k, _)| k).collect();
    let kept: Vec<usize> = (0..robot.base.len()).filter(|k| !known.contains(k)).collect();
    let base: Vec<_> = kept.iter().map(|&k| robot.base[k].clone()).collect();
    let robot = Robot { base: base.into(), fixed: Vec::new().into(), ..robot.clone() };
    (RecursiveModel::new(robot).unwrap(), kept)
}

/// Base parameters with a point mass of `mass` kg at x, y on the last link.
fn chi(model: &dyn Model, mass: f64) -> Vec<f64> {
    let robot = model.robot();
    let mut standard = robot.nominal.as_ref().unwrap().standard.to_vec();
    let (x, y) = (0.2, 0.05);
    for (kind, value) in [
        (ParameterKind::ZZ, x * x + y * y),
        (ParameterKind::MX, x),
        (ParameterKind::MY, y),
        (ParameterKind::M, 1.0),
    ] {
        let place = robot.standard.iter().position(|s| s.frame == 1 && s.kind == kind).unwrap();
        standard[place] += mass * value;
    }
    robot.base_from_standard(&standard)
}

fn motion(model: &dyn Model, chi: &[f64], gains: [f64; 2], seed: u64) -> Motion {
    let mut random = Pcg64::seed_from_u64(seed);
    let wave = |j: usize, order: i32| -> Vec<f64> {
        let at = |t: f64, h: f64| {
            let w = std::f64::consts::TAU * 0.1 * h;
            let phase = (j as f64 + 1.3) * h * h * 0.9 + f64::from(order) * std::f64::consts::FRAC_PI_2;
            0.9 / h * w.powi(order) * (w * t + phase).sin()
        };
        (0..1500).map(|t| (1..=5).map(|h| at(t as f64 / RATE, f64::from(h))).sum()).collect()
    };
    let [q, dq, ddq] = [0, 1, 2].map(|order| vec![wave(0, order), wave(1, order)]);
    let mut torque = torques(model, chi, StateSlices::new(&q, &dq, &ddq).states());
    for (own, gain) in torque.iter_mut().zip(gains) {
        let largest = own.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for x in own.iter_mut() {
            let draw: f64 = StandardNormal.sample(&mut random);
            *x = (*x + 0.02 * largest * draw) / gain;
        }
    }
    Motion { name: "run".into(), rate: RATE, start: 0.0, q, dq, ddq, torque, fixed: vec![], edge_samples: 0 }
}

fn observed(model: &dyn Model, motion: Motion) -> Observation {
    let settings = ObserveSettings { band: 10.0, keep_rows: true, threads: 1, ..ObserveSettings::default() };
    observe(model, &[motion], Equations::Torque, None, &settings, None).unwrap()
}

fn gains(model: &RecursiveModel, mass: Option<f64>, seed: u64) -> DriveGains {
    let of = |carried: f64, seed: u64| observed(model, motion(model, &chi(model, carried), GAINS, seed));
    let known = KnownPayload { mass, ..KnownPayload::default() };
    drive_gains(model.robot(), &of(0.0, 2 * seed), &of(3.0, 2 * seed + 1), &known).unwrap()
}

fn determined(gain: &DriveGain) -> [f64; 2] {
    match gain {
        DriveGain::Determined { value, sigma } => [*value, *sigma],
        other => panic!("{other:?}"),
    }
}

/// Spread of the first gain over recordings, and what is stated.
fn spread(model: &RecursiveModel, mass: Option<f64>) -> [f64; 2] {
    let seeds = 100;
    let (mut spread, mut stated) = (0.0, 0.0);
    for seed in 0..seeds {
        let found = gains(model, mass, 500 + seed);
        assert!(found.absolute);
        let [value, sigma] = determined(&found.gains[0]);
        spread += (value - GAINS[0]).powi(2) / seeds as f64;
        stated += sigma * sigma / seeds as f64;
    }
    [spread.sqrt(), stated.sqrt()]
}

#[test]
fn a_known_value_gives_the_scale_of_the_gains_and_its_share_of_what_is_known() {
    let (free, known) = (arm(""), arm("known: {Ia2: 0.3, Fc1: 1.5}"));
    let names: Vec<_> =
        known.robot().fixed_base().iter().map(|&(k, _)| known.robot().base[k].name.clone()).collect();
    assert_eq!(names, ["Fc1", "Ia2"]);
    // Without any mass the table has the scale.
    assert!(!gains(&free, None, 1).absolute);
    let [alone, both, of_mass] = [spread(&known, None), spread(&known, Some(3.0)), spread(&free, Some(3.0))];
    println!("table {alone:?}, table and mass {both:?}, mass {of_mass:?}");
    for [spread, stated] in [alone, both, of_mass] {
        // A hundred draws know their spread to 7 %.
        assert!((spread / stated - 1.0).abs() < 0.25, "{spread} {stated}");
    }
    assert!(both[1] < alone[1] && both[1] < of_mass[1]);
    let found = gains(&known, Some(3.0), 9);
    for &(k, value) in &known.robot().fixed_base() {
        assert!((found.base[k] / value - 1.0).abs() < 1e-9, "{}", found.base[k]);
    }
}

#[test]
fn a_known_value_that_determines_no_gain_leaves_their_ratios() {
    // Friction that is lost in the noise of one in fifty.
    let text = "known: {Fc1: 0.001}";
    let table = ARM.replace("Fc1: 1.5", "Fc1: 0.001").replace("nominal:", &format!("{text}\nnominal:"));
    let table = parse("arm", table.as_bytes()).unwrap();
    let model = RecursiveModel::new(numeric_robot(&table, &base_set(&table))).unwrap();
    assert_eq!(model.robot().fixed_base().len(), 1);
    let found = gains(&model, None, 3);
    assert!(!found.absolute);
    let [value, sigma] = determined(&found.gains[1]);
    assert!((value - GAINS[1] / GAINS[0]).abs() < 4.0 * sigma, "{value} {sigma}");
}

#[test]
fn a_payload_is_that_of_a_robot_without_the_columns_of_what_is_known() {
    let known = arm("known: {Ia2: 0.3, Fc1: 1.5}");
    let (less, kept) = less(&known);
    let of_known: Vec<f64> = {
        let all = chi(&known, 0.0);
        (0..all.len()).map(|k| if kept.contains(&k) { 0.0 } else { all[k] }).collect()
    };
    let without = |mut motion: Motion| {
        let states = StateSlices::new(&motion.q, &motion.dq, &motion.ddq);
        let taken = torques(&known, &of_known, states.states());
        motion.torque.iter_mut().flatten().zip(taken.iter().flatten()).for_each(|(t, k)| *t -= k);
        motion
    };
    let reference = |model: &RecursiveModel, motion: Motion| {
        let found = estimate(&observed(model, motion), &EstimateSettings::default());
        let k = model.robot().base.len();
        let chi: Vec<f64> = found.parameters.iter().map(|p| p.value).collect();
        let upper = found.covariance.unwrap();
        let at = |i: usize, l: usize| upper[i * k + l - i * (i + 1) / 2];
        ReferenceModel { chi, covariance: DMatrix::from_fn(k, k, |i, l| at(i.min(l), i.max(l))) }
    };
    let before = motion(&known, &chi(&known, 0.0), [1.0; 2], 11);
    let after = motion(&known, &chi(&known, 3.0), [1.0; 2], 12);
    let [a, b] = [(&known, before.clone(), after.clone()), (&less, without(before), without(after))].map(
        |(model, before, after)| {
            let before = reference(model, before);
            payload_of(model.robot(), &observed(model, after), &before).unwrap()
        },
    );
    assert_eq!(a.determined, b.determined);
    let all = |fit: &dynid_runtime::estimation::PayloadFit| {
        let body = &fit.body;
        let told: Vec<_> = [body.mass, body.centre[0], body.centre[1]].to_vec();
        told
    };
    for (a, b) in all(&a).into_iter().zip(all(&b)) {
        assert!((a.value - b.value).abs() < 1e-6 * b.sigma.unwrap(), "{a:?} {b:?}");
        assert!((a.sigma.unwrap() / b.sigma.unwrap() - 1.0).abs() < 1e-6, "{a:?} {b:?}");
    }
    assert!((a.body.mass.value - 3.0).abs() < 4.0 * a.body.mass.sigma.unwrap());
    for (k, value) in known.robot().fixed_base() {
        assert_eq!(a.chi[k], value);
    }
}

#[test]
fn a_payload_on_a_link_whose_mass_is_known_is_weighed() {
    // Everything that torques tell of the mass of the second link is known: what is more is the payload's.
    let known = arm("known: {MX2: 0.7, Ia2: 0.3}");
    let fixed: Vec<usize> = known.robot().fixed_base().into_iter().map(|(k, _)| k).collect();
    assert_eq!(fixed.len(), 2);
    let found = estimate(
        &observed(&known, motion(&known, &chi(&known, 0.0), [1.0; 2], 21)),
        &EstimateSettings::default(),
    );
    let k = known.robot().base.len();
    let upper = found.covariance.as_ref().unwrap();
    let at = |i: usize, l: usize| upper[i * k + l - i * (i + 1) / 2];
    let reference = ReferenceModel {
        chi: found.parameters.iter().map(|p| p.value).collect(),
        covariance: DMatrix::from_fn(k, k, |i, l| at(i.min(l), i.max(l))),
    };
    let loaded = observed(&known, motion(&known, &chi(&known, 3.0), [1.0; 2], 22));
    let fit = payload_of(known.robot(), &loaded, &reference).unwrap();
    let truth = [(fit.body.mass, 3.0), (fit.body.centre[0], 0.2), (fit.body.centre[1], 0.05)];
    for (q, truth) in truth {
        assert!((q.value - truth).abs() < 4.0 * q.sigma.unwrap(), "{q:?} {truth}");
    }
}
