use super::*;
use crate::estimation::observe::Equations;
use crate::estimation::{EstimateSettings, RecordedSettings, estimate, observe_trajectories};
use crate::model::{Model, RecursiveModel};
use crate::recording::Trajectory;
use crate::testing::{normal, vertical_axis};
use rand::SeedableRng;

const PARAMETERS: [&str; 3] = ["ZZ1", "Fv1", "Fc1"];

/// Twenty seconds of one axis with noise that lasts, in the torques and in the positions.
fn trajectory(name: &str, seed: u64) -> Trajectory {
    let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
    let time: Vec<f64> = (0..4000).map(|k| f64::from(k) / 200.0).collect();
    let quantum = 1e-5;
    let noisy = |t: &f64| (2.0 * t).sin() + 0.3 * (5.1 * t).sin();
    let position = time.iter().map(|t| (noisy(t) / quantum).round() * quantum).collect();
    let mut lasting = 0.0;
    let torque = time
        .iter()
        .map(|t| {
            let speed: f64 = 2.0 * (2.0 * t).cos() + 1.53 * (5.1 * t).cos();
            let acceleration = -4.0 * (2.0 * t).sin() - 7.803 * (5.1 * t).sin();
            lasting = 0.9 * lasting + 0.1 * normal(&mut random);
            2.0 * acceleration + 0.7 * speed + 1.5 * speed.signum() + lasting
        })
        .collect();
    Trajectory {
        name: name.into(),
        time,
        position: vec![position],
        velocity: None,
        torque: vec![torque],
        fixed: vec![],
    }
}

fn observed(model: &RecursiveModel, motions: &[Trajectory]) -> (Observation, Estimate) {
    let settings = RecordedSettings { band: Some(10.0), ..RecordedSettings::default() };
    let mut observed =
        observe_trajectories(motions, model, &[Equations::Torque], &settings, None).expect("rows");
    let observation = observed.observations.remove(0);
    let found = estimate(&observation, &EstimateSettings::default());
    (observation, found)
}

fn reduced(model: &RecursiveModel, motions: &[Trajectory]) -> Vec<Reduced> {
    let (observation, found) = observed(model, motions);
    (0..motions.len()).map(|k| Reduced::of(&observation, &found, model.robot(), Some(k))).collect()
}

fn merged(parts: &[Reduced]) -> Reduced {
    let mut all = parts[0].clone();
    parts[1..].iter().for_each(|part| all.merge(part).expect("one robot"));
    all
}

#[test]
fn motions_of_one_recording_merge_to_its_estimate() {
    let model = vertical_axis(&PARAMETERS);
    let motions = [trajectory("a", 1), trajectory("b", 2)];
    let (_, expected) = observed(&model, &motions);
    let all = merged(&reduced(&model, &motions));
    let found = all.solve();
    for (found, expected) in found.parameters.iter().zip(&expected.parameters) {
        let sigma = expected.sigma.expect("determined");
        assert!((found.value - expected.value).abs() < 1e-6 * sigma, "{found:?} {expected:?}");
        let ratio = found.sigma.expect("determined") / sigma;
        assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");
        assert_eq!(found.correction.is_some(), expected.correction.is_some());
    }
    assert_eq!(all.rows(), expected.rows);
    assert!((all.residual_norm(&found.chi()).expect("its own") - found.residual_norm).abs() < 1e-9);
}

#[test]
fn the_order_of_merging_is_rounding() {
    let model = vertical_axis(&PARAMETERS);
    let mut parts: Vec<Reduced> = (0..5).flat_map(|seed| reduced(&model, &[trajectory("a", seed)])).collect();
    let forward = merged(&parts).solve();
    parts.reverse();
    let (left, right) = parts.split_at(2);
    let backward = merged(&[merged(left), merged(right)]).solve();
    for (a, b) in forward.parameters.iter().zip(&backward.parameters) {
        assert!((a.value - b.value).abs() < 1e-6 * a.sigma.expect("determined"), "{a:?} {b:?}");
    }
}

#[test]
fn more_recordings_know_more_and_standard_deviations_hold() {
    let model = vertical_axis(&PARAMETERS);
    let parts: Vec<Reduced> =
        (0..40).flat_map(|seed| reduced(&model, &[trajectory("a", 100 + seed)])).collect();
    let all = merged(&parts).solve();
    let one = parts[0].solve();
    let truth = [2.0, 0.7, 1.5];
    for l in 0..3 {
        let ratio =
            one.parameters[l].sigma.expect("determined") / all.parameters[l].sigma.expect("determined");
        // Forty recordings: sqrt(40) = 6.3, but for what corrections have in common.
        assert!(ratio > 3.0 && ratio < 9.0, "{ratio}");
    }
    let inside = |part: &Reduced| {
        let found = part.solve();
        (0..3)
            .filter(|&l| {
                let p = &found.parameters[l];
                (p.value - truth[l]).abs() < 1.96 * p.sigma.expect("determined")
            })
            .count()
    };
    let share = parts.iter().map(inside).sum::<usize>() as f64 / 120.0;
    assert!(share > 0.85, "{share}");
}

#[test]
fn bytes_are_read_back_bit_for_bit_and_others_are_refused() {
    let model = vertical_axis(&PARAMETERS);
    let one = reduced(&model, &[trajectory("a", 1)]).remove(0);
    let bytes = one.to_bytes();
    assert_eq!(Reduced::from_bytes(&bytes).expect("its own"), one);
    for end in 0..bytes.len() {
        assert!(Reduced::from_bytes(&bytes[..end]).is_err(), "{end}");
    }
    for place in 0..bytes.len() {
        let mut broken = bytes.clone();
        broken[place] ^= 0x7f;
        // Whatever it is then, it is no panic, also where it is solved.
        let _ = Reduced::from_bytes(&broken).map(|read| read.solve());
    }
}

#[test]
fn robots_are_not_mixed() {
    let mut one = reduced(&vertical_axis(&PARAMETERS), &[trajectory("a", 1)]).remove(0);
    let other = reduced(&vertical_axis(&["ZZ1", "Fv1", "off1"]), &[trajectory("a", 1)]).remove(0);
    assert!(matches!(one.merge(&other), Err(ReducedError::OtherRobot { .. })));
}
