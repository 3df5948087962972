//! How long a residual remembers, and what that makes of its inner products with other columns.

use crate::diagnosis::rows::design::Design;
use nalgebra::DMatrix;

/// Rows of a joint, motion by motion: their place in the motion, counted in rows, and their index in the design.
pub(in crate::diagnosis) type Places = Vec<Vec<(usize, usize)>>;

/// Autocorrelation below which a residual has forgotten.
const FORGOTTEN: f64 = 0.2;
/// The memory is taken for longer than it looks by this many standard errors of an autocorrelation: what a fit takes
/// out of a residual takes its slow parts first.
const LONGER: f64 = 2.0;
/// Longest memory: correlation of neighbouring rows.
const LONGEST: f64 = 0.97;

/// Where the rows of a joint are.
pub(in crate::diagnosis) fn places(design: &Design, joint: usize) -> Places {
    let motions = design.segments.iter().map(|s| s.signal + 1).max().unwrap_or(0);
    let motion = |signal: usize| {
        let rows = design.of_signal(joint, signal).into_iter().flat_map(|(range, _)| range);
        rows.map(|r| (design.rows[r].centre / design.spacing(signal), r)).collect()
    };
    (0..motions).map(motion).collect()
}

/// The lag, in rows, at which values have forgotten themselves; `longest` where they never do.
pub(in crate::diagnosis) fn forgotten(places: &Places, values: &[f64], longest: usize) -> usize {
    (1..longest).find(|&lag| autocorrelation(places, values, lag) < FORGOTTEN).unwrap_or(longest)
}

/// Correlation of values with themselves `lag` places later, over pairs of places that are there.
fn autocorrelation(places: &Places, values: &[f64], lag: usize) -> f64 {
    let (mut products, mut pairs, mut squares, mut rows) = (0.0, 0, 0.0, 0);
    for motion in places {
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

/// A memory that fades by the same factor from each place to the next, and is as long, all autocorrelations taken
/// together, as that of the residual up to where it has forgotten.
pub(in crate::diagnosis) struct Memory {
    /// Correlation of neighbouring places.
    fading: f64,
    /// Mean square.
    variance: f64,
    rows: usize,
}

impl Memory {
    /// Of the residual of a joint.
    pub fn of(places: &Places, residual: &[f64], longest: usize) -> Self {
        let rows = places.iter().map(Vec::len).sum::<usize>();
        let squares: f64 = places.iter().flatten().map(|&(_, r)| residual[r] * residual[r]).sum();
        let remembered: f64 = (1..=forgotten(places, residual, longest))
            .map(|lag| autocorrelation(places, residual, lag).max(0.0))
            .sum();
        // The autocorrelations x, x², x³ .. add up to x / (1 - x).
        let seen = remembered / (1.0 + remembered);
        let count = rows.max(1) as f64;
        Self { fading: (seen + LONGER / count.sqrt()).min(LONGEST), variance: squares / count, rows }
    }

    /// Independent rows that say as much about a variance as the rows do.
    pub fn independent_rows(&self) -> f64 {
        let square = self.fading * self.fading;
        self.rows as f64 * (1.0 - square) / (1.0 + square)
    }

    /// Covariance of the inner products of columns with a residual that remembers like this.
    pub fn covariance(&self, places: &Places, columns: &[Vec<f64>]) -> DMatrix<f64> {
        let k = columns.len();
        let mut sum = DMatrix::zeros(k, k);
        for motion in places {
            // What the rows before are still remembered for, per column.
            let mut before = vec![0.0; k];
            let mut last = 0;
            for &(place, r) in motion {
                let faded = self.fading.powf(place.saturating_sub(last) as f64);
                last = place;
                before.iter_mut().for_each(|b| *b *= faded);
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
        let there: Places = vec![(0..400).filter(|k| k % 37 != 0).map(|k| (k, k)).collect()];
        assert!((autocorrelation(&there, &values, 4) - 1.0).abs() < 1e-12);
        assert!((autocorrelation(&there, &values, 2) + 1.0).abs() < 1e-12);
        assert!(autocorrelation(&there, &values, 1).abs() < 0.02);
        assert_eq!(autocorrelation(&vec![vec![(0, 0), (9, 1)]], &values, 1), 0.0);
    }

    #[test]
    fn covariance_is_that_of_the_full_matrix_with_rows_missing_and_motions_apart() {
        let columns = [vec![1.0, -2.0, 0.5, 3.0, 1.5], vec![0.3, 0.1, -0.7, 2.0, -1.0]];
        let there: Places = vec![vec![(0, 0), (1, 1), (4, 2)], vec![(0, 3), (2, 4)]];
        let memory = Memory { fading: 0.6, variance: 2.0, rows: 5 };
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
        assert!((memory.covariance(&there, &columns) - expected).norm() < 1e-12);
    }

    /// How often a wave that has nothing to do with a residual, each value of which is `again` times the one before
    /// and something new, comes below each of these tails.
    fn accidents(again: f64, levels: [f64; 2]) -> [f64; 2] {
        let (rows, runs) = (180, 20_000);
        let there: Places = vec![(0..rows).map(|k| (k, k)).collect()];
        let mut rng = Pcg64::seed_from_u64(30);
        let mut below = [0; 2];
        for _ in 0..runs {
            let mut x = 0.0;
            let mut residual: Vec<f64> = (0..rows + 50)
                .map(|_| {
                    let new: f64 = (0..12).map(|_| rng.random_range(-0.5..0.5)).sum();
                    x = again * x + new;
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
            let memory = Memory::of(&there, &residual, 25);
            let variance = memory.covariance(&there, &[wave])[(0, 0)];
            let tail = Evidence::fisher(product * product / variance, 1, memory.independent_rows()).tail;
            below.iter_mut().zip(levels).for_each(|(b, level)| *b += usize::from(tail < level));
        }
        below.map(|b| b as f64 / runs as f64)
    }

    #[test]
    fn an_accident_stands_out_no_more_often_than_its_tail_says_however_long_the_residual_remembers() {
        for again in [0.0, 0.3, 0.5, 0.7] {
            let [often, seldom] = accidents(again, [0.01, 0.001]);
            println!("{again}: {:.2} % below 1 %, {:.3} % below 0.1 %", 100.0 * often, 100.0 * seldom);
            assert!(often < 0.01, "{again}: {often}");
            assert!(seldom < 0.001, "{again}: {seldom}");
        }
    }

    #[test]
    fn a_residual_that_remembers_counts_for_fewer_rows() {
        let there: Places = vec![(0..200).map(|k| (k, k)).collect()];
        let slow: Vec<f64> = (0..200).map(|k| f64::sin(k as f64 / 10.0)).collect();
        let fast: Vec<f64> = (0..200).map(|k| f64::sin(2.5 * k as f64)).collect();
        assert!(Memory::of(&there, &slow, 50).independent_rows() < 10.0);
        assert!(Memory::of(&there, &fast, 50).independent_rows() > 180.0);
        // Nothing left at all is no division by zero.
        assert!(Memory::of(&there, &[0.0; 200], 50).independent_rows() > 180.0);
        assert_eq!(Memory::of(&vec![], &[], 50).independent_rows(), 0.0);
    }
}
