#![allow(clippy::unwrap_used)]
use super::*;
use crate::estimation::Factor;
use crate::model::{Drive, Frame, JointKind, Limits, RecursiveModel, Robot, StateSlices, torques};
use crate::signal::Decimator;
use nalgebra::DMatrix;
use std::borrow::Cow;
use std::ops::Range;

const RATE: f64 = 500.0;

/// A revolute axis across gravity that carries a prismatic one.
fn model() -> RecursiveModel {
    let frame =
        |kind, alpha, parent| Frame { parent, kind, gamma: 0.0, b: 0.0, alpha, d: 0.2, theta: 0.1, r: 0.3 };
    let frames = vec![frame(JointKind::Revolute, 1.2, None), frame(JointKind::Prismatic, 0.7, Some(0))];
    let drive = Drive { gear: Cow::Owned(vec![30.0, 0.0, 0.0, 200.0]), coupled_friction: Cow::Owned(vec![]) };
    RecursiveModel::new(Robot::with_standard_as_base(
        "rp",
        [0.0, 0.0, -9.81],
        frames,
        drive,
        Limits::default(),
    ))
    .unwrap()
}

/// Sums of sines, with the torques of made-up parameters.
fn motion(seconds: f64, phase: f64) -> Motion {
    let model = model();
    let n = (seconds * RATE) as usize;
    let signal = |order: i32| -> Vec<Vec<f64>> {
        [(0.8, 3.0), (0.3, 4.1)]
            .iter()
            .map(|&(a, w): &(f64, f64)| {
                let quarter = f64::from(order) * std::f64::consts::FRAC_PI_2;
                (0..n).map(|t| a * w.powi(order) * (w * t as f64 / RATE + phase + quarter).sin()).collect()
            })
            .collect()
    };
    let (q, dq, ddq) = (signal(0), signal(1), signal(2));
    let chi: Vec<f64> = (1..=model.robot().base.len()).map(|k| k as f64).collect();
    let torque = torques(&model, &chi, StateSlices::new(&q, &dq, &ddq).states());
    Motion { name: "m".into(), rate: RATE, start: 1.0, q, dq, ddq, torque, fixed: vec![], edge_samples: 10 }
}

fn settings() -> ObserveSettings {
    ObserveSettings { band: 25.0, keep_rows: true, threads: 1, ..ObserveSettings::default() }
}

/// Whether a joint turns round within the reach of the filter of a row.
fn is_reached(motion: &Motion, joint: usize, sample: usize, decimator: &Decimator) -> bool {
    let reach = decimator.support() + 1;
    let around =
        &motion.dq[joint][sample.saturating_sub(reach)..(sample + reach + 1).min(motion.dq[joint].len())];
    around.windows(2).any(|v| v[0] * v[1] <= 0.0)
}

fn run(motions: &[Motion], equations: Equations, settings: &ObserveSettings) -> Observation {
    observe(&model(), motions, equations, None, settings, None).unwrap()
}

#[test]
fn rows_that_no_reversal_reaches_are_the_filtered_columns_of_the_full_rate() {
    let motion = motion(4.0, 0.3);
    let observation = run(std::slice::from_ref(&motion), Equations::Torque, &settings());
    assert_eq!(observation.rates, [50.0]);
    let decimator = Decimator::new(10).unwrap();
    let model = model();
    let samples = motion.q[0].len();
    let mut full = vec![vec![0.0; samples]; model.pattern().columns.len()];
    let mut entries = vec![0.0; full.len()];
    for t in 0..samples {
        let at = |x: &[Vec<f64>]| [x[0][t], x[1][t]];
        model.idm(&at(&motion.q), &at(&motion.dq), &at(&motion.ddq), &mut entries);
        for (column, e) in full.iter_mut().zip(&entries) {
            column[t] = *e;
        }
    }
    for rows in observation.rows.as_ref().unwrap() {
        let j = rows.equation;
        let first = model.pattern().rows[j];
        let count = rows.y.len();
        assert_eq!(count, (samples - 20 - 201) / 10 + 1);
        assert_eq!(rows.sample[0], 110);
        assert!((rows.time[0] - 1.22).abs() < 1e-12);
        let reached: Vec<bool> = rows.sample.iter().map(|&s| is_reached(&motion, j, s, &decimator)).collect();
        assert!(reached.iter().filter(|r| !**r).count() > count / 4);
        let filtered = |x: &[f64]| {
            let mut out = vec![0.0; count];
            assert_eq!(decimator.decimate_run(&x[10..samples - 10], &mut out), count);
            out
        };
        for (c, w) in rows.w.chunks_exact(count).enumerate() {
            assert_eq!(rows.columns[c], model.pattern().columns[first + c]);
            for (t, (a, b)) in w.iter().zip(filtered(&full[first + c])).enumerate() {
                assert!(reached[t] || (a - b).abs() < 1e-11 * (1.0 + b.abs()));
            }
        }
        for (t, (a, b)) in rows.y.iter().zip(filtered(&motion.torque[j])).enumerate() {
            assert!(reached[t] || (a - b).abs() < 1e-11 * (1.0 + b.abs()));
        }
    }
}

#[test]
fn factors_hold_exactly_the_rows_that_are_used() {
    let motions = [motion(4.0, 0.3), motion(2.5, 2.0)];
    let observation = run(&motions, Equations::Torque, &settings());
    assert_eq!(observation.groups.len(), 4);
    for ((group, rows), left_out) in
        observation.groups.iter().zip(observation.rows.as_ref().unwrap()).zip(&observation.left_out)
    {
        assert_eq!((group.trajectory, group.equation), (rows.trajectory, rows.equation));
        assert_eq!((group.trajectory, group.equation), (left_out.trajectory, left_out.equation));
        let used: Vec<usize> = (0..rows.y.len()).filter(|&t| rows.used[t]).collect();
        assert_eq!(group.reversals.len(), 1);
        assert_eq!(group.factor.rows() + group.reversals.len(), used.len());
        assert_eq!(left_out.used, used.len());
        assert!(left_out.standstill > 0, "the motion has turning points");
        let c = rows.columns.len();
        let table = DMatrix::from_fn(used.len(), c + 1, |i, l| {
            if l < c { rows.w[l * rows.y.len() + used[i]] } else { rows.y[used[i]] }
        });
        let r = DMatrix::from_fn(c + 1, c + 1, |i, l| group.factor.r(i, l));
        let expected = table.transpose() * &table;
        assert!((r.transpose() * r - &expected).norm() < 1e-11 * expected.norm());
        let blocks: usize = observation
            .blocks
            .iter()
            .filter(|b| b.trajectory == group.trajectory)
            .map(|b| b.equations[group.equation].factor.rows())
            .sum();
        assert_eq!(blocks, used.len());
    }
}

#[test]
fn the_result_has_the_same_digits_for_every_number_of_threads() {
    let motions = [motion(9.0, 0.3), motion(2.5, 2.0)];
    for equations in [Equations::Torque, Equations::Power { closed_form: false }] {
        let one = run(&motions, equations, &settings());
        for threads in [2, 3, 0] {
            assert_eq!(one, run(&motions, equations, &ObserveSettings { threads, ..settings() }));
        }
    }
}

#[test]
fn the_power_model_is_the_same_in_closed_form_and_from_differences_of_the_energy() {
    let motions = [motion(4.0, 0.3)];
    let closed = run(&motions, Equations::Power { closed_form: true }, &settings());
    let differences = run(&motions, Equations::Power { closed_form: false }, &settings());
    let (closed, differences) = (&closed.rows.unwrap()[0], &differences.rows.unwrap()[0]);
    let scale = closed.w.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    for (a, b) in closed.w.iter().zip(&differences.w) {
        assert!((a - b).abs() < 1e-4 * scale);
    }
    // The torques were made with the parameters 1, 2, 3, ...: the power equation must close.
    let chi: Vec<f64> = (0..model().robot().base.len()).map(|c| 1.0 + c as f64).collect();
    for (e, y) in closed.residual(&chi).iter().zip(&closed.y) {
        assert!(e.abs() < 1e-9 * (1.0 + y.abs()));
    }
}

#[test]
fn a_fixed_joint_has_no_equation_and_no_speed() {
    let mut motion = motion(4.0, 0.3);
    motion.fixed = vec![0];
    motion.hold();
    let observation = run(&[motion], Equations::Torque, &settings());
    assert_eq!(observation.left_out[0].used, 0);
    assert!(observation.left_out[0].fixed > 0);
    let rows = observation.rows.unwrap();
    let speed = model().robot().base.iter().position(|p| p.name == "Fv1").unwrap();
    let at = rows[0].columns.iter().position(|&c| c == speed).unwrap();
    assert!(rows[0].w[at * rows[0].y.len()..][..rows[0].y.len()].iter().all(|&w| w == 0.0));
}

#[test]
fn windows_keep_only_rows_whose_whole_support_is_inside() {
    let windows = ObserveSettings { windows: vec![[2.0, 3.5]], standstill: Standstill::Keep, ..settings() };
    let observation = run(&[motion(4.0, 0.3)], Equations::Torque, &windows);
    let rows = &observation.rows.unwrap()[0];
    let used: Vec<f64> = rows.time.iter().zip(&rows.used).filter(|(_, u)| **u).map(|(t, _)| *t).collect();
    assert!(used[0] >= 2.2 - 1e-9 && used[0] < 2.22 + 1e-9);
    assert!(*used.last().unwrap() <= 3.3 + 1e-9);
    assert!(observation.left_out[0].windows > 0);
}

/// Two made-up columns, one of them in both equations.
struct Two(Vec<String>);

impl ExtraColumns for Two {
    fn names(&self) -> &[String] {
        &self.0
    }
    fn columns(&self, joint: usize) -> &[usize] {
        if joint == 0 { &[0, 1] } else { &[1] }
    }
    fn fill(
        &self,
        _: usize,
        motion: &Motion,
        range: Range<usize>,
        joint: usize,
        stride: usize,
        out: &mut [f64],
    ) {
        for (c, &column) in self.columns(joint).iter().enumerate() {
            for (t, s) in range.clone().enumerate() {
                out[c * stride + t] = if column == 0 { motion.q[0][s] } else { 7.0 + joint as f64 };
            }
        }
    }
}

#[test]
fn extra_columns_are_filtered_like_the_others() {
    let extra = Two(vec!["a".into(), "b".into()]);
    let motion = motion(4.0, 0.3);
    let observation =
        observe(&model(), std::slice::from_ref(&motion), Equations::Torque, Some(&extra), &settings(), None)
            .unwrap();
    let base = observation.base;
    assert_eq!(observation.unknowns[base..], ["a", "b"]);
    let rows = observation.rows.unwrap();
    assert_eq!(rows[0].columns[rows[0].columns.len() - 2..], [base, base + 1]);
    assert_eq!(rows[1].columns.last(), Some(&(base + 1)));
    let count = rows[0].y.len();
    let first = &rows[0].w[(rows[0].columns.len() - 2) * count..][..count];
    let decimator = Decimator::new(10).unwrap();
    let second = &rows[1].w[rows[1].w.len() - count..];
    for ((a, b), &s) in first.iter().zip(second).zip(&rows[0].sample) {
        let passes = (a - motion.q[0][s]).abs() < 1e-3;
        assert!(passes || is_reached(&motion, 0, s, &decimator), "a slow signal passes");
        assert!((b - 8.0).abs() < 1e-12 || is_reached(&motion, 1, s, &decimator));
    }
}

#[test]
fn what_cannot_be_observed_is_refused_with_the_reason() {
    let refuse = |motions: &[Motion], settings: &ObserveSettings| {
        observe(&model(), motions, Equations::Torque, None, settings, None).unwrap_err().to_string()
    };
    assert!(refuse(&[motion(0.3, 0.0)], &settings()).contains("lasts 0.300 s"));
    let mut still = motion(4.0, 0.0);
    still.dq = vec![vec![0.0; still.q[0].len()]; 2];
    let below = ObserveSettings { standstill: Standstill::Below(vec![0.1, 0.1]), ..settings() };
    assert!(refuse(&[still], &below).contains("no joint moves"));
    let mut other = motion(4.0, 0.0);
    other.q.pop();
    assert!(refuse(&[other], &settings()).contains("has 1 joints: the robot has 2"));
    let band = ObserveSettings { band: f64::NAN, ..settings() };
    assert!(refuse(&[motion(4.0, 0.0)], &band).contains("band must be"));
    let windows = ObserveSettings { windows: vec![[100.0, 200.0]], ..settings() };
    assert!(refuse(&[motion(4.0, 0.0)], &windows).contains("time windows"));
}

#[test]
fn pieces_observed_one_by_one_are_the_motions_observed_together() {
    let motions = [motion(4.0, 0.3), motion(2.5, 2.0), motion(3.0, 1.0)];
    // Speeds of standstill are common to all motions only where all are seen at once.
    let settings = ObserveSettings { standstill: Standstill::BelowShare(0.02), ..settings() };
    let together = run(&motions, Equations::Torque, &settings);
    let mut pieces = run(&motions[..1], Equations::Torque, &settings);
    pieces.append(run(&motions[1..], Equations::Torque, &settings)).unwrap();
    assert_eq!(pieces, together);
    let power = run(&motions[..1], Equations::Power { closed_form: true }, &settings);
    assert_eq!(pieces.append(power), Err(ObserveError::OtherUnknowns));
}

#[test]
fn pieces_of_one_trajectory_are_one_trajectory_with_the_same_normal_equations() {
    let pieces = [motion(40.0, 0.3), motion(40.0, 2.0), motion(40.0, 1.0)];
    let settings = ObserveSettings { keep_rows: false, standstill: Standstill::Keep, ..settings() };
    let apart = run(&pieces, Equations::Torque, &settings);
    let mut merged = run(&pieces[..1], Equations::Torque, &settings);
    for piece in &pieces[1..] {
        merged.merge(run(std::slice::from_ref(piece), Equations::Torque, &settings)).unwrap();
    }
    assert_eq!(merged.trajectories.len(), 1);
    assert_eq!(merged.samples, apart.samples);
    assert!(merged.blocks.len() > 40 && merged.blocks.len() <= 128, "{}", merged.blocks.len());
    for (group, count) in merged.groups.iter().zip(&merged.left_out) {
        let mut expected = Factor::new(group.columns.len());
        for part in apart.groups.iter().filter(|g| g.equation == group.equation) {
            expected.merge(&part.factor);
        }
        let normal = |f: &Factor| {
            let r = DMatrix::from_fn(f.unknowns() + 1, f.unknowns() + 1, |i, l| f.r(i, l));
            r.transpose() * r
        };
        let (own, expected_normal) = (normal(&group.factor), normal(&expected));
        assert!((own - &expected_normal).norm() < 1e-12 * expected_normal.norm());
        assert_eq!(count.used, expected.rows() + group.reversals.len());
        let in_blocks: usize = merged.blocks.iter().map(|b| b.equations[group.equation].factor.rows()).sum();
        assert_eq!(in_blocks, count.used);
    }
}

/// Friction of joint 1 that follows its speed by `late` samples.
fn with_late_friction(late: usize) -> Motion {
    let mut motion = motion(12.0, 0.3);
    let robot = model().robot().clone();
    let friction = robot.base.iter().position(|p| p.name == "Fc1").unwrap();
    let speed = motion.dq[0].clone();
    for t in late..speed.len() {
        let change = speed[t - late].signum() - speed[t].signum();
        motion.torque[0][t] += (1.0 + friction as f64) * change;
    }
    motion
}

#[test]
fn parameters_do_not_depend_on_the_moment_at_which_friction_changes_its_sign() {
    let settings = ObserveSettings { keep_rows: false, ..settings() };
    let observed = |late: usize| run(&[with_late_friction(late)], Equations::Torque, &settings);
    let true_friction = observed(0);
    let late = observed(2);
    // Relative error of the parameters that a factor has on what there would be if friction followed the speed.
    let error = |factor: &Factor| {
        let mut chi = vec![0.0; true_friction.unknowns.len()];
        let solved = factor.solve().chi;
        true_friction.groups[0].columns.iter().zip(solved).for_each(|(&l, x)| chi[l] = x);
        (true_friction.groups[0].squares_left(&chi) / true_friction.groups[0].squares_measured()).sqrt()
    };
    assert!(error(&true_friction.groups[0].factor) < 1e-9);
    let group = &late.groups[0];
    let (own, plain) = (error(&group.factor), error(&group.of_all_rows()));
    assert!(plain > 1e-5 && own < 0.1 * plain, "{own} {plain}");
}

#[test]
fn errors_count_what_the_moments_of_reversals_take() {
    let chi: Vec<f64> = (0..model().robot().base.len()).map(|c| 1.1 + c as f64).collect();
    let observation = run(&[motion(4.0, 0.3)], Equations::Torque, &settings());
    let group = &observation.groups[0];
    let left = group.squares_left(&chi);
    let own: Vec<f64> = group.columns.iter().map(|&u| chi[u]).collect();
    assert!(left > group.factor.residual_norm(&own).powi(2));
    assert!((group.of_all_rows().residual_norm(&own).powi(2) - left).abs() < 1e-12 * left);
    assert_eq!(group.of_all_rows().rows(), group.factor.rows() + group.reversals.len());
    assert!(group.squares_measured() > group.factor.norm_y().powi(2));
}
