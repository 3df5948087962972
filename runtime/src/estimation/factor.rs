//! The orthogonal factor of rows [W Y]: what is kept of any number of rows, without W and without WT W.

use super::householder::reduce;
use nalgebra::DMatrix;

/// Rows that are gathered before they are reduced: columns an odd number of cache lines apart, so that a row does not
/// crowd a few sets of the cache.
pub const BLOCK_ROWS: usize = 120;

/// Most columns of a factor that is read: more than any robot has parameters.
const MOST_COLUMNS: usize = 4096;

/// Upper-triangular R of [W Y] = Q R, with the number of rows that went in.
///
/// R determines the least-squares solution, its covariance, and the residual of any other parameters, with the
/// digits of an orthogonal factorisation of the tall matrix (Golub and Van Loan, chapter 5).
#[derive(Debug, Clone, PartialEq)]
pub struct Factor {
    unknowns: usize,
    rows: usize,
    /// (unknowns + 1) squared, column by column; the last column is Y.
    r: Vec<f64>,
}

impl Factor {
    /// No rows yet.
    pub fn new(unknowns: usize) -> Factor {
        Factor { unknowns, rows: 0, r: vec![0.0; (unknowns + 1) * (unknowns + 1)] }
    }

    /// A factor that was written down: of so many rows, the upper triangle of R column by column, Y last. `None` where the
    /// triangle has another number of entries, one of them is no number, or there are more unknowns than a robot has.
    pub fn from_upper(unknowns: usize, rows: usize, upper: &[f64]) -> Option<Factor> {
        let columns = unknowns.checked_add(1).filter(|columns| *columns <= MOST_COLUMNS)?;
        if upper.len() != columns * (columns + 1) / 2 || upper.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let mut factor = Factor { rows, ..Factor::new(unknowns) };
        let mut rest = upper;
        for l in 0..columns {
            let (column, behind) = rest.split_at(l + 1);
            factor.r[l * columns..][..=l].copy_from_slice(column);
            rest = behind;
        }
        Some(factor)
    }

    /// The upper triangle of R column by column, Y last: what [`Factor::from_upper`] reads.
    pub fn upper(&self) -> Vec<f64> {
        let columns = self.unknowns + 1;
        (0..columns).flat_map(|l| &self.r[l * columns..][..=l]).copied().collect()
    }

    /// Columns of W.
    pub fn unknowns(&self) -> usize {
        self.unknowns
    }

    /// Rows that went in.
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// R(i, l), zero below the diagonal; column `unknowns` is Y.
    pub fn r(&self, i: usize, l: usize) -> f64 {
        self.r[l * (self.unknowns + 1) + i]
    }

    /// Takes in `rows` rows. Column l of [W Y] is `block[l * stride..][..rows]`; the block is destroyed, and its
    /// rows from `rows` up to the next multiple of four are overwritten.
    ///
    /// # Panics
    /// If the block is shorter than (unknowns + 1) * stride, or the stride is not a multiple of four or less than
    /// the rows.
    pub fn push(&mut self, rows: usize, stride: usize, block: &mut [f64]) {
        let columns = self.unknowns + 1;
        let padded = rows.next_multiple_of(4);
        assert!(stride.is_multiple_of(4) && padded <= stride && block.len() >= columns * stride);
        if rows == 0 {
            return;
        }
        for l in 0..columns {
            block[l * stride + rows..l * stride + padded].fill(0.0);
            if padded < stride {
                block.copy_within(l * stride..l * stride + padded, l * padded);
            }
        }
        reduce(columns, &mut self.r, padded, &mut block[..columns * padded]);
        self.rows += rows;
    }

    /// Takes in the rows of another factor of the same unknowns.
    pub fn merge(&mut self, other: &Factor) {
        let columns: Vec<usize> = (0..self.unknowns).collect();
        self.merge_weighted(other, &columns, 1.0);
    }

    /// Takes in the rows of a factor of fewer unknowns, multiplied by `weight`: its column l is this factor's
    /// column `columns[l]`.
    ///
    /// # Panics
    /// If `columns` is not one place among the unknowns for each column of `other`.
    pub fn merge_weighted(&mut self, other: &Factor, columns: &[usize], weight: f64) {
        assert_eq!(columns.len(), other.unknowns);
        let rows = other.unknowns + 1;
        let stride = rows.next_multiple_of(4);
        let mut block = vec![0.0; (self.unknowns + 1) * stride];
        for (l, &to) in columns.iter().chain([&self.unknowns]).enumerate() {
            assert!(to <= self.unknowns);
            let from = &other.r[l * rows..l * rows + l + 1];
            for (x, r) in block[to * stride..].iter_mut().zip(from) {
                *x = weight * r;
            }
        }
        reduce(self.unknowns + 1, &mut self.r, stride, &mut block);
        self.rows += other.rows;
    }

    /// The factor of the same rows with only some of the columns of W, in the given order.
    pub fn select(&self, columns: &[usize]) -> Factor {
        let mut selected = Factor::new(columns.len());
        let stride = (self.unknowns + 1).next_multiple_of(4);
        let mut block = vec![0.0; (columns.len() + 1) * stride];
        for (l, &from) in columns.iter().chain([&self.unknowns]).enumerate() {
            let at = from * (self.unknowns + 1);
            block[l * stride..][..from + 1].copy_from_slice(&self.r[at..at + from + 1]);
        }
        reduce(columns.len() + 1, &mut selected.r, stride, &mut block);
        selected.rows = self.rows;
        selected
    }

    /// What the first `known` columns leave of the others and of Y: that many rows less.
    ///
    /// # Panics
    /// If there are fewer columns.
    pub fn beyond(&self, known: usize) -> Factor {
        assert!(known <= self.unknowns);
        let mut left = Factor::new(self.unknowns - known);
        let rows = left.unknowns + 1;
        for l in 0..rows {
            let at = (l + known) * (self.unknowns + 1) + known;
            left.r[l * rows..][..=l].copy_from_slice(&self.r[at..=at + l]);
        }
        left.rows = self.rows.saturating_sub(known);
        left
    }

    /// The factor of the same rows with Y replaced by Y - sum of value * column, and those columns left out:
    /// parameters that are held at known values.
    pub fn hold(&self, held: &[(usize, f64)]) -> Factor {
        let mut moved = self.clone();
        let rows = self.unknowns + 1;
        for &(l, value) in held {
            for i in 0..=l {
                moved.r[self.unknowns * rows + i] -= value * self.r[l * rows + i];
            }
        }
        let free: Vec<usize> = (0..self.unknowns).filter(|l| held.iter().all(|(h, _)| h != l)).collect();
        moved.select(&free)
    }

    /// The factor of the same rows with other columns: [W Y] times a matrix of unknowns + 1 rows, whose last column gives
    /// the new Y.
    ///
    /// # Panics
    /// If the matrix has another number of rows, or no column.
    pub fn times(&self, matrix: &DMatrix<f64>) -> Factor {
        let rows = self.unknowns + 1;
        assert!(matrix.nrows() == rows && matrix.ncols() > 0);
        let product = DMatrix::from_column_slice(rows, rows, &self.r) * matrix;
        let mut changed = Factor::new(matrix.ncols() - 1);
        let stride = rows.next_multiple_of(4);
        let mut block = vec![0.0; matrix.ncols() * stride];
        for (to, column) in block.chunks_exact_mut(stride).zip(product.column_iter()) {
            for (x, value) in to.iter_mut().zip(column.iter()) {
                *x = *value;
            }
        }
        reduce(matrix.ncols(), &mut changed.r, stride, &mut block);
        changed.rows = self.rows;
        changed
    }

    /// ||Y||
    pub fn norm_y(&self) -> f64 {
        let at = self.unknowns * (self.unknowns + 1);
        norm(&self.r[at..])
    }

    /// ||W_l|| of each column.
    pub fn column_norms(&self) -> Vec<f64> {
        let rows = self.unknowns + 1;
        (0..self.unknowns).map(|l| norm(&self.r[l * rows..l * rows + l + 1])).collect()
    }

    /// ||Y - W chi|| for any parameters.
    pub fn residual_norm(&self, chi: &[f64]) -> f64 {
        norm(&self.residual(chi))
    }

    /// QT (Y - W chi): unknowns + 1 values with the norm of the residual.
    pub fn residual(&self, chi: &[f64]) -> Vec<f64> {
        let rows = self.unknowns + 1;
        let mut e = self.r[self.unknowns * rows..].to_vec();
        for (l, &x) in chi.iter().enumerate() {
            for (e, r) in e.iter_mut().zip(&self.r[l * rows..l * rows + l + 1]) {
                *e -= x * r;
            }
        }
        e
    }

    /// WT (Y - W chi): the score of each unknown.
    pub fn score(&self, chi: &[f64]) -> Vec<f64> {
        let rows = self.unknowns + 1;
        let e = self.residual(chi);
        (0..self.unknowns)
            .map(|l| self.r[l * rows..l * rows + l + 1].iter().zip(&e).map(|(r, e)| r * e).sum())
            .collect()
    }
}

fn norm(x: &[f64]) -> f64 {
    x.iter().map(|x| x * x).sum::<f64>().sqrt()
}

#[cfg(test)]
#[path = "factor_tests.rs"]
mod tests;
