//! Least squares from a factor: rank, condition, solution, covariance.
//! Equation numbers are those of Gautier and Briot.

use super::Factor;
use nalgebra::{DMatrix, DVector};

/// Directions whose singular value of the scaled W is below this share of the largest are not determined.
pub const RANK_TOLERANCE: f64 = 1e-9;
/// A column of which no more than this share of the largest is there holds the rounding errors of what cancels in it.
pub(crate) const ROUNDING: f64 = 1e-12;

/// Least-squares solution of a factor.
#[derive(Debug, Clone, PartialEq)]
pub struct Solution {
    /// Unknowns that were solved for, ascending. The others cannot be told from these: their value is zero.
    pub kept: Vec<usize>,
    /// Parameters, one per unknown; zero where not kept.
    pub chi: Vec<f64>,
    /// Diagonal of (WT W)^-1 over the kept columns; infinite where not kept.
    pub variance: Vec<f64>,
    /// ||Y - W chi||
    pub residual_norm: f64,
    /// Rows minus kept unknowns.
    pub degrees_of_freedom: usize,
    /// Condition number of the kept columns of W, each scaled to unit length.
    pub condition: f64,
    /// Unit direction among the scaled unknowns that the data determine least, among the kept ones.
    pub weakest: Vec<f64>,
    /// For each unknown that is not kept: the unknowns it cannot be told from (itself among them), the strongest
    /// first. A column of zeros stands alone.
    pub dependent: Vec<Vec<usize>>,
}

impl Factor {
    /// The least-squares solution (15) with what it rests on; see [`Solution`].
    ///
    /// Rank by a pivoted QR of the triangle with columns of unit length, then back substitution on what is
    /// independent.
    pub fn solve(&self) -> Solution {
        solve(self)
    }
}

fn solve(factor: &Factor) -> Solution {
    let k = factor.unknowns();
    let norms = factor.column_norms();
    let least = ROUNDING * norms.iter().copied().fold(0.0, f64::max);
    let scale: Vec<f64> = norms.iter().map(|&n| if n > least { 1.0 / n } else { 0.0 }).collect();
    let scaled = DMatrix::from_fn(k + 1, k, |i, l| if i <= l { factor.r(i, l) * scale[l] } else { 0.0 });
    let y = DVector::from_fn(k + 1, |i, _| factor.r(i, k));

    let (order, rank) = independent(&scaled);
    let mut kept = order[..rank].to_vec();
    kept.sort_unstable();
    let dependent = order[rank..].iter().map(|&l| partners(&scaled, &kept, l)).collect();

    let basis = DMatrix::from_fn(k + 1, rank, |i, c| scaled[(i, kept[c])]);
    let qr = basis.clone().qr();
    let r = qr.r();
    let mut qty = y.clone();
    qr.q_tr_mul(&mut qty);
    let x = r.solve_upper_triangular(&qty.rows(0, rank));
    let inverse = r.solve_upper_triangular(&DMatrix::identity(rank, rank));
    let (Some(x), Some(inverse)) = (x, inverse) else { return undetermined(factor) };

    let mut chi = vec![0.0; k];
    let mut variance = vec![f64::INFINITY; k];
    for (c, &l) in kept.iter().enumerate() {
        chi[l] = x[c] * scale[l];
        variance[l] = inverse.row(c).norm_squared() * scale[l] * scale[l];
    }
    let (condition, weakest) = conditioning(&r, &kept, k);
    let residual_norm = factor.residual_norm(&chi);
    let degrees_of_freedom = factor.rows().saturating_sub(rank);
    Solution { kept, chi, variance, residual_norm, degrees_of_freedom, condition, weakest, dependent }
}

/// The solution where no column is independent of the others: every unknown stands alone.
fn undetermined(factor: &Factor) -> Solution {
    let k = factor.unknowns();
    let chi = vec![0.0; k];
    Solution {
        kept: Vec::new(),
        variance: vec![f64::INFINITY; k],
        residual_norm: factor.residual_norm(&chi),
        degrees_of_freedom: factor.rows(),
        condition: 1.0,
        weakest: vec![0.0; k],
        dependent: (0..k).map(|l| vec![l]).collect(),
        chi,
    }
}

/// Parameters and the diagonal of (WT W)^-1 of a factor whose columns are known to be independent.
pub(super) fn back_substitute(factor: &Factor) -> (Vec<f64>, Vec<f64>) {
    let k = factor.unknowns();
    let mut chi = vec![0.0; k];
    for i in (0..k).rev() {
        let known: f64 = (i + 1..k).map(|l| factor.r(i, l) * chi[l]).sum();
        chi[i] = (factor.r(i, k) - known) / factor.r(i, i);
    }
    // Column m of R^-1 by back substitution; its entries count in the variances of the rows.
    let mut variance = vec![0.0; k];
    let mut column = vec![0.0; k];
    for m in 0..k {
        column[m] = 1.0 / factor.r(m, m);
        variance[m] += column[m] * column[m];
        for i in (0..m).rev() {
            let known: f64 = (i + 1..=m).map(|l| factor.r(i, l) * column[l]).sum();
            column[i] = -known / factor.r(i, i);
            variance[i] += column[i] * column[i];
        }
    }
    (chi, variance)
}

/// (WT W)^-1 of a factor whose columns are known to be independent.
pub(super) fn inverse_gram(factor: &Factor) -> DMatrix<f64> {
    let k = factor.unknowns();
    let r = DMatrix::from_fn(k, k, |i, l| factor.r(i, l));
    let inverse = r.solve_upper_triangular(&DMatrix::identity(k, k)).unwrap_or_else(|| DMatrix::zeros(k, k));
    &inverse * inverse.transpose()
}

/// Column order of the pivoted QR and the number of columns that are independent.
fn independent(scaled: &DMatrix<f64>) -> (Vec<usize>, usize) {
    let k = scaled.ncols();
    let mut order: Vec<usize> = (0..k).collect();
    if k == 0 {
        return (order, 0);
    }
    let qr = scaled.clone().col_piv_qr();
    let mut places = nalgebra::RowDVector::from_iterator(k, order.iter().map(|&l| l as f64));
    qr.p().permute_columns(&mut places);
    for (to, from) in order.iter_mut().zip(places.iter()) {
        *to = *from as usize;
    }
    let r = qr.r();
    let rank = (0..k).take_while(|&i| r[(i, i)].abs() > RANK_TOLERANCE).count();
    (order, rank)
}

/// The unknowns whose columns make up the column of a dependent one.
fn partners(scaled: &DMatrix<f64>, kept: &[usize], dependent: usize) -> Vec<usize> {
    let column = scaled.column(dependent).into_owned();
    if column.norm() == 0.0 || kept.is_empty() {
        return vec![dependent];
    }
    let basis = DMatrix::from_fn(scaled.nrows(), kept.len(), |i, c| scaled[(i, kept[c])]);
    let qr = basis.qr();
    let mut projected = column;
    qr.q_tr_mul(&mut projected);
    let Some(shares) = qr.r().solve_upper_triangular(&projected.rows(0, kept.len())) else {
        return vec![dependent];
    };
    let mut named: Vec<(f64, usize)> = shares.iter().zip(kept).map(|(x, &l)| (x.abs(), l)).collect();
    named.retain(|&(share, _)| share > 1e-3);
    named.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    std::iter::once(dependent).chain(named.into_iter().map(|(_, l)| l)).collect()
}

fn conditioning(r: &DMatrix<f64>, kept: &[usize], unknowns: usize) -> (f64, Vec<f64>) {
    let mut weakest = vec![0.0; unknowns];
    if kept.is_empty() {
        return (1.0, weakest);
    }
    let svd = r.clone().svd(false, true);
    let values = &svd.singular_values;
    let at = values.imin();
    if let Some(v) = &svd.v_t {
        for (c, &l) in kept.iter().enumerate() {
            weakest[l] = v[(at, c)];
        }
    }
    (values.max() / values[at], weakest)
}
