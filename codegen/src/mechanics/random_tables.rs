//! The equations of random tables against an engine that shares nothing with them: poses as products of matrices,
//! geometric Jacobians, and the Lagrange equations by differences.
#![allow(clippy::unwrap_used)]

use super::inverse::Derivation;
use super::model::{Equations, Variant};
use crate::base::base_set;
use crate::robot::{DriveTable, Expression, RobotTable, TableRow};
use crate::testing::{Random, all_parameters, make_dependent};
use dynid_description::JointKind;
use dynid_description::ParameterKind;
use std::f64::consts::{FRAC_PI_2, PI};

type Matrix = [[f64; 4]; 4];
type Vector = [f64; 3];

/// A tree of up to six axes, with special and general angles, zero and general lengths, fixed frames in between.
fn random_robot(random: &mut Random) -> RobotTable {
    let mut pick = |count: usize| ((random.unit() + 1.0) / 2.0 * count as f64) as usize;
    let count = 1 + pick(6);
    let mut frames: Vec<TableRow> = Vec::new();
    for j in 1..=count {
        let angle = |choice: usize| [0.0, FRAC_PI_2, -FRAC_PI_2, PI, 0.0, 0.7, -1.9][choice];
        let length = |choice: usize| [0.0, 0.3, -0.17, 0.0][choice];
        let number = Expression::Number;
        let kind =
            [JointKind::Revolute, JointKind::Revolute, JointKind::Prismatic, JointKind::Fixed][pick(4)];
        let branches = pick(5) == 0;
        frames.push(TableRow {
            j,
            parent: if branches { pick(j) } else { j - 1 },
            kind: if j == 1 { JointKind::Revolute } else { kind },
            gamma: number(if branches { angle(pick(7)) } else { 0.0 }),
            b: number(if branches { length(pick(4)) } else { 0.0 }),
            alpha: number(angle(pick(7))),
            d: number(length(pick(4))),
            theta: number(angle(pick(7))),
            r: number(length(pick(4))),
        });
    }
    let joints = frames.iter().filter(|f| f.kind != JointKind::Fixed).count();
    let gravity = if pick(2) == 0 { [0.0, 0.0, -9.81] } else { [1.3, -4.0, 8.0] };
    RobotTable::of_frames("random", gravity, frames, DriveTable::direct(joints))
}

/// One whose frames move with several joints, and several with one.
fn random_dependent_robot(random: &mut Random) -> RobotTable {
    let mut robot = random_robot(random);
    make_dependent(&mut robot, |count| ((random.unit() + 1.0) / 2.0 * count as f64) as usize);
    robot
}

fn product(a: &Matrix, b: &Matrix) -> Matrix {
    std::array::from_fn(|i| std::array::from_fn(|k| (0..4).map(|m| a[i][m] * b[m][k]).sum()))
}

fn turn(axis: usize, angle: f64) -> Matrix {
    let mut m: Matrix = std::array::from_fn(|i| std::array::from_fn(|k| f64::from(u8::from(i == k))));
    let (i, k) = ((axis + 1) % 3, (axis + 2) % 3);
    (m[i][i], m[i][k], m[k][i], m[k][k]) = (angle.cos(), -angle.sin(), angle.sin(), angle.cos());
    m
}

fn shift(axis: usize, length: f64) -> Matrix {
    let mut m = turn(0, 0.0);
    m[axis][3] = length;
    m
}

fn cross(a: Vector, b: Vector) -> Vector {
    std::array::from_fn(|i| a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3])
}

fn dot(a: Vector, b: Vector) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn column(m: &Matrix, k: usize) -> Vector {
    [m[0][k], m[1][k], m[2][k]]
}

/// Energy per unit of each of the ten inertial parameters of every frame.
fn energies(robot: &RobotTable, q: &[f64], dq: &[f64]) -> Vec<f64> {
    let mut poses: Vec<Matrix> = Vec::new();
    // Of each frame, the frames that it moves with.
    let mut paths: Vec<Vec<usize>> = Vec::new();
    let motions = robot.motions();
    let combined = |terms: &[(usize, f64)], x: &[f64]| terms.iter().map(|&(k, c)| c * x[k]).sum::<f64>();
    for (index, (frame, motion)) in robot.frames.iter().zip(&motions).enumerate() {
        let parent = robot.frames.iter().position(|f| f.j == frame.parent);
        let moved = |kind: JointKind| if motion.kind == kind { combined(&motion.terms, q) } else { 0.0 };
        let steps = [
            turn(2, frame.gamma.value()),
            shift(2, frame.b.value()),
            turn(0, frame.alpha.value()),
            shift(0, frame.d.value()),
            turn(2, frame.theta.value() + moved(JointKind::Revolute)),
            shift(2, frame.r.value() + moved(JointKind::Prismatic)),
        ];
        let start = parent.map_or(turn(0, 0.0), |p| poses[p]);
        poses.push(steps.iter().fold(start, |pose, step| product(&pose, step)));
        let mut path = parent.map_or(Vec::new(), |p| paths[p].clone());
        path.extend((motion.kind != JointKind::Fixed).then_some(index));
        paths.push(path);
    }
    let mut h = Vec::new();
    for (pose, path) in poses.iter().zip(&paths) {
        let (mut w, mut v) = ([0.0; 3], [0.0; 3]);
        for &frame in path {
            let rate = combined(&motions[frame].terms, dq);
            let axis = column(&poses[frame], 2);
            let arm: Vector = std::array::from_fn(|i| pose[i][3] - poses[frame][i][3]);
            let revolute = motions[frame].kind == JointKind::Revolute;
            let velocity = if revolute { cross(axis, arm) } else { axis };
            for i in 0..3 {
                w[i] += if revolute { axis[i] * rate } else { 0.0 };
                v[i] += velocity[i] * rate;
            }
        }
        let axes = [0, 1, 2].map(|k| column(pose, k));
        let [x, y, z] = axes.map(|axis| dot(axis, w));
        h.extend([0.5 * x * x, x * y, x * z, 0.5 * y * y, y * z, 0.5 * z * z]);
        h.extend(axes.map(|axis| dot(v, cross(w, axis)) - dot(robot.gravity, axis)));
        h.push(0.5 * dot(v, v) - dot(robot.gravity, column(pose, 3)));
    }
    h
}

/// Torques of one joint per unit parameter: d/dt (dT/d dq_i) - d(T - U)/dq_i.
fn lagrange_row(robot: &RobotTable, [q, dq, ddq]: [&[f64]; 3], i: usize) -> Vec<f64> {
    let rest = vec![0.0; q.len()];
    let momentum = |t: f64| -> Vec<f64> {
        let q: Vec<f64> = (0..q.len()).map(|k| q[k] + dq[k] * t + 0.5 * ddq[k] * t * t).collect();
        let at = |extra: f64| {
            let mut dq: Vec<f64> = (0..q.len()).map(|k| dq[k] + ddq[k] * t).collect();
            dq[i] += extra;
            energies(robot, &q, &dq)
        };
        // T is quadratic in the speeds: this difference is exact.
        at(1.0).iter().zip(at(-1.0)).map(|(a, b)| (a - b) / 2.0).collect()
    };
    let lagrangian = |step: f64| -> Vec<f64> {
        let mut q = q.to_vec();
        q[i] += step;
        energies(robot, &q, dq).iter().zip(energies(robot, &q, &rest)).map(|(h, u)| h - 2.0 * u).collect()
    };
    let derivative = |f: &dyn Fn(f64) -> Vec<f64>| -> Vec<f64> {
        let step = 1e-3;
        let [a, b, c, d] = [-2.0, -1.0, 1.0, 2.0].map(|k| f(k * step));
        (0..a.len()).map(|k| (a[k] - 8.0 * b[k] + 8.0 * c[k] - d[k]) / (12.0 * step)).collect()
    };
    derivative(&momentum).iter().zip(derivative(&lagrangian)).map(|(p, l)| p - l).collect()
}

#[test]
fn energy_power_and_rows_are_right_for_random_trees_however_they_are_derived() {
    let mut random = Random(11);
    for case in 0..250 {
        let robot = if case < 150 { random_robot(&mut random) } else { random_dependent_robot(&mut random) };
        let set = all_parameters(&robot);
        let inertial: Vec<usize> =
            (0..set.standard.len()).filter(|&k| set.standard[k].kind <= ParameterKind::M).collect();
        for (merge, compose, derivation) in [
            (true, true, Derivation::ScrewsOutward),
            (true, false, Derivation::WrenchesInward),
            (false, false, Derivation::ScrewsOutward),
        ] {
            let variant = Variant { merge, compose, derivation };
            let mut equations = Equations::derive_as(&robot, &set, variant).unwrap();
            let n = equations.idm.len();
            let mut point = random.point(n);
            point.ddq.iter_mut().for_each(|x| *x *= 0.3);
            let what = format!("case {case}, {variant:?}, {:?}", robot.frames);
            let close = |found: f64, expected: f64, tolerance: f64, k: usize| {
                let name = &set.standard[inertial[k]].name;
                let error = (found - expected).abs() / expected.abs().max(1.0);
                assert!(error < tolerance, "{name}: {found} and {expected}, {what}");
            };
            let expected = energies(&robot, &point.q, &point.dq);
            let h = equations.graph.evaluate(&equations.energy, &point);
            let dh = equations.graph.evaluate(&equations.power, &point);
            let mut power = vec![0.0; inertial.len()];
            // M ddq + N for parameters drawn at random, friction and offsets left out as the bias does.
            let moves = |k: usize| set.standard[k].kind <= ParameterKind::Ia;
            point.chi = (0..set.standard.len()).map(|k| if moves(k) { random.unit() } else { 0.0 }).collect();
            let mass = equations.graph.evaluate(&equations.mass, &point);
            let bias = equations.graph.evaluate(&equations.bias, &point);
            let torques = equations.torque.graph.evaluate(&equations.torque.torques, &point);
            for i in 0..n {
                let row = equations.graph.evaluate(&equations.idm[i], &point);
                let torque: f64 = row.iter().zip(&point.chi).map(|(w, chi)| w * chi).sum();
                let size =
                    row.iter().zip(&point.chi).fold(1.0, |most: f64, (w, chi)| most.max((w * chi).abs()));
                assert!((torques[i] - torque).abs() < 1e-12 * size, "{} {torque} {what}", torques[i]);
                let entry = |k: usize| mass[i.max(k) * (i.max(k) + 1) / 2 + i.min(k)];
                let inertial_torque: f64 = (0..n).map(|k| entry(k) * point.ddq[k]).sum();
                assert!((inertial_torque + bias[i] - torque).abs() < 1e-9 * torque.abs().max(1.0), "{what}");
                let expected = lagrange_row(&robot, [&point.q, &point.dq, &point.ddq], i);
                for (k, &column) in inertial.iter().enumerate() {
                    close(row[column], expected[k], 1e-6, k);
                    power[k] += point.dq[i] * row[column];
                }
            }
            for (k, &column) in inertial.iter().enumerate() {
                close(h[column], expected[k], 1e-11, k);
                close(dh[column], power[k], 1e-10, k);
                // What mechanics states as the derivative is what the engine derives.
                let derived = equations.graph.time_derivative(equations.energy[column]);
                close(equations.graph.evaluate(&[derived], &point)[0], dh[column], 1e-10, k);
            }
        }
    }
}

/// Torques in base parameters, however special or general the angles that were regrouped over.
#[test]
fn torques_are_the_regressor_times_the_base_parameters_of_random_trees() {
    let mut random = Random(29);
    for case in 0..160 {
        let mut robot =
            if case < 80 { random_robot(&mut random) } else { random_dependent_robot(&mut random) };
        let joints = robot.drive.gear.len();
        // Every other drive is coupled: the last motor turns with the joint before it too.
        if case % 2 == 0 && joints > 1 {
            robot.drive.gear[joints - 1][joints - 2] = 0.7;
            robot.drive.coupled_friction = vec![joints - 1];
        }
        let set = base_set(&robot);
        let equations = Equations::derive(&robot, &set).unwrap();
        for _ in 0..3 {
            let mut point = random.point(joints);
            point.chi = set.base.iter().map(|_| random.unit()).collect();
            let torques = equations.torque.graph.evaluate(&equations.torque.torques, &point);
            for (row, torque) in equations.idm.iter().zip(torques) {
                let row = equations.graph.evaluate(row, &point);
                let terms: Vec<f64> = row.iter().zip(&point.chi).map(|(w, chi)| w * chi).collect();
                let size = terms.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
                assert!(
                    (torque - terms.iter().sum::<f64>()).abs() < 1e-12 * size,
                    "case {case} {:?}",
                    robot.frames
                );
            }
        }
    }
}
