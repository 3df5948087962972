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
        let mut sums = vec![RunningSums::default(); self.of_order.len()];
        for stretch in stretches {
            let x = &values[stretch.clone()];
            if x.iter().all(|x| *x == 0.0) {
                continue;
            }
            let ends = self.of_order.len();
            for (lag, sums) in sums.iter_mut().enumerate().take(x.len()) {
                sums.fill(x, &x[lag..], ends);
            }
            for (m, of_order) in self.of_order.iter_mut().enumerate().take(x.len()) {
                for a in 0..=m {
                    for b in 0..=a {
                        let sums = &sums[a - b];
                        of_order[(a, b)] += sums.of_first(x.len() - a) - sums.of_first(m - a);
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

/// Sums of the first so many products of two series, for numbers near none and near all.
#[derive(Debug, Clone, Default)]
struct RunningSums {
    of_few: Vec<f64>,
    /// From this many on.
    many: usize,
    of_many: Vec<f64>,
}

impl RunningSums {
    /// Of `x` and the shorter `later`, for `ends` numbers at least from each end of `x`.
    fn fill(&mut self, x: &[f64], later: &[f64], ends: usize) {
        let few = ends.min(later.len());
        self.many = x.len().saturating_sub(ends).max(few);
        fill_from(&mut self.of_few, 0.0, &x[..few], &later[..few]);
        let between = few..self.many.min(later.len());
        let of_between = self.of_few[few] + dot(&x[between.clone()], &later[between.clone()]);
        fill_from(&mut self.of_many, of_between, &x[between.end..], &later[between.end..]);
    }

    fn of_first(&self, count: usize) -> f64 {
        self.of_few.get(count).copied().unwrap_or_else(|| self.of_many[count - self.many])
    }
}

/// A first sum, and it with one product after the other.
fn fill_from(sums: &mut Vec<f64>, first: f64, x: &[f64], later: &[f64]) {
    sums.clear();
    sums.push(first);
    let mut sum = first;
    sums.extend(x.iter().zip(later).map(|(a, b)| {
        sum += a * b;
        sum
    }));
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
            assert_eq!(products.rows(order), rows().count());
        }
    }
}
