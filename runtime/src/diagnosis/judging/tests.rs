//! Partial regression, predictions and verdicts against explicit least squares on all rows.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::candidates::trial::Trial;
use crate::diagnosis::judging::prediction::Prediction;
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::effects::{EffectKind, Place};
use approx::assert_relative_eq;
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const JOINTS: usize = 2;
const ROWS: usize = 30;
const SEGMENTS: [(usize, bool); 3] = [(0, true), (1, true), (2, true)];
const ALL: usize = JOINTS * SEGMENTS.len() * ROWS;

/// A random regression with four columns, and a candidate with two more, both on both joints.
fn random(seed: u64) -> (Regression, Candidate) {
    let mut rng = Pcg64::seed_from_u64(seed);
    let mut series =
        |scale: f64| -> Vec<f64> { (0..ALL).map(|_| scale * rng.random_range(-1.0..1.0)).collect() };
    let columns: Vec<Vec<f64>> = (0..4).map(|_| series(1.0)).collect();
    // What the candidate shares with the columns is what partial regression must take out.
    let own: Vec<Vec<f64>> = (0..2)
        .map(|k| series(0.7).iter().zip(&columns[k]).map(|(own, shared)| own + 1.5 * shared).collect())
        .collect();
    let mut y = series(0.3);
    for r in 0..ALL {
        y[r] += 2.0 * columns[0][r] - columns[3][r] + 0.8 * own[0][r] - 0.4 * own[1][r];
    }
    let design = Design::made_up(JOINTS, &SEGMENTS, ROWS, columns, y);
    let regression = Regression::new(design, Vec::new()).expect("a small problem is regular");
    let half = ALL / JOINTS;
    let sparse = own.iter().map(|c| (0..JOINTS).map(|j| (j, c[j * half..(j + 1) * half].to_vec())).collect());
    let trial = Trial::new(&regression.design, vec![1.0], sparse.collect());
    let candidate = Candidate {
        effect: EffectKind::Spring,
        place: Place::Joint(0),
        own: vec![0, 1],
        trials: vec![trial],
        shapes: 1,
        fixed: None,
        only_positive: false,
    };
    (regression, candidate)
}

/// Weighted least squares over the rows of some segments: the solution and its squares.
fn explicit(
    regression: &Regression,
    columns: &[Vec<f64>],
    y: &[f64],
    segments: &[bool],
) -> (DVector<f64>, f64) {
    let design = &regression.design;
    let rows: Vec<(usize, f64)> = (0..JOINTS)
        .flat_map(|j| {
            let weight = 1.0 / regression.sigma[j];
            let ranges = (0..segments.len()).filter(|&g| segments[g]).map(move |g| (j, g));
            ranges
                .flat_map(|(j, g)| design.ranges[j][g].clone())
                .map(move |r| (r, weight))
                .collect::<Vec<_>>()
        })
        .collect();
    let w = DMatrix::from_fn(rows.len(), columns.len(), |i, k| rows[i].1 * columns[k][rows[i].0]);
    let b = DVector::from_fn(rows.len(), |i, _| rows[i].1 * y[rows[i].0]);
    let x = w.clone().svd(true, true).solve(&b, 1e-14).expect("a small problem is regular");
    let left = (b - w * &x).norm_squared();
    (x, left)
}

#[test]
fn columns_beside_one_that_is_known_take_away_what_a_regression_on_what_it_leaves_does() {
    for seed in 1..5 {
        let (regression, candidate) = random(seed);
        let (design, trial) = (&regression.design, &candidate.trials[0]);
        let own = trial.dense(design);
        let known = 1.3;
        let y: Vec<f64> = design.y.iter().zip(&own[0]).map(|(y, c)| y - known * c).collect();
        let columns = [&design.columns[..], &own[1..]].concat();
        let (solution, left) = explicit(&regression, &columns, &y, &[true; 3]);
        let part = regression.fit.project_out(trial).expect("it has a part of its own");
        let (amplitude, gain) = part.solve_beside(&[known]).expect("it is determined");
        assert_relative_eq!(amplitude[0], solution[4], max_relative = 1e-5);
        let before = regression.fit.weighted_squares(design);
        assert_relative_eq!(before - gain, left, max_relative = 1e-5);
        // With both known nothing is left to solve.
        let (none, of_known) = part.solve_beside(&[known, amplitude[0]]).expect("nothing to solve");
        assert!(none.is_empty());
        assert_relative_eq!(of_known, gain, max_relative = 1e-12);
    }
}

#[test]
fn amplitudes_and_gain_are_those_of_one_regression_on_all_columns() {
    for seed in 0..5 {
        let (regression, candidate) = random(seed);
        let (design, trial) = (&regression.design, &candidate.trials[0]);
        let everything = [true; 3];
        let mut columns = design.columns.clone();
        let (_, before) = explicit(&regression, &columns, &design.y, &everything);
        columns.extend(trial.dense(design));
        let (expected, after) = explicit(&regression, &columns, &design.y, &everything);

        let part = regression.fit.project_out(trial).expect("a small problem is regular");
        let (amplitude, gain) = part.solve(&candidate).expect("a small problem is regular");
        let shift = -(&part.coefficients * &amplitude);
        for k in 0..2 {
            assert!((amplitude[k] - expected[4 + k]).abs() < 1e-5, "{seed}: {amplitude} {expected}");
        }
        for k in 0..4 {
            assert!((regression.fit.chi[k] + shift[k] - expected[k]).abs() < 1e-5);
        }
        assert!((gain - (before - after)).abs() < 1e-4 * gain, "{seed}: {gain} {}", before - after);
    }
}

#[test]
fn amplitudes_of_one_sign_are_the_best_of_that_sign() {
    let (mut at_zero, mut refused) = (0, 0);
    for seed in 0..40 {
        let (regression, mut candidate) = random(seed);
        // The second amplitude is nearly nothing, and small next to the noise of y.
        let add = 0.4 * (seed as f64 - 20.0) / 200.0 + 0.4;
        let mut design = regression.design.clone();
        let own = candidate.trials[0].dense(&design);
        design.y.iter_mut().zip(&own[1]).for_each(|(y, c)| *y += add * c);
        let columns: Vec<_> = own
            .iter()
            .map(|c| (0..JOINTS).map(|j| (j, c[j * ALL / JOINTS..(j + 1) * ALL / JOINTS].to_vec())).collect())
            .collect();
        candidate.trials = vec![Trial::new(&design, vec![1.0], columns)];
        let regression = Regression::new(design, Vec::new()).expect("a small problem is regular");
        let part = regression.fit.project_out(&candidate.trials[0]).expect("a small problem is regular");
        let (any_sign, gain) = part.solve(&candidate).expect("a small problem is regular");
        candidate.only_positive = true;
        let (one_sign, less) = part.solve(&candidate).expect("the first amplitude is clearly positive");
        if any_sign[1] >= 0.0 {
            assert_eq!(one_sign, any_sign, "seed {seed}");
            continue;
        }
        at_zero += 1;
        assert!(one_sign[0] > 0.0 && one_sign[1] == 0.0, "seed {seed}: {one_sign}");
        assert!(less <= gain && less > 0.9 * gain, "seed {seed}: {less} of {gain}");
        // Beside the first column alone the amplitude is the same.
        let mut columns = regression.design.columns.clone();
        columns.push(candidate.trials[0].dense(&regression.design)[0].clone());
        let (expected, _) = explicit(&regression, &columns, &regression.design.y, &[true; 3]);
        assert!((one_sign[0] - expected[4]).abs() < 1e-5, "seed {seed}: {one_sign} {}", expected[4]);
    }
    assert!(at_zero > 5, "{at_zero}");
    // One that is clearly negative is something else.
    for seed in 0..5 {
        let (regression, mut candidate) = random(seed);
        candidate.only_positive = true;
        let part = regression.fit.project_out(&candidate.trials[0]).expect("a small problem is regular");
        refused += usize::from(part.solve(&candidate).is_none());
    }
    assert_eq!(refused, 5);
}

#[test]
fn a_prediction_gains_what_the_squares_of_the_held_out_rows_fall_by() {
    let (regression, candidate) = random(7);
    let (design, trial) = (&regression.design, &candidate.trials[0]);
    let train = [true, true, false];
    let fit = Fit::new(design, &regression.sigma, train.to_vec()).expect("a small problem is regular");
    let part = fit.project_out(trial).expect("a small problem is regular");
    let (amplitude, _) = part.solve(&candidate).expect("a small problem is regular");
    let prediction = Prediction::new(&fit, trial, &part, amplitude);

    let mut columns = design.columns.clone();
    let (without, _) = explicit(&regression, &columns, &design.y, &train);
    columns.extend(trial.dense(design));
    let (with, _) = explicit(&regression, &columns, &design.y, &train);
    for j in 0..JOINTS {
        let left = |x: &DVector<f64>| -> f64 {
            let fitted = |r: usize| (0..x.len()).map(|k| x[k] * columns[k][r]).sum::<f64>();
            design.ranges[j][2].clone().map(|r| (design.y[r] - fitted(r)).powi(2)).sum()
        };
        let expected = left(&without) - left(&with);
        let gain = prediction.gain(design, j, 2);
        assert!((gain - expected).abs() < 1e-4 * expected.abs(), "{gain} {expected}");
    }
}

#[test]
fn on_some_segments_only_the_amplitude_is_fitted() {
    let (regression, candidate) = random(8);
    let (design, trial) = (&regression.design, &candidate.trials[0]);
    let whole = regression.fit.project_out(trial).expect("a small problem is regular");
    let train = [true, false, true];
    let parts = regression.by_segment(&whole, trial);
    let part = parts.on(&train, &regression.sigma, &whole);
    let (amplitude, _) = part.solve(&candidate).expect("a small problem is regular");
    let columns = whole.columns(design, trial);
    let (expected, _) = explicit(&regression, &columns, &regression.residual(), &train);
    assert!((amplitude - expected).norm() < 1e-5);
}

#[test]
fn on_one_segment_the_amplitude_gains_what_the_squares_fall_by() {
    let (regression, candidate) = random(8);
    let (design, trial) = (&regression.design, &candidate.trials[0]);
    let whole = regression.fit.project_out(trial).expect("a small problem is regular");
    let parts = regression.by_segment(&whole, trial);
    let (amplitude, _) = whole.solve(&candidate).expect("a small problem is regular");
    let (columns, before) = (whole.columns(design, trial), regression.residual());
    for j in 0..JOINTS {
        for g in 0..SEGMENTS.len() {
            let fall = |r: usize| {
                let change: f64 = columns.iter().zip(amplitude.iter()).map(|(c, a)| a * c[r]).sum();
                before[r].powi(2) - (before[r] - change).powi(2)
            };
            let expected: f64 = design.ranges[j][g].clone().map(fall).sum();
            let gain = parts.gain(&amplitude, j, g);
            assert!((gain - expected).abs() < 1e-8 * (1.0 + expected.abs()), "{gain} {expected}");
        }
    }
}

#[test]
fn what_the_columns_make_themselves_is_not_identifiable() {
    let (regression, mut candidate) = random(9);
    let design = &regression.design;
    let half = ALL / JOINTS;
    let made: Vec<f64> = (0..ALL).map(|r| design.columns[0][r] - 3.0 * design.columns[2][r]).collect();
    let sparse = (0..JOINTS).map(|j| (j, made[j * half..(j + 1) * half].to_vec())).collect();
    candidate.trials = vec![Trial::new(design, vec![1.0], vec![sparse])];
    assert!(!regression.is_identifiable(&candidate));
    assert_eq!(regression.whole_gain(&candidate), f64::NEG_INFINITY);
    assert!(regression.judge(&candidate).is_none());
}

#[test]
fn a_real_candidate_holds_on_held_out_motion() {
    let (regression, candidate) = random(10);
    let verdict = regression.judge(&candidate).expect("a small problem is regular");
    assert_eq!(verdict.held_out.len(), SEGMENTS.len());
    assert!(verdict.held_out.iter().all(|gain| *gain > 0.0), "{verdict:?}");
    assert!(verdict.explained_fraction > 0.3 && verdict.explained_fraction < 1.0, "{verdict:?}");
}
