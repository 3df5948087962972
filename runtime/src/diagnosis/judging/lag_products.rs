//! Inner products of a series with itself some rows back: all that an autoregression is fitted to.

use crate::diagnosis::rows::gram::dot;
use nalgebra::DMatrix;
use std::ops::Range;

/// Of one series or the sum over several, on stretches of neighbouring rows.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct LagProducts {
    /// `of_order[m][(a, b)]`, a at least b: the value a rows back times that b rows back, summed over the rows with m
    /// predecessors.
    of_order: Vec<DMatrix<f64>>,
    /// How many rows have m predecessors.
    rows: Vec<usize>,
}

impl LagProducts {
    /// Of nothing, up to an order.
    pub fn zero(highest: usize) -> Self {
        let of_order = (0..=highest).map(|m| DMatrix::zeros(m + 1, m + 1)).collect();
        Self { of_order, rows: vec![0; highest + 1] }
    }

    /// Of values on stretches.
    pub fn of(stretches: &[Range<usize>], values: &[f64], highest: usize) -> Self {
        let mut out = Self::zero(highest);
        for stretch in stretches {
            for (m, rows) in out.rows.iter_mut().enumerate() {
                *rows += stretch.len().saturating_sub(m);
            }
        }
        out.add(stretches, values);
        out
    }

    /// Adds the products of another series on the same rows.
    pub fn add(&mut self, stretches: &[Range<usize>], values: &[f64]) {
        self.add_sums(stretches, |t, later| values[t] * values[later]);
    }

    /// Adds those of several series on the same rows, of which each column has the values of a row.
    pub fn add_all(&mut self, stretches: &[Range<usize>], series: &DMatrix<f64>) {
        let (values, count) = (series.as_slice(), series.nrows());
        let at = |t: usize| &values[t * count..(t + 1) * count];
        self.add_sums(stretches, |t, later| dot(at(t), at(later)));
    }

    /// Adds products of a row with a later one.
    fn add_sums(&mut self, stretches: &[Range<usize>], product: impl Fn(usize, usize) -> f64) {
        let mut running = vec![Vec::new(); self.of_order.len()];
        for stretch in stretches {
            let length = stretch.len();
            // Sums of products of values that are `lag` apart, over the first so many.
            for (lag, running) in running.iter_mut().enumerate().take(length) {
                running.clear();
                running.push(0.0);
                let mut sum = 0.0;
                running.extend((stretch.start..stretch.end - lag).map(|t| {
                    sum += product(t, t + lag);
                    sum
                }));
            }
            for (m, of_order) in self.of_order.iter_mut().enumerate().take(length) {
                for a in 0..=m {
                    for b in 0..=a {
                        let running = &running[a - b];
                        of_order[(a, b)] += running[length - a] - running[m - a];
                    }
                }
            }
        }
    }

    /// Adds those of other series, which are no rows of their own.
    pub fn add_products(&mut self, other: &Self) {
        for (sum, part) in self.of_order.iter_mut().zip(&other.of_order) {
            *sum += part;
        }
    }

    /// Highest order.
    pub fn highest(&self) -> usize {
        self.of_order.len() - 1
    }

    /// How many rows have so many predecessors.
    pub fn rows(&self, order: usize) -> usize {
        self.rows[order]
    }

    /// Inner product of two filters' outputs, over the rows with `order` predecessors; a filter is its weights from the row
    /// itself backwards.
    pub fn between(&self, order: usize, left: &[f64], right: &[f64]) -> f64 {
        let products = &self.of_order[order];
        let at = |a: usize, b: usize| products[(a.max(b), a.min(b))];
        let of_row = |(a, l): (usize, &f64)| -> f64 {
            l * right.iter().enumerate().map(|(b, r)| r * at(a, b)).sum::<f64>()
        };
        left.iter().enumerate().map(of_row).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::normal;
    use approx::assert_relative_eq;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    #[test]
    fn products_of_filtered_series_are_those_of_their_rows_whatever_the_stretches() {
        let mut rng = Pcg64::seed_from_u64(4);
        let values: Vec<Vec<f64>> = (0..2).map(|_| (0..60).map(|_| normal(&mut rng)).collect()).collect();
        let stretches = [0..3, 5..6, 9..40, 40..44, 50..60];
        let mut products = LagProducts::of(&stretches, &values[0], 4);
        products.add(&stretches, &values[1]);
        let mut of_both = LagProducts::zero(4);
        of_both.add_all(&stretches, &DMatrix::from_fn(2, 60, |series, t| values[series][t]));
        let filters = [[1.0, -0.5, 0.2, 0.1], [0.0, 0.3, -0.7, 1.0]];
        for order in 3..=4 {
            let rows = || stretches.iter().flat_map(move |s| s.clone().skip(order));
            let filtered = |x: &[f64], filter: &[f64], t: usize| -> f64 {
                filter.iter().enumerate().map(|(i, w)| w * x[t - i]).sum()
            };
            let of = |x: &[f64]| -> f64 {
                rows().map(|t| filtered(x, &filters[0], t) * filtered(x, &filters[1], t)).sum()
            };
            let sum = of(&values[0]) + of(&values[1]);
            let found = products.between(order, &filters[0], &filters[1]);
            assert_relative_eq!(found, sum, max_relative = 1e-10);
            let at_once = of_both.between(order, &filters[0], &filters[1]);
            assert_relative_eq!(at_once, sum, max_relative = 1e-10);
            assert_eq!(products.rows(order), rows().count());
        }
    }
}
