#![allow(clippy::unwrap_used)]
use super::*;
use crate::estimation::physical::pseudo_inertia::pseudo_inertia;
use crate::model::{Drive, Frame, JointKind, Limits};

/// An upright arm of two joints with a motor each, its standard parameters as base parameters grouped by `groups`.
fn arm() -> Robot {
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
fn rod(mass: f64, length: f64) -> [f64; 10] {
    let (thick, long) = (mass * 1e-3, mass * length * length / 3.0);
    [2.0 * thick, 0.0, 0.0, long + thick, 0.0, long + thick, 0.5 * mass * length, 0.0, 0.0, mass]
}

fn prior() -> Prior {
    Prior {
        bodies: vec![Some(rod(6.0, 0.4)), Some(rod(3.0, 0.3))],
        attached: vec![[0.0; 10]; 2],
        rotors: vec![None, None],
    }
}

/// Standard parameters of two rods, rotors and friction.
fn standard(robot: &Robot, rods: [[f64; 10]; 2]) -> Vec<f64> {
    let value =
        |p: &crate::model::StandardParameter| match ParameterKind::INERTIAL.iter().position(|k| *k == p.kind)
        {
            Some(place) => rods[p.frame][place],
            None if p.kind == ParameterKind::Ia => 0.3,
            None => 1.0,
        };
    robot.standard.iter().map(value).collect()
}

fn sigmas(chi: &[f64], relative: f64) -> DMatrix<f64> {
    DMatrix::from_fn(chi.len(), chi.len(), |i, k| {
        if i == k { (relative * (0.1 + chi[k].abs())).powi(2) } else { 0.0 }
    })
}

fn is_body(near: &NearPrior, frame: usize) -> bool {
    let link: [usize; 10] = std::array::from_fn(|k| 14 * frame + k);
    nalgebra::Cholesky::new(pseudo_inertia(&link, &DVector::from_column_slice(&near.standard))).is_some()
}

#[test]
fn a_prior_that_agrees_with_the_data_is_kept() {
    let robot = arm();
    let truth = standard(&robot, [rod(6.0, 0.4), rod(3.0, 0.3)]);
    let chi = robot.base_from_standard(&truth);
    let near = near_prior(&robot, &chi, &sigmas(&chi, 0.02), &prior()).unwrap();
    assert!(near.distance <= near.determined as f64 + 1e-6, "{near:?}");
    for frame in 0..2 {
        for k in 0..10 {
            let at = 14 * frame + k;
            assert!((near.standard[at] - truth[at]).abs() < 0.05 * (0.1 + truth[at].abs()), "{k} of {frame}");
        }
    }
}

#[test]
fn what_the_data_determine_is_the_data_s_and_every_body_has_a_density() {
    let robot = arm();
    let truth = standard(&robot, [rod(9.0, 0.5), rod(1.5, 0.25)]);
    let chi = robot.base_from_standard(&truth);
    let near = near_prior(&robot, &chi, &sigmas(&chi, 1e-4), &prior()).unwrap();
    assert!(near.least < 0.1 && near.distance <= near.determined as f64 + 0.2, "{near:?}");
    for (own, wanted) in near.chi.iter().zip(&chi) {
        assert!((own - wanted).abs() < 1e-3 * (0.1 + wanted.abs()), "{:?} {chi:?}", near.chi);
    }
    assert!(is_body(&near, 0) && is_body(&near, 1));
    let share = |name: &str| near.from_data[robot.standard.iter().position(|p| p.name == name).unwrap()];
    assert!(share("MX2") > 0.99 && share("ZZ2") > 0.99 && share("M1") < 0.5, "{near:?}");
}

#[test]
fn values_that_no_body_has_are_told_by_their_distance() {
    let robot = arm();
    let truth = standard(&robot, [rod(6.0, 0.4), rod(3.0, 0.3)]);
    let mut chi = robot.base_from_standard(&truth);
    // A weight without inertia.
    chi[robot.base.iter().position(|b| b.name == "ZZ2").unwrap()] = -0.2;
    let near = near_prior(&robot, &chi, &sigmas(&chi, 0.01), &prior()).unwrap();
    assert!(near.least > 10.0 * near.determined as f64, "{near:?}");
    assert!(is_body(&near, 0) && is_body(&near, 1));
}

#[test]
fn what_is_attached_stays_part_of_the_body() {
    let robot = arm();
    let truth = standard(&robot, [rod(6.0, 0.4), rod(3.0, 0.3)]);
    let chi = robot.base_from_standard(&truth);
    let tool = rod(1.0, 0.3);
    let bodies = vec![Some(rod(6.0, 0.4)), Some(rod(1.0, 0.3))];
    let prior = Prior { bodies, attached: vec![[0.0; 10], tool], rotors: vec![Some(0.3); 2] };
    let near = near_prior(&robot, &chi, &sigmas(&chi, 1e-3), &prior).unwrap();
    let own: [f64; 10] = std::array::from_fn(|k| near.standard[14 + k] - tool[k]);
    let link: [usize; 10] = std::array::from_fn(|k| k);
    assert!(nalgebra::Cholesky::new(pseudo_inertia(&link, &DVector::from_column_slice(&own))).is_some());
    assert!(near.least < 0.1 && near.distance <= near.determined as f64 + 0.2, "{near:?}");
}

#[test]
fn arguments_that_do_not_belong_together_are_refused() {
    let robot = arm();
    let truth = standard(&robot, [rod(6.0, 0.4), rod(3.0, 0.3)]);
    let chi = robot.base_from_standard(&truth);
    let covariance = sigmas(&chi, 0.01);
    assert_eq!(near_prior(&robot, &chi[1..], &covariance, &prior()), Err(NearPriorError::Shape));
    assert_eq!(near_prior(&robot, &chi, &(&covariance * 0.0), &prior()), Err(NearPriorError::NoInformation));
    let mut flat = prior();
    flat.bodies[1] = Some([0.0; 10]);
    assert_eq!(near_prior(&robot, &chi, &covariance, &flat), Err(NearPriorError::Prior(1)));
}
