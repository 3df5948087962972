//! What a law is judged against.

use crate::diagnosis::rows::prior::Prior;
use crate::statistics::moderation::Variance;
use std::ops::Range;

/// What a law is judged against: everything by row, over all rows of all joints.
pub(in crate::diagnosis) struct Regressors<'a> {
    /// Columns of the model and its nuisances.
    pub shared: &'a [Vec<f64>],
    pub y: &'a [f64],
    /// Columns of each joint that are free in every motion, values on the joint's rows.
    pub free: &'a [Vec<Vec<f64>>],
    /// Other laws of each joint, values on the joint's rows: how much they vary from unit to unit tells how much laws
    /// of this joint do.
    pub companions: &'a [Vec<Vec<f64>>],
    /// What is known of the shared columns beforehand.
    pub prior: Option<&'a Prior>,
    /// Per joint the mean statistic of a law in a motion as long as the recording's, where nothing has changed, as a model of
    /// the robot before knows it; empty where there is none.
    pub between_motions: &'a [Option<Variance>],
    /// Rows of each joint.
    pub of_joint: &'a [Range<usize>],
}

impl Regressors<'_> {
    /// Whether a law, given as columns over all rows, acts on a joint.
    pub fn acts_on(&self, law: &[Vec<f64>], joint: usize) -> bool {
        let range = self.of_joint[joint].clone();
        law.iter().any(|c| c[range.clone()].iter().any(|x| *x != 0.0))
    }

    /// Sum of the squares of a column over all rows on those of a joint.
    pub fn squares_on(&self, joint: usize, column: &[f64]) -> f64 {
        column[self.of_joint[joint].clone()].iter().map(|x| x * x).sum()
    }

    /// A column of a joint, given as values on its rows, over all rows.
    pub fn on_all_rows(&self, joint: usize, on_joint: &[f64]) -> Vec<f64> {
        let mut column = vec![0.0; self.y.len()];
        column[self.of_joint[joint].clone()].copy_from_slice(on_joint);
        column
    }
}
