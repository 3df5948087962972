//! What the columns of a model make of other columns, from inner products.

use crate::diagnosis::rows::gram::dot;
use crate::diagnosis::rules::CALIBRATION_RIDGE;
use nalgebra::{Cholesky, DMatrix, DVector, Dyn};
use std::ops::Range;

/// The first columns of a table of inner products, factored once for all that is compared beside them.
pub(in crate::diagnosis) struct Projection {
    factor: Cholesky<f64, Dyn>,
    scale: DVector<f64>,
}

impl Projection {
    /// Of the first `m` columns; `None` where their products are not finite.
    pub fn of(products: &DMatrix<f64>, m: usize) -> Option<Self> {
        let (factor, scale) = factored(&products.view((0, 0), (m, m)).into_owned())?;
        Some(Self { factor, scale })
    }

    /// Columns of inner products with them, made white: the product of two such columns is that of the parts which the
    /// model's columns make of both.
    pub fn white(&self, products: &DMatrix<f64>, from: usize, count: usize) -> DMatrix<f64> {
        let mut white = products.view((0, from), (self.scale.len(), count)).into_owned();
        for (i, scale) in self.scale.iter().enumerate() {
            white.row_mut(i).scale_mut(*scale);
        }
        // The factor's diagonal is positive, so that there is a solution.
        let solve = |right: &mut DMatrix<f64>| self.factor.l_dirty().solve_lower_triangular_mut(right);
        if count > white.nrows() {
            // A product of matrices is several times as fast as substitution, column by column.
            let mut inverse = DMatrix::identity(white.nrows(), white.nrows());
            let _ = solve(&mut inverse);
            return inverse * white;
        }
        let _ = solve(&mut white);
        white
    }

    /// How much of each column of the model makes the part that is `white`.
    pub fn made(&self, mut white: DVector<f64>) -> DVector<f64> {
        let _ = self.factor.l_dirty().ad_solve_lower_triangular_mut(&mut white);
        white.component_mul(&self.scale)
    }
}

/// Cholesky factor with a unit diagonal and a ridge, and the scale of each column (0 where it is zero).
pub(in crate::diagnosis) fn factored(g: &DMatrix<f64>) -> Option<(Cholesky<f64, Dyn>, DVector<f64>)> {
    let n = g.nrows();
    let scale = DVector::from_fn(n, |k, _| if g[(k, k)] > 0.0 { 1.0 / g[(k, k)].sqrt() } else { 0.0 });
    let scaled = DMatrix::from_fn(n, n, |i, k| {
        let diagonal = if i != k {
            0.0
        } else if scale[k] == 0.0 {
            1.0
        } else {
            CALIBRATION_RIDGE
        };
        g[(i, k)] * scale[i] * scale[k] + diagonal
    });
    Some((scaled.cholesky()?, scale))
}

/// Inner products of columns over these rows.
pub(in crate::diagnosis) fn inner_products(columns: &[&[f64]], rows: Range<usize>) -> DMatrix<f64> {
    let n = columns.len();
    let mut g = DMatrix::zeros(n, n);
    for i in 0..n {
        for k in 0..=i {
            let value = dot(&columns[i][rows.clone()], &columns[k][rows.clone()]);
            g[(i, k)] = value;
            g[(k, i)] = value;
        }
    }
    g
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::normal;
    use approx::assert_relative_eq;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    #[test]
    fn parts_that_columns_make_of_others_are_those_of_a_regression() {
        let mut rng = Pcg64::seed_from_u64(3);
        let columns = DMatrix::from_fn(40, 5, |_, _| normal(&mut rng));
        let (model, others) = (columns.columns(0, 3).into_owned(), columns.columns(3, 2).into_owned());
        let projection = Projection::of(&columns.tr_mul(&columns), 3).expect("finite");
        let white = projection.white(&columns.tr_mul(&columns), 3, 2);
        let x = model.clone().svd(true, true).solve(&others, 1e-12).expect("both sides");
        let fitted = &model * &x;
        assert_relative_eq!(white.tr_mul(&white), fitted.tr_mul(&fitted), max_relative = 1e-8);
        let made = projection.made(white.column(1).into_owned());
        assert_relative_eq!(made, x.column(1).into_owned(), max_relative = 1e-8);
    }
}
