#![allow(clippy::unwrap_used)]
//! Small robots for the tests of this module. Equation numbers are those of Gautier and Briot.

use crate::model::{Drive, Frame, JointKind, Limits, ParameterKind, RecursiveModel, Robot};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};

fn frame(kind: JointKind, alpha: f64, d: f64, r: f64, parent: Option<usize>) -> Frame {
    Frame { parent, kind, gamma: 0.0, b: 0.0, alpha, d, theta: 0.0, r }
}

fn model(gravity: [f64; 3], frames: Vec<Frame>, gear: Vec<f64>, coupled: Vec<usize>) -> RecursiveModel {
    let drive = Drive { gear: gear.into(), coupled_friction: coupled.into() };
    RecursiveModel::new(Robot::with_standard_as_base("test", gravity, frames, drive, Limits::default()))
        .unwrap()
}

fn parameters(model: &RecursiveModel, values: &[(&str, f64)]) -> Vec<f64> {
    use crate::model::Model;
    let mut chi = vec![0.0; model.robot().standard.len()];
    for (name, value) in values {
        chi[model.robot().standard.iter().position(|p| p.name == *name).unwrap()] = *value;
    }
    chi
}

/// One link about a horizontal axis; its gravity torque is `ml`·9.81·sin(q), hanging down at q = 0.
pub fn pendulum(ml: f64, zz: f64, coulomb: f64, viscous: f64) -> (RecursiveModel, Vec<f64>) {
    let frames = vec![frame(JointKind::Revolute, 0.0, 0.0, 0.0, None)];
    let model = model([9.81, 0.0, 0.0], frames, vec![1.0], vec![]);
    let values = [("MX1", ml), ("ZZ1", zz), ("Fc1", coulomb), ("Fv1", viscous)];
    let chi = parameters(&model, &values);
    (model, chi)
}

/// Two axes of which the second motor turns with dq1 + dq2; no gravity.
pub fn wrist(fc1: f64, fc2: f64, fcm2: f64) -> (RecursiveModel, Vec<f64>) {
    let frames = vec![
        frame(JointKind::Revolute, 0.0, 0.0, 0.0, None),
        frame(JointKind::Revolute, 1.0, 0.0, 0.0, Some(0)),
    ];
    let model = model([0.0; 3], frames, vec![45.0, 0.0, 32.0, 32.0], vec![1]);
    let values = [
        ("ZZ1", 0.3),
        ("ZZ2", 0.1),
        ("XX2", 0.1),
        ("YY2", 0.1),
        ("Fc1", fc1),
        ("Fc2", fc2),
        ("Fcm2", fcm2),
        ("Ia2", 0.05),
        ("Ia1", 0.1),
    ];
    let chi = parameters(&model, &values);
    (model, chi)
}

/// A branched arm with a prismatic axis, a fixed frame, coupled motors, friction and offsets; its standard
/// parameters belong to real bodies.
pub fn arm() -> (RecursiveModel, Vec<f64>) {
    use crate::model::Model;
    use JointKind::{Fixed, Prismatic, Revolute};
    let frames = vec![
        frame(Revolute, 0.3, 0.1, 0.4, None),
        frame(Prismatic, -1.1, 0.2, 0.1, Some(0)),
        frame(Revolute, 0.8, 0.3, 0.2, Some(1)),
        frame(Fixed, 0.4, 0.1, 0.3, Some(2)),
        frame(Revolute, 1.2, 0.25, 0.2, Some(0)),
        frame(Revolute, -0.7, 0.1, 0.2, Some(4)),
    ];
    let mut gear = vec![0.0; 25];
    for (k, ratio) in [30.0, 200.0, 40.0, 45.0, 32.0].into_iter().enumerate() {
        gear[6 * k] = ratio;
    }
    gear[23] = 32.0;
    let model = model([0.0, 0.0, -9.81], frames, gear, vec![4]);
    let mut random = rand_pcg::Pcg64::seed_from_u64(11);
    let mut standard = vec![0.0; model.robot().standard.len()];
    let robot = model.robot();
    for f in 0..robot.frames.len() {
        let mass = random.random_range(0.5..4.0);
        let center: [f64; 3] = std::array::from_fn(|_| random.random_range(-0.15..0.15));
        let own: [f64; 3] = std::array::from_fn(|_| random.random_range(0.02..0.03));
        let [x, y, z] = center;
        for (p, value) in robot.standard.iter().zip(&mut standard).filter(|(p, _)| p.frame == f) {
            *value = match p.kind {
                ParameterKind::XX => own[0] + mass * (y * y + z * z),
                ParameterKind::YY => own[1] + mass * (x * x + z * z),
                ParameterKind::ZZ => own[2] + mass * (x * x + y * y),
                ParameterKind::XY => -mass * x * y,
                ParameterKind::XZ => -mass * x * z,
                ParameterKind::YZ => -mass * y * z,
                ParameterKind::MX => mass * x,
                ParameterKind::MY => mass * y,
                ParameterKind::MZ => mass * z,
                ParameterKind::M => mass,
                // The rotor of the last motor is part of the Ia of the joint before: (26).
                ParameterKind::Ia => random.random_range(0.05..0.2) + if f == 4 { 0.2 } else { 0.0 },
                ParameterKind::Off => random.random_range(-0.5..0.5),
                _ => random.random_range(0.5..2.0),
            };
        }
    }
    (model, standard)
}

/// [`arm`] with friction between its links and two springs.
pub fn tethered_arm() -> (RecursiveModel, Vec<f64>) {
    use crate::model::{Coupling, CouplingLaw, Model};
    let (model, mut standard) = arm();
    let coupling = |name: &'static str, terms: &[(usize, f64)], law| Coupling {
        name: name.into(),
        terms: terms.to_vec().into(),
        law,
    };
    let couplings = vec![
        coupling("_belt", &[(2, 1.0), (4, -0.5)], CouplingLaw::Friction),
        coupling("1", &[(0, 1.0)], CouplingLaw::Spring),
        coupling("_hose", &[(0, 0.1), (1, 1.0), (3, -0.2)], CouplingLaw::SpringAt(0.4)),
    ];
    let robot = model.robot().clone().with_couplings(couplings);
    // Fvc, Fcc, K and KR, and K.
    standard.extend([1.5, 2.0, 30.0, 12.0, 150.0]);
    (RecursiveModel::new(robot).unwrap(), standard)
}

/// Random q, dq, ddq of n joints.
pub fn random_state(n: usize, random: &mut rand_pcg::Pcg64) -> [Vec<f64>; 3] {
    [2.0, 3.0, 20.0].map(|size| (0..n).map(|_| random.random_range(-size..size)).collect())
}

/// The robot with only the independent columns of its regressor kept, found numerically: each column that depends
/// on those before it is regrouped into them. An oracle of its own, for tests that need a small base.
pub fn with_numeric_base(robot: &Robot) -> Robot {
    use crate::model::{BaseParameter, Model};
    let model = RecursiveModel::new(robot.clone()).unwrap();
    let (n, columns) = (robot.joints(), robot.standard.len());
    let pattern = model.pattern();
    let mut random = rand_pcg::Pcg64::seed_from_u64(1);
    let states = 3 * columns / n + 10;
    let mut w = DMatrix::<f64>::zeros(states * n, columns);
    let mut entries = vec![0.0; pattern.columns.len()];
    for s in 0..states {
        let [q, dq, ddq] = random_state(n, &mut random);
        model.idm(&q, &dq, &ddq, &mut entries);
        for i in 0..n {
            for e in pattern.rows[i]..pattern.rows[i + 1] {
                w[(s * n + i, pattern.columns[e])] = entries[e];
            }
        }
    }
    let (kept, dropped) = independent_columns(&w);
    let small = DMatrix::from_columns(&kept.iter().map(|&c| w.column(c)).collect::<Vec<_>>());
    let svd = small.svd(true, true);
    let mut combinations: Vec<Vec<(usize, f64)>> = kept.iter().map(|&c| vec![(c, 1.0)]).collect();
    for c in dropped {
        let x = svd.solve(&w.column(c), 1e-12).unwrap();
        for (k, &value) in x.iter().enumerate() {
            if value.abs() > 1e-9 {
                combinations[k].push((c, value));
            }
        }
    }
    let mut robot = robot.clone();
    robot.base = kept
        .iter()
        .zip(combinations)
        .map(|(&c, mut combination)| {
            combination.sort_by_key(|x| x.0);
            let regrouped = if combination.len() > 1 { "R" } else { "" };
            BaseParameter {
                name: format!("{}{regrouped}", robot.standard[c].name).into(),
                standard: c,
                combination: combination.into(),
                relation: "".into(),
                unit: "".into(),
            }
        })
        .collect::<Vec<_>>()
        .into();
    robot
}

/// The columns that do not depend on those before them, and the others.
fn independent_columns(w: &DMatrix<f64>) -> (Vec<usize>, Vec<usize>) {
    let mut kept: Vec<usize> = Vec::new();
    let mut basis: Vec<DVector<f64>> = Vec::new();
    let mut dropped = Vec::new();
    for c in 0..w.ncols() {
        let mut rest: DVector<f64> = w.column(c).into();
        let size = rest.norm();
        for _ in 0..2 {
            for b in &basis {
                rest -= b * b.dot(&rest);
            }
        }
        if rest.norm() > 1e-9 * size.max(1e-9) {
            basis.push(&rest / rest.norm());
            kept.push(c);
        } else {
            dropped.push(c);
        }
    }
    (kept, dropped)
}

/// The TX-40 of Table I without payload, with parameters of published order, limits, gains and noise.
pub fn tx40() -> (RecursiveModel, Vec<f64>) {
    use crate::model::Nominal;
    use JointKind::Revolute;
    let half = std::f64::consts::FRAC_PI_2;
    let mut frames = vec![
        frame(Revolute, 0.0, 0.0, 0.0, None),
        frame(Revolute, -half, 0.0, 0.0, Some(0)),
        frame(Revolute, 0.0, 0.225, 0.035, Some(1)),
        frame(Revolute, half, 0.0, 0.225, Some(2)),
        frame(Revolute, -half, 0.0, 0.0, Some(3)),
        frame(Revolute, half, 0.0, 0.0, Some(4)),
    ];
    frames[1].theta = -half;
    frames[2].theta = half;
    let mut gear = vec![0.0; 36];
    for (k, ratio) in [32.0, 32.0, 45.0, -48.0, 45.0, 32.0].into_iter().enumerate() {
        gear[7 * k] = ratio;
    }
    gear[34] = 32.0;
    let drive = Drive { gear: gear.into(), coupled_friction: vec![5].into() };
    let mut robot = Robot::with_standard_as_base("tx40", [0.0, 0.0, -9.81], frames, drive, Limits::default());
    let values = [
        ("XX", [0.424, 0.0443, 0.0397, 0.147, 0.001, 0.0035]),
        ("YY", [0.424, 0.14, 0.0398, 0.146, 0.001, 0.0035]),
        ("ZZ", [0.352, 0.124, 0.0046, 0.0042, 0.001, 0.00035]),
        ("MX", [0.0, 0.392, 0.0326, 0.0145, 0.0, 0.0]),
        ("MY", [0.0, -0.0072, 0.0244, -0.00724, -0.00306, 0.0]),
        ("MZ", [-0.43, 0.162, 0.265, -0.369, -0.00102, 0.00168]),
        ("M", [8.61, 4.85, 4.07, 3.62, 1.02, 0.2]),
        ("Ia", [0.362, 0.507, 0.0829, 0.0341, 0.0361, 0.0114]),
        ("Fv", [7.94, 5.69, 1.98, 1.11, 1.6, 0.69]),
        ("Fc", [6.98, 7.83, 6.19, 2.41, 3.41, 1.83]),
        ("Fvm", [0.0, 0.0, 0.0, 0.0, 0.0, 0.7]),
        ("Fcm", [0.0, 0.0, 0.0, 0.0, 0.0, 1.7]),
    ];
    let mut standard = vec![0.0; robot.standard.len()];
    for (p, value) in robot.standard.iter().zip(&mut standard) {
        let letters = p.name.trim_end_matches(|c: char| c.is_ascii_digit());
        if let Some((_, list)) = values.iter().find(|(name, _)| *name == letters) {
            *value = list[p.frame];
        }
    }
    let degrees = |list: [f64; 6]| -> Vec<[f64; 2]> {
        list.iter().map(|x| [-x.to_radians(), x.to_radians()]).collect()
    };
    robot.limits = Limits {
        position: degrees([180.0, 125.0, 138.0, 270.0, 120.0, 270.0]).into(),
        velocity: degrees([287.0, 287.0, 430.0, 410.0, 320.0, 700.0]).into(),
        acceleration: vec![[-50.0, 50.0]; 6].into(),
        torque: [150.0, 180.0, 80.0, 35.0, 35.0, 20.0].map(|x| [-x, x]).to_vec().into(),
    };
    robot.nominal = Some(Nominal {
        standard: standard.clone().into(),
        kp: vec![9000.0, 9000.0, 2200.0, 500.0, 350.0, 150.0].into(),
        kd: vec![260.0, 260.0, 65.0, 15.0, 10.0, 4.5].into(),
        ki: vec![].into(),
        position_noise: [0.057, 0.057, 0.122, 0.114, 0.122, 0.172]
            .map(|x: f64| (x * 1e-3).to_radians())
            .to_vec()
            .into(),
        torque_noise: vec![0.6, 0.6, 0.3, 0.1, 0.1, 0.08].into(),
    });
    let model = RecursiveModel::new(with_numeric_base(&robot)).unwrap();
    (model, standard)
}
