//! What counts as evidence on motion that was held out, where it goes where the fitted motion has not been.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::candidates::trial::Trial;
use crate::diagnosis::judging::prediction::Prediction;
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::effects::{EffectKind, Place};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

const ROWS: usize = 80;
const SEGMENTS: [(usize, bool); 3] = [(0, true), (1, true), (2, true)];
const ALL: usize = SEGMENTS.len() * ROWS;

/// Powers 1 to 5 of a position.
fn powers(q: &[f64]) -> Vec<Vec<f64>> {
    (1..=5).map(|n| q.iter().map(|q| q.powi(n)).collect()).collect()
}

fn candidate(design: &Design, effect: EffectKind, columns: Vec<Vec<f64>>) -> Candidate {
    let columns = columns.into_iter().map(|c| vec![(0, c)]).collect();
    Candidate {
        effect,
        place: Place::Joint(0),
        own: vec![0],
        trials: vec![Trial::new(design, vec![0.0, 1.0], columns)],
        shapes: 1,
        fixed: None,
        only_positive: false,
    }
}

fn noise(rng: &mut Pcg64) -> Vec<f64> {
    (0..ALL).map(|_| StandardNormal.sample(rng)).collect()
}

/// A bump over the position, in motions of which only the last goes beyond 0.2.
fn bump(rng: &mut Pcg64) -> (Design, Vec<Vec<f64>>) {
    let ranges = [[-1.0, 0.2], [-0.9, 0.1], [-0.6, 1.0]];
    let q: Vec<f64> = ranges
        .iter()
        .flat_map(|[low, high]| (0..ROWS).map(|_| rng.random_range(*low..*high)).collect::<Vec<f64>>())
        .collect();
    let y = noise(rng);
    let y = q.iter().zip(&y).map(|(q, e)| (-8.0 * (q + 0.4) * (q + 0.4)).exp() + 0.05 * e).collect();
    (Design::made_up(1, &SEGMENTS, ROWS, vec![vec![1.0; ALL]], y), powers(&q))
}

#[test]
fn motion_beyond_what_a_curve_was_fitted_to_is_no_evidence_against_it() {
    let mut rng = Pcg64::seed_from_u64(3);
    for _ in 0..10 {
        let (design, columns) = bump(&mut rng);
        let regression = Regression::new(design, Vec::new()).expect("a small problem is regular");
        let judge = |effect| {
            let candidate = candidate(&regression.design, effect, columns.clone());
            regression.judge(&candidate).expect("a small problem is regular")
        };
        let curve = judge(EffectKind::PositionDependentTorque);
        assert!(curve.held_out.iter().all(|gain| *gain > 0.0) && curve.lost == 0, "{curve:?}");
        assert!(curve.explained_fraction > 0.9, "{curve:?}");
        // The same columns of a law that says something of every position are wrong there.
        let law = judge(EffectKind::Spring);
        assert!(law.held_out[2] < 0.0, "{law:?}");
    }
}

#[test]
fn beside_a_curve_other_laws_are_not_judged_where_it_says_nothing() {
    use crate::diagnosis::judging::regression::{Besides, TermColumns};
    let mut rng = Pcg64::seed_from_u64(4);
    let (mut design, columns) = bump(&mut rng);
    let other = noise(&mut rng);
    design.y.iter_mut().zip(&other).for_each(|(y, c)| *y += 0.1 * c);
    let mut regression = Regression::new(design, Vec::new()).expect("a small problem is regular");
    let mut judged_beside = |curve_on| {
        let besides = Besides { known: None, gains: Vec::new(), deviation: 1.0, bent: None };
        let term = TermColumns {
            columns: columns.clone().into(),
            fixed: None,
            derived_at: Vec::new(),
            uncovered: None,
            is_curve: false,
            curve_on,
        };
        regression.set_terms(vec![term], besides).expect("a small problem is regular");
        regression.hold_out().expect("a small problem is regular");
        let candidate = candidate(&regression.design, EffectKind::Spring, vec![other.clone()]);
        regression.judge(&candidate).expect("a small problem is regular")
    };
    let where_seen = judged_beside(Some(0));
    assert!(where_seen.explained_fraction > 0.6 && where_seen.lost == 0, "{where_seen:?}");
    // The error of the curve where it was not fitted is all that is seen otherwise.
    let everywhere = judged_beside(None);
    assert!(everywhere.explained_fraction < 0.1, "{everywhere:?}");
}

#[test]
fn motion_that_the_others_do_not_tell_is_no_evidence() {
    let mut rng = Pcg64::seed_from_u64(6);
    // A parameter that both joints have in common, hardly seen but in the last motion of the second one.
    let in_last = |r: usize| if r < 2 * ALL - ROWS { 0.01 } else { 10.0 };
    let law: Vec<f64> = noise(&mut rng);
    let errors: Vec<f64> = [noise(&mut rng), noise(&mut rng)].concat();
    let parameter: Vec<f64> = (0..2 * ALL).map(|r| in_last(r) * (1.7 * r as f64).sin()).collect();
    let y = (0..2 * ALL).map(|r| parameter[r] + errors[r] + law.get(r).copied().unwrap_or(0.0)).collect();
    let mut design = Design::made_up(2, &SEGMENTS, ROWS, vec![parameter], y);
    let judge = |design: Design| {
        // By accident it goes with the law in the others.
        let mut columns = law.clone();
        columns.iter_mut().zip(&design.columns[0]).for_each(|(law, parameter)| *law += 3.0 * parameter);
        let regression = Regression::new(design, Vec::new()).expect("a small problem is regular");
        let candidate = candidate(&regression.design, EffectKind::Spring, vec![columns]);
        regression.judge(&candidate).expect("a small problem is regular")
    };
    // What changes there is the error of the parameter, a hundred times what the law can be.
    let of_all = judge(design.clone());
    assert!(of_all.held_out[2].abs() > 1e4, "{of_all:?}");
    design.untold = std::sync::Arc::new([(1, 2)].into());
    let told = judge(design);
    assert!((0.0..100.0).contains(&told.held_out[2]) && told.lost == 0, "{told:?}");
}

#[test]
fn what_a_prediction_gains_scatters_by_the_error_of_the_parameters_as_its_deviation_says() {
    let mut rng = Pcg64::seed_from_u64(5);
    // The second column is small in the motions that are fitted, and large in the one that is predicted.
    let columns: Vec<Vec<f64>> = [1.0, 0.3]
        .map(|scale| {
            (0..ALL).map(|r| rng.random_range(-1.0..1.0) * if r < 2 * ROWS { scale } else { 1.0 }).collect()
        })
        .to_vec();
    // So is what the law has in common with it.
    let shared = |r: usize| if r < 2 * ROWS { 0.5 } else { 1.5 };
    let own = |(r, c): (usize, &f64)| shared(r) * c + 0.3 * rng.random_range(-1.0..1.0);
    let own: Vec<f64> = columns[1].iter().enumerate().map(own).collect();
    let train = vec![true, true, false];
    let design = Design::made_up(1, &SEGMENTS, ROWS, columns, noise(&mut rng));
    let law = candidate(&design, EffectKind::Spring, vec![own]);
    let fit = Fit::new(&design, &[1.0], train.clone()).expect("a small problem is regular");
    let part = fit.project_out(&law.trials[0]).expect("a small problem is regular");
    let prediction = Prediction::new(&fit, &law.trials[0], &part, nalgebra::DVector::from_element(1, 1.0));
    let held = design.ranges[0][2].clone();
    let expected = prediction.deviation_by_parameters(&design, &[held.clone().collect()]);

    let runs = 2000;
    let mut squares = 0.0;
    for _ in 0..runs {
        let mut design = design.clone();
        design.y = noise(&mut rng);
        // The rows that are predicted have none of their own.
        design.y[held.clone()].fill(0.0);
        design.refresh();
        let fit = Fit::new(&design, &[1.0], train.clone()).expect("a small problem is regular");
        let fitted = Prediction::new(&fit, &law.trials[0], &part, prediction.amplitude.clone());
        let rows: Vec<usize> = held.clone().collect();
        let own: f64 = fitted.changes(&design, 0, &rows).iter().map(|change| change * change).sum();
        let [gain, _] = fitted.gain_on(&design, 0, &rows);
        squares += (gain + own).powi(2);
    }
    let deviation = (squares / f64::from(runs)).sqrt();
    assert!((deviation / expected - 1.0).abs() < 0.06, "{deviation}, expected {expected}");
}
