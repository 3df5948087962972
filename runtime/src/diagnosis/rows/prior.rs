//! What is known of columns beforehand, as the inner products of rows that nobody has kept.

use nalgebra::{Cholesky, DMatrix, DVector};
use std::ops::Range;

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

    /// What rows with these normal equations say of all columns.
    pub fn of_normal_equations(information: DMatrix<f64>, right: DVector<f64>) -> Self {
        Self { columns: (0..right.len()).collect(), information, right }
    }

    /// The same, and that these columns are zero within a standard deviation, each for itself.
    pub fn with_zeros(before: Option<&Self>, columns: Range<usize>, deviation: f64) -> Self {
        let old = before.map_or(0, |before| before.columns.len());
        let all = old + columns.len();
        let mut information = DMatrix::from_diagonal_element(all, all, 1.0 / (deviation * deviation));
        let mut right = DVector::zeros(all);
        if let Some(before) = before {
            information.view_mut((0, 0), (old, old)).copy_from(&before.information);
            right.rows_mut(0, old).copy_from(&before.right);
        }
        let before = before.map(|before| before.columns.clone()).unwrap_or_default();
        Self { columns: before.into_iter().chain(columns).collect(), information, right }
    }

    /// The same, so many times less certain of every value.
    pub fn loosened(&self, times: f64) -> Self {
        let less = 1.0 / (times * times);
        Self {
            columns: self.columns.clone(),
            information: &self.information * less,
            right: &self.right * less,
        }
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

    /// What it says of the other columns where the values of these are known.
    pub fn given(self, known: &[(usize, f64)]) -> Self {
        let value = |k: usize| known.iter().find(|(column, _)| *column == k).map(|(_, value)| *value);
        let kept: Vec<usize> =
            (0..self.columns.len()).filter(|&i| value(self.columns[i]).is_none()).collect();
        if kept.len() == self.columns.len() {
            return self;
        }
        let values = DVector::from_fn(self.columns.len(), |i, _| value(self.columns[i]).unwrap_or(0.0));
        Self {
            right: (&self.right - &self.information * values).select_rows(&kept),
            information: self.information.select_rows(&kept).select_columns(&kept),
            columns: kept.iter().map(|&i| self.columns[i]).collect(),
        }
    }

    /// What it says of the other columns where these are not there, and the others stand without a gap.
    pub fn without(&self, columns: &Range<usize>) -> Self {
        let zero: Vec<(usize, f64)> = columns.clone().map(|k| (k, 0.0)).collect();
        let mut left = self.clone().given(&zero);
        for k in left.columns.iter_mut().filter(|k| **k >= columns.end) {
            *k -= columns.len();
        }
        left
    }

    /// How many parameters it stands for in a fit with this covariance, all information together: the part of each unknown
    /// that it knows, summed. What is left of their number are the parameters that the rows have to tell (effective number
    /// of parameters; Bishop, Pattern Recognition and Machine Learning, 3.5.3).
    pub fn parameters(&self, covariance: impl Fn(usize, usize) -> f64) -> f64 {
        let of = |a: usize, b: usize| self.information[(a, b)] * covariance(self.columns[b], self.columns[a]);
        let places = 0..self.columns.len();
        places.clone().flat_map(|a| places.clone().map(move |b| (a, b))).map(|(a, b)| of(a, b)).sum()
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_stands_for_as_many_parameters_as_rows_need_not_tell() {
        let covariance = DMatrix::from_row_slice(2, 2, &[4.0, 1.0, 1.0, 9.0]);
        let prior = Prior::of_covariance(&covariance, vec![1.0, 2.0], vec![0, 2]).expect("it is positive");
        // Three unknowns, of which it knows two, beside rows with so much information on all of them.
        let parameters = |of_rows: f64| {
            let (mut g, mut v) = (DMatrix::identity(3, 3) * of_rows, DVector::zeros(3));
            prior.add_to(&mut g, &mut v);
            let inverse = g.try_inverse().expect("rows tell all of them");
            prior.parameters(|i, k| inverse[(i, k)])
        };
        approx::assert_relative_eq!(parameters(1e-9), 2.0, epsilon = 1e-6);
        assert!(parameters(1e9) < 1e-6);
        // Eigenvalues 1/4 and 1/9 beside 1, were they not correlated.
        assert!((0.2..0.4).contains(&parameters(1.0)), "{}", parameters(1.0));
    }

    #[test]
    fn columns_that_are_nearly_zero_are_drawn_to_it_beside_what_was_known_before() {
        let covariance = DMatrix::from_row_slice(1, 1, &[4.0]);
        let prior = Prior::of_covariance(&covariance, vec![1.0], vec![0]).expect("it is positive");
        let both = Prior::with_zeros(Some(&prior), 2..4, 0.5);
        let (mut g, mut v) = (DMatrix::identity(4, 4), DVector::from_element(4, 1.0));
        both.add_to(&mut g, &mut v);
        let x = g.try_inverse().expect("rows tell all of them") * v;
        // (1 + 1/4) over itself, 1, and 1 over 1 + 4.
        approx::assert_relative_eq!(x, DVector::from_vec(vec![1.0, 1.0, 0.2, 0.2]), max_relative = 1e-12);
    }

    #[test]
    fn beside_a_known_value_it_is_the_conditional_distribution() {
        let covariance = DMatrix::from_row_slice(2, 2, &[4.0, 1.0, 1.0, 9.0]);
        let prior = Prior::of_covariance(&covariance, vec![1.0, 2.0], vec![0, 2]).expect("it is positive");
        let left = prior.clone().given(&[(2, 5.0)]);
        assert_eq!(left.columns, [0]);
        // Mean 1 + 1/9 (5 - 2), variance 4 - 1/9.
        approx::assert_relative_eq!(left.information[(0, 0)], 1.0 / (4.0 - 1.0 / 9.0), max_relative = 1e-12);
        let mean = left.right[0] / left.information[(0, 0)];
        approx::assert_relative_eq!(mean, 4.0 / 3.0, max_relative = 1e-12);
        assert_eq!(prior.clone().given(&[(1, 7.0)]), prior);
        // Of columns that close the gap of those that are not there, the same.
        let without = Prior::with_zeros(Some(&prior), 6..7, 0.5).without(&(3..5));
        assert_eq!(without, Prior::with_zeros(Some(&prior), 4..5, 0.5));
        assert_eq!(prior.without(&(2..3)), prior.clone().given(&[(2, 0.0)]));
    }
}
