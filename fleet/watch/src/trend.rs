//! Monotone trends: Mann and Kendall's test for dependent days, and the slope of Theil and Sen.
//!
//! Kendall, Rank Correlation Methods (1975); Hamed and Rao, A modified Mann-Kendall trend test for autocorrelated data,
//! J. Hydrology 204 (1998); Sen, JASA 63 (1968).

use crate::memory::Memory;
use crate::robust::median;
use statrs::distribution::{ContinuousCDF, Normal};
use std::cmp::Ordering;

/// Most days of which all pairs are taken; of longer series every second, third ... day is.
const MOST_DAYS: usize = 1500;

/// A monotone trend of one series.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Monotone {
    /// Theil-Sen slope, unit a day.
    pub(crate) slope: f64,
    /// Its 95 % interval, from the same variance as the test.
    pub(crate) interval: (f64, f64),
    /// Two-sided p-value.
    pub(crate) p_value: f64,
    /// Independent days that are worth as much, over days.
    pub(crate) effective_fraction: f64,
}

/// Trend of values over days, both in the same order; `None` of fewer than four days. `memory` is the memory of healthy
/// siblings' days.
pub(crate) fn monotone(days: &[i64], values: &[f64], memory: Memory) -> Option<Monotone> {
    let step = values.len().div_ceil(MOST_DAYS).max(1);
    let points: Vec<(f64, f64)> =
        days.iter().zip(values).step_by(step).map(|(&d, &v)| ((d - days[0]) as f64, v)).collect();
    let n = points.len();
    if n < 4 {
        return None;
    }
    let mut score = 0.0;
    let mut slopes = Vec::with_capacity(n * (n - 1) / 2);
    for (j, later) in points.iter().enumerate() {
        for earlier in points[..j].iter().filter(|p| p.0 < later.0) {
            score += sign(later.1 - earlier.1);
            slopes.push((later.1 - earlier.1) / (later.0 - earlier.0));
        }
    }
    slopes.sort_by(f64::total_cmp);
    let slope = median(&slopes)?;
    let inflation = inflation(&points, slope, memory);
    let variance = kendall_variance(&points) * inflation;
    let z = if variance > 0.0 { (score.abs() - 1.0).max(0.0) / variance.sqrt() } else { 0.0 };
    Some(Monotone {
        slope,
        interval: interval(&slopes, variance),
        p_value: two_sided(z),
        effective_fraction: (1.0 / inflation).min(1.0),
    })
}

fn sign(x: f64) -> f64 {
    match x.partial_cmp(&0.0) {
        Some(Ordering::Greater) => 1.0,
        Some(Ordering::Less) => -1.0,
        _ => 0.0,
    }
}

/// Two-sided p-value of a standard normal deviate.
pub(crate) fn two_sided(z: f64) -> f64 {
    Normal::standard().cdf(-z.abs()).mul_add(2.0, 0.0).clamp(0.0, 1.0)
}

/// Variance of Kendall's score of independent values, less what ties take.
fn kendall_variance(points: &[(f64, f64)]) -> f64 {
    let n = points.len() as f64;
    let mut values: Vec<f64> = points.iter().map(|p| p.1).collect();
    values.sort_by(f64::total_cmp);
    let ties: f64 = values
        .chunk_by(|a, b| a == b)
        .map(|tie| tie.len() as f64)
        .map(|t| t * (t - 1.0) * (2.0 * t + 5.0))
        .sum();
    ((n * (n - 1.0) * (2.0 * n + 5.0) - ties) / 18.0).max(0.0)
}

/// Sen's interval: the slopes at the ranks that the score's variance allows.
fn interval(sorted: &[f64], variance: f64) -> (f64, f64) {
    let count = sorted.len() as f64;
    let half = 0.5 * 1.959_964 * variance.sqrt();
    let at = |rank: f64| sorted[(rank.max(0.0) as usize).min(sorted.len() - 1)];
    (at((0.5 * count - half).floor()), at((0.5 * count + half).ceil()))
}

/// How much larger than of independent days the variance of the score is (Hamed and Rao 1998, eq. 10): from the
/// autocorrelation of the ranks of what the slope leaves, at lags where it differs from zero at 5 %. Sixty days show too
/// little of it (a test at 5 % then calls 16 % of AR(1) series with factor 0.5 a trend), so that it is at least what the
/// siblings' memory gives, whose autocorrelations become 6/pi asin(rho/2) in ranks (Kendall 1975); and at least 1: that
/// days repel each other is nothing to rely on.
fn inflation(points: &[(f64, f64)], slope: f64, memory: Memory) -> f64 {
    let left: Vec<f64> = points.iter().map(|(day, value)| value - slope * day).collect();
    let ranks = ranks(&left);
    let n = ranks.len() as f64;
    let mean = 0.5 * (n + 1.0);
    let total: f64 = ranks.iter().map(|r| (r - mean).powi(2)).sum();
    if total <= 0.0 {
        return 1.0;
    }
    let bound = 1.959_964 / n.sqrt();
    let (mut sum, mut of_siblings) = (0.0, 0.0);
    for lag in 1..ranks.len().saturating_sub(2) {
        let products: f64 = ranks.iter().zip(&ranks[lag..]).map(|(a, b)| (a - mean) * (b - mean)).sum();
        let rho = products / total;
        let k = lag as f64;
        let weight = (n - k) * (n - k - 1.0) * (n - k - 2.0);
        if rho.abs() > bound {
            sum += weight * rho;
        }
        of_siblings += weight * 6.0 / std::f64::consts::PI * (0.5 * memory.at(lag)).asin();
    }
    (1.0 + 2.0 / (n * (n - 1.0) * (n - 2.0)) * sum.max(of_siblings)).max(1.0)
}

/// Ranks from 1; ties share their mean rank.
fn ranks(values: &[f64]) -> Vec<f64> {
    let mut order: Vec<usize> = (0..values.len()).collect();
    order.sort_by(|&a, &b| values[a].total_cmp(&values[b]));
    let mut ranks = vec![0.0; values.len()];
    let mut first = 0;
    for tie in order.chunk_by(|&a, &b| values[a] == values[b]) {
        let mean = first as f64 + 0.5 * (tie.len() as f64 + 1.0);
        tie.iter().for_each(|&k| ranks[k] = mean);
        first += tie.len();
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::Noise;

    fn days(n: usize) -> Vec<i64> {
        (20_000..).take(n).collect()
    }

    const NONE: Memory = Memory { share: 0.0, rho: 0.5 };

    /// Fraction of series without a trend that a test at 5 % calls one.
    fn size(rho: f64, n: usize, memory: Memory) -> f64 {
        let mut noise = Noise::new(3);
        let called = (0..1000)
            .filter(|_| monotone(&days(n), &noise.ar1(n, rho), memory).is_some_and(|m| m.p_value < 0.05))
            .count();
        called as f64 / 1000.0
    }

    #[test]
    fn mann_kendall_keeps_its_size_where_days_depend_on_each_other() {
        assert!((0.02..0.08).contains(&size(0.0, 60, NONE)), "{}", size(0.0, 60, NONE));
        let memory = Memory { share: 1.0, rho: 0.5 };
        assert!((0.02..0.08).contains(&size(0.5, 60, memory)), "{}", size(0.5, 60, memory));
        // A robot without siblings has the correction of Hamed and Rao alone; 26 % without any.
        assert!(size(0.5, 60, NONE) < 0.18, "{}", size(0.5, 60, NONE));
        assert!(size(0.5, 240, NONE) < 0.15, "{}", size(0.5, 240, NONE));
    }

    #[test]
    fn a_slope_is_found_with_an_interval_that_holds_it() {
        let mut noise = Noise::new(4);
        let mut held = 0;
        for _ in 0..200 {
            let values: Vec<f64> =
                noise.ar1(60, 0.3).iter().enumerate().map(|(k, x)| 0.05 * k as f64 + x).collect();
            let m = monotone(&days(60), &values, NONE).expect("sixty days");
            held += i32::from(m.interval.0 <= 0.05 && 0.05 <= m.interval.1);
        }
        assert!(held > 170, "{held}");
    }

    #[test]
    fn equal_values_have_no_trend() {
        let m = monotone(&days(30), &[2.0; 30], NONE).expect("thirty days");
        assert_eq!((m.slope, m.p_value), (0.0, 1.0));
    }
}
