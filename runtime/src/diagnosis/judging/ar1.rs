//! First-order autocorrelation of a residual, and the covariance of its inner products with other columns.

use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::{HIGHEST_RHO, RHO_MARGIN, UNCORRELATED};
use nalgebra::DMatrix;

/// Rows of a joint, motion by motion: their place in the motion, counted in rows, and their index in the design.
#[derive(Debug, Clone, Default)]
pub(in crate::diagnosis) struct Places(Vec<Vec<(usize, usize)>>);

impl Places {
    /// Where the rows of a joint are.
    pub fn of(design: &Design, joint: usize) -> Self {
        let motions = design.segments.iter().map(|s| s.signal + 1).max().unwrap_or(0);
        let motion = |signal: usize| {
            let rows = design.of_signal(joint, signal).into_iter().flat_map(|(range, _)| range);
            rows.map(|r| (design.rows[r].centre / design.spacing(signal), r)).collect()
        };
        Self((0..motions).map(motion).collect())
    }

    /// Motion by motion: place and row.
    pub fn motions(&self) -> &[Vec<(usize, usize)>] {
        &self.0
    }
}

/// The lag, in rows, from which on values are uncorrelated; `longest` where they never are.
pub(in crate::diagnosis) fn decorrelation_lag(places: &Places, values: &[f64], longest: usize) -> usize {
    (1..longest).find(|&lag| autocorrelation(places, values, lag) < UNCORRELATED).unwrap_or(longest)
}

/// Correlation of values with themselves `lag` places later, over pairs of places that are there.
fn autocorrelation(places: &Places, values: &[f64], lag: usize) -> f64 {
    let (mut products, mut pairs, mut squares, mut rows) = (0.0, 0, 0.0, 0);
    for motion in &places.0 {
        let mut later = motion.iter().peekable();
        for &(place, r) in motion {
            squares += values[r] * values[r];
            rows += 1;
            while later.next_if(|(l, _)| *l < place + lag).is_some() {}
            if let Some((_, other)) = later.peek().filter(|(l, _)| *l == place + lag) {
                products += values[r] * values[*other];
                pairs += 1;
            }
        }
    }
    if pairs == 0 || squares == 0.0 { 0.0 } else { products / pairs as f64 / (squares / rows as f64) }
}

/// AR(1) residual; `rho` from the sum of positive autocorrelations up to the decorrelation lag, plus a margin.
pub(in crate::diagnosis) struct Ar1 {
    /// Correlation of neighbouring places.
    rho: f64,
    /// Mean square.
    variance: f64,
    rows: usize,
}

impl Ar1 {
    /// Of the residual of a joint.
    pub fn of(places: &Places, residual: &[f64], longest: usize) -> Self {
        let rows = places.0.iter().map(Vec::len).sum::<usize>();
        let squares: f64 = places.0.iter().flatten().map(|&(_, r)| residual[r] * residual[r]).sum();
        let sum: f64 = (1..=decorrelation_lag(places, residual, longest))
            .map(|lag| autocorrelation(places, residual, lag).max(0.0))
            .sum();
        // The autocorrelations rho, rho², rho³ .. add up to rho / (1 - rho).
        let estimate = sum / (1.0 + sum);
        let count = rows.max(1) as f64;
        Self { rho: (estimate + RHO_MARGIN / count.sqrt()).min(HIGHEST_RHO), variance: squares / count, rows }
    }

    /// Independent rows that say as much about a variance as the rows do.
    pub fn independent_rows(&self) -> f64 {
        let square = self.rho * self.rho;
        self.rows as f64 * (1.0 - square) / (1.0 + square)
    }

    /// Covariance of the inner products of columns with such a residual.
    pub fn covariance(&self, places: &Places, columns: &[Vec<f64>]) -> DMatrix<f64> {
        let k = columns.len();
        let mut sum = DMatrix::zeros(k, k);
        for motion in &places.0 {
            // Per column: the rows before, each weighted by its correlation with this one.
            let mut before = vec![0.0; k];
            let mut last = 0;
            for &(place, r) in motion {
                let decay = self.rho.powf(place.saturating_sub(last) as f64);
                last = place;
                before.iter_mut().for_each(|b| *b *= decay);
                for a in 0..k {
                    for b in 0..k {
                        sum[(a, b)] += columns[a][r] * columns[b][r]
                            + columns[a][r] * before[b]
                            + before[a] * columns[b][r];
                    }
                }
                before.iter_mut().zip(columns).for_each(|(b, c)| *b += c[r]);
            }
        }
        sum * self.variance
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::judging::significance::Evidence;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    #[test]
    fn correlation_looks_at_pairs_of_rows_that_are_there() {
        // A square wave of period 4, with rows missing: 1 after four rows, -1 after two, nothing after one.
        let values: Vec<f64> = (0..400).map(|k| if k % 4 < 2 { 1.0 } else { -1.0 }).collect();
        let there = Places(vec![(0..400).filter(|k| k % 37 != 0).map(|k| (k, k)).collect()]);
        assert!((autocorrelation(&there, &values, 4) - 1.0).abs() < 1e-12);
        assert!((autocorrelation(&there, &values, 2) + 1.0).abs() < 1e-12);
        assert!(autocorrelation(&there, &values, 1).abs() < 0.02);
        assert_eq!(autocorrelation(&Places(vec![vec![(0, 0), (9, 1)]]), &values, 1), 0.0);
    }

    #[test]
    fn covariance_is_that_of_the_full_matrix_with_rows_missing_and_motions_apart() {
        let columns = [vec![1.0, -2.0, 0.5, 3.0, 1.5], vec![0.3, 0.1, -0.7, 2.0, -1.0]];
        let there = Places(vec![vec![(0, 0), (1, 1), (4, 2)], vec![(0, 3), (2, 4)]]);
        let noise = Ar1 { rho: 0.6, variance: 2.0, rows: 5 };
        let at = [(0, 0), (0, 1), (0, 4), (1, 0), (1, 2)];
        let expected = DMatrix::from_fn(2, 2, |a, b| {
            let mut sum = 0.0;
            for (i, &(motion, place)) in at.iter().enumerate() {
                for (k, &(_, later)) in at.iter().enumerate().filter(|(_, other)| other.0 == motion) {
                    let gap = i32::abs(place - later);
                    sum += 2.0 * columns[a][i] * columns[b][k] * 0.6_f64.powi(gap);
                }
            }
            sum
        });
        assert!((noise.covariance(&there, &columns) - expected).norm() < 1e-12);
    }

    /// How often a wave that has nothing to do with an AR(1) residual has a p-value below each of these levels.
    fn false_positives(rho: f64, levels: [f64; 2]) -> [f64; 2] {
        let (rows, runs) = (180, 20_000);
        let there = Places(vec![(0..rows).map(|k| (k, k)).collect()]);
        let mut rng = Pcg64::seed_from_u64(30);
        let mut below = [0; 2];
        for _ in 0..runs {
            let mut x = 0.0;
            let mut residual: Vec<f64> = (0..rows + 50)
                .map(|_| {
                    let new: f64 = (0..12).map(|_| rng.random_range(-0.5..0.5)).sum();
                    x = rho * x + new;
                    x
                })
                .skip(50)
                .collect();
            // A drift: there in the first strokes, gone in the last.
            let stroke = rng.random_range(10..30);
            let way = |k: usize| if (k / stroke).is_multiple_of(2) { 1.0 } else { -1.0 };
            let drift = |k: usize| way(k) * (-(k as f64) / 60.0).exp();
            let wave: Vec<f64> = (0..rows).map(drift).collect();
            let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
            let product = dot(&wave, &residual);
            let amplitude = product / dot(&wave, &wave);
            residual.iter_mut().zip(&wave).for_each(|(r, w)| *r -= amplitude * w);
            let noise = Ar1::of(&there, &residual, 25);
            let variance = noise.covariance(&there, &[wave])[(0, 0)];
            let p_value = Evidence::fisher(product * product / variance, 1, noise.independent_rows()).p_value;
            below.iter_mut().zip(levels).for_each(|(b, level)| *b += usize::from(p_value < level));
        }
        below.map(|b| b as f64 / runs as f64)
    }

    #[test]
    fn noise_passes_no_more_often_than_its_p_value_says_however_correlated_the_residual_is() {
        for rho in [0.0, 0.3, 0.5, 0.7] {
            let [often, seldom] = false_positives(rho, [0.01, 0.001]);
            println!("{rho}: {:.2} % below 1 %, {:.3} % below 0.1 %", 100.0 * often, 100.0 * seldom);
            assert!(often < 0.01, "{rho}: {often}");
            assert!(seldom < 0.001, "{rho}: {seldom}");
        }
    }

    #[test]
    fn a_correlated_residual_counts_for_fewer_rows() {
        let there = Places(vec![(0..200).map(|k| (k, k)).collect()]);
        let slow: Vec<f64> = (0..200).map(|k| f64::sin(k as f64 / 10.0)).collect();
        let fast: Vec<f64> = (0..200).map(|k| f64::sin(2.5 * k as f64)).collect();
        assert!(Ar1::of(&there, &slow, 50).independent_rows() < 10.0);
        assert!(Ar1::of(&there, &fast, 50).independent_rows() > 180.0);
        // Nothing left at all is no division by zero.
        assert!(Ar1::of(&there, &[0.0; 200], 50).independent_rows() > 180.0);
        assert_eq!(Ar1::of(&Places::default(), &[], 50).independent_rows(), 0.0);
    }
}
