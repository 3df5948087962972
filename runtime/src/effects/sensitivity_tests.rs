//! Columns of sensitivities against differences of a changed robot.
#![allow(clippy::unwrap_used)]

use super::*;
use crate::model::{
    BaseParameter, DependentFrame, Drive, Frame, JointKind, Limits, RecursiveModel, Robot,
    standard_parameters, torques_at,
};
use std::borrow::Cow;

fn arm() -> Robot {
    let row = |parent, alpha, d, r| Frame {
        parent,
        kind: JointKind::Revolute,
        gamma: 0.0,
        b: 0.0,
        alpha,
        d,
        theta: 0.0,
        r,
    };
    let frames = vec![
        row(None, 0.0, 0.0, 0.3),
        row(Some(0), -std::f64::consts::FRAC_PI_2, 0.1, 0.0),
        row(Some(1), 0.0, 0.4, 0.05),
    ];
    let standard = standard_parameters(&frames, &[], &[]);
    let base = standard
        .iter()
        .enumerate()
        .map(|(k, p)| BaseParameter {
            name: p.name.clone(),
            standard: k,
            combination: Cow::Owned(vec![(k, 1.0)]),
            relation: p.name.clone(),
            unit: Cow::Borrowed("1"),
        })
        .collect();
    Robot {
        name: "arm".into(),
        description: "three axes".into(),
        gravity: [0.0, 0.0, -9.81],
        frames: frames.into(),
        dependent: Vec::new().into(),
        drive: Drive {
            gear: vec![1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 1.0].into(),
            coupled_friction: vec![].into(),
        },
        couplings: Vec::new().into(),
        known: Vec::new().into(),
        fixed: Vec::new().into(),
        ellipsoids: Vec::new().into(),
        limits: Limits::default(),
        standard: standard.into(),
        base: Cow::Owned(base),
        nominal: None,
    }
}

fn torque(robot: &Robot, chi: &[f64], q: &[f64], dq: &[f64], ddq: &[f64]) -> Vec<f64> {
    torques_at(&RecursiveModel::new(robot.clone()).unwrap(), chi, q, dq, ddq)
}

/// The third frame turns with q2 and q3 apart, as on a parallelogram; the second turns the other way.
fn arm_with_bars() -> Robot {
    let bar = |frame, terms: Vec<(usize, f64)>| DependentFrame {
        frame,
        kind: JointKind::Revolute,
        terms: terms.into(),
    };
    Robot {
        dependent: vec![bar(1, vec![(1, -1.0)]), bar(2, vec![(0, 1.0), (1, -1.0), (2, 2.0)])].into(),
        ..arm()
    }
}

#[test]
fn columns_agree_with_differences_of_a_changed_robot() {
    columns_agree_with_differences(&arm());
    columns_agree_with_differences(&arm_with_bars());
}

fn columns_agree_with_differences(robot: &Robot) {
    let model = derivable(robot).unwrap();
    let chi: Vec<f64> = (0..robot.base.len()).map(|k| 0.3 + (k as f64 * 0.7).sin()).collect();
    let (q, dq, ddq, jerk) = ([0.3, -0.8, 1.1], [0.9, -1.4, 0.6], [2.0, 1.0, -3.0], [5.0, -7.0, 4.0]);
    let wrap = |x: [f64; 3]| x.iter().map(|&v| vec![v]).collect::<Vec<_>>();
    let states = [wrap(q), wrap(dq), wrap(ddq), wrap(jerk)];
    let h = 1e-6;
    for kind in EffectKind::ALL {
        let Form::Sensitivity(effect) = kind.form() else { continue };
        for variant in effect.variants(robot) {
            let mut out = vec![Vec::new(); 3];
            let signals = [&states[0], &states[1], &states[2], &states[3]].map(Vec::as_slice);
            let alone = Direction { effect, variants: &[variant], which: 0, at: &[] };
            derivative(&model, robot.gravity, &chi, &alone, signals, &mut out);
            let moved = |e: f64| {
                let mut robot = robot.clone();
                let (mut q, mut dq, mut ddq) = (q, dq, ddq);
                match kind {
                    EffectKind::PositionOffset => q[variant.index] += e,
                    EffectKind::WrongSampleRate => {
                        dq = dq.map(|x| x * (1.0 + e));
                        ddq = ddq.map(|x| x * (1.0 + e) * (1.0 + e));
                    }
                    EffectKind::TimeDelay => {
                        for j in 0..3 {
                            q[j] -= e * dq[j];
                            dq[j] -= e * ddq[j];
                            ddq[j] -= e * jerk[j];
                        }
                    }
                    EffectKind::GeometryError => {
                        let row = &mut robot.frames.to_mut()[variant.index / 2];
                        if variant.index.is_multiple_of(2) { row.d += e } else { row.r += e }
                    }
                    EffectKind::BaseTilt => {
                        let axis = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]][variant.index];
                        robot.gravity[0] += e * axis[1] * -9.81;
                        robot.gravity[1] -= e * axis[0] * -9.81;
                    }
                    other => panic!("what does a robot do in which the number of {other:?} is wrong?"),
                }
                torque(&robot, &chi, &q, &dq, &ddq)
            };
            let (plus, minus) = (moved(h), moved(-h));
            for j in 0..3 {
                let expected = (plus[j] - minus[j]) / (2.0 * h);
                assert!(
                    (out[j][0] - expected).abs() < 1e-6,
                    "{kind:?} {variant:?} {j}: {} {expected}",
                    out[j][0]
                );
            }
        }
    }
}

#[test]
fn means_along_the_path_add_up_to_the_whole_change_of_a_large_error() {
    let robot = arm();
    let model = derivable(&robot).unwrap();
    let chi: Vec<f64> = (0..robot.base.len()).map(|k| 0.3 + (k as f64 * 0.7).sin()).collect();
    let (q, dq, ddq) = ([0.3, -0.8, 1.1], [0.9, -1.4, 0.6], [2.0, 1.0, -3.0]);
    let wrap = |x: [f64; 3]| x.iter().map(|&v| vec![v]).collect::<Vec<_>>();
    let states = [wrap(q), wrap(dq), wrap(ddq), wrap([0.0; 3])];
    let signals = [&states[0], &states[1], &states[2], &states[3]].map(Vec::as_slice);
    let whole = |kind: EffectKind, at: &[f64]| {
        let Form::Sensitivity(effect) = kind.form() else { return vec![0.0; 3] };
        let variants = effect.variants(&robot);
        let variants = if effect.together() { &variants[..] } else { &variants[1..2] };
        let mut sum = vec![0.0; 3];
        for (which, e) in at.iter().enumerate() {
            let mut out = vec![Vec::new(); 3];
            let direction = Direction { effect, variants, which, at };
            derivative(&model, robot.gravity, &chi, &direction, signals, &mut out);
            sum.iter_mut().zip(&out).for_each(|(s, o)| *s += e * o[0]);
        }
        sum
    };
    let before = torque(&robot, &chi, &q, &dq, &ddq);
    let close = |found: Vec<f64>, after: Vec<f64>| {
        let change: Vec<f64> = after.iter().zip(&before).map(|(a, b)| a - b).collect();
        let size = change.iter().map(|x| x * x).sum::<f64>().sqrt();
        for (f, c) in found.iter().zip(&change) {
            assert!((f - c).abs() < 0.01 * size, "{found:?} {change:?}");
        }
    };
    close(whole(EffectKind::PositionOffset, &[0.4]), torque(&robot, &chi, &[0.3, -0.4, 1.1], &dq, &ddq));
    close(whole(EffectKind::PositionOffset, &[-2.9]), torque(&robot, &chi, &[0.3, -3.7, 1.1], &dq, &ddq));
    let (x, y) = (0.15, -0.2);
    let angle = f64::hypot(x, y);
    let axis = [x / angle, y / angle];
    let mut tilted = robot.clone();
    tilted.gravity = [axis[1], -axis[0], 0.0].map(|u| u * -9.81 * angle.sin());
    tilted.gravity[2] = -9.81 * angle.cos();
    close(whole(EffectKind::BaseTilt, &[x, y]), torque(&tilted, &chi, &q, &dq, &ddq));
}

#[test]
fn a_corrected_robot_is_where_the_way_of_its_errors_ends() {
    let robot = arm();
    let with = |effect: EffectKind, variant: usize, amplitude: &[f64]| {
        let term = EffectTerm {
            effect,
            place: Place::Variant(variant),
            joints: Vec::new(),
            shape: Vec::new(),
            amplitude: amplitude.to_vec(),
            sigma: vec![0.0; amplitude.len()],
            scale: None,
            wrenches: Vec::new(),
        };
        term.corrected(&robot)
    };
    let off = with(EffectKind::PositionOffset, 1, &[0.7]).unwrap();
    assert_eq!((off.robot.gravity, off.robot.frames), (robot.gravity, robot.frames.clone()));
    assert!((off.beyond_encoder[1] - 0.7).abs() < 1e-12 && off.beyond_encoder[0] == 0.0);
    let tilted = with(EffectKind::BaseTilt, 0, &[0.3, 0.0]).unwrap().robot.gravity;
    let expected = [0.0, 9.81 * 0.3_f64.sin(), -9.81 * 0.3_f64.cos()];
    assert!(tilted.iter().zip(expected).all(|(g, e)| (g - e).abs() < 0.02), "{tilted:?} {expected:?}");
    let longer = with(EffectKind::GeometryError, 0, &[0.02]).unwrap().robot;
    let change = |of: fn(&Frame) -> f64| -> f64 {
        longer.frames.iter().zip(robot.frames.iter()).map(|(a, b)| of(a) - of(b)).sum()
    };
    assert!((change(|f| f.d) + change(|f| f.r) - 0.02).abs() < 1e-12);
    // Of a recording nothing is in the robot.
    assert!(with(EffectKind::TimeDelay, 0, &[0.01]).is_none());
    assert!(with(EffectKind::WrongSampleRate, 0, &[0.5]).is_none());
}
