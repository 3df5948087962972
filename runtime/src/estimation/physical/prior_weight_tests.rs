#![allow(clippy::unwrap_used)]
use crate::estimation::physical::testing::{arm, rod, sigmas, standard};
use crate::estimation::physical::{NearPrior, Prior, near_prior};
use nalgebra::{Cholesky, DMatrix, DVector};
use rand::SeedableRng;
use rand_pcg::Pcg64;

use crate::testing::normal;

/// Identified values of an arm with links of 6 and 3 kg, as far off as their covariance says; with the true ones.
fn identified(
    seed: u64,
    covariance_of: &dyn Fn(&[f64]) -> DMatrix<f64>,
) -> (Vec<f64>, Vec<f64>, DMatrix<f64>) {
    let mut random = Pcg64::seed_from_u64(seed);
    let robot = arm();
    let truth = robot.base_from_standard(&standard(&robot, [rod(6.0, 0.4), rod(3.0, 0.3)]));
    let covariance = covariance_of(&truth);
    let root = Cholesky::new(covariance.clone()).unwrap().l();
    let chi =
        DVector::from_column_slice(&truth) + root * DVector::from_fn(truth.len(), |_, _| normal(&mut random));
    (chi.as_slice().to_vec(), truth, covariance)
}

/// A prior whose links are so many times as heavy and as long.
fn times(mass: f64, length: f64) -> Prior {
    Prior {
        bodies: vec![Some(rod(6.0 * mass, 0.4 * length)), Some(rod(3.0 * mass, 0.3 * length))],
        attached: vec![[0.0; 10]; 2],
        rotors: vec![Some(0.3); 2],
        ellipsoids: vec![None; 2],
    }
}

/// Squared distance of values from others in units of a covariance: what the torques lose by the difference.
fn squared(a: &[f64], b: &[f64], covariance: &DMatrix<f64>) -> f64 {
    let off = DVector::from_fn(a.len(), |k, _| a[k] - b[k]);
    off.dot(&Cholesky::new(covariance.clone()).unwrap().solve(&off))
}

/// Mean, over recordings, of the squared error of the bodies' base parameters over that of the identified ones.
fn mean_error(prior: &Prior, covariance_of: &dyn Fn(&[f64]) -> DMatrix<f64>) -> f64 {
    let robot = arm();
    let errors = (0..40).map(|seed| {
        let (chi, truth, covariance) = identified(seed, covariance_of);
        let near = near_prior(&robot, &chi, &covariance, prior).unwrap();
        [squared(&near.chi, &truth, &covariance), squared(&chi, &truth, &covariance)]
    });
    let [bodies, free] = errors.fold([0.0, 0.0], |sum, pair| [sum[0] + pair[0], sum[1] + pair[1]]);
    bodies / free
}

fn correlated(chi: &[f64]) -> DMatrix<f64> {
    let own = sigmas(chi, 0.05);
    DMatrix::from_fn(chi.len(), chi.len(), |i, k| {
        (own[(i, i)] * own[(k, k)]).sqrt() * 0.8_f64.powf(i.abs_diff(k) as f64)
    })
}

#[test]
fn a_right_prior_takes_error_away_and_a_wrong_one_adds_little() {
    for covariance_of in [&(|chi: &[f64]| sigmas(chi, 0.05)) as &dyn Fn(&[f64]) -> DMatrix<f64>, &correlated]
    {
        // Of thirteen, the six of friction and offsets stay as they were identified.
        let right = mean_error(&times(1.0, 1.0), covariance_of);
        assert!(right < 0.7, "{right}");
        for wrong in [times(1.1, 0.95), times(0.7, 1.2), times(2.0, 1.5), times(0.3, 0.5)] {
            let found = mean_error(&wrong, covariance_of);
            assert!(found < 1.2, "{found} with {wrong:?}");
        }
    }
}

fn found(chi: &[f64], covariance: &DMatrix<f64>, prior: &Prior) -> NearPrior {
    near_prior(&arm(), chi, covariance, prior).unwrap()
}

#[test]
fn the_weight_falls_as_the_data_show_that_the_prior_is_wrong() {
    let weights: Vec<f64> = [0.3, 0.1, 0.03, 0.01]
        .iter()
        .map(|&relative| {
            let (_, truth, covariance) = identified(0, &|chi| sigmas(chi, relative));
            let near = found(&truth, &covariance, &times(1.3, 1.1));
            assert!(near.freedom > 6.0 && near.freedom < 13.0 && near.dispersion == 1.0, "{near:?}");
            // In units of what was known before: the prior's own curvature does not change.
            near.gamma * relative * relative
        })
        .collect();
    assert!(weights.windows(2).all(|pair| pair[1] < pair[0]), "{weights:?}");
}

#[test]
fn uncertainties_that_no_body_meets_are_too_small_and_do_not_drive_bodies_to_the_rim() {
    let robot = arm();
    let (mut chi, _, covariance) = identified(1, &|chi| sigmas(chi, 0.01));
    // Less inertia about the elbow than the link's centre alone has.
    chi[robot.base.iter().position(|b| b.name == "ZZ2").unwrap()] = -0.05;
    chi[robot.base.iter().position(|b| b.name == "Ia2").unwrap()] = 0.01;
    let near = found(&chi, &covariance, &times(1.1, 1.0));
    assert!(near.least > 10.0 * near.determined as f64 && near.dispersion > 10.0, "{near:?}");
    // The shoulder's mass does not show; of its prior of 6.6 kg it keeps most.
    let shoulder = near.standard[robot.standard.iter().position(|p| p.name == "M1").unwrap()];
    assert!((4.0..9.0).contains(&shoulder), "{near:?}");
    assert!(near.divergence[0] < 1.0, "{near:?}");
}
