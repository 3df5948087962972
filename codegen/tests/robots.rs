//! The robots of `robots/` are what the references say they are.
#![allow(clippy::unwrap_used)]

mod shipped;

use dynid_description::JointKind;
use shipped::{robots, workspace};
use std::io::Write as _;

#[test]
fn every_robot_reads_and_is_called_like_its_file() {
    let names: Vec<String> = robots().into_iter().map(|robot| robot.name).collect();
    let expected = [
        "branched",
        "cobot6",
        "palletiser",
        "panda",
        "parallelogram6",
        "planar_2r",
        "puma560",
        "scara4",
        "stanford",
        "tx40",
        "ur10e",
    ];
    assert_eq!(names, expected);
}

#[test]
fn the_tables_are_those_of_the_independent_reference() {
    let path = workspace().join("../shared/reference/regressors.json");
    let Ok(text) = std::fs::read(&path) else {
        let _ = writeln!(std::io::stderr(), "skipped: {} is not there", path.display());
        return;
    };
    let reference: serde_json::Value = serde_json::from_slice(&text).unwrap();
    let mut compared = 0;
    for robot in robots() {
        let Some(expected) = reference.get(&robot.name) else { continue };
        compared += 1;
        let gravity: Vec<f64> = serde_json::from_value(expected["gravity"].clone()).unwrap();
        assert_eq!(robot.gravity.to_vec(), gravity, "{}", robot.name);
        let rows: Vec<Vec<f64>> = serde_json::from_value(expected["mdh"].clone()).unwrap();
        // The reference has no payload frames.
        let frames: Vec<_> = robot.frames.iter().filter(|f| f.kind != JointKind::Fixed).collect();
        assert_eq!(frames.len(), rows.len(), "{}", robot.name);
        for (frame, row) in frames.iter().zip(&rows) {
            let sigma = if frame.kind == JointKind::Revolute { 0.0 } else { 1.0 };
            let ours = [sigma, frame.alpha.value(), frame.d.value(), frame.theta.value(), frame.r.value()];
            assert_eq!(ours.to_vec(), *row, "{} frame {}", robot.name, frame.j);
            assert_eq!(frame.parent, frame.j - 1);
            assert_eq!([frame.gamma.value(), frame.b.value()], [0.0, 0.0]);
        }
    }
    assert_eq!(compared, 7);
}

#[test]
fn every_robot_has_limits_and_nominal_values_for_every_joint() {
    for robot in robots() {
        let n = robot.joint_frames().len();
        let limits = &robot.limits;
        for ranges in [&limits.position, &limits.velocity, &limits.acceleration, &limits.torque] {
            assert_eq!(ranges.len(), n, "{}", robot.name);
        }
        let nominal = robot.nominal.as_ref().unwrap();
        for list in [&nominal.kp, &nominal.kd, &nominal.ki, &nominal.position_noise, &nominal.torque_noise] {
            assert_eq!(list.len(), n, "{}", robot.name);
        }
    }
}

/// A link is a real body when the matrix [[tr(J)/2 - J, MS], [MS^T, M]] is positive definite (Wensing, Kim, Slotine
/// 2018). A fixed frame may carry nothing at all.
#[test]
fn nominal_links_are_bodies_that_can_exist() {
    for robot in robots() {
        let nominal = robot.nominal.as_ref().unwrap();
        let get = |kind: &str, j: usize| {
            let name = format!("{kind}{j}");
            nominal.standard.iter().find(|(known, _)| *known == name).map_or(0.0, |(_, value)| *value)
        };
        for frame in &robot.frames {
            let g = |kind: &str| get(kind, frame.j);
            let inertia = nalgebra::Matrix3::new(
                g("XX"),
                g("XY"),
                g("XZ"),
                g("XY"),
                g("YY"),
                g("YZ"),
                g("XZ"),
                g("YZ"),
                g("ZZ"),
            );
            let first = nalgebra::Vector3::new(g("MX"), g("MY"), g("MZ"));
            let nothing = g("M") == 0.0 && first.norm() == 0.0 && inertia.norm() == 0.0;
            if frame.kind == JointKind::Fixed && nothing {
                continue;
            }
            let mut pseudo = nalgebra::Matrix4::zeros();
            let spread = nalgebra::Matrix3::identity() * (inertia.trace() / 2.0) - inertia;
            pseudo.fixed_view_mut::<3, 3>(0, 0).copy_from(&spread);
            pseudo.fixed_view_mut::<3, 1>(0, 3).copy_from(&first);
            pseudo.fixed_view_mut::<1, 3>(3, 0).copy_from(&first.transpose());
            pseudo[(3, 3)] = g("M");
            assert!(pseudo.cholesky().is_some(), "{} link {}: {pseudo}", robot.name, frame.j);
            for kind in ["Ia", "Fv", "Fc", "Fvm", "Fcm"] {
                assert!(g(kind) >= 0.0, "{} {kind}{}", robot.name, frame.j);
            }
        }
    }
}
