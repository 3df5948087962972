#![allow(clippy::unwrap_used)]
//! The recursive model against an independent engine, and against itself where physics says so.
//! Equation numbers are those of Gautier and Briot.

use super::*;
use crate::model::{
    Drive, Frame, JointKind, LANES, Lanes, Limits, Model, Number, ParameterKind, Robot, States,
};
use approx::assert_abs_diff_eq;
use serde_json::Value;
use std::io::Write as _;

fn frame(sigma: u8, alpha: f64, d: f64, theta: f64, r: f64, parent: Option<usize>) -> Frame {
    let kind = [JointKind::Revolute, JointKind::Prismatic, JointKind::Fixed][sigma as usize];
    Frame { parent, kind, gamma: 0.0, b: 0.0, alpha, d, theta, r }
}

fn diagonal(n: usize, ratio: f64) -> Vec<f64> {
    (0..n * n).map(|k| if k % (n + 1) == 0 { ratio } else { 0.0 }).collect()
}

fn robot(gravity: [f64; 3], frames: Vec<Frame>, gear: Vec<f64>, coupled: Vec<usize>) -> Robot {
    let drive = Drive { gear: gear.into(), coupled_friction: coupled.into() };
    Robot::with_standard_as_base("test", gravity, frames, drive, Limits::default())
}

/// A branched tree with every kind of frame, oblique angles, and a coupled differential drive.
fn tree() -> Robot {
    let mut frames = vec![
        frame(0, 0.3, 0.1, 0.2, 0.4, None),
        frame(1, -1.1, 0.2, 0.7, 0.1, Some(0)),
        frame(0, 0.8, -0.3, 0.0, 0.2, Some(1)),
        frame(2, 0.4, 0.1, -0.5, 0.3, Some(2)),
        frame(0, 1.2, 0.25, 0.1, -0.2, Some(0)),
        frame(1, 0.5, 0.0, 0.3, 0.15, Some(4)),
    ];
    frames[4].gamma = 0.9;
    frames[4].b = -0.35;
    let gear = vec![
        20., 0., 0., 0., 0., //
        0., 300., 0., 0., 0., //
        5., 0., 40., 0., 0., //
        0., 0., 0., 30., 100., //
        0., 0., 0., 10., 200.,
    ];
    robot([1.0, -2.0, -9.0], frames, gear, vec![2, 4])
}

fn states(n: usize) -> Vec<[Vec<f64>; 3]> {
    let value = |k: usize, a: f64| ((k as f64) * a).sin() * 2.5;
    (0..5)
        .map(|s| [1.3, 2.1, 3.7].map(|a| (0..n).map(|j| value(7 * s + j + 1, a)).collect::<Vec<_>>()))
        .collect()
}

fn dense(model: &RecursiveModel, q: &[f64], dq: &[f64], ddq: &[f64]) -> Vec<Vec<f64>> {
    let pattern = model.pattern();
    let mut entries = vec![f64::NAN; pattern.columns.len()];
    model.idm(q, dq, ddq, &mut entries);
    let mut rows = vec![vec![0.0; model.robot().base.len()]; q.len()];
    for (i, row) in rows.iter_mut().enumerate() {
        for e in pattern.rows[i]..pattern.rows[i + 1] {
            row[pattern.columns[e]] = entries[e];
        }
    }
    rows
}

fn numbers(value: &Value) -> Vec<f64> {
    value.as_array().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

#[test]
fn rows_and_energy_agree_with_an_independent_engine() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../shared/reference/regressors.json");
    let Ok(text) = std::fs::read_to_string(path) else {
        let _ = writeln!(std::io::stderr(), "skipped: {path} is not there");
        return;
    };
    let all: Value = serde_json::from_str(&text).unwrap();
    let mut compared = 0;
    for (name, reference) in all.as_object().unwrap().iter().filter(|(_, v)| v.is_object()) {
        let mut frames = Vec::new();
        for (k, row) in reference["mdh"].as_array().unwrap().iter().enumerate() {
            let x = numbers(row);
            frames.push(frame(x[0] as u8, x[1], x[2], x[3], x[4], k.checked_sub(1)));
        }
        let n = frames.len();
        let gravity: [f64; 3] = numbers(&reference["gravity"]).try_into().unwrap();
        let model = RecursiveModel::new(robot(gravity, frames, diagonal(n, 1.0), vec![])).unwrap();
        for state in reference["states"].as_array().unwrap() {
            let [q, dq, ddq] = ["q", "dq", "ddq"].map(|k| numbers(&state[k]));
            let rows = dense(&model, &q, &dq, &ddq);
            let mut h = vec![0.0; model.robot().base.len()];
            model.energy(&q, &dq, &mut h);
            let energy = numbers(&state["energy"]);
            let inertial =
                (0..h.len()).filter(|&c| (model.robot().standard[c].kind as usize) < 10).collect::<Vec<_>>();
            for (i, expected) in state["torque"].as_array().unwrap().iter().enumerate() {
                for (&c, &e) in inertial.iter().zip(&numbers(expected)) {
                    assert!((rows[i][c] - e).abs() < 1e-10, "{name} row {i} column {c}: {} {e}", rows[i][c]);
                    compared += 1;
                }
            }
            for (&c, &e) in inertial.iter().zip(&energy) {
                assert!((h[c] - e).abs() < 1e-10, "{name} energy {c}: {} {e}", h[c]);
            }
        }
    }
    assert!(compared > 5000, "{compared} entries compared");
}

#[test]
fn power_is_speed_times_torque_for_every_column() {
    let model = RecursiveModel::new(tree()).unwrap();
    for [q, dq, ddq] in states(5) {
        let rows = dense(&model, &q, &dq, &ddq);
        let mut dh = vec![f64::NAN; model.robot().base.len()];
        model.power(&q, &dq, &ddq, &mut dh);
        for (c, value) in dh.iter().enumerate() {
            let expected: f64 = (0..5).map(|i| dq[i] * rows[i][c]).sum();
            assert_abs_diff_eq!(*value, expected, epsilon = 1e-11 * (1.0 + expected.abs()));
        }
    }
}

#[test]
fn power_is_the_time_derivative_of_energy() {
    let model = RecursiveModel::new(tree()).unwrap();
    let nb = model.robot().base.len();
    for [q, dq, ddq] in states(5) {
        let mut dh = vec![0.0; nb];
        model.power(&q, &dq, &ddq, &mut dh);
        let energy_at = |t: f64| {
            let moved = |x: &[f64], v: &[f64], a: &[f64]| {
                (0..5).map(|j| x[j] + t * v[j] + 0.5 * t * t * a[j]).collect::<Vec<_>>()
            };
            let mut h = vec![0.0; nb];
            model.energy(&moved(&q, &dq, &ddq), &moved(&dq, &ddq, &[0.0; 5]), &mut h);
            h
        };
        let step = 1e-4;
        // Five-point difference: error of order step^4.
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| energy_at(k * step));
        for k in 0..nb {
            let kind = model.robot().standard[k].kind;
            if kind > ParameterKind::Ia {
                continue;
            }
            let slope = (a[k] - 8.0 * b[k] + 8.0 * c[k] - d[k]) / (12.0 * step);
            assert_abs_diff_eq!(dh[k], slope, epsilon = 1e-7 * (1.0 + slope.abs()));
        }
    }
}

#[test]
fn blocks_hold_the_same_numbers_as_single_samples() {
    let model = RecursiveModel::new(tree()).unwrap();
    let samples = states(5);
    let (n, nb, count, stride) = (5, model.robot().base.len(), samples.len(), 9);
    let signals: Vec<Vec<Vec<f64>>> =
        (0..3).map(|s| (0..n).map(|j| samples.iter().map(|x| x[s][j]).collect()).collect()).collect();
    let slices: Vec<Vec<&[f64]>> = signals.iter().map(|s| s.iter().map(Vec::as_slice).collect()).collect();
    let states = States { q: &slices[0], dq: &slices[1], ddq: &slices[2] };
    let entries = model.pattern().columns.len();
    let mut idm = vec![f64::NAN; entries * stride];
    let mut power = vec![f64::NAN; nb * stride];
    let mut energy = vec![f64::NAN; nb * stride];
    model.idm_block(states, stride, &mut idm);
    model.power_block(states, stride, &mut power);
    model.energy_block(states, stride, &mut energy);
    let mut lines = vec![[Lanes::constant(0.0); 2]; entries];
    model.idm_lines(states, entries, &mut lines);
    for (t, [q, dq, ddq]) in samples.iter().enumerate().take(count) {
        let mut one = vec![0.0; entries];
        model.idm(q, dq, ddq, &mut one);
        for (e, value) in one.iter().enumerate() {
            assert_abs_diff_eq!(idm[e * stride + t], *value, epsilon = 1e-12 * (1.0 + value.abs()));
            assert_eq!(lines[e][t / LANES].to_array()[t % LANES], idm[e * stride + t]);
        }
        let (mut dh, mut h) = (vec![0.0; nb], vec![0.0; nb]);
        model.power(q, dq, ddq, &mut dh);
        model.energy(q, dq, &mut h);
        for k in 0..nb {
            assert_abs_diff_eq!(power[k * stride + t], dh[k], epsilon = 1e-12 * (1.0 + dh[k].abs()));
            assert_abs_diff_eq!(energy[k * stride + t], h[k], epsilon = 1e-12 * (1.0 + h[k].abs()));
        }
    }
}

#[test]
fn mass_and_bias_are_the_regressor_times_the_parameters() {
    let model = RecursiveModel::new(tree()).unwrap();
    let chi: Vec<f64> = (0..model.robot().base.len()).map(|k| (k as f64 * 0.37).cos()).collect();
    let frictionless: Vec<f64> = model
        .robot()
        .standard
        .iter()
        .zip(&chi)
        .map(|(p, &x)| if p.kind > ParameterKind::Ia { 0.0 } else { x })
        .collect();
    for [q, dq, ddq] in states(5) {
        let mut mass = vec![f64::NAN; 25];
        let mut bias = vec![f64::NAN; 5];
        model.mass_and_bias(&chi, &q, &dq, &mut mass, &mut bias);
        let rows = dense(&model, &q, &dq, &ddq);
        for i in 0..5 {
            let torque: f64 = rows[i].iter().zip(&frictionless).map(|(w, x)| w * x).sum();
            let from_mass: f64 = (0..5).map(|j| mass[i * 5 + j] * ddq[j]).sum::<f64>() + bias[i];
            assert_abs_diff_eq!(torque, from_mass, epsilon = 1e-10 * (1.0 + torque.abs()));
            for j in 0..5 {
                assert_abs_diff_eq!(mass[i * 5 + j], mass[j * 5 + i], epsilon = 1e-11);
            }
        }
    }
}

#[test]
fn the_mass_matrix_of_real_bodies_is_positive_definite() {
    let robot = tree();
    let mut standard = vec![0.0; robot.standard.len()];
    for (k, p) in robot.standard.iter().enumerate() {
        standard[k] = match p.kind {
            ParameterKind::XX | ParameterKind::YY | ParameterKind::ZZ => 0.5,
            ParameterKind::M => 3.0,
            ParameterKind::MX | ParameterKind::MZ => 0.3,
            _ => 0.0,
        };
    }
    let model = RecursiveModel::new(robot).unwrap();
    for [q, dq, _] in states(5) {
        let mut mass = vec![0.0; 25];
        model.mass_and_bias(&standard, &q, &dq, &mut mass, &mut [0.0; 5]);
        assert!(nalgebra::DMatrix::from_row_slice(5, 5, &mass).cholesky().is_some());
    }
}

#[test]
fn the_rotor_that_two_joints_drive_acts_on_both() {
    // Axes 5 and 6 of (25), (26): motors turn with 45 dq1 and 32 (dq1 + dq2).
    let frames = vec![frame(0, 0.0, 0.0, 0.0, 0.0, None), frame(0, 1.0, 0.0, 0.0, 0.0, Some(0))];
    let model = RecursiveModel::new(robot([0.0; 3], frames, vec![45., 0., 32., 32.], vec![1])).unwrap();
    let (dq, ddq) = ([0.7, -1.9], [3.0, 5.0]);
    let rows = dense(&model, &[0.1, 0.2], &dq, &ddq);
    let column = |name: &str| {
        let c = model.robot().base.iter().position(|p| p.name == name).unwrap();
        [rows[0][c], rows[1][c]]
    };
    let close = |a: [f64; 2], b: [f64; 2]| a.iter().zip(b).all(|(x, y)| (x - y).abs() < 1e-12);
    assert!(close(column("Ia1"), [3.0, 0.0]));
    assert!(close(column("Ia2"), [5.0, 8.0]));
    assert!(close(column("Fvm2"), [-1.2, -1.2]));
    assert!(close(column("Fcm2"), [-1.0, -1.0]));
    assert!(close(column("Fv2"), [0.0, -1.9]));
    assert!(close(column("off1"), [1.0, 0.0]));
}

#[test]
fn a_differential_whose_squared_ratios_are_singular_keeps_one_inertia_per_motor() {
    let frames = vec![frame(0, 0.0, 0.0, 0.0, 0.0, None), frame(0, 1.0, 0.0, 0.0, 0.0, Some(0))];
    let model = RecursiveModel::new(robot([0.0; 3], frames, vec![10., 10., -10., 10.], vec![])).unwrap();
    let rows = dense(&model, &[0.1, 0.2], &[0.0; 2], &[3.0, 5.0]);
    let column = |name: &str| {
        let c = model.robot().base.iter().position(|p| p.name == name).unwrap();
        [rows[0][c], rows[1][c]]
    };
    assert_eq!(column("Ia1"), [8.0, 8.0]);
    assert_eq!(column("Ia2"), [-2.0, 2.0]);
}

#[test]
fn entries_that_vanish_for_every_state_are_not_in_the_pattern() {
    let frames = vec![frame(0, 0.0, 0.0, 0.0, 0.0, None), frame(0, 0.0, 0.5, 0.0, 0.0, Some(0))];
    let model = RecursiveModel::new(robot([0.0, -9.81, 0.0], frames, diagonal(2, 1.0), vec![])).unwrap();
    let pattern = model.pattern();
    let names = |row: usize| -> Vec<&str> {
        pattern.columns[pattern.rows[row]..pattern.rows[row + 1]]
            .iter()
            .map(|&c| model.robot().base[c].name.as_ref())
            .collect()
    };
    assert_eq!(names(0), ["ZZ1", "MX1", "MY1", "Ia1", "Fv1", "Fc1", "off1", "ZZ2", "MX2", "MY2", "M2"]);
    assert_eq!(names(1), ["ZZ2", "MX2", "MY2", "Ia2", "Fv2", "Fc2", "off2"]);
}

#[test]
fn tables_that_cannot_be_evaluated_are_refused_by_name() {
    let long = (0..17).map(|k: usize| frame(2, 0.1, 0.0, 0.0, 0.0, k.checked_sub(1))).collect();
    let refused = RecursiveModel::new(robot([0.0; 3], long, vec![], vec![])).unwrap_err();
    assert_eq!(refused, RecursiveModelError::TooManyFrames { found: 17 });
    let frames = vec![frame(0, 0.0, 0.0, 0.0, 0.0, None), frame(0, 1.0, 0.0, 0.0, 0.0, Some(0))];
    let gear =
        RecursiveModel::new(robot([0.0; 3], frames.clone(), vec![1., 1., 1., 0.], vec![])).unwrap_err();
    assert_eq!(gear, RecursiveModelError::GearDiagonal { motor: 2 });
    let short = RecursiveModel::new(robot([0.0; 3], frames, vec![1.0], vec![])).unwrap_err();
    assert_eq!(short, RecursiveModelError::GearShape { found: 1, joints: 2 });
}
