#![allow(clippy::unwrap_used)]
//! Small robots for the tests of this module.

use crate::model::{Drive, Frame, JointKind, Limits, ParameterKind, RecursiveModel, Robot};
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

/// Random q, dq, ddq of n joints.
pub fn random_state(n: usize, random: &mut rand_pcg::Pcg64) -> [Vec<f64>; 3] {
    [2.0, 3.0, 20.0].map(|size| (0..n).map(|_| random.random_range(-size..size)).collect())
}
