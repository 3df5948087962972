//! Weighted least squares from inner products: the whole, a fold, and a candidate added to either.

use crate::diagnosis::rows::design::Design;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// A fit of the columns of a design on some of its segments.
pub(in crate::diagnosis) struct Fit {
    /// Parameters, in units of the design's columns.
    pub chi: DVector<f64>,
    /// Per column: 1 / norm, so that the factored matrix has a unit diagonal.
    scale: DVector<f64>,
    factor: Option<Cholesky<f64, Dyn>>,
}

/// Relative ridge: what is not determined stays small instead of exploding.
const RIDGE: f64 = 1e-10;

impl Fit {
    /// Fits on the segments that `train` accepts with weights 1 / sigma² per joint.
    pub fn new(design: &Design, sigma: &[f64], train: impl Fn(usize) -> bool) -> Self {
        let p = design.columns.len();
        let (g, v) = normal(design, sigma, &train);
        let scale = DVector::from_fn(p, |k, _| if g[(k, k)] > 0.0 { 1.0 / g[(k, k)].sqrt() } else { 0.0 });
        let mut scaled =
            DMatrix::from_fn(p, p, |i, k| g[(i, k)] * scale[i] * scale[k] + if i == k { RIDGE } else { 0.0 });
        for k in 0..p {
            if scale[k] == 0.0 {
                scaled[(k, k)] = 1.0;
            }
        }
        let factor = Cholesky::new(scaled);
        let mut fit = Self { chi: DVector::zeros(p), scale, factor };
        fit.chi = fit.solve(&v);
        fit
    }

    /// (WT W)⁻¹ b.
    pub fn solve(&self, b: &DVector<f64>) -> DVector<f64> {
        let scaled = b.component_mul(&self.scale);
        match &self.factor {
            Some(f) => f.solve(&scaled).component_mul(&self.scale),
            None => DVector::zeros(b.len()),
        }
    }

    /// Squared residuals on one group, unweighted.
    pub fn squares(&self, design: &Design, joint: usize, segment: usize) -> f64 {
        let p = design.columns.len();
        let g = &design.gram[joint][segment];
        let mut sum = g[p * (p + 1) + p];
        for i in 0..p {
            let row = &g[i * (p + 1)..i * (p + 1) + p];
            let product: f64 = row.iter().zip(self.chi.iter()).map(|(a, b)| a * b).sum();
            sum += self.chi[i] * (product - 2.0 * g[i * (p + 1) + p]);
        }
        sum.max(0.0)
    }

    /// Residual of every row.
    pub fn residual(&self, design: &Design) -> Vec<f64> {
        let mut r = design.y.clone();
        for (column, &x) in design.columns.iter().zip(self.chi.iter()) {
            if x != 0.0 {
                for (r, c) in r.iter_mut().zip(column) {
                    *r -= c * x;
                }
            }
        }
        r
    }

    /// Variance of each parameter in units of the residual variance.
    pub fn variances(&self) -> DVector<f64> {
        let p = self.chi.len();
        let Some(f) = &self.factor else { return DVector::zeros(p) };
        let inverse = f.inverse();
        DVector::from_fn(p, |k, _| inverse[(k, k)] * self.scale[k] * self.scale[k])
    }

    /// Columns that the segments do not determine: their own part is below 1e-4 of their norm, or they are zero.
    pub fn undetermined(&self, least: f64) -> Vec<usize> {
        let p = self.chi.len();
        let Some(f) = &self.factor else { return (0..p).collect() };
        let inverse = f.inverse();
        (0..p).filter(|&k| self.scale[k] == 0.0 || 1.0 / inverse[(k, k)] < least * least).collect()
    }
}

/// Weighted inner products of the columns with each other and with y.
fn normal(design: &Design, sigma: &[f64], train: &dyn Fn(usize) -> bool) -> (DMatrix<f64>, DVector<f64>) {
    let p = design.columns.len();
    let mut sum = vec![0.0; (p + 1) * (p + 1)];
    for (groups, s) in design.gram.iter().zip(sigma) {
        let w = 1.0 / (s * s);
        for (segment, g) in groups.iter().enumerate() {
            if train(segment) {
                for (a, b) in sum.iter_mut().zip(g) {
                    *a += w * b;
                }
            }
        }
    }
    (DMatrix::from_fn(p, p, |i, k| sum[i * (p + 1) + k]), DVector::from_fn(p, |i, _| sum[i * (p + 1) + p]))
}

/// Fits with weights that are iterated to the residuals' own standard deviations; returns them per joint.
pub(in crate::diagnosis) fn fit_weighted(
    design: &Design,
    sigma: &mut [f64],
    train: impl Fn(usize) -> bool + Copy,
) -> Fit {
    let mut fit = Fit::new(design, sigma, train);
    for _ in 0..6 {
        for (j, s) in sigma.iter_mut().enumerate() {
            let rows = design.count(j, train);
            let squares: f64 =
                (0..design.segments.len()).filter(|&g| train(g)).map(|g| fit.squares(design, j, g)).sum();
            let largest = design.y[design.of_joint(j)].iter().fold(0.0_f64, |a, b| a.max(b.abs()));
            *s = (squares / rows.max(1) as f64).sqrt().max(1e-9 * largest).max(1e-12);
        }
        fit = Fit::new(design, sigma, train);
    }
    fit
}
