//! Weighted least squares from Gram matrices: on all segments of a design, or on some of them.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::gram::{Gram, dot};
use crate::diagnosis::rows::prior::Prior;
use crate::diagnosis::rules::{LEAST_RELATIVE_SIGMA, LEAST_SIGMA, WEIGHT_ROUNDS, WEIGHTS_AT_REST};
use crate::statistics::moderation::{Lent, Variance};
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use std::ops::Range;

/// A fit of the columns of a design on some of its segments, with weights 1 / sigma² per joint.
#[derive(Clone)]
pub(in crate::diagnosis) struct Fit {
    /// Parameters, in units of the design's columns.
    pub chi: DVector<f64>,
    /// Standard deviation of the rows of each joint, which the weights are from.
    pub sigma: Vec<f64>,
    /// Segments that are fitted.
    pub train: Vec<bool>,
    /// Per column: 1 / norm, so that the factored matrix has a unit diagonal.
    scale: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
}

impl Fit {
    /// Fits on the segments that `train` marks.
    ///
    /// # Errors
    /// [`SingularDesign`] where the normal equations have no solution.
    pub fn new(design: &Design, sigma: &[f64], train: Vec<bool>) -> Result<Self, SingularDesign> {
        let p = design.columns.len();
        let (mut g, mut v) = weighted_sum(design, sigma, &train).normal_equations();
        if let Some(prior) = &design.prior {
            prior.add_to(&mut g, &mut v);
        }
        let scale = DVector::from_fn(p, |k, _| if g[(k, k)] > 0.0 { 1.0 / g[(k, k)].sqrt() } else { 0.0 });
        let mut scaled = DMatrix::from_fn(p, p, |i, k| {
            g[(i, k)] * scale[i] * scale[k] + if i == k { design.ridge(i, |c| g[(c, c)]) } else { 0.0 }
        });
        for k in 0..p {
            if scale[k] == 0.0 {
                scaled[(k, k)] = 1.0;
            }
        }
        let factor = Cholesky::new(scaled).ok_or(SingularDesign { columns: p })?;
        let mut fit = Self { chi: DVector::zeros(p), sigma: sigma.to_vec(), train, scale, factor };
        fit.chi = fit.solve(&v);
        design.known.iter().for_each(|&(k, value)| fit.chi[k] = value);
        // A column that is not finite has no norm, and would pass as one that is zero.
        if fit.chi.iter().all(|x| x.is_finite()) { Ok(fit) } else { Err(SingularDesign { columns: p }) }
    }

    /// Fits on all segments.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn whole(design: &Design, sigma: &[f64]) -> Result<Self, SingularDesign> {
        Self::new(design, sigma, vec![true; design.segments.len()])
    }

    /// Fits on all segments with weights that are iterated to the residuals' own standard deviations, which the fit
    /// then has in `sigma`; the first weights are from `start`.
    ///
    /// # Errors
    /// As [`Self::new`].
    pub fn weighted(design: &Design, start: &[f64]) -> Result<Self, SingularDesign> {
        let mut fit = Self::whole(design, start)?;
        for _ in 0..WEIGHT_ROUNDS {
            let sigma = fit.deviations(design);
            let moved = sigma.iter().zip(&fit.sigma).map(|(now, before)| (now / before - 1.0).abs());
            if moved.fold(0.0, f64::max) <= WEIGHTS_AT_REST {
                break;
            }
            fit = Self::whole(design, &sigma)?;
        }
        Ok(fit)
    }

    /// What the segments that are fitted say of the parameters, weighted by what the fit leaves of them.
    pub fn as_prior(&self, design: &Design) -> Prior {
        let of_joint = |j: usize| {
            let segments = || (0..self.train.len()).filter(|&g| self.train[g]);
            let rows = segments().map(|g| design.ranges[j][g].len()).sum::<usize>();
            let squares = segments().map(|g| self.squares(design, j, g)).sum::<f64>();
            if squares > 0.0 { (squares / rows as f64).sqrt() } else { self.sigma[j] }
        };
        let sigma: Vec<f64> = (0..design.joints).map(of_joint).collect();
        let (g, v) = weighted_sum(design, &sigma, &self.train).normal_equations();
        Prior::of_normal_equations(g, v)
    }

    /// Standard deviations of the residuals of the joints on all segments, bounded from below: squares over the degrees of
    /// freedom that the fit leaves there, which is their share of restricted maximum likelihood (Patterson and Thompson
    /// 1971). A joint that it leaves none is lent the relative error of the others.
    fn deviations(&self, design: &Design) -> Vec<f64> {
        let inverse = self.inverse_gram();
        let mean_square = |j: usize| {
            let rows = design.of_joint(j);
            let count = rows.len().max(1) as f64;
            rows.map(|r| design.torque(r).powi(2)).sum::<f64>() / count
        };
        let told: Vec<(Variance, f64)> = (0..design.joints)
            .map(|j| {
                let (rows, squares) = (design.of_joint(j).len() as f64, self.squares_of_joint(design, j));
                let freedom = (rows - self.leverage(design, j, &inverse)).clamp(0.0, rows);
                (Variance::of_squares(squares, freedom), mean_square(j))
            })
            .collect();
        let lent = Lent::of(told.iter().copied());
        let deviation = |(j, &(own, mean_square)): (usize, &(Variance, f64))| {
            let largest = design.of_joint(j).map(|r| design.torque(r).abs()).fold(0.0_f64, f64::max);
            let variance = lent.completed(own.value, own.freedom, mean_square);
            variance.sqrt().max(LEAST_RELATIVE_SIGMA * largest).max(LEAST_SIGMA)
        };
        told.iter().enumerate().map(deviation).collect()
    }

    /// Trace of a joint's part of the hat matrix, W (Wᵀ W)⁻¹ Wᵀ of the weighted rows of all segments.
    fn leverage(&self, design: &Design, joint: usize, inverse: &DMatrix<f64>) -> f64 {
        let gram = design.gram_of_joint(joint);
        let trace = (0..gram.columns()).map(|i| dot(gram.row(i), inverse.column(i).as_slice())).sum::<f64>();
        trace / (self.sigma[joint] * self.sigma[joint])
    }

    /// (Wᵀ W)⁻¹ in units of the columns.
    fn inverse_gram(&self) -> DMatrix<f64> {
        let inverse = self.factor.inverse();
        let p = self.chi.len();
        DMatrix::from_fn(p, p, |i, k| inverse[(i, k)] * self.scale[i] * self.scale[k])
    }

    /// (Wᵀ W)⁻¹ b.
    pub fn solve(&self, b: &DVector<f64>) -> DVector<f64> {
        self.factor.solve(&b.component_mul(&self.scale)).component_mul(&self.scale)
    }

    /// Squared residuals on the rows of one joint in one segment, unweighted.
    pub fn squares(&self, design: &Design, joint: usize, segment: usize) -> f64 {
        self.squares_on(design.gram(joint, segment))
    }

    /// The same in all segments.
    fn squares_of_joint(&self, design: &Design, joint: usize) -> f64 {
        self.squares_on(design.gram_of_joint(joint))
    }

    /// Squared residuals on the rows of a Gram matrix.
    fn squares_on(&self, gram: &Gram) -> f64 {
        let chi = self.chi.as_slice();
        let of = |i: usize| chi[i] * (dot(gram.row(i), chi) - 2.0 * gram.with_y(i));
        ((0..gram.columns()).map(of).sum::<f64>() + gram.y_squares()).max(0.0)
    }

    /// Squared residuals on all rows, in units of the joints' noise.
    pub fn weighted_squares(&self, design: &Design) -> f64 {
        let of_joint = |j: usize| self.squares_of_joint(design, j) / (self.sigma[j] * self.sigma[j]);
        (0..design.joints).map(of_joint).sum()
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

    /// Residual of some rows.
    pub fn residual_on(&self, design: &Design, rows: &[usize]) -> Vec<f64> {
        let mut left: Vec<f64> = rows.iter().map(|&r| design.y[r]).collect();
        for (column, &x) in design.columns.iter().zip(self.chi.iter()) {
            add_rows(&mut left, -x, column, (rows, 0));
        }
        left
    }

    /// Squares, in units of the residual variance, that only these columns explain: Wald's statistic. Nothing where they
    /// are not determined.
    pub fn wald(&self, columns: Range<usize>) -> Option<f64> {
        let (first, k) = (columns.start, columns.len());
        let unit = DMatrix::from_fn(self.chi.len(), k, |i, c| if i == first + c { 1.0 } else { 0.0 });
        let covariance = self.factor.solve(&unit).rows(first, k).into_owned();
        let scaled = DVector::from_fn(k, |c, _| match self.scale[first + c] {
            scale if scale > 0.0 => self.chi[first + c] / scale,
            _ => 0.0,
        });
        Some(scaled.dot(&covariance.cholesky()?.solve(&scaled)))
    }

    /// Information on some columns beside all others, in units of the residual variance; zero where a column is.
    pub fn information(&self, columns: Range<usize>) -> Option<DMatrix<f64>> {
        let (first, k) = (columns.start, columns.len());
        let unit = DMatrix::from_fn(self.chi.len(), k, |i, c| if i == first + c { 1.0 } else { 0.0 });
        let inverse = self.factor.solve(&unit).rows(first, k).into_owned().cholesky()?.inverse();
        let over = |c: usize| if self.scale[first + c] > 0.0 { 1.0 / self.scale[first + c] } else { 0.0 };
        Some(DMatrix::from_fn(k, k, |i, c| inverse[(i, c)] * over(i) * over(c)))
    }

    /// Variance of each parameter in units of the residual variance.
    pub fn variances(&self) -> DVector<f64> {
        let inverse = self.factor.inverse();
        DVector::from_fn(self.chi.len(), |k, _| inverse[(k, k)] * self.scale[k] * self.scale[k])
    }

    /// Variance with which the base parameters predict the rows of each joint in some segments that they were not fitted to,
    /// on average, in units of the residual variance; infinite where these have a column of one that was not seen at all.
    pub fn variance_of_prediction(&self, design: &Design, segments: &[usize]) -> Vec<f64> {
        let (inverse, parameters) = (self.inverse_gram(), 0..design.parameters);
        let of_joint = |joint: usize| {
            let mut gram = Gram::zero(design.columns.len());
            let mut rows = 0;
            for &segment in segments {
                gram.add(1.0, design.gram(joint, segment));
                rows += design.ranges[joint][segment].len();
            }
            let is_unseen = |k: usize| self.scale[k] == 0.0 && gram.squares(k) > 0.0;
            if parameters.clone().any(is_unseen) {
                return f64::INFINITY;
            }
            let of_column =
                |i: usize| -> f64 { parameters.clone().map(|k| gram.row(i)[k] * inverse[(k, i)]).sum() };
            let trace: f64 = parameters.clone().map(of_column).sum();
            trace / (self.sigma[joint] * self.sigma[joint] * rows.max(1) as f64)
        };
        (0..design.joints).map(of_joint).collect()
    }

    /// How many parameters were known beforehand, see [`crate::diagnosis::rows::prior::Prior::parameters`].
    pub fn known_beforehand(&self, design: &Design) -> f64 {
        let Some(prior) = &design.prior else { return 0.0 };
        let inverse = self.inverse_gram();
        prior.parameters(|i, k| inverse[(i, k)])
    }

    /// Columns that the segments do not determine: the part that the others do not make is below `least` of their
    /// norm, or they are zero.
    pub fn undetermined(&self, least: f64) -> Vec<usize> {
        let inverse = self.factor.inverse();
        (0..self.chi.len())
            .filter(|&k| self.scale[k] == 0.0 || 1.0 / inverse[(k, k)] < least * least)
            .collect()
    }
}

/// Adds a multiple of some values of a column, whose first is that of row `first`, given the rows in ascending order.
pub(in crate::diagnosis) fn add_rows(
    sums: &mut [f64],
    factor: f64,
    column: &[f64],
    (rows, first): (&[usize], usize),
) {
    let (Some(start), Some(last)) = (rows.first(), rows.last()) else { return };
    if last - start + 1 == rows.len() {
        // Mostly all of a stretch, which is read in one go.
        let stretch = &column[start - first..=last - first];
        sums.iter_mut().zip(stretch).for_each(|(sum, x)| *sum += factor * x);
    } else {
        sums.iter_mut().zip(rows).for_each(|(sum, r)| *sum += factor * column[r - first]);
    }
}

/// Weighted inner products over the segments that are fitted.
fn weighted_sum(design: &Design, sigma: &[f64], train: &[bool]) -> Gram {
    let mut sum = Gram::zero(design.columns.len());
    let all = !train.contains(&false);
    for (j, s) in sigma.iter().enumerate() {
        let weight = 1.0 / (s * s);
        if all {
            sum.add(weight, design.gram_of_joint(j));
            continue;
        }
        for segment in (0..train.len()).filter(|&g| train[g]) {
            sum.add(weight, design.gram(j, segment));
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn what_some_segments_say_beside_the_others_is_the_fit_to_all() {
        let rows = 40;
        let column = |w: f64| -> Vec<f64> { (0..rows).map(|r| (w * f64::from(r)).sin()).collect() };
        let (a, b) = (column(0.3), column(0.7));
        let y: Vec<f64> = (0..rows as usize).map(|r| 2.0 * a[r] - b[r] + 0.1 * (r as f64).cos()).collect();
        let design = Design::made_up(1, &[(0, false), (1, true)], 20, vec![a, b], y);
        let old = Fit::new(&design, &[1.0], vec![true, false]).expect("they are regular");
        let sigma = (old.squares(&design, 0, 0) / 20.0).sqrt();
        let all = Fit::whole(&design, &[sigma]).expect("it is regular");
        let mut beside = design.clone();
        beside.prior = Some(std::sync::Arc::new(old.as_prior(&design)));
        let new = Fit::new(&beside, &[sigma], vec![false, true]).expect("it is regular");
        assert_relative_eq!(new.chi, all.chi, max_relative = 1e-6);
    }
}
