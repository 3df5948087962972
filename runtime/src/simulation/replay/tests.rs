//! A simulated TX-40 on a smooth motion.

use super::follow::{follow, left_out};
use crate::effects::{EffectKind, EffectTerm, Place, TermScale};
use crate::model::{Model, RecursiveModel, torques_at};
use crate::signal::Motion;
use crate::simulation::testing::tx40;

/// Two seconds of a smooth motion of all joints.
fn motion(joints: usize) -> Motion {
    let rate = 500.0;
    let signal = |derivative: i32| -> Vec<Vec<f64>> {
        (0..joints)
            .map(|j| {
                let w = 3.0 + j as f64;
                let phase = std::f64::consts::FRAC_PI_2 * f64::from(derivative);
                (0..1000).map(|t| 0.05 * w.powi(derivative) * (w * t as f64 / rate + phase).sin()).collect()
            })
            .collect()
    };
    Motion {
        name: "a".to_owned(),
        rate,
        start: 0.0,
        q: signal(0),
        dq: signal(1),
        ddq: signal(2),
        torque: vec![vec![0.0; 1000]; joints],
        fixed: Vec::new(),
        edge_samples: 0,
    }
}

fn inverse(model: &dyn Model, chi: &[f64], motion: &Motion, t: usize) -> Vec<f64> {
    let at = |signal: &[Vec<f64>]| signal.iter().map(|x| x[t]).collect::<Vec<f64>>();
    torques_at(model, chi, &at(&motion.q), &at(&motion.dq), &at(&motion.ddq))
}

fn place(model: &dyn Model, name: &str) -> usize {
    model.robot().base.iter().position(|b| b.name == name).expect("the robot has the parameter")
}

#[test]
fn viscous_friction_below_zero_is_simulated_as_it_was_identified() {
    let (model, standard) = tx40();
    let mut chi = model.robot().base_from_standard(&standard);
    chi[place(&model, "Fv1")] = -0.5;
    let motion = motion(6);
    let followed = follow(&model, &motion, &chi, &chi, &[]).expect("it can be simulated");
    let (torque, off) = (followed.torque, followed.tracking_error);
    assert!(off.iter().all(|x| *x < 2e-3), "{off:?}");
    // Away from the reversals of the joint, where dry friction jumps.
    let fast = (200..900).filter(|&t| motion.dq[0][t].abs() > 0.08);
    let worst = fast.map(|t| (torque[0][t] - inverse(&model, &chi, &motion, t)[0]).abs()).fold(0.0, f64::max);
    assert!(worst < 0.1, "{worst} N.m");
}

#[test]
fn errors_of_the_table_and_of_encoders_are_in_the_robot_that_follows() {
    let (model, standard) = tx40();
    let chi = model.robot().base_from_standard(&standard);
    let motion = motion(6);
    let of = |effect: EffectKind, variant: usize, amplitude: &[f64]| EffectTerm {
        effect,
        place: Place::Variant(variant),
        joints: Vec::new(),
        shape: amplitude.to_vec(),
        amplitude: amplitude.to_vec(),
        sigma: vec![0.0; amplitude.len()],
        scale: None,
        wrenches: Vec::new(),
    };
    for term in [
        of(EffectKind::PositionOffset, 1, &[-1.2]),
        of(EffectKind::BaseTilt, 0, &[0.05, -0.1]),
        of(EffectKind::GeometryError, 0, &[0.05]),
    ] {
        assert_eq!(left_out(&model, &chi, std::slice::from_ref(&term)), Vec::<String>::new());
        let there = term.corrected(model.robot()).expect("an error of the robot");
        let beyond = Motion { q: there.real_positions(&motion.q), ..motion.clone() };
        let table = RecursiveModel::new(there.robot).expect("a robot");
        let followed = follow(&model, &motion, &chi, &chi, &[term]).expect("it can be simulated");
        let (mut left, mut change) = (0.0, 0.0);
        for t in (200..900).filter(|&t| motion.dq[1][t].abs() > 0.08) {
            let truth = inverse(&table, &chi, &beyond, t)[1];
            left += (followed.torque[1][t] - truth).powi(2);
            change += (inverse(&model, &chi, &motion, t)[1] - truth).powi(2);
        }
        assert!(left < 0.01 * change, "{left} {change}");
    }
}

#[test]
fn a_drive_that_records_twice_its_torque_gives_half_of_what_it_is_told() {
    let (model, standard) = tx40();
    let chi = model.robot().base_from_standard(&standard);
    let twice = EffectTerm {
        effect: EffectKind::TorqueConstantError,
        place: Place::Joint(1),
        joints: vec![2],
        shape: Vec::new(),
        amplitude: vec![1.0],
        sigma: vec![0.0],
        scale: Some(TermScale::UNIT),
        wrenches: Vec::new(),
    };
    let motion = motion(6);
    let followed = follow(&model, &motion, &chi, &chi, &[twice]).expect("it runs");
    assert!(followed.tracking_error.iter().all(|x| *x < 0.05), "{:?}", followed.tracking_error);
    let (mut left, mut whole) = (0.0, 0.0);
    for t in (200..900).filter(|&t| motion.dq[1][t].abs() > 0.08) {
        let real = inverse(&model, &chi, &motion, t)[1];
        left += (followed.torque[1][t] - 2.0 * real).powi(2);
        whole += real * real;
    }
    assert!(left < 1e-3 * whole, "{left} {whole}");
}

#[test]
fn a_compliant_joint_that_was_found_swings_in_the_simulation() {
    let (model, standard) = tx40();
    let chi = model.robot().base_from_standard(&standard);
    let term = |stiffness: f64| EffectTerm {
        effect: EffectKind::JointElasticity,
        place: Place::Joint(1),
        joints: vec![2],
        shape: vec![10.0, 0.05, 0.5, 0.0],
        amplitude: vec![stiffness, 0.5, 0.12, 0.0],
        sigma: vec![0.0; 4],
        scale: Some(TermScale::UNIT),
        wrenches: Vec::new(),
    };
    let motion = motion(6);
    let run = |terms: &[EffectTerm]| follow(&model, &motion, &chi, &chi, terms).expect("it runs").torque;
    let (rigid, stiff, soft) = (run(&[]), run(&[term(1e4)]), run(&[term(10.0)]));
    let apart = |a: &[Vec<f64>]| (200..900).map(|t| (a[1][t] - rigid[1][t]).powi(2)).sum::<f64>().sqrt();
    assert!(apart(&soft) > 10.0 * apart(&stiff), "{} {}", apart(&soft), apart(&stiff));
    assert_eq!(left_out(&model, &chi, &[term(10.0)]), Vec::<String>::new());
}
