//! The states at which the rows of an evaluation were measured: what a residual is drawn over.

use super::evaluate::decimated;
use super::predictor::PredictionError;
use crate::estimation::observe::{ObserveSettings, row_plans};
use crate::model::{Model, ParameterKind, Robot, torques};
use crate::signal::Motion;

/// The state of one joint at its rows in one motion, through the same filter as the torques.
#[derive(Debug, Clone, PartialEq)]
pub struct StateRows {
    /// Index of the motion.
    pub trajectory: usize,
    /// Joint, counted from 0.
    pub joint: usize,
    /// rad or m.
    pub position: Vec<f64>,
    /// rad/s or m/s.
    pub speed: Vec<f64>,
    /// rad/s² or m/s².
    pub acceleration: Vec<f64>,
    /// Torque of inertia and gravity by the model, without friction and offset, N.m or N.
    pub load: Vec<f64>,
}

/// The states at the rows that [`super::evaluate`] has of the same motions with the same settings, in the same order.
/// `chi` are the base parameters that the load is worked out with.
///
/// # Errors
/// Motions of another robot, settings that mean nothing, parameters of another model.
pub fn row_states(
    model: &dyn Model,
    chi: &[f64],
    motions: &[Motion],
    settings: &ObserveSettings,
) -> Result<Vec<StateRows>, PredictionError> {
    let robot = model.robot();
    if chi.len() != robot.base.len() {
        return Err(PredictionError::Parameters { found: chi.len(), expected: robot.base.len() });
    }
    let rigid = without_friction(robot, chi);
    let mut rows = Vec::new();
    for (trajectory, (motion, plan)) in motions.iter().zip(row_plans(robot, motions, settings)?).enumerate() {
        let load = torques(model, &rigid, motion.state_slices().states());
        for joint in 0..robot.joints() {
            let of = |signal: &[Vec<f64>]| decimated(&signal[joint], &plan);
            let (position, speed) = (of(&motion.q), of(&motion.dq));
            let (acceleration, load) = (of(&motion.ddq), of(&load));
            rows.push(StateRows { trajectory, joint, position, speed, acceleration, load });
        }
    }
    Ok(rows)
}

/// Parameters whose torques are those of inertia and gravity alone.
fn without_friction(robot: &Robot, chi: &[f64]) -> Vec<f64> {
    let is_friction = |kind: ParameterKind| kind.is_friction() || kind == ParameterKind::Off;
    let each = robot.base.iter().zip(chi);
    each.map(|(base, &value)| if is_friction(robot.standard[base.standard].kind) { 0.0 } else { value })
        .collect()
}
