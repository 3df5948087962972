//! What is known of columns beforehand, as the inner products of rows that nobody has kept.

use nalgebra::{Cholesky, DMatrix, DVector};

/// Information on some columns of a design, in units of the noise variance.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct Prior {
    columns: Vec<usize>,
    /// Inverse of the covariance.
    information: DMatrix<f64>,
    /// The information times the mean.
    right: DVector<f64>,
}

impl Prior {
    /// From mean and covariance of these columns; `None` where the covariance is not positive definite.
    pub fn of_covariance(covariance: &DMatrix<f64>, mean: Vec<f64>, columns: Vec<usize>) -> Option<Self> {
        let k = columns.len();
        let scale = DVector::from_fn(k, |i, _| 1.0 / covariance[(i, i)].sqrt());
        let correlation = DMatrix::from_fn(k, k, |i, l| covariance[(i, l)] * scale[i] * scale[l]);
        let inverse = Cholesky::new(correlation)?.inverse();
        let information = DMatrix::from_fn(k, k, |i, l| inverse[(i, l)] * scale[i] * scale[l]);
        let right = &information * DVector::from_vec(mean);
        right.iter().all(|x| x.is_finite()).then_some(Self { columns, information, right })
    }

    /// The same of columns that stand elsewhere: `from[i]` at `to[i]`.
    pub fn at(mut self, from: &[usize], to: &[usize]) -> Self {
        for column in &mut self.columns {
            if let Some(i) = from.iter().position(|f| f == column) {
                *column = to[i];
            }
        }
        self
    }

    /// Adds it to the normal equations of a fit.
    pub fn add_to(&self, g: &mut DMatrix<f64>, v: &mut DVector<f64>) {
        for (a, &i) in self.columns.iter().enumerate() {
            for (b, &k) in self.columns.iter().enumerate() {
                g[(i, k)] += self.information[(a, b)];
            }
            v[i] += self.right[a];
        }
    }

    /// Adds it to inner products whose column `y` is the torque.
    pub fn add_to_products(&self, products: &mut DMatrix<f64>, y: usize) {
        for (a, &i) in self.columns.iter().enumerate() {
            for (b, &k) in self.columns.iter().enumerate() {
                products[(i, k)] += self.information[(a, b)];
            }
            products[(i, y)] += self.right[a];
            products[(y, i)] += self.right[a];
        }
    }
}
