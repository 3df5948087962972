//! Where a curve that was fitted to some motion says something: within the hull of its regressors (Cook 1979; Brooks,
//! Carroll and Verdini 1988).
//!
//! A curve knows nothing of values that the fitted motion has not passed. A row whose leverage in the regression of the
//! curve and an offset is larger than that of every fitted row lies beyond these values, whatever the curve's variables
//! are; it is no evidence for the curve, and none against it.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::candidates::trial::Trial;
use crate::diagnosis::judging::projection::factored;
use crate::diagnosis::rows::design::Design;
use nalgebra::{DMatrix, DVectorView};

/// A curve on the rows of its joint.
pub(in crate::diagnosis) struct Curve {
    pub joint: usize,
    /// Values on the rows of the joint, one column per amplitude.
    pub columns: Vec<Vec<f64>>,
}

impl Curve {
    /// A shape of a candidate that says nothing of values that no motion has passed; `None` for every other law.
    pub fn of(candidate: &Candidate, trial: &Trial) -> Option<Self> {
        if !candidate.effect.form().holds_only_where_seen() {
            return None;
        }
        let joint = *candidate.own.first()?;
        let on_joint = trial.on_joint(joint).into_iter().map(|column| column.map(<[f64]>::to_vec));
        Some(Self { joint, columns: on_joint.collect::<Option<_>>()? })
    }
}

/// Rows of one joint that a fit says nothing about.
#[derive(Clone)]
pub(in crate::diagnosis) struct Beyond {
    pub joint: usize,
    first: usize,
    /// One per row of the joint.
    rows: Vec<bool>,
}

impl Beyond {
    /// Rows beyond the hull of a curve on the segments that `train` marks. Rows on which the curve is silent are no part of
    /// the fitted ones.
    pub fn of(design: &Design, curve: &Curve, train: &[bool]) -> Self {
        let all = design.of_joint(curve.joint);
        let (joint, first) = (curve.joint, all.start);
        let acts = |local: &usize| curve.columns.iter().any(|c| c[*local] != 0.0);
        let segments = (0..train.len()).filter(|&g| train[g]);
        let trained: Vec<usize> =
            segments.flat_map(|g| design.ranges[joint][g].clone()).map(|r| r - first).filter(acts).collect();
        let width = curve.columns.len() + 1;
        // One row of the joint a column.
        let value = |k: usize, local: usize| curve.columns.get(k).map_or(1.0, |c| c[local]);
        let regressors = DMatrix::from_fn(width, all.len(), value);
        let fitted = regressors.select_columns(&trained);
        let Some((factor, scale)) = factored(&(&fitted * fitted.transpose())) else {
            return Self { joint, first, rows: vec![true; all.len()] };
        };
        // A column that is zero on all fitted rows has no scale; a row on which it is not lies beyond them.
        let unseen = |row: DVectorView<'_, f64>| (0..width).any(|k| scale[k] == 0.0 && row[k] != 0.0);
        let mut beyond: Vec<bool> = regressors.column_iter().map(unseen).collect();
        let mut whitening = DMatrix::from_diagonal(&scale);
        // The factor's diagonal is positive, so that there is a solution.
        let _ = factor.l_dirty().solve_lower_triangular_mut(&mut whitening);
        let regressors = whitening * regressors;
        let leverage: Vec<f64> = regressors.column_iter().map(|row| row.norm_squared()).collect();
        let largest = trained.iter().map(|&local| leverage[local]).fold(0.0, f64::max);
        // What a fitted row has itself is passed, however its leverage was rounded.
        let passed = largest * (1.0 + 1e-9);
        beyond.iter_mut().zip(leverage).for_each(|(beyond, leverage)| *beyond |= leverage > passed);
        Self { joint, first, rows: beyond }
    }

    /// Those of several curves.
    pub fn each(design: &Design, curves: &[Curve], train: &[bool]) -> Vec<Self> {
        curves.iter().map(|curve| Self::of(design, curve, train)).collect()
    }

    /// Whether a row is one of them; rows of other joints are not.
    pub fn contains(&self, row: usize) -> bool {
        row.checked_sub(self.first).and_then(|local| self.rows.get(local)).copied().unwrap_or(false)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// One joint whose position in segment g runs from `ranges[g][0]` to `ranges[g][1]`, and polynomials of it.
    fn swept(ranges: &[[f64; 2]], degree: i32) -> (Design, Curve, Vec<f64>) {
        let rows = 40;
        let segments: Vec<(usize, bool)> = (0..ranges.len()).map(|g| (g, true)).collect();
        let q: Vec<f64> = ranges
            .iter()
            .flat_map(|[low, high]| {
                (0..rows).map(move |t| low + (high - low) * f64::from(t) / f64::from(rows - 1))
            })
            .collect();
        let columns = (1..=degree).map(|n| q.iter().map(|q| q.powi(n)).collect()).collect();
        let design = Design::made_up(1, &segments, rows as usize, vec![vec![1.0; q.len()]], q.clone());
        (design, Curve { joint: 0, columns }, q)
    }

    #[test]
    fn rows_beyond_the_positions_that_were_fitted_are_beyond_and_no_others() {
        for degree in 1..=5 {
            let (design, curve, q) = swept(&[[-0.5, 0.4], [-0.2, 0.6], [-1.0, 1.0]], degree);
            let beyond = Beyond::of(&design, &curve, &[true, true, false]);
            for (r, q) in q.iter().enumerate() {
                let outside = *q < -0.5 || *q > 0.6;
                // The hull of leverage is an ellipsoid: for a line it is centred on the mean, and cut on one side only.
                let near = *q < -0.45 || *q > 0.45;
                assert!(!beyond.contains(r) || near, "degree {degree}: {q} was passed");
                assert!(beyond.contains(r) || !outside || q.abs() < 0.75, "degree {degree}: {q} was not");
            }
        }
    }

    #[test]
    fn a_curve_that_no_fitted_motion_shows_says_nothing() {
        let (design, mut curve, _) = swept(&[[-0.5, 0.4], [-1.0, 1.0]], 3);
        curve.columns.iter_mut().for_each(|c| c[..40].fill(0.0));
        let beyond = Beyond::of(&design, &curve, &[true, false]);
        assert!((40..80).all(|r| beyond.contains(r)));
    }
}
