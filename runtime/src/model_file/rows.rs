//! Which rows of a recording a model was judged on, and what they say about it.

use serde::{Deserialize, Serialize};

use crate::estimation::observe::{LeftOut, Observation};
use crate::estimation::{EquationError, Estimate};
use crate::prediction::{Errors, Evaluation};

/// The rows of one equation in one trajectory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EquationRows {
    /// Name of the trajectory.
    pub trajectory: String,
    /// Number of the joint in the table; 0 for the power model.
    pub joint: usize,
    /// Equations used.
    pub used: usize,
    /// Left out because the joint hardly moves.
    pub standstill: usize,
    /// Left out because the joint is fixed.
    pub fixed: usize,
    /// Left out by time windows.
    pub windows: usize,
    /// Left out within reach of the filters from an end.
    pub edges: usize,
    /// Standard deviation of the errors, N.m, N or W: its inverse was the weight.
    pub sigma: Option<f64>,
    /// Relative error of this equation in this trajectory; `None` where no row was used or all torques are zero.
    pub relative_error: Option<f64>,
}

/// What the rows of a recording say about a model.
#[derive(Debug, Clone, PartialEq)]
pub struct EvaluatedRows {
    /// Samples read.
    pub samples: usize,
    /// Rows of the files that could not be right, where they were looked at.
    pub rows_left_out: Option<u64>,
    /// Rows used and left out.
    pub equations: Vec<EquationRows>,
    /// Band of the rows, Hz.
    pub band: f64,
    /// Errors of the torques.
    pub errors: Errors,
    /// What noise makes of them, where it matters.
    pub noise: Option<Errors>,
}

impl EvaluatedRows {
    /// From the observation that an estimate was made from; `errors` are those of the torques.
    pub fn observed(observation: &Observation, band: f64, estimate: &Estimate, errors: Errors) -> Self {
        let rows = |l| equation_rows(l, &observation.trajectories, &estimate.errors);
        Self {
            samples: observation.samples,
            rows_left_out: None,
            equations: observation.left_out.iter().map(rows).collect(),
            band,
            errors,
            noise: None,
        }
    }

    /// From an evaluation, for the model at `place` in it.
    pub fn evaluated(evaluation: &Evaluation, place: usize) -> Option<Self> {
        let rows = |l| equation_rows(l, &evaluation.trajectories, &[]);
        let prediction = evaluation.predictions.get(place)?;
        Some(Self {
            samples: evaluation.samples,
            rows_left_out: None,
            equations: evaluation.left_out.iter().map(rows).collect(),
            band: evaluation.band,
            errors: prediction.errors.clone(),
            noise: prediction.noise_matters().cloned(),
        })
    }
}

fn equation_rows(rows: &LeftOut, trajectories: &[String], errors: &[EquationError]) -> EquationRows {
    let error = errors.iter().find(|e| e.trajectory == rows.trajectory && e.equation == rows.equation);
    EquationRows {
        trajectory: trajectories.get(rows.trajectory).cloned().unwrap_or_default(),
        joint: rows.joint.map_or(0, |number| number.0),
        used: rows.used,
        standstill: rows.standstill,
        fixed: rows.fixed,
        windows: rows.windows,
        edges: rows.edges,
        sigma: error.and_then(|e| e.sigma),
        relative_error: error.and_then(|e| e.relative_error),
    }
}
