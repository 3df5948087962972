#![allow(clippy::unwrap_used)]
//! Motions against their limits, and the search against chance.

use super::*;
use crate::model::{Limits, Model, RecursiveModel, Robot, torques_at};
use crate::simulation::Reference;
use crate::simulation::testing::{arm, with_numeric_base};
use rand::{RngExt, SeedableRng};
use std::borrow::Cow;

/// The branched arm with limits, and its parameters.
fn limited_arm() -> (RecursiveModel, Vec<f64>) {
    let (model, chi) = arm();
    let mut robot: Robot = model.robot().clone();
    let n = robot.joints();
    let all = |x: f64| Cow::Owned(vec![[-x, x]; n]);
    robot.limits = Limits {
        position: Cow::Owned((0..n).map(|j| [-1.0 - 0.1 * j as f64, 1.5]).collect()),
        velocity: all(3.0),
        acceleration: all(20.0),
        torque: all(250.0),
    };
    (RecursiveModel::new(robot).unwrap(), chi)
}

fn settings(kind: MotionKind, sets: usize, identification: Identification) -> ExcitationSettings {
    ExcitationSettings {
        kind,
        identification,
        sets,
        starts: 2,
        evaluations: 150,
        ..ExcitationSettings::default()
    }
}

const FOURIER: MotionKind = MotionKind::Fourier { harmonics: 4, period: 4.0, periods: 1 };
const QUINTIC: MotionKind = MotionKind::PointToPoint { points: 5, profile: Profile::Quintic, pause: 0.0 };
const TRAPEZOIDAL: MotionKind =
    MotionKind::PointToPoint { points: 5, profile: Profile::TrapezoidalAcceleration, pause: 0.1 };

#[test]
fn no_limit_is_broken_between_samples_either() {
    let (model, chi) = limited_arm();
    let n = model.robot().joints();
    let limits = &model.robot().limits;
    for kind in [FOURIER, QUINTIC, TRAPEZOIDAL] {
        let plan = excite(&model, Some(&chi), &settings(kind, 1, Identification::Idim), &|_| {}).unwrap();
        let motion = &plan.motions[0];
        let (mut q, mut dq, mut ddq) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let mut used = [0.0_f64; 3];
        for k in 0..=200_000 {
            motion.at(motion.duration() * k as f64 / 200_000.0, &mut q, &mut dq, &mut ddq);
            for j in 0..n {
                let [low, high] = limits.position[j];
                assert!(q[j] >= low && q[j] <= high, "{kind:?} position of joint {j}: {}", q[j]);
                used[1] = used[1].max(dq[j].abs() / 3.0);
                used[2] = used[2].max(ddq[j].abs() / 20.0);
            }
        }
        assert!(used[1] <= 0.9 + 1e-9 && used[2] <= 0.9 + 1e-9, "{kind:?} {used:?}");
        assert!(used[1].max(used[2]) > 0.5, "the limits are used: {kind:?} {used:?}");
        assert!(plan.torque_share.unwrap() <= 0.9);
    }
}

/// Torques from the regressor, friction as the motion has it, at instants that share nothing with the designer's.
#[test]
fn torque_limits_are_not_broken_between_samples_either() {
    let (arm, chi) = limited_arm();
    let mut robot = arm.robot().clone();
    let n = robot.joints();
    // Limits that bind: the motion has to be slowed down to them.
    robot.limits.torque = Cow::Owned(vec![[-160.0, 160.0]; n]);
    let model = RecursiveModel::new(robot).unwrap();
    for kind in [FOURIER, QUINTIC, TRAPEZOIDAL] {
        let all =
            ExcitationSettings { share: 1.0, evaluations: 0, ..settings(kind, 1, Identification::Idim) };
        let plan = excite(&model, Some(&chi), &all, &|_| {}).unwrap();
        let motion = &plan.motions[0];
        let (mut q, mut dq, mut ddq) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        let mut largest = 0.0_f64;
        for k in 0..=50_021 {
            motion.at(motion.duration() * k as f64 / 50_021.0, &mut q, &mut dq, &mut ddq);
            for torque in torques_at(&model, &chi, &q, &dq, &ddq) {
                largest = largest.max(torque.abs() / 160.0);
            }
        }
        assert!(largest <= 1.0 && largest > 0.8, "{kind:?}: {largest}");
    }
}

#[test]
fn motions_start_and_end_at_rest_and_their_derivatives_belong_together() {
    let (model, chi) = limited_arm();
    let n = model.robot().joints();
    for kind in [FOURIER, QUINTIC, TRAPEZOIDAL] {
        let plan = excite(&model, Some(&chi), &settings(kind, 1, Identification::Idim), &|_| {}).unwrap();
        let motion = &plan.motions[0];
        let state = |t: f64| {
            let mut s = [vec![0.0; n], vec![0.0; n], vec![0.0; n]];
            let [q, dq, ddq] = &mut s;
            motion.at(t, q, dq, ddq);
            s
        };
        for t in [0.0, motion.duration()] {
            let [_, dq, ddq] = state(t);
            assert!(dq.iter().chain(&ddq).all(|x| x.abs() < 1e-9), "{kind:?} at {t}: {dq:?} {ddq:?}");
        }
        let h = 1e-5;
        for k in 1..500 {
            let t = motion.duration() * k as f64 / 500.0;
            let ([before, slow, _], [q, dq, ddq], [after, fast, _]) = (state(t - h), state(t), state(t + h));
            for j in 0..n {
                assert!(((after[j] - before[j]) / (2.0 * h) - dq[j]).abs() < 1e-4, "{kind:?} {t} {j}");
                let difference = (fast[j] - slow[j]) / (2.0 * h);
                assert!((difference - ddq[j]).abs() < 2e-2, "{kind:?} {t} {j}: {difference} {}", ddq[j]);
                assert!(q[j].is_finite());
            }
        }
    }
}

#[test]
fn bounds_of_a_series_hold_and_are_tight() {
    let mut random = rand_pcg::Pcg64::seed_from_u64(2);
    for _ in 0..50 {
        let mut draw = || (0..5).map(|_| random.random_range(-1.0..1.0)).collect::<Vec<f64>>();
        let joint = FourierJoint::at_rest_at_start(0.3, &draw(), &draw());
        let bounds = joint.bounds(3.0);
        let motion = FourierMotion { period: 3.0, periods: 1, joints: vec![joint] };
        let (mut speed, mut acceleration) = (0.0_f64, 0.0_f64);
        for k in 0..30_000 {
            let ([mut q], [mut dq], [mut ddq]) = ([0.0], [0.0], [0.0]);
            motion.at(
                3.0 * k as f64 / 30_000.0,
                std::slice::from_mut(&mut q),
                std::slice::from_mut(&mut dq),
                std::slice::from_mut(&mut ddq),
            );
            assert!(q >= bounds.position[0] && q <= bounds.position[1]);
            speed = speed.max(dq.abs());
            acceleration = acceleration.max(ddq.abs());
        }
        assert!(speed <= bounds.velocity && speed > 0.99 * bounds.velocity);
        assert!(acceleration <= bounds.acceleration && acceleration > 0.99 * bounds.acceleration);
    }
}

#[test]
fn the_sets_of_the_power_model_make_it_block_triangular() {
    let (model, chi) = limited_arm();
    let plan = excite(&model, Some(&chi), &settings(FOURIER, 5, Identification::Pim), &|_| {}).unwrap();
    // The arm branches after its first joint: joints 2, 3 and joints 4, 5 are two chains.
    for (set, blocks) in plan.blocks.iter().enumerate() {
        for (joint, &reached) in blocks.iter().enumerate() {
            assert_eq!(reached, joint >= set, "set {set}, joint {joint}");
        }
        assert_eq!(plan.motions[set].fixed(), (0..set).collect::<Vec<_>>());
    }
}

#[test]
fn the_search_improves_on_its_start_and_repeats_for_a_seed() {
    let (model, chi) = limited_arm();
    let settings = settings(FOURIER, 1, Identification::Idim);
    let plan = excite(&model, Some(&chi), &settings, &|_| {}).unwrap();
    assert!(plan.log_determinant_after > plan.log_determinant_before + 1.0);
    assert_eq!(plan, excite(&model, Some(&chi), &settings, &|_| {}).unwrap());
    let other = ExcitationSettings { seed: 2, ..settings };
    assert_ne!(plan.motions, excite(&model, Some(&chi), &other, &|_| {}).unwrap().motions);
}

#[test]
fn each_criterion_wins_at_what_it_is_for() {
    let (arm, standard) = limited_arm();
    // Of the standard parameters some are never observed: a condition number needs base parameters.
    let model = RecursiveModel::new(with_numeric_base(arm.robot())).unwrap();
    let chi = model.robot().base_from_standard(&standard);
    let by = |criterion| {
        let settings =
            ExcitationSettings { criterion, evaluations: 400, ..settings(FOURIER, 1, Identification::Idim) };
        excite(&model, Some(&chi), &settings, &|_| {}).unwrap()
    };
    let (determinant, condition) = (by(Criterion::Determinant), by(Criterion::Condition));
    assert!(condition.condition_after < determinant.condition_after);
    assert!(determinant.log_determinant_after > condition.log_determinant_after);
    for plan in [determinant, condition] {
        assert!(plan.condition_after < plan.condition_before && plan.condition_after.is_finite());
    }
}

#[test]
fn the_reach_keeps_motions_near_the_middle() {
    let (model, chi) = limited_arm();
    let n = model.robot().joints();
    for kind in [FOURIER, TRAPEZOIDAL] {
        let settings = ExcitationSettings { reach: 0.3, ..settings(kind, 1, Identification::Idim) };
        let motion = &excite(&model, Some(&chi), &settings, &|_| {}).unwrap().motions[0];
        let (mut q, mut dq, mut ddq) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        for k in 0..=1000 {
            motion.at(motion.duration() * k as f64 / 1000.0, &mut q, &mut dq, &mut ddq);
            for (j, [low, high]) in model.robot().limits.position.iter().enumerate() {
                let from_middle = (q[j] - 0.5 * (low + high)).abs() / (0.5 * (high - low));
                assert!(from_middle <= 0.3 + 1e-12, "{kind:?} joint {j}: {from_middle}");
            }
        }
    }
}

#[test]
fn a_robot_without_limits_and_settings_out_of_range_are_refused() {
    let (model, chi) = arm();
    let good = settings(FOURIER, 1, Identification::Idim);
    let refused = excite(&model, Some(&chi), &good, &|_| {}).unwrap_err();
    let told = "no position, velocity and acceleration limits";
    assert!(refused.to_string().contains(told), "{refused}");
    let (model, chi) = limited_arm();
    for bad in [
        ExcitationSettings { sets: 6, ..good.clone() },
        ExcitationSettings { share: 1.2, ..good.clone() },
        ExcitationSettings { starts: 0, ..good.clone() },
        ExcitationSettings { reach: 0.0, ..good.clone() },
        ExcitationSettings { kind: MotionKind::Fourier { harmonics: 1, period: 4.0, periods: 1 }, ..good },
    ] {
        assert!(excite(&model, Some(&chi), &bad, &|_| {}).is_err(), "{bad:?}");
    }
}

#[test]
fn what_is_known_is_no_part_of_what_a_motion_is_to_tell() {
    let (arm, _) = limited_arm();
    let robot = with_numeric_base(arm.robot());
    let places: Vec<usize> =
        (0..robot.base.len()).filter(|k| robot.base[*k].combination.len() == 1).step_by(3).collect();
    let fixed: Vec<(usize, f64)> = places.iter().map(|&k| (robot.base[k].standard, 0.7)).collect();
    let base: Vec<_> =
        (0..robot.base.len()).filter(|k| !places.contains(k)).map(|k| robot.base[k].clone()).collect();
    let known = RecursiveModel::new(Robot { fixed: fixed.into(), ..robot.clone() }).unwrap();
    let less = RecursiveModel::new(Robot { base: base.into(), ..robot.clone() }).unwrap();
    let free = RecursiveModel::new(robot).unwrap();
    for (identification, sets) in [(Identification::Idim, 1), (Identification::Pim, 2)] {
        for criterion in [Criterion::Determinant, Criterion::Condition] {
            let settings = ExcitationSettings { criterion, ..settings(FOURIER, sets, identification) };
            // Without sizes and torque limits nothing else tells the robots apart.
            let [known, less, free] =
                [&known, &less, &free].map(|model| excite(model, None, &settings, &|_| {}).unwrap());
            assert_eq!(known, less);
            assert!(known.condition_after.is_finite() && known.condition_after < free.condition_after);
        }
    }
}
