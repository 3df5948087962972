//! The most likely change of level of a whole series.
//!
//! Pettitt, A non-parametric approach to the change-point problem, Applied Statistics 28 (1979). Its p-value is a closed
//! bound, so that nothing is permuted and nothing drawn at random.

use crate::robust::{median, qn};

/// A change of level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Change {
    /// Index of the first value after it.
    pub(crate) first: usize,
    /// Median after less median before.
    pub(crate) size: f64,
    /// Standard deviation of `size`.
    pub(crate) sigma: f64,
    /// p-value.
    pub(crate) p_value: f64,
}

/// The change of level at which Mann and Whitney's statistic of before and after is largest; `None` of fewer than four
/// values. `effective_fraction` is how many independent values one is worth, in (0, 1]: K of dependent values varies
/// by its inverse more, so that K² is multiplied by it.
pub(crate) fn change(values: &[f64], effective_fraction: f64) -> Option<Change> {
    let n = values.len();
    if n < 4 {
        return None;
    }
    let mut largest = (1, 0.0_f64);
    let mut statistic = 0.0;
    for t in 0..n - 1 {
        // U of t is U of t - 1 plus the score of this value among all (Pettitt 1979, eq. 2.4).
        statistic += score(values[t], values);
        if statistic.abs() > largest.1 {
            largest = (t + 1, statistic.abs());
        }
    }
    let (first, k) = largest;
    let m = n as f64;
    let p_value = (2.0 * (-6.0 * k * k * effective_fraction / (m.powi(3) + m.powi(2))).exp()).min(1.0);
    let (before, after) = values.split_at(first);
    let size = median(after)? - median(before)?;
    let scale = within(before, after);
    // The variance of a median of Gaussian values is pi / 2 that of their mean.
    let each = std::f64::consts::FRAC_PI_2 / effective_fraction.max(1e-6);
    let sigma = scale * (each / before.len() as f64 + each / after.len() as f64).sqrt();
    Some(Change { first, size, sigma, p_value })
}

/// Values below less values above.
fn score(value: f64, values: &[f64]) -> f64 {
    let below = values.iter().filter(|&&v| v < value).count() as f64;
    let above = values.iter().filter(|&&v| v > value).count() as f64;
    below - above
}

/// Robust standard deviation on both sides of the change, each about its own level.
fn within(before: &[f64], after: &[f64]) -> f64 {
    let centred: Vec<f64> = [before, after]
        .into_iter()
        .filter_map(|side| Some((side, median(side)?)))
        .flat_map(|(side, level)| side.iter().map(move |v| v - level))
        .collect();
    qn(&centred).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Noise;

    #[test]
    fn a_jump_is_found_on_its_day_with_its_size() {
        let mut noise = Noise::new(5);
        let values: Vec<f64> = (0..60).map(|k| noise.normal() + if k >= 37 { 4.0 } else { 0.0 }).collect();
        let found = change(&values, 1.0).expect("sixty values");
        assert!(found.first.abs_diff(37) <= 1 && found.p_value < 1e-6, "{found:?}");
        assert!((found.size - 4.0).abs() < 3.0 * found.sigma, "{found:?}");
    }

    #[test]
    fn a_series_without_a_change_is_rarely_called_one() {
        let mut noise = Noise::new(6);
        let called = (0..1000)
            .filter(|_| {
                let values: Vec<f64> = (0..60).map(|_| noise.normal()).collect();
                change(&values, 1.0).is_some_and(|c| c.p_value < 0.05)
            })
            .count();
        assert!(called < 60, "{called}");
    }
}
