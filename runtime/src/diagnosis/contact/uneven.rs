//! Noise whose size follows the motion.
//!
//! The noise of a torque that is a motor's current grows with the torque, that of a gear with its speed, and that of a position,
//! or of a controller that sees it, with the inertia that its acceleration turns. Where one size is taken for all, the noise of
//! the larger ones passes for pushes. The variance is taken for a constant and parts that are
//! proportional to squares of such sizes (a variance function, Davidian and Carroll 1987).

use crate::diagnosis::contact::spread::spread;
use crate::diagnosis::rules::SCAN_LEAST_VARIANCE;

/// Squares beyond those of so many standard deviations count as no more: a push of half of the rows where the noise is large
/// must not make it larger without end.
const CLIPPED: f64 = 1.5;
/// Mean of squares of normal numbers that are clipped there.
const MEAN_OF_CLIPPED: f64 = 0.7785;
/// Rounds in which the rows are weighed by the variance found so far.
const ROUNDS: usize = 6;
/// Rounds of one coordinate after the other within each.
const STEPS: usize = 40;

/// The size of the noise of rows.
pub(super) struct Sizes {
    /// Standard deviation of each row, in that of all.
    pub deviations: Vec<f64>,
    /// How many of the sizes it grows with.
    pub grows_with: usize,
}

/// The size of the noise of each row: its square is a constant and squares of `sizes`, none with a negative weight. The weights are
/// fitted to squares of the residual, clipped, so that a few pushes hardly change them.
pub(super) fn sizes_of_noise(residual: &[f64], sizes: &[Vec<f64>]) -> Sizes {
    let rows = residual.len();
    let of_mean_one = |size: &Vec<f64>| {
        let mean = size.iter().map(|x| x * x).sum::<f64>() / rows.max(1) as f64;
        size.iter().map(|x| if mean > 0.0 { x * x / mean } else { 0.0 }).collect()
    };
    let mut parts: Vec<Vec<f64>> = vec![vec![1.0; rows]];
    parts.extend(sizes.iter().map(of_mean_one));
    let whole = spread(residual.iter().copied()).powi(2);
    if !(whole.is_finite() && whole > 0.0) {
        return Sizes { deviations: vec![1.0; rows], grows_with: 0 };
    }
    let mut weights = vec![0.0; parts.len()];
    weights[0] = whole;
    let mut variance = vec![whole; rows];
    for _ in 0..ROUNDS {
        let clip = |(x, v): (&f64, &f64)| (x * x).min(CLIPPED * CLIPPED * v) / MEAN_OF_CLIPPED;
        let squares: Vec<f64> = residual.iter().zip(&variance).map(clip).collect();
        not_negative(&parts, &squares, &variance, &mut weights);
        let of_row = |row: usize| weights.iter().zip(&parts).map(|(b, part)| b * part[row]).sum::<f64>();
        variance = (0..rows).map(of_row).collect();
        let least = SCAN_LEAST_VARIANCE * variance.iter().sum::<f64>() / rows as f64;
        variance.iter_mut().for_each(|v| *v = v.max(least));
    }
    let mean = variance.iter().sum::<f64>() / rows as f64;
    let deviations = variance.iter().map(|v| (v / mean).sqrt()).collect();
    Sizes { deviations, grows_with: weights[1..].iter().filter(|weight| **weight > 0.0).count() }
}

/// Weights of parts, none negative, that make squares best, each with an error in proportion to its variance: one coordinate
/// after the other.
fn not_negative(parts: &[Vec<f64>], squares: &[f64], variance: &[f64], weights: &mut [f64]) {
    let sum = |x: &[f64], y: &[f64]| -> f64 {
        x.iter().zip(y).zip(variance).map(|((x, y), v)| x / v * (y / v)).sum()
    };
    let gram: Vec<Vec<f64>> = parts.iter().map(|x| parts.iter().map(|y| sum(x, y)).collect()).collect();
    let with_squares: Vec<f64> = parts.iter().map(|x| sum(x, squares)).collect();
    for _ in 0..STEPS {
        for k in 0..parts.len() {
            let others: f64 = (0..parts.len()).filter(|i| *i != k).map(|i| gram[k][i] * weights[i]).sum();
            weights[k] =
                if gram[k][k] > 0.0 { ((with_squares[k] - others) / gram[k][k]).max(0.0) } else { 0.0 };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::normal;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    const ROWS: usize = 1000;

    /// How far the deviations are off at worst, for noise of this size at each row.
    fn worst(size: impl Fn(usize) -> f64, pushed: bool) -> f64 {
        let mut rng = Pcg64::seed_from_u64(1);
        let torque: Vec<f64> = (0..ROWS).map(|t| 20.0 * (0.02 * t as f64).sin()).collect();
        let speed: Vec<f64> = (0..ROWS).map(|t| (0.033 * t as f64).cos()).collect();
        let mut residual: Vec<f64> = (0..ROWS).map(|t| size(t) * normal(&mut rng)).collect();
        if pushed {
            residual[60..110].iter_mut().for_each(|x| *x += 10.0);
        }
        let found = sizes_of_noise(&residual, &[torque, speed]).deviations;
        let mean = ((0..ROWS).map(|t| size(t).powi(2)).sum::<f64>() / ROWS as f64).sqrt();
        (0..ROWS).map(|t| (found[t] * mean / size(t)).ln().abs()).fold(0.0, f64::max)
    }

    #[test]
    fn noise_that_grows_with_the_torque_is_as_large_as_it_is_where_it_is() {
        let size = |t: usize| (0.04 + (0.3 * (0.02 * t as f64).sin()).powi(2)).sqrt();
        assert!(worst(size, false) < 0.15, "{}", worst(size, false));
        assert!(worst(size, true) < 0.4, "{}", worst(size, true));
    }

    #[test]
    fn noise_of_one_size_is_left_as_it_is() {
        assert!(worst(|_| 0.3, false) < 0.08, "{}", worst(|_| 0.3, false));
        assert_eq!(sizes_of_noise(&[1.0, -1.0, 2.0], &[]).deviations, vec![1.0; 3]);
    }

    #[test]
    fn a_residual_without_noise_has_one_size() {
        assert_eq!(sizes_of_noise(&[0.0; 3], &[vec![1.0, 2.0, 3.0]]).deviations, vec![1.0; 3]);
        assert!(sizes_of_noise(&[], &[vec![]]).deviations.is_empty());
    }
}
