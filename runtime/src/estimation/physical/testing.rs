#![allow(clippy::unwrap_used)]
//! A planar arm, and priors of its bodies.

use super::prior::Prior;
use crate::model::{Drive, Frame, JointKind, Limits, ParameterKind, Robot};
use nalgebra::DMatrix;

/// An upright arm of two joints with a motor each, its standard parameters as base parameters grouped by `groups`.
pub fn arm() -> Robot {
    let shoulder = Frame::on_base(JointKind::Revolute);
    let elbow = Frame { parent: Some(0), d: 0.4, ..shoulder };
    let drive = Drive { gear: vec![50.0, 0.0, 0.0, 50.0].into(), coupled_friction: vec![].into() };
    let mut robot = Robot::with_standard_as_base(
        "arm",
        [0.0, -9.81, 0.0],
        vec![shoulder, elbow],
        drive,
        Limits::default(),
    );
    // What a planar arm shows: ZZ1 + Ia1 + d2² M2, MX1 + d2 M2, MY1, ZZ2, MX2, MY2, Ia2, and friction.
    let k = |name: &str| robot.standard.iter().position(|p| p.name == name).unwrap();
    let (zz1, ia1, m2, mx1) = (k("ZZ1"), k("Ia1"), k("M2"), k("MX1"));
    let kept = ["ZZ1", "MX1", "MY1", "ZZ2", "MX2", "MY2", "Ia2", "Fv1", "Fc1", "Fv2", "Fc2", "off1", "off2"];
    let mut base: Vec<_> = robot.base.iter().filter(|b| kept.contains(&b.name.as_ref())).cloned().collect();
    for b in &mut base {
        match b.name.as_ref() {
            "ZZ1" => b.combination = vec![(zz1, 1.0), (ia1, 1.0), (m2, 0.16)].into(),
            "MX1" => b.combination = vec![(mx1, 1.0), (m2, 0.4)].into(),
            _ => {}
        }
    }
    robot.base = base.into();
    robot
}

/// A solid cylinder along x, `mass` kg and `length` m long.
pub fn rod(mass: f64, length: f64) -> [f64; 10] {
    let (thick, long) = (mass * 1e-3, mass * length * length / 3.0);
    [2.0 * thick, 0.0, 0.0, long + thick, 0.0, long + thick, 0.5 * mass * length, 0.0, 0.0, mass]
}

pub fn prior() -> Prior {
    Prior {
        bodies: vec![Some(rod(6.0, 0.4)), Some(rod(3.0, 0.3))],
        attached: vec![[0.0; 10]; 2],
        rotors: vec![None, None],
        ellipsoids: vec![None; 2],
    }
}

/// Standard parameters of two rods, rotors and friction.
pub fn standard(robot: &Robot, rods: [[f64; 10]; 2]) -> Vec<f64> {
    let value =
        |p: &crate::model::StandardParameter| match ParameterKind::INERTIAL.iter().position(|k| *k == p.kind)
        {
            Some(place) => rods[p.frame][place],
            None if p.kind == ParameterKind::Ia => 0.3,
            None => 1.0,
        };
    robot.standard.iter().map(value).collect()
}

pub fn sigmas(chi: &[f64], relative: f64) -> DMatrix<f64> {
    DMatrix::from_fn(chi.len(), chi.len(), |i, k| {
        if i == k { (relative * (0.1 + chi[k].abs())).powi(2) } else { 0.0 }
    })
}
