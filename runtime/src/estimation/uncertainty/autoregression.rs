//! Noise that depends on its past: an autoregression from autocovariances.

/// An autoregression of unit-free noise with the predictors of all lower orders, which a stretch needs at its beginning.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Autoregression {
    /// For each order up to the chosen one the weights of the past values, the latest first.
    predictors: Vec<Vec<f64>>,
    /// Standard deviation of what each order leaves.
    deviations: Vec<f64>,
}

/// A reflection coefficient beyond this is taken for rounding: the noise would not be stationary.
const STATIONARY: f64 = 0.999;

impl Autoregression {
    /// Noise without memory.
    pub fn white(variance: f64) -> Self {
        Autoregression { predictors: vec![Vec::new()], deviations: vec![variance.sqrt()] }
    }

    /// By the recursion of Levinson and Durbin from the autocovariances of lags 0, 1, ... of `count` values. The order is that
    /// of Akaike's criterion with the correction for few values (Hurvich and Tsai 1989), or the cube root of their number
    /// where that is more: the criterion asks how well the next value is predicted, while variances of slow columns ask for
    /// the density at low frequencies, for which the order has to grow with the values, slower than that root (Berk 1974).
    pub fn of(autocovariance: &[f64], count: f64) -> Self {
        let Some((&variance, lags)) = autocovariance.split_first() else { return Self::white(0.0) };
        let mut all = Self::white(variance);
        let (mut best, mut least) = (0, f64::INFINITY);
        let mut left = variance;
        let least_order = count.cbrt() as usize;
        for order in 0..=lags.len() {
            if order > 0 {
                let before = &all.predictors[order - 1];
                let past: f64 = before.iter().zip((0..order - 1).rev()).map(|(a, l)| a * lags[l]).sum();
                let reflection = (lags[order - 1] - past) / left;
                if reflection.is_nan() || reflection.abs() >= STATIONARY {
                    break;
                }
                let mut next: Vec<f64> =
                    before.iter().zip(before.iter().rev()).map(|(a, b)| a - reflection * b).collect();
                next.push(reflection);
                left *= 1.0 - reflection * reflection;
                all.predictors.push(next);
                all.deviations.push(left.sqrt());
            }
            let spare = count - order as f64 - 2.0;
            if !(left > 0.0 && spare > 0.0) {
                break;
            }
            let criterion = count * left.ln() + 2.0 * count * (order as f64 + 1.0) / spare;
            if criterion < least || order <= least_order {
                (best, least) = (order, criterion);
            }
        }
        all.predictors.truncate(best + 1);
        all.deviations.truncate(best + 1);
        all
    }

    /// The order.
    pub fn order(&self) -> usize {
        self.predictors.len() - 1
    }

    /// Standard deviation of the innovations.
    pub fn deviation(&self) -> f64 {
        self.deviations[self.order()]
    }

    /// The values of a stretch less what the past of each predicts, in units of what that leaves.
    pub fn innovations(&self, values: &[f64]) -> Vec<f64> {
        let order = self.order();
        let mut past = vec![0.0; values.len()];
        for t in 0..order.min(values.len()) {
            let known = values[..t].iter().rev();
            past[t] = self.predictors[t].iter().zip(known).map(|(a, x)| a * x).sum();
        }
        // Lag by lag, so that each is one run through memory.
        for (lag, a) in self.predictors[order].iter().enumerate() {
            let later = past.iter_mut().skip(order);
            later.zip(values.iter().skip(order - 1 - lag)).for_each(|(past, x)| *past += a * x);
        }
        let deviation = |t: usize| self.deviations[t.min(order)];
        values.iter().zip(&past).enumerate().map(|(t, (x, past))| (x - past) / deviation(t)).collect()
    }

    /// For each innovation the weight that it has in the sum of `weights[t] * noise[t]`: the impulse response run
    /// backwards in time, with `before` innovations from before the first value, the earliest first.
    pub fn weights_of_innovations(&self, weights: &[f64], before: usize) -> Vec<f64> {
        let mut z = vec![0.0; before + weights.len()];
        z[before..].copy_from_slice(weights);
        self.run_backwards(&mut z);
        let deviation = self.deviation();
        z.iter_mut().for_each(|z| *z *= deviation);
        z
    }

    /// Solves z(t) = w(t) + sum of a(i) z(t + i) in the place of w.
    pub fn run_backwards(&self, values: &mut [f64]) {
        let coefficients = &self.predictors[self.order()];
        for t in (0..values.len()).rev() {
            let later: f64 = coefficients.iter().zip(values[t + 1..].iter()).map(|(a, x)| a * x).sum();
            values[t] += later;
        }
    }

    /// Variance of the sum of `slopes[i]` times the estimated coefficient i, times the number of values that it was
    /// estimated from: variance of the innovations times the inverse of the covariance of as many values (Brockwell and
    /// Davis 1991, theorem 8.1.1).
    pub fn variance_of_coefficients(&self, slopes: &[f64]) -> f64 {
        self.deviation().powi(2) * self.innovations(slopes).iter().map(|x| x * x).sum::<f64>()
    }

    /// Values after which an impulse has died out to a millionth of its squares, at most `most`.
    pub fn memory(&self, most: usize) -> usize {
        let coefficients = &self.predictors[self.order()];
        let mut response = vec![1.0_f64];
        let mut all = 1.0;
        while !coefficients.is_empty() && response.len() < most {
            let value: f64 = coefficients.iter().zip(response.iter().rev()).map(|(a, x)| a * x).sum();
            response.push(value);
            all += value * value;
            let recent: f64 = response.iter().rev().take(coefficients.len()).map(|x| x * x).sum();
            if recent < 1e-6 * all {
                break;
            }
        }
        response.len() - 1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Autocovariances of x(t) = 0.6 x(t-1) + 0.2 x(t-2) + e with a variance of e of 2, from the equations of Yule and
    /// Walker.
    fn second_order() -> Vec<f64> {
        let (a, b) = (0.6, 0.2);
        let first: f64 = a / (1.0 - b);
        let second = a * first + b;
        let variance = 2.0 / (1.0 - a * first - b * second);
        let mut all = vec![variance, first * variance, second * variance];
        for l in 3..8 {
            all.push(a * all[l - 1] + b * all[l - 2]);
        }
        all
    }

    #[test]
    fn an_autoregression_is_found_from_its_autocovariances() {
        let found = Autoregression::of(&second_order(), 1000.0);
        let (own, beyond) = found.predictors[found.order()].split_at(2);
        assert!((own[0] - 0.6).abs() < 1e-12 && (own[1] - 0.2).abs() < 1e-12);
        assert!(beyond.iter().all(|a| a.abs() < 1e-12));
        assert!((found.deviation().powi(2) - 2.0).abs() < 1e-12);
    }

    #[test]
    fn the_weights_of_the_innovations_give_the_variance_of_a_sum() {
        let covariance = second_order();
        let found = Autoregression::of(&covariance, 1000.0);
        let weights = [1.0, -0.5, 2.0, 0.0, 0.7];
        let mut expected = 0.0;
        for (s, a) in weights.iter().enumerate() {
            for (t, b) in weights.iter().enumerate() {
                expected += a * b * covariance[s.abs_diff(t)];
            }
        }
        let squares: f64 = found.weights_of_innovations(&weights, 400).iter().map(|z| z * z).sum();
        assert!((squares / expected - 1.0).abs() < 1e-9, "{squares} {expected}");
    }

    #[test]
    fn an_innovation_is_what_the_past_that_there_is_does_not_predict() {
        let found = Autoregression::of(&second_order(), 1000.0);
        let values = [1.0, -0.5, 2.0, 0.3];
        let first = second_order()[1] / second_order()[0];
        let left = [1.0, -0.5 - first, 2.0 + 0.6 * 0.5 - 0.2, 0.3 - 0.6 * 2.0 + 0.2 * 0.5];
        for (t, (found_at, left)) in found.innovations(&values).iter().zip(left).enumerate() {
            assert!((found_at - left / found.deviations[t.min(2)]).abs() < 1e-12, "{t}");
        }
    }

    #[test]
    fn coefficients_are_as_uncertain_as_in_large_samples() {
        // Of second order the covariance is (1 - b^2, -a (1 + b)) (Brockwell and Davis 1991, example 8.1.1).
        let found = Autoregression::of(&second_order(), 1000.0);
        let (a, b) = (0.6, 0.2);
        let (variance, covariance) = (1.0 - b * b, -a * (1.0 + b));
        for slopes in [[1.0, 0.0], [0.0, 1.0], [1.0, 2.0]] {
            let expected = variance * (slopes[0] * slopes[0] + slopes[1] * slopes[1])
                + 2.0 * covariance * slopes[0] * slopes[1];
            assert!((found.variance_of_coefficients(&slopes) - expected).abs() < 1e-9, "{slopes:?}");
        }
    }

    #[test]
    fn noise_that_is_nearly_white_is_nearly_its_own_innovations() {
        let found = Autoregression::of(&[4.0, 0.01, -0.02, 0.01], 500.0);
        for (innovation, expected) in found.innovations(&[3.0, 5.0]).iter().zip([1.5, 2.5]) {
            assert!((innovation - expected).abs() < 0.01);
        }
    }

    #[test]
    fn the_order_grows_with_the_cube_root_of_the_values() {
        let nearly_white: Vec<f64> = (0..30).map(|l| if l == 0 { 4.0 } else { 0.01 }).collect();
        for (count, order) in [(100.0, 4), (1001.0, 10), (8001.0, 20)] {
            assert_eq!(Autoregression::of(&nearly_white, count).order(), order);
        }
    }
}
