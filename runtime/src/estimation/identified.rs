//! An identified model as it is saved and handed to other programs.

use serde::{Deserialize, Serialize};

use super::observe::{LeftOut, ObserveSettings};
use super::{EquationError, Estimate, ParameterEstimate, Warning};
use crate::effects::EffectTerm;
use crate::model::Robot;

/// An identified model: what `identify` writes as JSON and saves, and what `validate` reads back.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Identified {
    /// Name of the robot, or the path it was given by.
    pub robot: String,
    /// `idim-wls`, ...
    pub method: String,
    /// Samples of the recording that were read, all joints counted once.
    pub samples: usize,
    /// ||Y - W chi|| / ||Y|| of the joint torques over the rows used.
    pub relative_error: f64,
    /// The same per joint.
    pub per_joint: Vec<f64>,
    /// The same of the power, where the power model was identified.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub power_relative_error: Option<f64>,
    /// chi with its standard deviations.
    pub base_parameters: Vec<NamedParameter>,
    /// The simplified model: parameters that are well determined, re-estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub essential_parameters: Option<EssentialParameters>,
    /// Condition number of the weighted observation matrix with columns of unit length.
    pub condition_number: f64,
    /// Rows of the files that could not be right.
    pub rows_left_out: u64,
    /// Equations used and left out, per trajectory and joint.
    #[serde(default)]
    pub equations: Vec<EquationRows>,
    /// Band of the equations, Hz.
    pub band: f64,
    /// What to know before believing it.
    #[serde(default)]
    pub warnings: Vec<String>,
    /// Effects that a diagnosis found and that belong to the model.
    #[serde(default)]
    pub effects: Vec<EffectTerm>,
}

/// A parameter with its uncertainty and unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NamedParameter {
    /// Base parameter.
    pub name: String,
    /// SI.
    pub value: f64,
    /// Standard deviation (18); `None` where the data do not determine the parameter.
    pub sigma: Option<f64>,
    /// 100 sigma / |value| (19).
    pub relative_sigma_percent: Option<f64>,
    /// Standard deviation from blocks of time, for errors that last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_blocks: Option<f64>,
    /// SI unit.
    pub unit: String,
}

/// The simplified model of the paper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EssentialParameters {
    /// What is kept.
    pub parameters: Vec<NamedParameter>,
    /// What was cancelled, first first.
    pub cancelled: Vec<String>,
    /// Relative error with what is kept.
    pub relative_error: f64,
}

/// The rows of one equation in one trajectory.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EquationRows {
    /// Name of the trajectory.
    pub trajectory: String,
    /// Joint, counted from 1; 0 for the power model.
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
    /// Relative error of this equation in this trajectory.
    pub relative_error: Option<f64>,
}

impl Identified {
    /// Brings an estimate and what is known of its rows together. `torque_errors` are the relative error of the
    /// joint torques, overall and per joint; they differ from the estimate's own for the power model.
    pub fn new(
        robot: &Robot,
        robot_name: &str,
        observed: &Observed<'_>,
        estimate: &Estimate,
        torque_errors: (f64, Vec<f64>),
        rows_left_out: u64,
    ) -> Self {
        let named = |p: &ParameterEstimate| NamedParameter {
            name: p.name.clone(),
            value: p.value,
            sigma: p.sigma,
            relative_sigma_percent: p.relative_sigma_percent,
            sigma_blocks: p.sigma_blocks,
            unit: robot
                .base
                .iter()
                .find(|b| b.name == p.name)
                .map_or_else(String::new, |b| b.unit.to_string()),
        };
        let power = estimate.method.is_power();
        Identified {
            robot: robot_name.to_owned(),
            method: estimate.method.name().to_owned(),
            samples: observed.samples,
            relative_error: torque_errors.0,
            per_joint: torque_errors.1,
            power_relative_error: power.then_some(estimate.relative_error),
            base_parameters: estimate.parameters.iter().map(named).collect(),
            essential_parameters: estimate.essential.as_ref().map(|e| EssentialParameters {
                parameters: e.parameters.iter().map(named).collect(),
                cancelled: e.cancelled.clone(),
                relative_error: e.relative_error,
            }),
            condition_number: estimate.condition,
            rows_left_out,
            equations: observed
                .left_out
                .iter()
                .map(|l| equation_rows(l, observed.trajectories, &estimate.errors, power))
                .collect(),
            band: observed.settings.band,
            warnings: estimate.warnings.iter().map(Warning::to_string).collect(),
            effects: Vec::new(),
        }
    }

    /// The same parameters with what another recording says about them.
    pub fn validated(&self, observed: &Observed<'_>, errors: (f64, Vec<f64>), rows_left_out: u64) -> Self {
        Identified {
            samples: observed.samples,
            relative_error: errors.0,
            per_joint: errors.1,
            power_relative_error: None,
            rows_left_out,
            equations: observed
                .left_out
                .iter()
                .map(|l| equation_rows(l, observed.trajectories, &[], false))
                .collect(),
            band: observed.settings.band,
            ..self.clone()
        }
    }

    /// chi in the order of a robot's base parameters.
    ///
    /// # Errors
    /// The name of the first base parameter of the robot that this model does not have.
    pub fn chi(&self, robot: &Robot) -> Result<Vec<f64>, String> {
        robot
            .base
            .iter()
            .map(|b| {
                self.base_parameters
                    .iter()
                    .find(|p| p.name == b.name)
                    .map(|p| p.value)
                    .ok_or_else(|| b.name.to_string())
            })
            .collect()
    }
}

/// What an observation says about its rows, without its factors.
#[derive(Debug, Clone, Copy)]
pub struct Observed<'a> {
    /// Samples read.
    pub samples: usize,
    /// Names of the trajectories.
    pub trajectories: &'a [String],
    /// Rows per equation.
    pub left_out: &'a [LeftOut],
    /// How it was sampled.
    pub settings: &'a ObserveSettings,
}

fn equation_rows(
    rows: &LeftOut,
    trajectories: &[String],
    errors: &[EquationError],
    power: bool,
) -> EquationRows {
    let error = errors.iter().find(|e| e.trajectory == rows.trajectory && e.equation == rows.equation);
    EquationRows {
        trajectory: trajectories.get(rows.trajectory).cloned().unwrap_or_default(),
        joint: if power { 0 } else { rows.equation + 1 },
        used: rows.used,
        standstill: rows.standstill,
        fixed: rows.fixed,
        windows: rows.windows,
        edges: rows.edges,
        sigma: error.map(|e| e.sigma),
        relative_error: error.map(|e| e.relative_error),
    }
}
