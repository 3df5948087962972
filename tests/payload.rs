//! Gains of drives and payloads from what is simulated: values, standard deviations, and what cannot be told.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use common::{Folder, error_of, json_of, words_of};
use dynid::models;
use dynid_runtime::estimation::observe::{Equations, Observation, ObserveSettings, observe};
use dynid_runtime::estimation::{
    DriveGain, DriveGains, DriveGainsError, EstimateSettings, KnownPayload, ReferenceModel, drive_gains,
    estimate, payload_of,
};
use dynid_runtime::model::{Model, ParameterKind, StateSlices, torques};
use dynid_runtime::signal::Motion;
use nalgebra::DMatrix;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

const RATE: f64 = 100.0;

/// XX XY XZ YY YZ ZZ MX MY MZ M of a box in the last frame.
fn body(mass: f64, [x, y, z]: [f64; 3], inertia: [f64; 6]) -> [f64; 10] {
    let steiner = [y * y + z * z, -x * y, -x * z, x * x + z * z, -y * z, x * x + y * y];
    std::array::from_fn(|k| match k {
        0..6 => inertia[k] + mass * steiner[k],
        6 => mass * x,
        7 => mass * y,
        8 => mass * z,
        _ => mass,
    })
}

const MASS: f64 = 3.0;
const CENTRE: [f64; 3] = [0.06, -0.03, 0.15];
const INERTIA: [f64; 6] = [0.02, 0.001, -0.002, 0.03, 0.0015, 0.025];

fn nominal(model: &dyn Model, payload: Option<[f64; 10]>) -> Vec<f64> {
    let robot = model.robot();
    let mut standard = robot.nominal.as_ref().unwrap().standard.to_vec();
    let frame = robot.frames.len() - 1;
    for (k, value) in payload.into_iter().flatten().enumerate() {
        let kind = ParameterKind::INERTIAL[k];
        let place = robot.standard.iter().position(|s| s.frame == frame && s.kind == kind).unwrap();
        standard[place] += value;
    }
    robot.base_from_standard(&standard)
}

/// A motion with the torques of base parameters over the gains, each joint with noise of a share of its largest.
fn motion(model: &dyn Model, chi: &[f64], gains: &[f64], noise: f64, seed: u64) -> Motion {
    let n = model.robot().joints();
    let samples = 1500;
    let mut random = Pcg64::seed_from_u64(seed);
    let mut signals = [vec![], vec![], vec![]];
    for j in 0..n {
        let mut own = [vec![0.0; samples], vec![0.0; samples], vec![0.0; samples]];
        for h in 1..=5 {
            let w = std::f64::consts::TAU * 0.1 * f64::from(h);
            let phase = (j as f64 + 1.3) * f64::from(h * h) * 0.9;
            let a = 0.9 / f64::from(h);
            for t in 0..samples {
                let angle = w * t as f64 / RATE + phase;
                own[0][t] += a * angle.sin();
                own[1][t] += a * w * angle.cos();
                own[2][t] -= a * w * w * angle.sin();
            }
        }
        for (all, own) in signals.iter_mut().zip(own) {
            all.push(own);
        }
    }
    let [q, dq, ddq] = signals;
    let mut torque = torques(model, chi, StateSlices::new(&q, &dq, &ddq).states());
    for (own, gain) in torque.iter_mut().zip(gains) {
        let largest = own.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
        for x in own.iter_mut() {
            let draw: f64 = StandardNormal.sample(&mut random);
            *x = (*x + noise * largest * draw) / gain;
        }
    }
    let name = "run".to_owned();
    Motion { name, rate: RATE, start: 0.0, q, dq, ddq, torque, fixed: vec![], edge_samples: 0 }
}

fn observed(model: &dyn Model, motion: Motion) -> Observation {
    let settings = ObserveSettings { band: 10.0, keep_rows: true, threads: 1, ..ObserveSettings::default() };
    observe(model, &[motion], Equations::Torque, None, &settings, None).unwrap()
}

/// Observations without and with a payload.
fn pair(model: &dyn Model, payload: [f64; 10], gains: &[f64], noise: f64, seed: u64) -> [Observation; 2] {
    [None, Some(payload)].map(|payload| {
        let chi = nominal(model, payload);
        observed(model, motion(model, &chi, gains, noise, 2 * seed + u64::from(payload.is_some())))
    })
}

fn found(model: &dyn Model, [unloaded, loaded]: &[Observation; 2], known: &KnownPayload) -> DriveGains {
    drive_gains(model.robot(), unloaded, loaded, known).unwrap()
}

fn determined(gain: &DriveGain) -> (f64, f64) {
    match gain {
        DriveGain::Determined { value, sigma } => (*value, *sigma),
        other => panic!("{other:?}"),
    }
}

const KNOWN: KnownPayload = KnownPayload { mass: Some(MASS), centre: None, inertia: None };

#[test]
fn gains_of_an_arm_and_the_rest_of_its_payload_are_found_within_their_uncertainty() {
    let model = models::find("tx40").unwrap();
    let gains = [30.0, 28.0, 14.0, 8.0, 6.0, 3.0];
    let payload = body(MASS, CENTRE, INERTIA);
    let observations = pair(model, payload, &gains, 0.003, 7);
    let found = found(model, &observations, &KNOWN);
    assert!(found.absolute);
    for (gain, truth) in found.gains.iter().zip(gains) {
        let (value, sigma) = determined(gain);
        println!("{value:.4} +- {sigma:.4}, true {truth}");
        assert!((value - truth).abs() < 3.0 * sigma && sigma < 0.1 * truth, "{found:?}");
    }
    let of_payload = found.payload.unwrap();
    assert_eq!((of_payload.mass.value, of_payload.mass.sigma), (MASS, Some(0.0)));
    for (q, truth) in of_payload.centre.iter().chain(&of_payload.inertia).zip(CENTRE.iter().chain(&INERTIA)) {
        println!("{q:?}, true {truth}");
        assert!((q.value - truth).abs() < 3.0 * q.sigma.unwrap());
    }
    // The base parameters are those of the robot without payload.
    let chi = nominal(model, None);
    let scale = chi.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for (value, truth) in found.base.iter().zip(&chi) {
        assert!((value - truth).abs() < 0.1 * scale, "{value} {truth}");
    }
}

#[test]
fn a_mass_that_is_wrong_by_a_factor_makes_all_gains_wrong_by_it_and_none_leaves_their_ratios() {
    let model = models::find("planar_2r").unwrap();
    let observations = pair(model, body(MASS, CENTRE, INERTIA), &[20.0, 5.0], 0.01, 3);
    let right = found(model, &observations, &KNOWN);
    let wrong = found(model, &observations, &KnownPayload { mass: Some(2.0 * MASS), ..KNOWN });
    for (a, b) in right.gains.iter().zip(&wrong.gains) {
        approx::assert_relative_eq!(2.0 * determined(a).0, determined(b).0, max_relative = 1e-6);
    }
    let ratios = found(model, &observations, &KnownPayload::default());
    assert!(!ratios.absolute && ratios.payload.is_none());
    assert_eq!(determined(&ratios.gains[0]), (1.0, 0.0));
    let (ratio, sigma) = determined(&ratios.gains[1]);
    assert!((ratio - 0.25).abs() < 3.0 * sigma && sigma < 0.02, "{ratio} {sigma}");
}

#[test]
fn a_drive_of_the_other_sign_is_told_and_a_payload_that_cannot_show_is_refused() {
    let model = models::find("planar_2r").unwrap();
    let payload = body(MASS, CENTRE, INERTIA);
    let turned = found(model, &pair(model, payload, &[20.0, -5.0], 0.01, 3), &KNOWN);
    assert!(matches!(turned.gains[1], DriveGain::Negative { value, .. } if (value + 5.0).abs() < 0.5));
    // Both recordings are of the same robot without payload.
    let empty = pair(model, [0.0; 10], &[20.0, 5.0], 0.01, 3);
    let nothing = drive_gains(model.robot(), &empty[0], &empty[1], &KNOWN);
    assert_eq!(nothing, Err(DriveGainsError::Nothing));
}

/// A vertical axis and a lift on it: what turns about the axis says nothing of a mass on it.
const LIFT: &str = "\
name: lift
gravity: [0, 0, -9.81]
frames:
  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}
  - {j: 2, sigma: 1, alpha: 0, d: 0, theta: 0, r: q2}
drive: {gear: [1, 1]}
nominal:
  parameters: {ZZ1: 0.5, Ia1: 0.2, Fv1: 1.0, Fc1: 2.0, M1: 3, M2: 4, ZZ2: 0.1, Ia2: 1.0, Fv2: 5.0, Fc2: 10.0}
";

#[test]
fn a_joint_that_the_payload_does_not_load_is_undetermined_and_leaves_the_others_what_they_are() {
    let folder = Folder::new("lift");
    folder.write("lift.yaml", LIFT);
    let dynamics = dynid::robots::resolve(folder.path("lift.yaml").to_str().unwrap(), None).unwrap();
    let model = dynamics.model();
    for seed in 0..10 {
        let observations = pair(model, body(MASS, CENTRE, INERTIA), &[20.0, 50.0], 0.01, seed);
        let found = found(model, &observations, &KNOWN);
        assert_eq!(found.gains[0], DriveGain::Undetermined, "{found:?}");
        let (value, sigma) = determined(&found.gains[1]);
        assert!((value - 50.0).abs() < 4.0 * sigma && sigma < 2.0, "{value} {sigma}");
    }
}

#[test]
fn standard_deviations_of_gains_are_those_of_repeated_recordings() {
    let model = models::find("planar_2r").unwrap();
    let gains = [20.0, 5.0];
    let seeds = 150;
    let (mut squares, mut inside, mut stated, mut errors) = ([0.0; 2], [0; 2], [0.0; 2], [0.0; 2]);
    for seed in 0..seeds {
        let found =
            found(model, &pair(model, body(MASS, CENTRE, INERTIA), &gains, 0.03, 1000 + seed), &KNOWN);
        for (j, truth) in gains.into_iter().enumerate() {
            let (value, sigma) = determined(&found.gains[j]);
            squares[j] += (value - truth).powi(2) / seeds as f64;
            errors[j] += (value - truth) / seeds as f64;
            stated[j] += sigma * sigma / seeds as f64;
            inside[j] += usize::from((value - truth).abs() < 1.96 * sigma);
        }
    }
    for j in 0..2 {
        let spread = squares[j].sqrt();
        println!(
            "joint {}: spread {spread:.4}, bias {:.4}, stated {:.4}, {} of {seeds} within 1.96 sigma",
            j + 1,
            errors[j],
            stated[j].sqrt(),
            inside[j]
        );
        // 150 draws know their spread to 6 %, and a coverage of 95 % to 1.8 %.
        assert!((spread / stated[j].sqrt() - 1.0).abs() < 0.2, "{spread} {}", stated[j].sqrt());
        assert!((0.89..=0.99).contains(&(inside[j] as f64 / seeds as f64)), "{}", inside[j]);
        assert!(errors[j].abs() < 0.35 * spread, "{} {spread}", errors[j]);
    }
}

/// A model with its covariance, from an unloaded recording.
fn reference(model: &dyn Model, noise: f64, seed: u64) -> ReferenceModel {
    let gains = vec![1.0; model.robot().joints()];
    let chi = nominal(model, None);
    let found =
        estimate(&observed(model, motion(model, &chi, &gains, noise, seed)), &EstimateSettings::default());
    let upper = found.covariance.clone().unwrap();
    let n = chi.len();
    let covariance = DMatrix::from_fn(n, n, |i, k| {
        let (i, k) = (i.min(k), i.max(k));
        upper[i * n + k - i * (i + 1) / 2]
    });
    ReferenceModel { chi: found.chi(), covariance }
}

#[test]
fn a_payload_by_itself_is_found_within_its_uncertainty_and_is_a_body() {
    let model = models::find("tx40").unwrap();
    let gains = vec![1.0; 6];
    let (mut inside, mut all) = (0, 0);
    for seed in 0..8 {
        let before = reference(model, 0.003, 500 + seed);
        let chi = nominal(model, Some(body(MASS, CENTRE, INERTIA)));
        let loaded = observed(model, motion(model, &chi, &gains, 0.003, 900 + seed));
        let start = std::time::Instant::now();
        let found = payload_of(model.robot(), &loaded, &before).unwrap();
        if seed == 0 {
            println!("{:?} {found:?}", start.elapsed());
        }
        let body = &found.body;
        for (q, truth) in [&body.mass]
            .into_iter()
            .chain(&body.centre)
            .chain(&body.inertia)
            .zip([MASS].iter().chain(&CENTRE).chain(&INERTIA))
        {
            all += 1;
            inside += usize::from((q.value - truth).abs() < 3.0 * q.sigma.unwrap());
        }
        assert!((body.mass.value - MASS).abs() < 0.1, "{body:?}");
        let [xx, xy, xz, yy, yz, zz] = body.inertia.map(|q| q.value);
        let moments = nalgebra::Matrix3::new(xx, xy, xz, xy, yy, yz, xz, yz, zz).symmetric_eigenvalues();
        assert!(moments.min() > 0.0 && moments.sum() > 2.0 * moments.max(), "{moments}");
    }
    println!("{inside} of {all} within 3 sigma");
    assert!(inside + 2 >= all, "{inside} of {all}");
}

#[test]
fn standard_deviations_of_a_payload_are_those_of_repeated_recordings() {
    let model = models::find("planar_2r").unwrap();
    let chi = nominal(model, Some(body(MASS, CENTRE, INERTIA)));
    let seeds = 120;
    let (mut squares, mut stated, mut inside) = ([0.0; 3], [0.0; 3], [0; 3]);
    for seed in 0..seeds {
        let before = reference(model, 0.03, 3000 + seed);
        let loaded = observed(model, motion(model, &chi, &[1.0; 2], 0.03, 6000 + seed));
        let body = payload_of(model.robot(), &loaded, &before).unwrap().body;
        let told = [(body.mass, MASS), (body.centre[0], CENTRE[0]), (body.centre[1], CENTRE[1])];
        for (k, (q, truth)) in told.into_iter().enumerate() {
            let sigma = q.sigma.unwrap();
            squares[k] += (q.value - truth).powi(2) / seeds as f64;
            stated[k] += sigma * sigma / seeds as f64;
            inside[k] += usize::from((q.value - truth).abs() < 1.96 * sigma);
        }
    }
    for k in 0..3 {
        let (spread, stated) = (squares[k].sqrt(), stated[k].sqrt());
        println!("{k}: spread {spread:.5}, stated {stated:.5}, {} of {seeds} within 1.96 sigma", inside[k]);
        // 120 draws know their spread to 6.5 %, and a coverage of 95 % to 2 %.
        assert!((spread / stated - 1.0).abs() < 0.22, "{spread} {stated}");
        assert!((0.88..=0.995).contains(&(inside[k] as f64 / seeds as f64)), "{}", inside[k]);
    }
}

#[test]
fn numbers_of_a_payload_that_a_robot_does_not_feel_are_not_made_up() {
    let model = models::find("planar_2r").unwrap();
    let before = reference(model, 0.003, 5);
    let chi = nominal(model, Some(body(MASS, CENTRE, INERTIA)));
    let loaded = observed(model, motion(model, &chi, &[1.0; 2], 0.003, 6));
    let found = payload_of(model.robot(), &loaded, &before).unwrap();
    assert_eq!(found.determined, 4);
    let body = found.body;
    assert!(body.centre[2].sigma.is_none() && body.inertia[0].sigma.is_none());
    for (q, truth) in [(body.mass, MASS), (body.centre[0], CENTRE[0]), (body.centre[1], CENTRE[1])] {
        assert!((q.value - truth).abs() < 3.5 * q.sigma.unwrap(), "{q:?} {truth}");
    }
}

const RECORDING: &str = "\
robot: planar_2r
side: joint
layout: {header: true, delimiter: \",\"}
time: {column: t, unit: s}
position: {columns: [q1, q2], unit: rad}
torque: {columns: [u1, u2], unit: A, gain: [1, 1]}
trajectories:
";

/// Recordings of planar_2r in amperes, without and with a payload.
fn folder(name: &str, gains: [f64; 2]) -> Folder {
    let folder = Folder::new(name);
    let model = models::find("planar_2r").unwrap();
    for (name, payload) in [("unloaded", None), ("loaded", Some(body(MASS, CENTRE, INERTIA)))] {
        let motion = motion(model, &nominal(model, payload), &gains, 0.003, name.len() as u64);
        let mut text = String::from("t,q1,q2,u1,u2\n");
        for t in 0..motion.q[0].len() {
            let [q, u] = [&motion.q, &motion.torque];
            text += &format!("{},{},{},{},{}\n", t as f64 / RATE, q[0][t], q[1][t], u[0][t], u[1][t]);
        }
        let manifest = format!("{RECORDING}  - {{file: {name}.csv}}\n");
        folder.write(&format!("{name}.csv"), &text).write(&format!("{name}.yaml"), &manifest);
    }
    folder
}

#[test]
fn the_command_gives_gains_with_a_mass_and_ratios_without_one() {
    let folder = folder("gains", [20.0, 5.0]);
    folder.write("payload.yaml", "mass: 3.0\ncentre: [0.06, -0.03, 0.15]\n");
    let words = ["identify", "unloaded.yaml", "--loaded", "loaded.yaml", "--payload", "payload.yaml"];
    let output = folder.run(&words);
    let said = words_of(&output);
    assert!(output.status.success(), "{}", error_of(&output));
    println!("{said}");
    assert!(said.contains("gain") && said.contains("known") && said.contains("N.m for 1"), "{said}");
    let json = json_of(&folder.run(&[&words[..], &["--json", "-"]].concat()));
    for (gain, truth) in json["gains"].as_array().unwrap().iter().zip([20.0, 5.0]) {
        let [value, sigma] = ["gain", "sigma"].map(|name| gain[name].as_f64().unwrap());
        assert!((value - truth).abs() < 3.5 * sigma + 0.01 * truth, "{gain}");
    }
    let ratios = words_of(&folder.run(&words[..4]));
    assert!(ratios.contains("ratios of the gains only") && ratios.contains("mass"), "{ratios}");
}

#[test]
fn the_command_finds_a_payload_beyond_a_model() {
    let folder = folder("payload-only", [1.0, 1.0]);
    let output = folder.run(&["identify", "unloaded.yaml", "--out", "model.json"]);
    assert!(output.status.success(), "{}", error_of(&output));
    let words = ["identify", "loaded.yaml", "--reference", "model.json", "--payload-only"];
    let start = std::time::Instant::now();
    let output = folder.run(&words);
    if !cfg!(debug_assertions) {
        assert!(start.elapsed().as_secs_f64() < 1.0, "{:?}", start.elapsed());
    }
    let said = words_of(&output);
    println!("{said}");
    assert!(output.status.success(), "{}", error_of(&output));
    assert!(said.contains("mass") && said.contains("not determined"), "{said}");
    let json = json_of(&folder.run(&[&words[..], &["--json", "-"]].concat()));
    let mass = &json["payload"]["mass"];
    let [value, sigma] = ["value", "sigma"].map(|name| mass[name].as_f64().unwrap());
    assert!((value - MASS).abs() < 3.5 * sigma + 0.01 * MASS, "{mass}");
}

#[test]
fn files_and_options_that_do_not_fit_are_refused_in_words() {
    let folder = folder("refused-payload", [1.0, 1.0]);
    folder
        .write("unknown.yaml", "mass: 3.0\nweight: 2\n")
        .write("negative.yaml", "mass: -1\n")
        .write("inertia.yaml", "mass: 1\ninertia: {XX: 1, YY: 1, ZZ: 1}\n");
    let with = |file| ["identify", "unloaded.yaml", "--loaded", "loaded.yaml", "--payload", file];
    for (words, what) in [
        (&with("unknown.yaml")[..], "centre: [x, y, z]"),
        (&with("negative.yaml"), "above zero"),
        (&with("inertia.yaml"), "mass and centre"),
        (&with("none.yaml"), "none.yaml"),
        (&["identify", "unloaded.yaml", "--payload", "negative.yaml"], "--loaded"),
        (&["identify", "loaded.yaml", "--payload-only"], "--reference"),
        (&["identify", "loaded.yaml", "--payload-only", "--reference", "loaded.yaml"], "loaded.yaml"),
    ] {
        let output = folder.run(words);
        let error = error_of(&output);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {error}");
        assert!(error.contains(what), "{words:?}: {error}");
    }
}
