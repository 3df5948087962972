//! How far means of a residual that remembers wander, whatever a few pushes do to it.

use crate::diagnosis::contact::spread::spread;
use crate::diagnosis::rules::{SCAN_CLIPPED, SCAN_MOST_ORDER, SIGMA_PER_MAD};
use crate::statistics::median::median;

/// An autoregression with all of its lower orders.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Memory {
    /// `coefficients[p][i]` is the weight of the value `i + 1` places back in the prediction of order p.
    coefficients: Vec<Vec<f64>>,
    /// Standard deviation of the error of each of these predictions, relative to the last.
    deviations: Vec<f64>,
    /// Standard deviation of the series itself.
    sigma: f64,
    level: f64,
}

impl Memory {
    /// From the rows of all motions, `(place, value)`: the level is a median of absolute values, the autoregression is
    /// fitted to clipped values (Yule and Walker; order by Schwarz's criterion), so that a few pushes hardly change
    /// either. `None` where there is no spread.
    pub fn of(motions: &[&[(usize, f64)]]) -> Option<Self> {
        let mut values: Vec<f64> = motions.iter().flat_map(|m| m.iter().map(|r| r.1)).collect();
        let level = median(&mut values);
        let sigma = spread(values.iter().map(|x| x - level));
        if !(sigma.is_finite() && sigma > 0.0) {
            return None;
        }
        let correlation = autocorrelation(motions, level, sigma);
        let (coefficients, variances) = autoregression(&correlation, values.len());
        let last = variances.last().copied().unwrap_or(1.0);
        let deviations = variances.iter().map(|v| (v / last).sqrt()).collect();
        Some(Self { coefficients, deviations, sigma, level })
    }

    /// Order.
    pub fn order(&self) -> usize {
        self.coefficients.len() - 1
    }

    /// What a value differs from its prediction, all orders in the same unit. `behind` values before it are there;
    /// `value(back)` is the one so many places back, that of zero itself.
    pub fn innovation(&self, behind: usize, value: impl Fn(usize) -> f64) -> f64 {
        let order = behind.min(self.order());
        let predicted: f64 = self.coefficients[order].iter().enumerate().map(|(i, a)| a * value(i + 1)).sum();
        (value(0) - predicted) / self.deviations[order]
    }
}

/// Standard deviation of means over so many rows.
pub(in crate::diagnosis) struct Spread {
    /// By the number of rows, from one on.
    of_mean: Vec<f64>,
}

impl Spread {
    /// From the rows of all motions, `(place, value)`; `lengths` are the windows that means are taken over, in rows.
    ///
    /// The variance of a mean follows from the autoregression; where means over windows themselves spread wider than
    /// that, as they do where something slow is not in the model, their own spread counts.
    pub fn of(motions: &[&[(usize, f64)]], lengths: &[usize]) -> Option<Self> {
        let longest = lengths.iter().copied().max()?;
        let Memory { coefficients, sigma, level, .. } = Memory::of(motions)?;
        let count: usize = motions.iter().map(|m| m.len()).sum();
        let gamma = continued(coefficients.last()?, longest);
        let mut of_mean: Vec<f64> = Vec::with_capacity(longest);
        for n in 1..=longest {
            let sum: f64 = n as f64 + 2.0 * (1..n).map(|k| (n - k) as f64 * gamma[k]).sum::<f64>();
            of_mean.push(sigma * (sum.max(1.0)).sqrt() / n as f64);
        }
        let mut wider = vec![1.0_f64; lengths.len()];
        for (wider, &n) in wider.iter_mut().zip(lengths) {
            let mut means = means(motions, n);
            means.iter_mut().for_each(|m| *m -= level);
            *wider = widening(&mut means, of_mean[n - 1], count as f64 / n as f64);
        }
        for (n, sigma) in of_mean.iter_mut().enumerate() {
            let above = lengths.iter().position(|l| *l > n);
            *sigma *= above.map_or(wider[wider.len() - 1], |k| wider[k]);
        }
        Some(Self { of_mean })
    }

    /// Of a mean over this many rows.
    pub fn of_mean(&self, rows: usize) -> f64 {
        self.of_mean[rows.clamp(1, self.of_mean.len()) - 1]
    }
}

/// How much wider deviations spread than they should, as far as so many independent ones surely tell; at least 1. They
/// are left in another order, without their signs.
pub(in crate::diagnosis) fn widening(deviations: &mut [f64], sigma: f64, independent: f64) -> f64 {
    if independent < 8.0 || deviations.is_empty() {
        return 1.0;
    }
    deviations.iter_mut().for_each(|m| *m = m.abs());
    let seen = SIGMA_PER_MAD * median(deviations);
    // So many know their spread no better than this.
    let surely = seen * (1.0 - 1.2 / independent.sqrt());
    (surely / sigma).max(1.0)
}

/// Means over windows of n places that are all there, half of a window apart.
fn means(motions: &[&[(usize, f64)]], n: usize) -> Vec<f64> {
    let mut out = Vec::new();
    for motion in motions {
        for window in motion.windows(n).step_by((n / 2).max(1)) {
            if window[n - 1].0 - window[0].0 == n - 1 {
                out.push(window.iter().map(|r| r.1).sum::<f64>() / n as f64);
            }
        }
    }
    out
}

/// Autocorrelation of clipped values over pairs of places that are there, lags 0 to [`SCAN_MOST_ORDER`].
fn autocorrelation(motions: &[&[(usize, f64)]], level: f64, sigma: f64) -> Vec<f64> {
    let clip = |x: f64| ((x - level) / sigma).clamp(-SCAN_CLIPPED, SCAN_CLIPPED);
    let mut products = [0.0; SCAN_MOST_ORDER + 1];
    let mut pairs = [0usize; SCAN_MOST_ORDER + 1];
    for motion in motions {
        for (i, &(place, x)) in motion.iter().enumerate() {
            for &(later, y) in motion[i..].iter().take(SCAN_MOST_ORDER + 1) {
                let lag = later - place;
                if lag <= SCAN_MOST_ORDER {
                    products[lag] += clip(x) * clip(y);
                    pairs[lag] += 1;
                }
            }
        }
    }
    let mean = |k: usize| if pairs[k] > 0 { products[k] / pairs[k] as f64 } else { 0.0 };
    (0..=SCAN_MOST_ORDER).map(|k| mean(k) / mean(0).max(1e-300)).collect()
}

/// Coefficients of the autoregressions by Levinson's recursion up to the order with the least Schwarz criterion, but at least
/// the cube root of the rows (Berk 1974: what predicts best misses the density at low frequencies, which slow windows are
/// judged by), and the variances that they leave.
fn autoregression(correlation: &[f64], rows: usize) -> (Vec<Vec<f64>>, Vec<f64>) {
    let (mut all, mut variances) = (vec![Vec::new()], vec![1.0_f64]);
    let least = ((rows as f64).cbrt() as usize).min(correlation.len() - 1);
    let mut best = (f64::INFINITY, least);
    for order in 1..correlation.len() {
        let mut now: Vec<f64> = all[order - 1].clone();
        let left = variances[order - 1];
        let reflection = raise_order(&mut now, correlation, left.max(1e-12));
        all.push(now);
        variances.push(left * (1.0 - reflection * reflection));
        let criterion =
            rows as f64 * variances[order].max(1e-12).ln() + order as f64 * (rows.max(2) as f64).ln();
        if order >= least && criterion < best.0 {
            best = (criterion, order);
        }
    }
    all.truncate(best.1 + 1);
    variances.truncate(best.1 + 1);
    (all, variances)
}

/// One step of Levinson's recursion: the coefficients of an autoregression become those of the next order, where `lags` are
/// covariances by lag and `left` is the variance that the order before leaves. Returns the reflection coefficient r: the next one
/// leaves 1 - r² of that.
pub(super) fn raise_order(coefficients: &mut Vec<f64>, lags: &[f64], left: f64) -> f64 {
    let order = coefficients.len() + 1;
    let made: f64 = coefficients.iter().enumerate().map(|(k, a)| a * lags[order - 1 - k]).sum();
    let reflection = ((lags[order] - made) / left).clamp(-0.999, 0.999);
    for k in 0..order / 2 {
        let (a, b) = (coefficients[k], coefficients[order - 2 - k]);
        coefficients[k] = a - reflection * b;
        coefficients[order - 2 - k] = b - reflection * a;
    }
    coefficients.push(reflection);
    reflection
}

/// Autocorrelations of an autoregression, lags 0 to `longest`.
fn continued(coefficients: &[f64], longest: usize) -> Vec<f64> {
    let p = coefficients.len();
    // Those up to the order from the Yule-Walker equations, by the recursion that made the coefficients, run as a
    // filter's response to noise: the sum over its impulse response.
    let mut response = vec![1.0];
    let many = 40 * (p + 1) + longest;
    for t in 1..many {
        let next: f64 = coefficients.iter().enumerate().take(t).map(|(k, a)| a * response[t - 1 - k]).sum();
        response.push(next);
    }
    let at =
        |lag: usize| response.iter().zip(&response[lag.min(many - 1)..]).map(|(a, b)| a * b).sum::<f64>();
    let whole = at(0);
    (0..=longest).map(|lag| at(lag) / whole).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::normal;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    #[test]
    fn means_of_a_series_that_remembers_spread_as_said() {
        let mut rng = Pcg64::seed_from_u64(1);
        let mut slow = 0.0;
        let rows: Vec<(usize, f64)> = (0..20_000)
            .map(|k| {
                slow = 0.8 * slow + 0.6 * normal(&mut rng);
                (k, 0.84 * normal(&mut rng) + 0.55 * slow)
            })
            .collect();
        let spread = Spread::of(&[&rows], &[8, 25, 50]).expect("rows");
        for n in [8, 25, 50] {
            let means: Vec<f64> =
                rows.chunks_exact(n).map(|c| c.iter().map(|r| r.1).sum::<f64>() / n as f64).collect();
            let rms = (means.iter().map(|m| m * m).sum::<f64>() / means.len() as f64).sqrt();
            assert!((spread.of_mean(n) / rms - 1.0).abs() < 0.1, "{n}: {} {rms}", spread.of_mean(n));
        }
    }

    #[test]
    fn white_noise_averages_out_with_the_root_of_the_rows() {
        let mut rng = Pcg64::seed_from_u64(2);
        let rows: Vec<(usize, f64)> = (0..5000).map(|k| (k, 3.0 * normal(&mut rng))).collect();
        let spread = Spread::of(&[&rows], &[10, 40]).expect("rows");
        assert!((spread.of_mean(1) / 3.0 - 1.0).abs() < 0.1);
        assert!((spread.of_mean(40) / (3.0 / 40.0_f64.sqrt()) - 1.0).abs() < 0.15);
    }

    #[test]
    fn a_few_large_values_do_not_widen_it() {
        let mut rng = Pcg64::seed_from_u64(3);
        let rows: Vec<(usize, f64)> =
            (0..2000).map(|k| (k, if k % 400 < 20 { 30.0 } else { normal(&mut rng) })).collect();
        let spread = Spread::of(&[&rows], &[10]).expect("rows");
        assert!(spread.of_mean(1) < 1.3);
    }
}
