//! What makes the rows of a joint white: an autoregression of the noise, beside what is free in every motion.

use crate::diagnosis::judging::ar::Autoregression;
use crate::diagnosis::judging::lag_products::LagProducts;
use crate::diagnosis::judging::projection::factored;
use crate::diagnosis::judging::regressors::Regressors;
use crate::diagnosis::judging::units::Units;
use crate::diagnosis::rules::HIGHEST_AR_ORDER;
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// What makes the rows of a joint white.
pub(super) struct Whitening {
    /// Neighbouring rows, as places among the joint's.
    pub stretches: Vec<Range<usize>>,
    pub ar: Autoregression,
    /// What is free in every motion, white.
    pub free: Vec<Vec<f64>>,
}

impl Whitening {
    /// Of a model that leaves a residual and took a part of the noise, beside what is free in every motion.
    pub fn of(
        units: &Units,
        regressors: &Regressors<'_>,
        j: usize,
        (residual, taken): (&[f64], Option<&LagProducts>),
    ) -> Self {
        let range = &regressors.of_joint[j];
        let local = |r: &Range<usize>| r.start - range.start..r.end - range.start;
        let stretches: Vec<Range<usize>> = units.stretches[j].iter().map(local).collect();
        let left = without_free(units, j, range, &residual[range.clone()], &regressors.free[j]);
        let mut noise = LagProducts::of(&stretches, &left, HIGHEST_AR_ORDER);
        if let Some(taken) = taken {
            noise.add_products(taken);
        }
        let ar = Autoregression::of(&noise);
        let free = regressors.free[j].iter().map(|c| ar.whitened(&stretches, c)).collect();
        Self { stretches, ar, free }
    }
}

/// A column over all rows and the residual of a model on one joint, both made white, without what is free in every motion.
pub(super) fn white_with_residual(
    units: &Units,
    regressors: &Regressors<'_>,
    j: usize,
    whitening: &Whitening,
    [column, residual]: [&[f64]; 2],
) -> [Vec<f64>; 2] {
    let range = &regressors.of_joint[j];
    let Whitening { stretches, ar, free } = whitening;
    let white = |c: &[f64]| without_free(units, j, range, &ar.whitened(stretches, &c[range.clone()]), free);
    [white(column), white(residual)]
}

/// The residual of a joint without what its free columns make of it in each motion.
fn without_free(
    units: &Units,
    j: usize,
    range: &Range<usize>,
    residual: &[f64],
    free: &[Vec<f64>],
) -> Vec<f64> {
    let mut left = residual.to_vec();
    if free.is_empty() {
        return left;
    }
    for file in 0..units.files() {
        let rows: Vec<usize> = rows_of_motion(units, j, file, range).flatten().collect();
        let f = free.len();
        let g = DMatrix::from_fn(f, f, |a, b| rows.iter().map(|&r| free[a][r] * free[b][r]).sum::<f64>());
        let b = DVector::from_fn(f, |a, _| rows.iter().map(|&r| free[a][r] * residual[r]).sum::<f64>());
        if let Some((factor, scale)) = factored(&g) {
            let x = factor.solve(&b.component_mul(&scale)).component_mul(&scale);
            for &r in &rows {
                left[r] -= (0..f).map(|a| x[a] * free[a][r]).sum::<f64>();
            }
        }
    }
    left
}

/// The rows of each unit of a motion as places among those of a joint.
pub(super) fn rows_of_motion(
    units: &Units,
    j: usize,
    file: usize,
    of: &Range<usize>,
) -> impl Iterator<Item = Range<usize>> {
    let of_motion = units.units.iter().zip(&units.rows[j]).filter(move |(unit, _)| unit.file == file);
    of_motion.map(|(_, rows)| local_or_empty(rows, of))
}

/// The rows of a unit as places among those of a joint.
pub(super) fn local_or_empty(rows: &Range<usize>, of: &Range<usize>) -> Range<usize> {
    if rows.is_empty() { 0..0 } else { rows.start - of.start..rows.end - of.start }
}
