//! How well the variance of an estimate is known, whose noise was itself estimated.

use super::autoregression::Autoregression;
use super::innovations::Innovations;
use super::noise::Noise;
use crate::statistics::student::student_factor;
use nalgebra::{DMatrix, DVector};

/// Of a squared normal innovation the fourth moment in units of its squared variance.
const FOURTH_MOMENT: f64 = 3.0;

/// Variances of unknowns, and what is known of them.
pub(super) struct Known {
    /// Of each unknown the variance, added over the motions.
    variance: DVector<f64>,
    /// Derivatives of the variances by the coefficients of each equation's autoregression, one column a lag.
    by_coefficients: Vec<DMatrix<f64>>,
    /// By the logarithm of the variance of its innovations.
    by_variance: DMatrix<f64>,
    /// Squared uncertainties that come from innovations that have each their own variance.
    of_squares: DVector<f64>,
}

impl Known {
    pub fn new(noise: &Noise, unknowns: usize) -> Self {
        let of = |e: &Autoregression| DMatrix::zeros(unknowns, e.order());
        Self {
            variance: DVector::zeros(unknowns),
            by_coefficients: noise.equations.iter().map(of).collect(),
            by_variance: DMatrix::zeros(unknowns, noise.equations.len()),
            of_squares: DVector::zeros(unknowns),
        }
    }

    /// Adds one motion, whose `equations` move the unknowns by `inverse` times their scores.
    ///
    /// An innovation weighs z(t) = w(t) + sum of a(i) z(t + i) in a sum of noise, so that the derivative by a(i) obeys
    /// d(t) = z(t + i) + sum of a(j) d(t + j): for all i one recursion, shifted.
    pub fn add(&mut self, equations: &[Innovations<'_>], inverse: &DMatrix<f64>, noise: &Noise) {
        let moves: Vec<DMatrix<f64>> = equations.iter().map(|e| e.moves(inverse)).collect();
        for (own, z) in equations.iter().zip(&moves) {
            let mut all = DMatrix::<f64>::zeros(z.nrows(), z.ncols());
            for (other, of_other) in equations.iter().zip(&moves) {
                let correlation = noise.correlation[(own.equation, other.equation)];
                // They end at the same time.
                let last = z.nrows().min(of_other.nrows());
                let mut end = all.rows_mut(z.nrows() - last, last);
                end += correlation * of_other.rows(of_other.nrows() - last, last);
            }
            if let Some(variances) = &own.variances {
                all.column_iter_mut().for_each(|mut x| x.component_mul_assign(variances));
            }
            let model = &noise.equations[own.equation];
            for (l, (z, all)) in z.column_iter().zip(all.column_iter()).enumerate() {
                let product = z.dot(&all);
                self.variance[l] += product;
                self.by_variance[(l, own.equation)] += product;
                let mut slope: Vec<f64> = z.iter().copied().collect();
                model.run_backwards(&mut slope);
                for lag in 1..=model.order() {
                    let sum: f64 = slope.iter().skip(lag).zip(all.iter()).map(|(d, x)| d * x).sum();
                    self.by_coefficients[own.equation][(l, lag - 1)] += 2.0 * sum;
                }
                if own.variances.is_some() {
                    let fourth: f64 = z.iter().zip(all.iter()).map(|(z, x)| (z * x).powi(2)).sum();
                    self.of_squares[l] += 2.0 / FOURTH_MOMENT * fourth;
                }
            }
        }
    }

    /// For each unknown the factor, 1 at least, that makes of its standard deviation one whose 1.96-fold is half an
    /// interval of 95 %: Student's deviate over the normal one, with the degrees of freedom that a variance of the same
    /// mean and uncertainty has (Satterthwaite 1946; for estimated covariances Kenward and Roger 1997). The uncertainty of
    /// an autoregression is that of large samples (Brockwell and Davis 1991, theorem 8.1.1), by the delta method.
    pub fn student(&self, noise: &Noise) -> Vec<f64> {
        let of = |l: usize| {
            let mut uncertainty = self.of_squares[l];
            for (e, model) in noise.equations.iter().enumerate() {
                let slopes: Vec<f64> = self.by_coefficients[e].row(l).iter().copied().collect();
                let of_level = 2.0 * self.by_variance[(l, e)].powi(2);
                uncertainty +=
                    (of_level + model.variance_of_coefficients(&slopes)) / noise.freedom[e].max(1.0);
            }
            let freedom = 2.0 * self.variance[l].powi(2) / uncertainty;
            student_factor(freedom)
        };
        (0..self.variance.len()).map(of).collect()
    }
}
