#![allow(clippy::unwrap_used)]
use super::*;
use crate::estimation::observe::{EquationFactor, LeftOut, TimeBlock};
use crate::estimation::{Essential, Factor};
use nalgebra::{DMatrix, DVector};
use rand::{RngExt, SeedableRng};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

/// The rows of one equation of one trajectory, dense.
struct Dense {
    trajectory: usize,
    equation: usize,
    columns: Vec<usize>,
    w: DMatrix<f64>,
    y: DVector<f64>,
}

fn factor(w: &DMatrix<f64>, y: &DVector<f64>, rows: std::ops::Range<usize>) -> Factor {
    let mut factor = Factor::new(w.ncols());
    let stride = rows.len().next_multiple_of(4);
    let mut block = vec![0.0; (w.ncols() + 1) * stride];
    for (i, row) in rows.clone().enumerate() {
        for l in 0..w.ncols() {
            block[l * stride + i] = w[(row, l)];
        }
        block[w.ncols() * stride + i] = y[row];
    }
    factor.push(rows.len(), stride, &mut block);
    factor
}

fn observation(unknowns: &[&str], dense: &[Dense], blocks: usize) -> Observation {
    let of = |d: &Dense, rows| EquationFactor {
        trajectory: d.trajectory,
        equation: d.equation,
        columns: d.columns.clone(),
        factor: factor(&d.w, &d.y, rows),
        reversals: Vec::new(),
    };
    let trajectories = dense.iter().map(|d| d.trajectory + 1).max().unwrap();
    let time_blocks = (0..trajectories)
        .flat_map(|trajectory| (0..blocks).map(move |b| (trajectory, b)))
        .map(|(trajectory, b)| TimeBlock {
            trajectory,
            time: [b as f64, b as f64 + 1.0],
            equations: dense
                .iter()
                .filter(|d| d.trajectory == trajectory)
                .map(|d| {
                    let n = d.y.len();
                    of(d, b * n / blocks..(b + 1) * n / blocks)
                })
                .collect(),
        })
        .collect();
    Observation {
        equations: Equations::Torque,
        unknowns: unknowns.iter().map(|s| s.to_string()).collect(),
        base: unknowns.len(),
        fixed: Vec::new(),
        exact: vec![false; unknowns.len()],
        trajectories: (0..trajectories).map(|t| format!("t{t}")).collect(),
        rates: vec![100.0; trajectories],
        bands: vec![50.0; trajectories],
        groups: dense.iter().map(|d| of(d, 0..d.y.len())).collect(),
        blocks: time_blocks,
        left_out: vec![LeftOut::default(); dense.len()],
        samples: 0,
        rows: None,
        noise_of_columns: None,
    }
}

const TRUE: [f64; 5] = [2.0, -1.0, 0.5, 3.0, -0.25];

/// Two equations and two trajectories in block-triangular form, with errors of very different size.
fn made(seed: u64, rows: usize, errors: [[f64; 2]; 2], memory: f64) -> Vec<Dense> {
    // The motion is the same for every seed of the noise.
    let mut motion = Pcg64::seed_from_u64(1);
    let mut noise = Pcg64::seed_from_u64(seed);
    let mut all = Vec::new();
    for (trajectory, errors) in errors.iter().enumerate() {
        for (equation, error) in errors.iter().enumerate() {
            let columns: Vec<usize> = if equation == 0 { (0..5).collect() } else { vec![2, 3, 4] };
            // Slow columns, like those of a robot: noise with memory then matters.
            let mut state = vec![0.0; columns.len()];
            let w = DMatrix::from_row_iterator(
                rows,
                columns.len(),
                (0..rows * columns.len()).map(|k| {
                    let l = k % columns.len();
                    state[l] = 0.9 * state[l] + motion.random_range(-1.0..1.0);
                    state[l]
                }),
            );
            let mut e = 0.0;
            let y = DVector::from_fn(rows, |i, _| {
                let shock: f64 = StandardNormal.sample(&mut noise);
                e = memory * e + (1.0 - memory * memory).sqrt() * shock;
                columns.iter().enumerate().map(|(l, &c)| w[(i, l)] * TRUE[c]).sum::<f64>() + error * e
            });
            all.push(Dense { trajectory, equation, columns, w, y });
        }
    }
    all
}

const NAMES: [&str; 5] = ["a", "b", "c", "d", "e"];
const ERRORS: [[f64; 2]; 2] = [[3.0, 0.1], [0.5, 0.02]];

fn plain() -> EstimateSettings {
    EstimateSettings { r_sigma: None, ..EstimateSettings::default() }
}

/// W and Y of everything, each group divided by its sigma.
fn stacked(dense: &[Dense], sigma: &[f64]) -> (DMatrix<f64>, DVector<f64>) {
    let rows: usize = dense.iter().map(|d| d.y.len()).sum();
    let mut w = DMatrix::zeros(rows, 5);
    let mut y = DVector::zeros(rows);
    let mut at = 0;
    for (d, s) in dense.iter().zip(sigma) {
        for i in 0..d.y.len() {
            for (l, &c) in d.columns.iter().enumerate() {
                w[(at, c)] = d.w[(i, l)] / s;
            }
            y[at] = d.y[i] / s;
            at += 1;
        }
    }
    (w, y)
}

#[test]
fn weighted_least_squares_is_that_of_the_textbook() {
    let dense = made(7, 150, ERRORS, 0.0);
    let estimate = estimate(&observation(&NAMES, &dense, 10), &plain());
    let mut sigma = vec![1.0; 4];
    let mut chi = DVector::zeros(5);
    for _ in 0..60 {
        let (w, y) = stacked(&dense, &sigma);
        let inverse = (w.transpose() * &w).try_inverse().unwrap();
        chi = &inverse * w.transpose() * &y;
        // Squares and degrees of freedom of each group: rows less the trace of its part of the hat matrix.
        let left: Vec<(f64, f64)> = sigma
            .iter()
            .zip(&dense)
            .map(|(s, d)| {
                let own = DVector::from_iterator(d.columns.len(), d.columns.iter().map(|&c| chi[c]));
                let part = inverse.select_rows(&d.columns).select_columns(&d.columns);
                let hat = &d.w * part * d.w.transpose() / (s * s);
                ((&d.y - &d.w * own).norm_squared(), 150.0 - hat.trace())
            })
            .collect();
        for (g, s) in sigma.iter_mut().enumerate() {
            // The two motions of a joint lend each other one degree of freedom.
            let joint = left.iter().zip(&dense).filter(|(_, d)| d.equation == dense[g].equation);
            let (squares, freedom) = joint.fold((0.0, 0.0), |(a, b), (l, _)| (a + l.0, b + l.1));
            *s = ((squares / freedom + left[g].0) / (1.0 + left[g].1)).sqrt();
        }
    }
    let (w, y) = stacked(&dense, &sigma);
    let gram = (w.transpose() * &w).try_inverse().unwrap();
    let noise = (&y - &w * &chi).norm_squared() / 595.0;
    for l in 0..5 {
        assert!((estimate.parameters[l].value - chi[l]).abs() < 1e-6 * chi[l].abs());
        let expected = (noise * gram[(l, l)]).sqrt();
        assert!((estimate.parameters[l].sigma_white.unwrap() / expected - 1.0).abs() < 1e-4);
    }
    assert_eq!(estimate.method, Method::IdimWls);
    assert_eq!((estimate.rows, estimate.degrees_of_freedom), (600, 595));
    for (error, expected) in estimate.errors.iter().zip(ERRORS.concat()) {
        assert!((error.sigma.unwrap() / expected - 1.0).abs() < 0.2);
    }
    assert!(estimate.warnings.is_empty());
}

#[test]
fn ordinary_least_squares_weighs_every_row_the_same() {
    let dense = made(7, 150, ERRORS, 0.0);
    let settings = EstimateSettings { weighted: false, ..plain() };
    let estimate = estimate(&observation(&NAMES, &dense, 10), &settings);
    let (w, y) = stacked(&dense, &[1.0; 4]);
    let chi = (w.transpose() * &w).try_inverse().unwrap() * w.transpose() * &y;
    for l in 0..5 {
        assert!((estimate.parameters[l].value - chi[l]).abs() < 1e-10);
    }
    assert!((estimate.relative_error.unwrap() - (&y - &w * &chi).norm() / y.norm()).abs() < 1e-12);
}

/// Spread of the values over seeds, and the mean of the two kinds of sigma.
fn monte_carlo(memory: f64) -> Vec<[f64; 3]> {
    let runs = 300;
    let mut values = vec![Vec::new(); 5];
    let mut sigmas = vec![[0.0; 2]; 5];
    for seed in 0..runs {
        let dense = made(1000 + seed, 400, ERRORS, memory);
        let estimate = estimate(&observation(&NAMES, &dense, 12), &plain());
        for (l, p) in estimate.parameters.iter().enumerate() {
            values[l].push(p.value);
            sigmas[l][0] += p.sigma_white.unwrap() / runs as f64;
            sigmas[l][1] += p.sigma_blocks.unwrap() / runs as f64;
        }
    }
    values
        .iter()
        .zip(sigmas)
        .enumerate()
        .map(|(l, (v, s))| {
            let spread = v.iter().map(|x| (x - TRUE[l]).powi(2)).sum::<f64>() / v.len() as f64;
            [spread.sqrt(), s[0], s[1]]
        })
        .collect()
}

#[test]
fn sigmas_are_the_spread_over_seeds_when_errors_are_independent() {
    for [spread, white, blocks] in monte_carlo(0.0) {
        assert!((0.85..1.15).contains(&(white / spread)), "{white} {spread}");
        assert!((0.85..1.3).contains(&(blocks / spread)), "{blocks} {spread}");
    }
}

#[test]
fn sigmas_by_blocks_stay_honest_when_errors_last() {
    for [spread, white, blocks] in monte_carlo(0.9) {
        assert!(white < 0.6 * spread, "the paper's assumption is far too optimistic: {white} {spread}");
        assert!((0.8..1.4).contains(&(blocks / spread)), "{blocks} {spread}");
    }
}

#[test]
fn parameters_that_the_motion_does_not_determine_are_named() {
    let mut dense = made(3, 150, ERRORS, 0.0);
    for d in &mut dense {
        let c = d.columns.iter().position(|&c| c == 2).unwrap();
        let twice = d.w.column(c) * 2.0;
        d.w.set_column(c + 1, &twice);
        if d.equation == 0 {
            d.w.column_mut(0).fill(0.0);
        }
    }
    let estimate = estimate(&observation(&NAMES, &dense, 10), &plain());
    let named: Vec<String> = estimate.warnings.iter().map(|w| w.to_string()).collect();
    assert_eq!(named.len(), 2, "{named:?}");
    assert!(named.iter().any(|w| w.starts_with("a is not determined: nothing")));
    assert!(named.iter().any(|w| w.contains("cannot be told from") && w.contains('c') && w.contains('d')));
    assert_eq!(estimate.parameters[0].sigma, None);
    assert_eq!(estimate.parameters.iter().filter(|p| p.sigma.is_some()).count(), 3);
    assert!(estimate.relative_error.unwrap().is_finite());
}

#[test]
fn a_column_of_rounding_errors_determines_nothing() {
    let mut dense = made(3, 150, ERRORS, 0.0);
    let mut rng = Pcg64::seed_from_u64(5);
    for d in &mut dense {
        let c = d.columns.iter().position(|&c| c == 3).unwrap();
        let rounding = d.w.column(c).map(|_| 1e-15 * rng.random_range(-1.0..1.0));
        d.w.set_column(c, &rounding);
    }
    let estimate = estimate(&observation(&NAMES, &dense, 10), &plain());
    assert_eq!((estimate.parameters[3].value, estimate.parameters[3].sigma), (0.0, None));
    let named: Vec<String> = estimate.warnings.iter().map(|w| w.to_string()).collect();
    assert!(named.iter().any(|w| w.starts_with("d is not determined: nothing")), "{named:?}");
}

#[test]
fn a_badly_conditioned_direction_is_named() {
    let mut dense = made(3, 150, ERRORS, 0.0);
    let mut rng = Pcg64::seed_from_u64(4);
    for d in &mut dense {
        let c = d.columns.iter().position(|&c| c == 3).unwrap();
        let nearly = d.w.column(c).map(|x| x + 1e-4 * rng.random_range(-1.0..1.0));
        d.w.set_column(c + 1, &nearly);
    }
    let estimate = estimate(&observation(&NAMES, &dense, 10), &plain());
    let Some(Warning::BadlyConditioned { condition, parameters }) = estimate.warnings.first() else {
        panic!("{:?}", estimate.warnings);
    };
    assert!(*condition > 1e4);
    let mut parameters = parameters.clone();
    parameters.sort_unstable();
    assert_eq!(parameters, ["d", "e"]);
}

#[test]
fn an_equation_on_which_iterated_weights_give_up_is_reported_and_kept() {
    // The second joint's torque has the wrong sign and three times the size: one of the two must be wrong.
    let mut dense = made(5, 150, [[0.01, 0.01]; 2], 0.0);
    for d in dense.iter_mut().filter(|d| d.equation == 1) {
        d.y *= -3.0;
    }
    let estimate = estimate(&observation(&NAMES, &dense, 10), &plain());
    let collapsed: Vec<&Warning> = estimate
        .warnings
        .iter()
        .filter(|w| matches!(w, Warning::WeightCollapsed { relative_error, .. } if *relative_error > 1.0))
        .collect();
    assert_eq!(collapsed.len(), 1, "{:?}", estimate.warnings);
    assert_eq!(estimate.iterations, 0);
}

/// The essential parameters of orthogonal columns of equal length, whose relative standard deviations are inversely
/// proportional to the values: that of c is 25 times that of a.
fn essential_beside(noise: f64) -> Essential {
    let w = DMatrix::<f64>::identity(40, 5) * 10.0;
    let values = [100.0, 10.0, 4.0, 6.0, 0.5];
    let mut rng = Pcg64::seed_from_u64(2);
    let y =
        DVector::from_fn(40, |i, _| if i < 5 { 10.0 * values[i] } else { rng.random_range(-noise..noise) });
    let dense = [Dense { trajectory: 0, equation: 0, columns: (0..5).collect(), w, y }];
    let settings = EstimateSettings { r_sigma: Some(20.0), ..EstimateSettings::default() };
    let essential = estimate(&observation(&NAMES, &dense, 1), &settings).essential.unwrap();
    for p in &essential.parameters {
        let l = NAMES.iter().position(|n| *n == p.name).unwrap();
        assert!((p.value - values[l]).abs() < 1e-9);
    }
    essential
}

#[test]
fn essential_parameters_are_those_within_the_ratio_of_the_best() {
    let essential = essential_beside(10.0);
    assert_eq!(essential.cancelled, ["e", "c"]);
    let kept: Vec<&str> = essential.parameters.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(kept, ["a", "b", "d"]);
}

#[test]
fn a_parameter_that_is_known_to_a_hundredth_is_essential_whatever_the_best_is_known_to() {
    let essential = essential_beside(1.0);
    assert_eq!(essential.cancelled, ["e"]);
    assert!(essential.parameters.iter().any(|p| p.name == "c"));
}

#[test]
fn perfect_data_have_finite_weights_and_the_exact_parameters() {
    let dense = made(5, 60, [[0.0; 2]; 2], 0.0);
    let estimate = estimate(&observation(&NAMES, &dense, 6), &EstimateSettings::default());
    for (p, expected) in estimate.parameters.iter().zip(TRUE) {
        assert!((p.value - expected).abs() < 1e-11);
    }
    assert!(estimate.relative_error.unwrap() < 1e-12);
}

#[test]
fn a_disturbed_block_of_time_counts_less_and_does_not_move_the_robust_estimate() {
    let mut dense = made(11, 400, [[0.1, 0.1]; 2], 0.0);
    dense.truncate(1);
    // Somebody leans on the joint for one block in ten.
    for i in 120..160 {
        dense[0].y[i] += 20.0;
    }
    let seen = observation(&NAMES, &dense, 10);
    let distance = |e: &Estimate| -> f64 {
        e.parameters.iter().zip(TRUE).map(|(p, x)| (p.value - x).powi(2)).sum::<f64>().sqrt()
    };
    let ordinary = estimate(&seen, &plain());
    let robust = estimate(
        &seen,
        &EstimateSettings { r_sigma: None, ..EstimateSettings::for_method(Method::IdimIrls) },
    );
    assert_eq!(robust.method, Method::IdimIrls);
    assert!(distance(&robust) < 0.2 * distance(&ordinary), "{} {}", distance(&robust), distance(&ordinary));
    let low: Vec<_> = robust.low_blocks.iter().map(|b| (b.trajectory, b.equation, b.time)).collect();
    assert_eq!(low, [(0, 0, [3.0, 4.0])]);
}

#[test]
fn methods_are_found_by_the_name_they_print() {
    for method in Method::ALL {
        assert_eq!(method.name().parse(), Ok(method));
        assert_eq!(serde_json::to_string(&method).unwrap(), format!("\"{}\"", method.name()));
    }
    assert!("idim".parse::<Method>().unwrap_err().contains("idim-wls"));
}
