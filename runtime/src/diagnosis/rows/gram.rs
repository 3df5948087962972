//! Gram matrices: inner products of the columns of a design and of its torques, on one group of rows.
//!
//! Least squares, folds, candidates and held-out errors all follow from these products; rows are read only to make
//! them.

use nalgebra::{DMatrix, DVector};

/// Inner products of p columns with each other and with y: `[W y]ᵀ [W y]`.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct Gram {
    columns: usize,
    /// (p + 1) x (p + 1), row-major; y comes last.
    products: Vec<f64>,
}

impl Gram {
    /// No rows.
    pub fn zero(columns: usize) -> Self {
        Self { columns, products: vec![0.0; (columns + 1) * (columns + 1)] }
    }

    /// Of columns and y on the same rows; `before`: a Gram matrix and how many of its first columns are the same, whose
    /// products are taken over.
    pub fn new(columns: &[&[f64]], y: &[f64], before: Option<(&Gram, usize)>) -> Self {
        let p = columns.len();
        let mut gram = Self::zero(p);
        let kept = before.map_or(0, |(_, kept)| kept);
        if let Some((before, _)) = before {
            for i in 0..kept {
                let start = i * (p + 1);
                gram.products[start..start + kept].copy_from_slice(&before.row(i)[..kept]);
            }
        }
        let of = |k: usize| if k < p { columns[k] } else { y };
        let nonzero: Vec<usize> = (0..=p).filter(|&k| of(k).iter().any(|&x| x != 0.0)).collect();
        for (a, &i) in nonzero.iter().enumerate().filter(|(_, i)| **i >= kept) {
            for &k in &nonzero[..=a] {
                let value = dot(of(i), of(k));
                gram.products[i * (p + 1) + k] = value;
                gram.products[k * (p + 1) + i] = value;
            }
        }
        gram
    }

    /// Of the rows of all `parts` together, of so many columns each.
    pub fn sum(columns: usize, parts: &[Gram]) -> Self {
        let mut sum = Self::zero(columns);
        parts.iter().for_each(|part| sum.add(1.0, part));
        sum
    }

    /// Number of columns p, y not counted.
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Products of column `i` with all p columns.
    pub fn row(&self, i: usize) -> &[f64] {
        let start = i * (self.columns + 1);
        &self.products[start..start + self.columns]
    }

    /// Squares of column `i`.
    pub fn squares(&self, i: usize) -> f64 {
        self.row(i)[i]
    }

    /// Product of column `i` with y.
    pub fn with_y(&self, i: usize) -> f64 {
        self.products[i * (self.columns + 1) + self.columns]
    }

    /// Squares of y.
    pub fn y_squares(&self) -> f64 {
        self.products[self.columns * (self.columns + 1) + self.columns]
    }

    /// Adds `weight` times the products on other rows.
    pub fn add(&mut self, weight: f64, other: &Gram) {
        for (a, b) in self.products.iter_mut().zip(&other.products) {
            *a += weight * b;
        }
    }

    /// Products of the columns with each other, p x p, and with y.
    pub fn normal_equations(&self) -> (DMatrix<f64>, DVector<f64>) {
        let p = self.columns;
        (DMatrix::from_fn(p, p, |i, k| self.row(i)[k]), DVector::from_fn(p, |i, _| self.with_y(i)))
    }
}

/// Inner product, in as many partial sums as keep the machine's vector units busy.
#[inline(always)]
pub(in crate::diagnosis) fn dot(a: &[f64], b: &[f64]) -> f64 {
    const SUMS: usize = 16;
    let mut sums = [0.0; SUMS];
    let (ca, cb) = (a.chunks_exact(SUMS), b.chunks_exact(SUMS));
    let rest: f64 = ca.remainder().iter().zip(cb.remainder()).map(|(x, y)| x * y).sum();
    for (x, y) in ca.zip(cb) {
        for k in 0..SUMS {
            sums[k] += x[k] * y[k];
        }
    }
    sums.iter().sum::<f64>() + rest
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    fn naive(a: &[f64], b: &[f64]) -> f64 {
        a.iter().zip(b).map(|(x, y)| x * y).sum()
    }

    fn columns(rng: &mut Pcg64, count: usize, rows: usize) -> Vec<Vec<f64>> {
        (0..count).map(|_| (0..rows).map(|_| rng.random_range(-1.0..1.0)).collect()).collect()
    }

    #[test]
    fn every_product_is_the_sum_over_the_rows() {
        let mut rng = Pcg64::seed_from_u64(1);
        for rows in [0, 1, 16, 37] {
            let mut w = columns(&mut rng, 4, rows);
            w[2].fill(0.0);
            let y = columns(&mut rng, 1, rows).remove(0);
            let slices: Vec<&[f64]> = w.iter().map(Vec::as_slice).collect();
            let gram = Gram::new(&slices, &y, None);
            assert_eq!(gram.columns(), 4);
            for i in 0..4 {
                for k in 0..4 {
                    assert!((gram.row(i)[k] - naive(&w[i], &w[k])).abs() < 1e-12);
                }
                assert!((gram.with_y(i) - naive(&w[i], &y)).abs() < 1e-12);
                assert_eq!(gram.squares(i), gram.row(i)[i]);
            }
            assert!((gram.y_squares() - naive(&y, &y)).abs() < 1e-12);
        }
    }

    #[test]
    fn products_that_are_taken_over_are_those_that_would_be_computed() {
        let mut rng = Pcg64::seed_from_u64(2);
        let w = columns(&mut rng, 5, 23);
        let y = columns(&mut rng, 2, 23);
        let slices: Vec<&[f64]> = w.iter().map(Vec::as_slice).collect();
        let before = Gram::new(&slices[..4], &y[0], None);
        let kept = Gram::new(&slices, &y[1], Some((&before, 3)));
        assert_eq!(kept, Gram::new(&slices, &y[1], None));
    }

    #[test]
    fn grams_of_parts_add_up_to_that_of_the_whole() {
        let mut rng = Pcg64::seed_from_u64(3);
        let w = columns(&mut rng, 3, 20);
        let y = columns(&mut rng, 1, 20).remove(0);
        let part = |range: std::ops::Range<usize>| {
            let slices: Vec<&[f64]> = w.iter().map(|c| &c[range.clone()]).collect();
            Gram::new(&slices, &y[range], None)
        };
        let sum = Gram::sum(3, &[part(0..7), part(7..20)]);
        let (matrix, vector) = part(0..20).normal_equations();
        let (added, with_y) = sum.normal_equations();
        assert!((matrix - added).norm() < 1e-12 && (vector - with_y).norm() < 1e-12);
    }
}
