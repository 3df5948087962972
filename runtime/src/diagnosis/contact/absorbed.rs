//! What the fit of a model takes over of a push, and of the noise.
//!
//! The columns of a model, white like the residual of each joint, are made orthonormal over all joints together. The part of a
//! half wave in their space is what a fit makes of it, and the amplitude of what is left of it that of a fit with the half wave
//! among the columns (Frisch and Waugh 1933). Without this a window with a large leverage has a small residual, and noise and
//! push in it are taken for less than they are (Cook and Weisberg, Residuals and Influence in Regression, 1982, 2.2).

use crate::diagnosis::contact::white::White;
use crate::diagnosis::rows::gram::dot;
use crate::diagnosis::rules::FIT_RIDGE;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};

/// A column on the rows of one joint, with its number.
type Column = (usize, Vec<f64>);

/// What a column is made with, beside all others.
#[derive(Debug, Clone, Copy)]
pub(super) struct Amplitude {
    /// In standard deviations from zero.
    pub deviations: f64,
    /// Part of the column's squares that the other columns do not make.
    pub left: f64,
}

/// Puts the columns of a model beside the residuals of joints; `of_joints[joint][column]` over the joint's rows, empty where a
/// column is zero there. Returns what each column is made with, in standard deviations of the joint that it acts on alone, if
/// there is one. Columns that have no fit leave all as it was.
pub(super) fn put_beside(whites: &mut [White], of_joints: &[Vec<Vec<f64>>]) -> Vec<Option<Amplitude>> {
    let count = of_joints.iter().map(Vec::len).max().unwrap_or(0);
    let white = |(white, columns): (&White, &Vec<Vec<f64>>)| -> Vec<Column> {
        let there = columns.iter().enumerate().filter(|(_, c)| !c.is_empty());
        there.map(|(k, c)| (k, white.column(c))).collect()
    };
    let of_joints: Vec<Vec<Column>> = whites.iter().zip(of_joints).map(white).collect();
    let Some(fit) = Fit::of(whites, &of_joints, count) else { return vec![None; count] };
    let mut amplitudes = vec![None; count];
    for (white, columns) in whites.iter_mut().zip(of_joints) {
        for (k, column) in &columns {
            white.residual.iter_mut().zip(column).for_each(|(r, x)| *r -= fit.chi[*k] * x);
        }
        let numbers: Vec<usize> = columns.iter().map(|c| c.0).collect();
        white.absorbed = fit.orthonormal(columns, white.residual.len());
        let before = white.sigma;
        white.scale();
        for k in numbers {
            amplitudes[k] = fit.amplitude(k, white.sigma / before);
        }
    }
    amplitudes
}

/// Least squares of the residuals of all joints on the columns.
struct Fit {
    chi: DVector<f64>,
    /// Per column: 1 / norm.
    scale: DVector<f64>,
    factor: Cholesky<f64, Dyn>,
    /// Diagonal of the inverse of the Gram matrix of columns of norm 1.
    inverse: DVector<f64>,
}

impl Fit {
    fn of(whites: &[White], of_joints: &[Vec<Column>], count: usize) -> Option<Self> {
        let (mut g, mut v) = (DMatrix::<f64>::zeros(count, count), DVector::<f64>::zeros(count));
        for (white, columns) in whites.iter().zip(of_joints) {
            for (a, (i, x)) in columns.iter().enumerate() {
                v[*i] += dot(x, &white.residual);
                for (k, y) in &columns[..=a] {
                    g[(*i, *k)] += dot(x, y);
                }
            }
        }
        let scale =
            DVector::from_fn(count, |k, _| if g[(k, k)] > 0.0 { 1.0 / g[(k, k)].sqrt() } else { 0.0 });
        // Numbers of columns rise: only the lower triangle is filled, and read.
        let scaled = DMatrix::from_fn(count, count, |i, k| match (i == k, scale[k] > 0.0) {
            (true, true) => 1.0 + FIT_RIDGE,
            (true, false) => 1.0,
            _ => g[(i, k)] * scale[i] * scale[k],
        });
        let factor = Cholesky::new(scaled)?;
        let chi = factor.solve(&v.component_mul(&scale)).component_mul(&scale);
        let inverse = factor.inverse().diagonal();
        chi.iter().all(|x| x.is_finite()).then_some(Self { chi, scale, factor, inverse })
    }

    /// That of a column, in noise of this standard deviation; `None` of a column that is zero.
    fn amplitude(&self, column: usize, sigma: f64) -> Option<Amplitude> {
        let (scale, inverse) = (self.scale[column], self.inverse[column]);
        let deviations = self.chi[column] / (scale * inverse.sqrt() * sigma);
        deviations.is_finite().then_some(Amplitude { deviations, left: 1.0 / inverse })
    }

    /// One joint's part of the orthonormal columns, by forward substitution.
    fn orthonormal(&self, columns: Vec<Column>, rows: usize) -> Vec<Vec<f64>> {
        let lower = self.factor.l_dirty();
        let mut columns = columns.into_iter().peekable();
        let mut out: Vec<Option<Vec<f64>>> = Vec::with_capacity(self.scale.len());
        for k in 0..self.scale.len() {
            let mut own = columns.next_if(|c| c.0 == k).map(|(_, mut column)| {
                column.iter_mut().for_each(|x| *x *= self.scale[k]);
                column
            });
            for (i, before) in out.iter().enumerate() {
                if let Some(before) = before.as_ref().filter(|_| lower[(k, i)] != 0.0) {
                    let own = own.get_or_insert_with(|| vec![0.0; rows]);
                    own.iter_mut().zip(before).for_each(|(x, y)| *x -= lower[(k, i)] * y);
                }
            }
            if let Some(own) = &mut own {
                own.iter_mut().for_each(|x| *x /= lower[(k, k)]);
            }
            out.push(own);
        }
        out.into_iter().flatten().collect()
    }
}
