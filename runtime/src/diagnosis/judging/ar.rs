//! Autoregression: a residual that remembers, made white.
//!
//! Burg's method over several stretches (Burg 1967; de Waele and Broersen 2000), order by the Bayesian information
//! criterion (Schwarz 1978). Its recursion is Levinson's, so that every lower order comes with it: the first rows of a
//! stretch are predicted by the orders that they have predecessors for, which makes the product of the innovations the
//! exact likelihood of a stationary series. Rows on both sides of a gap say nothing about each other.

use crate::diagnosis::judging::lag_products::LagProducts;
use crate::diagnosis::rules::LEAST_AR_PAIRS;
use std::ops::Range;

/// A stationary autoregression and all of its lower orders.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Autoregression {
    /// `coefficients[p][i]` is the weight of the value `i + 1` places back in the prediction of order p.
    coefficients: Vec<Vec<f64>>,
    /// Standard deviation of the error of each of these predictions.
    deviations: Vec<f64>,
}

impl Autoregression {
    /// Fits to values on stretches of neighbouring rows, with an order up to `highest`.
    #[cfg(test)]
    pub fn fit(stretches: &[Range<usize>], values: &[f64], highest: usize) -> Self {
        Self::of(&LagProducts::of(stretches, values, highest))
    }

    /// From the products of a series, with an order up to their highest.
    pub fn of(products: &LagProducts) -> Self {
        let rows = products.rows(0) as f64;
        let variance = (products.between(0, &[1.0], &[1.0]) / rows.max(1.0)).max(f64::MIN_POSITIVE);
        let (mut coefficients, mut variances) = (vec![Vec::new()], vec![variance]);
        // The criterion of each order, less that of order zero.
        let (mut criterion, mut best, mut chosen) = (0.0, 0.0, 0);
        for order in 1..=products.highest() {
            let before: &Vec<f64> = &coefficients[order - 1];
            // Errors of the prediction of a row from those before it, and of the row before them from those after it.
            let ahead: Vec<f64> =
                std::iter::once(1.0).chain(before.iter().map(|c| -c)).chain([0.0]).collect();
            let behind: Vec<f64> = ahead.iter().rev().copied().collect();
            let power = products.between(order, &ahead, &ahead) + products.between(order, &behind, &behind);
            if products.rows(order) < LEAST_AR_PAIRS || power <= 0.0 {
                break;
            }
            let reflection = 2.0 * products.between(order, &ahead, &behind) / power;
            let mut now: Vec<f64> =
                (0..order - 1).map(|i| before[i] - reflection * before[order - 2 - i]).collect();
            now.push(reflection);
            coefficients.push(now);
            variances.push((variances[order - 1] * (1.0 - reflection * reflection)).max(1e-12 * variance));
            // A row without so many predecessors is predicted no better.
            criterion +=
                products.rows(order) as f64 * (variances[order] / variances[order - 1]).ln() + rows.ln();
            if criterion < best {
                (best, chosen) = (criterion, order);
            }
        }
        coefficients.truncate(chosen + 1);
        variances.truncate(chosen + 1);
        Self { coefficients, deviations: variances.into_iter().map(f64::sqrt).collect() }
    }

    /// Order that was chosen.
    #[cfg(test)]
    pub fn order(&self) -> usize {
        self.deviations.len() - 1
    }

    /// The innovations of `values` in units of their standard deviation, row by row; 0 outside of the stretches.
    /// Any column goes through the same linear map as the residual.
    pub fn whitened(&self, stretches: &[Range<usize>], values: &[f64]) -> Vec<f64> {
        let mut out = vec![0.0; values.len()];
        let top = self.deviations.len() - 1;
        for stretch in stretches {
            for t in stretch.clone() {
                let order = (t - stretch.start).min(top);
                let past = values[t - order..t].iter().rev();
                let predicted: f64 = self.coefficients[order].iter().zip(past).map(|(a, x)| a * x).sum();
                out[t] = (values[t] - predicted) / self.deviations[order];
            }
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::judging::testing::correlated;
    use crate::diagnosis::rules::HIGHEST_AR_ORDER as HIGHEST_ORDER;
    use crate::testing::normal;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    fn second_order(rng: &mut Pcg64, rows: usize) -> Vec<f64> {
        let (mut a, mut b) = (0.0, 0.0);
        (0..rows + 200)
            .map(|_| {
                let x = 1.3 * a - 0.6 * b + 0.5 * normal(rng);
                (b, a) = (a, x);
                x
            })
            .skip(200)
            .collect()
    }

    #[test]
    fn a_second_order_series_in_short_stretches_is_recognised_and_made_white() {
        let mut rng = Pcg64::seed_from_u64(1);
        let lengths: Vec<usize> = (0..60).map(|k| 20 + k % 17).collect();
        let (mut values, mut stretches) = (Vec::new(), Vec::new());
        for n in lengths {
            let start = values.len();
            values.extend(second_order(&mut rng, n));
            stretches.push(start..values.len());
        }
        let found = Autoregression::fit(&stretches, &values, HIGHEST_ORDER);
        assert_eq!(found.order(), 2);
        assert!((found.coefficients[2][0] - 1.3).abs() < 0.06, "{:?}", found.coefficients[2]);
        assert!((found.coefficients[2][1] + 0.6).abs() < 0.06);
        assert!((found.deviations[2] - 0.5).abs() < 0.02);
        let white = found.whitened(&stretches, &values);
        let n = values.len() as f64;
        assert!((white.iter().map(|x| x * x).sum::<f64>() / n - 1.0).abs() < 0.06);
        // The first rows of the stretches are no louder than the others.
        let firsts: f64 = stretches.iter().map(|s| white[s.start].powi(2)).sum();
        assert!((firsts / stretches.len() as f64 - 1.0).abs() < 0.5);
        let products: f64 =
            stretches.iter().flat_map(|s| s.clone().skip(1)).map(|t| white[t] * white[t - 1]).sum();
        assert!((products / n).abs() < 0.06);
    }

    #[test]
    fn white_noise_keeps_order_zero_and_nothing_is_no_failure() {
        let mut rng = Pcg64::seed_from_u64(2);
        let zero = (0..50)
            .filter(|_| {
                let values: Vec<f64> = (0..300).map(|_| normal(&mut rng)).collect();
                Autoregression::fit(std::slice::from_ref(&(0..300)), &values, HIGHEST_ORDER).order() == 0
            })
            .count();
        assert!(zero >= 45, "{zero}");
        assert_eq!(Autoregression::fit(&[], &[], HIGHEST_ORDER).order(), 0);
        let still = Autoregression::fit(std::slice::from_ref(&(0..50)), &[0.0; 50], HIGHEST_ORDER);
        assert!(still.whitened(std::slice::from_ref(&(0..50)), &[0.0; 50]).iter().all(|x| *x == 0.0));
    }

    #[test]
    fn few_long_stretches_among_short_ones_are_no_reason_for_a_high_order() {
        let mut rng = Pcg64::seed_from_u64(3);
        let lengths = [10, 14, 11, 2, 6, 9, 7, 21, 5, 12, 10, 11, 4, 21, 3, 4];
        let too_high = (0..200)
            .filter(|_| {
                let (mut values, mut stretches) = (Vec::new(), Vec::new());
                for n in lengths {
                    let start = values.len();
                    values.extend(correlated(&mut rng, n, 0.5));
                    stretches.push(start..values.len());
                }
                Autoregression::fit(&stretches, &values, HIGHEST_ORDER).order() > 1
            })
            .count();
        println!("{too_high} of 200");
        assert!(too_high <= 20, "{too_high} of 200");
    }

    #[test]
    fn a_gap_starts_a_new_stretch() {
        let values: Vec<f64> = (0..40).map(f64::from).collect();
        let ar = Autoregression { coefficients: vec![vec![], vec![1.0]], deviations: vec![2.0, 1.0] };
        let white = ar.whitened(&[0..20, 20..40], &values);
        assert_eq!((white[20], white[21], white[0]), (10.0, 1.0, 0.0));
    }
}
