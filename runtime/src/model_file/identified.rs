//! An identified model as it is saved and handed to other programs. Equation numbers are those of Gautier and Briot.

use serde::{Deserialize, Serialize};

use super::bodies::Bodies;
use super::covariance::Covariance;
use super::fingerprint::fingerprint;
use super::rows::{EquationRows, EvaluatedRows};
use crate::diagnosis::BetweenMotions;
use crate::effects::EffectTerm;
use crate::estimation::{Estimate, ParameterEstimate, Warning};
use crate::model::{ParameterKind, Robot};
use crate::prediction::Errors;

/// Version of the fields of [`Identified`]: raised when a reader of the version before would misread a file.
pub const SCHEMA: u32 = 1;

/// An identified model: what `identify` writes as JSON and saves, and what `validate` reads back.
///
/// [`super::read`] reads it with every field checked.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Identified {
    /// [`SCHEMA`]; 0 in files from before there was one.
    #[serde(default)]
    pub schema_version: u32,
    /// The dynid that wrote it; empty in files from before schema 1.
    #[serde(default)]
    pub dynid_version: String,
    /// Name of the robot, or the path it was given by.
    pub robot: String,
    /// `idim-wls`, ...
    pub method: String,
    /// Samples of the recording that were read, all joints counted once.
    pub samples: usize,
    /// ||Y - W chi|| / ||Y|| of the joint torques over the rows used; `None` where Y is zero.
    pub relative_error: Option<f64>,
    /// The same per joint.
    pub per_joint: Vec<Option<f64>>,
    /// The same of the power, where the power model was identified.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub power_relative_error: Option<f64>,
    /// chi with its standard deviations.
    pub base_parameters: Vec<NamedParameter>,
    /// The simplified model: parameters that are well determined, re-estimated.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub essential_parameters: Option<EssentialParameters>,
    /// Condition number of the weighted observation matrix with columns of unit length, where the method has one.
    #[serde(default)]
    pub condition_number: Option<f64>,
    /// Rows of the files that could not be right, where the files were looked at.
    #[serde(default)]
    pub rows_left_out: Option<u64>,
    /// Equations used and left out, per trajectory and joint.
    #[serde(default)]
    pub equations: Vec<EquationRows>,
    /// Band of the equations, Hz.
    pub band: f64,
    /// What the states were simulated with, where the method simulates them.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub simulated: Option<SimulatedStates>,
    /// How the parameters were made those of bodies, where they were.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub bodies: Option<Bodies>,
    /// What to know before believing it.
    #[serde(default)]
    pub warnings: Vec<String>,
    /// Effects that a diagnosis found and that belong to the model.
    #[serde(default)]
    pub effects: Vec<EffectTerm>,
    /// By how much the torque channel was found to be later than the positions, s.
    #[serde(default)]
    pub delay: f64,
    /// Its standard deviation, s, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub delay_sigma: Option<f64>,
    /// Relative error that the noise of the torques makes up, where it matters.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub noise: Option<Errors>,
    /// How parameters and amplitudes vary together, where it is known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub covariance: Option<Covariance>,
    /// Speeds below which the joints stood in the recording that it is from, rad/s or m/s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub standstill: Option<Vec<f64>>,
    /// How much each joint's torques differ between the motions that it is from, in the order of the joints.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub between_motions: Vec<Option<BetweenMotions>>,
    /// The recording that it is from, where it was written down.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub recording: Option<RecordedFrom>,
    /// [`fingerprint`] of the table.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fingerprint: Option<String>,
    /// The robot as it was when the parameters were identified.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub table: Option<Robot>,
}

/// The recording that a model is from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct RecordedFrom {
    /// Of its manifest, from the folder of the model, with `/`.
    pub path: String,
    /// SHA-256, hexadecimal, of the hexadecimal digests of its manifest, its robot where that is a file, and its data, one after
    /// the other.
    pub sha256: String,
    /// What comes before this time was not used, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub from: Option<f64>,
    /// What comes after this time was not used, s.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub to: Option<f64>,
}

/// A parameter with its uncertainty and unit.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct NamedParameter {
    /// Base parameter.
    pub name: String,
    /// SI.
    pub value: f64,
    /// Standard deviation, for errors that last and with what noise of the encoders may have taken away; `None` where the
    /// data do not determine the parameter.
    pub sigma: Option<f64>,
    /// 100 sigma / |value| (19).
    pub relative_sigma_percent: Option<f64>,
    /// What is wrong with the value where no robot can have it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub doubt: Option<String>,
    /// Standard deviation (18) of the paper, for errors that are independent from row to row.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_white: Option<f64>,
    /// What was added to the value for the noise of the encoders.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub correction: Option<f64>,
    /// Standard deviation from blocks of time, for errors that last.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sigma_blocks: Option<f64>,
    /// SI unit.
    pub unit: String,
}

/// How a method that simulates the planned motions came to its values.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SimulatedStates {
    /// The method whose values it began with and is compared with, as `idim-wls`.
    pub compared_with: String,
    /// These values, in the order of the base parameters.
    pub values: Vec<f64>,
    /// For each joint the root mean square of measured less simulated positions over that of the measured ones about
    /// their mean.
    pub apart: Vec<f64>,
    /// Relative change of the parameters in each iteration, where there are any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub changes: Vec<f64>,
}

/// The simplified model of the paper.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct EssentialParameters {
    /// What is kept.
    pub parameters: Vec<NamedParameter>,
    /// What was cancelled, first first.
    pub cancelled: Vec<String>,
    /// Relative error with what is kept; `None` where Y is zero.
    pub relative_error: Option<f64>,
}

impl Identified {
    /// Brings an estimate and what is known of its rows together. `errors` are those of the joint torques; they
    /// differ from the estimate's own for the power model.
    pub fn new(robot: &Robot, robot_name: &str, rows: EvaluatedRows, estimate: &Estimate) -> Self {
        let named = |p: &ParameterEstimate| NamedParameter {
            name: p.name.clone(),
            value: p.value,
            sigma: p.sigma,
            relative_sigma_percent: p.relative_sigma_percent,
            sigma_white: p.sigma_white,
            correction: p.correction,
            doubt: doubt(robot, &p.name, p.value, p.sigma),
            sigma_blocks: p.sigma_blocks,
            unit: robot
                .base
                .iter()
                .find(|b| b.name == p.name)
                .map_or_else(String::new, |b| b.unit.to_string()),
        };
        let power = estimate.method.is_power();
        let essential = estimate.essential.as_ref().map(|e| EssentialParameters {
            parameters: e.parameters.iter().map(named).collect(),
            cancelled: e.cancelled.clone(),
            relative_error: e.relative_error,
        });
        Identified {
            power_relative_error: estimate.relative_error.filter(|_| power),
            essential_parameters: essential,
            condition_number: Some(estimate.condition),
            covariance: estimate.covariance.clone().and_then(|upper| Covariance::new(robot, &[], upper)),
            warnings: estimate.warnings.iter().map(Warning::to_string).collect(),
            ..Self::with_parameters(
                robot,
                robot_name,
                estimate.method.name(),
                rows,
                estimate.parameters.iter().map(named).collect(),
            )
        }
    }

    /// A model of which nothing is known but its parameters and its rows.
    pub fn with_parameters(
        robot: &Robot,
        robot_name: &str,
        method: &str,
        rows: EvaluatedRows,
        base_parameters: Vec<NamedParameter>,
    ) -> Self {
        Identified {
            schema_version: SCHEMA,
            dynid_version: env!("CARGO_PKG_VERSION").to_owned(),
            robot: robot_name.to_owned(),
            method: method.to_owned(),
            samples: rows.samples,
            relative_error: rows.errors.relative_error,
            per_joint: rows.errors.per_joint,
            power_relative_error: None,
            base_parameters,
            essential_parameters: None,
            condition_number: None,
            rows_left_out: rows.rows_left_out,
            equations: rows.equations,
            band: rows.band,
            simulated: None,
            bodies: None,
            warnings: Vec::new(),
            effects: Vec::new(),
            delay: 0.0,
            delay_sigma: None,
            noise: rows.noise,
            covariance: None,
            between_motions: Vec::new(),
            standstill: None,
            recording: None,
            fingerprint: Some(fingerprint(robot)),
            table: Some(robot.clone()),
        }
    }

    /// The same parameters with what another recording says about them.
    pub fn validated(&self, rows: EvaluatedRows) -> Self {
        Identified {
            samples: rows.samples,
            relative_error: rows.errors.relative_error,
            per_joint: rows.errors.per_joint,
            power_relative_error: None,
            rows_left_out: rows.rows_left_out,
            equations: rows.equations,
            band: rows.band,
            noise: rows.noise,
            simulated: None,
            bodies: None,
            covariance: None,
            between_motions: Vec::new(),
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

/// Why the value of a base parameter is none that a robot can have: a mass, a moment of inertia or a friction below zero,
/// where nothing else is regrouped into it. `None` where a robot can have it.
pub fn doubt(robot: &Robot, name: &str, value: f64, sigma: Option<f64>) -> Option<String> {
    use ParameterKind::{Ia, M, XX, YY, ZZ};
    let base = robot.base.iter().find(|b| b.name == name)?;
    let standard = robot.standard.get(base.standard)?;
    let positive = matches!(standard.kind, M | XX | YY | ZZ | Ia) || standard.kind.is_friction();
    if !positive || base.name != standard.name || value >= 0.0 {
        return None;
    }
    Some(match sigma {
        Some(sigma) if value > -2.0 * sigma => "below zero, but not more than its uncertainty".to_owned(),
        _ => "below zero: no robot can have it".to_owned(),
    })
}
