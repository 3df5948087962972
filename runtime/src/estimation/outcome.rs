//! What an estimation says. Equation numbers are those of Gautier and Briot.

use super::method::Method;
use super::warning::Warning;
use serde::{Deserialize, Serialize};

/// One identified unknown.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct ParameterEstimate {
    /// Base parameter or extra unknown.
    pub name: String,
    /// SI; zero where the data do not determine it.
    pub value: f64,
    /// Standard deviation, for errors that last as the residuals show it where the rows were kept, else by blocks of
    /// time, and where there are too few of them `sigma_white`. The first is made for use with the normal deviate: where the
    /// noise is known from few degrees of freedom, it is larger by Student's deviate over 1.96, so that 1.96 of it are half
    /// an interval of 95 %. `None` where the parameter is not determined.
    pub sigma: Option<f64>,
    /// Standard deviation (18), for errors that are independent from row to row, as the paper assumes.
    #[serde(default)]
    pub sigma_white: Option<f64>,
    /// Standard deviation by leaving out one block of time after the other: right for errors that last up to half a
    /// second, as those of robots do. `None` where not determined or with fewer than five blocks.
    pub sigma_blocks: Option<f64>,
    /// What was added to the value of least squares for the noise of the encoders in its columns; its uncertainty is part
    /// of `sigma`. `None` where that noise is not known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub correction: Option<f64>,
    /// 100 sigma / |value| (19).
    pub relative_sigma_percent: Option<f64>,
}

impl ParameterEstimate {
    /// One that the data do not determine.
    pub(super) fn undetermined(name: &str) -> Self {
        Self {
            name: name.to_owned(),
            value: 0.0,
            sigma: None,
            sigma_white: None,
            sigma_blocks: None,
            correction: None,
            relative_sigma_percent: None,
        }
    }

    /// One that was known beforehand.
    pub(super) fn known(name: &str, value: f64) -> Self {
        let certain = Some(0.0);
        Self { value, sigma: certain, relative_sigma_percent: certain, ..Self::undetermined(name) }
    }
}

/// The standard deviation of the errors of one equation in one trajectory, whose inverse is its weight.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EquationError {
    /// Index of the motion.
    pub trajectory: usize,
    /// Joint (0-based), or 0 for the power model.
    pub equation: usize,
    /// N.m, N or W; `None` where every row is zero, so that there is no error to speak of.
    pub sigma: Option<f64>,
    /// ||Y - W chi|| / ||Y|| over the rows that were used; `None` where all torques Y are zero.
    pub relative_error: Option<f64>,
    /// Rows that were used, less one for each dry friction whose moments of reversal were an unknown.
    pub rows: usize,
}

/// A block of time that counts less than half in a robust estimate.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct BlockWeight {
    /// Index of the motion.
    pub trajectory: usize,
    /// Joint (0-based), or 0 for the power model.
    pub equation: usize,
    /// First and last row, s.
    pub time: [f64; 2],
    /// What it counts, 1 for a block that fits.
    pub weight: f64,
}

/// The simplified model of the paper: parameters that the data determine well compared with the best.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Essential {
    /// The parameters that are kept, with their own estimates.
    pub parameters: Vec<ParameterEstimate>,
    /// Parameters that were cancelled, in the order of cancelling.
    pub cancelled: Vec<String>,
    /// ||Y - W chi|| / ||Y|| with the kept parameters; `None` where Y is zero.
    pub relative_error: Option<f64>,
}

/// An identified set of parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Estimate {
    /// How it was made.
    pub method: Method,
    /// Base parameters, then extra unknowns, in the order of the observation.
    pub parameters: Vec<ParameterEstimate>,
    /// Errors per trajectory and equation.
    pub errors: Vec<EquationError>,
    /// ||Y - W chi|| / ||Y|| over all rows that were used; `None` where Y is zero.
    pub relative_error: Option<f64>,
    /// The same per equation.
    pub per_equation: Vec<Option<f64>>,
    /// Rows of all equations: the sum of those of `errors`.
    pub rows: usize,
    /// Rows minus parameters.
    pub degrees_of_freedom: usize,
    /// Condition number of the weighted W with columns of unit length.
    pub condition: f64,
    /// Iterations of the weights.
    pub iterations: usize,
    /// Blocks of time that count less than half, where the estimate is robust.
    pub low_blocks: Vec<BlockWeight>,
    /// What to know before believing it.
    pub warnings: Vec<Warning>,
    /// Upper triangle, row by row, of the covariance of the parameters, with their standard deviations `sigma`; rows of
    /// what is not determined are zero. `None` where there are no standard deviations.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub covariance: Option<Vec<f64>>,
    /// The simplified model, where it was asked for.
    pub essential: Option<Essential>,
}

impl Estimate {
    /// Equations for each parameter that they determine; infinite where they determine none.
    ///
    /// With fewer than two most of what the equations say is taken up by the parameters, and their errors say little.
    pub fn rows_per_parameter(&self) -> f64 {
        self.rows as f64 / self.rows.saturating_sub(self.degrees_of_freedom) as f64
    }

    /// The parameters as a vector in the order of the observation's unknowns.
    pub fn chi(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.value).collect()
    }
}
