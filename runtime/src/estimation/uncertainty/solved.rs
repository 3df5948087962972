//! What an estimate was solved for, and how.

use crate::estimation::observe::Observation;
use nalgebra::DMatrix;

/// What was solved, and with which errors of the groups.
pub(in crate::estimation) struct Solved<'a> {
    /// The rows, kept.
    pub observation: &'a Observation,
    /// The unknowns that were solved for.
    pub unknowns: &'a [usize],
    /// For each of them the unknown whose column stands in for its own in the equations of the estimate: itself for
    /// least squares, its instrument for instrumental variables.
    pub instruments: &'a [usize],
    /// What noise in the columns added to the weighted WT W, which was taken away.
    pub noise_of_columns: Option<&'a DMatrix<f64>>,
    /// Error of each group of the observation, whose inverse was the weight.
    pub weights: &'a [f64],
    /// The same as the noise has it: another one where the weights were not those of the noise.
    pub errors: &'a [f64],
}
