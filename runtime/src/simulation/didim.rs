//! DIDIM: identification from measured torques and simulated states, for the inverse dynamic and the power model.
//!
//! The observation matrix of the usual methods is built from measured positions, whose noise it shares with the
//! power. DIDIM (Gautier, Janot and Vandanjon 2013) builds it from the closed loop simulated with the parameters
//! found so far, the same controller and the same planned motion, and needs a few iterations. Applied to the power
//! model it is what Gautier and Briot announced as future work.

use thiserror::Error;

use super::SimulationError;
use super::closed_loop::{LoopSettings, simulate};
use super::plant::Plant;
use super::reference::Reference;
use super::sensors::SensorSettings;
use crate::estimation::observe::{Equations, ObserveError, ObserveSettings, observe};
use crate::estimation::{Estimate, EstimateSettings, estimate};
use crate::model::Model;
use crate::recording::Trajectory;
use crate::signal::Motion;

/// One recorded motion with how it was made.
#[derive(Clone, Copy)]
pub struct Experiment<'a> {
    /// What was planned.
    pub reference: &'a dyn Reference,
    /// The controller and the rates of the recording; its sensors are not used, simulated states have no noise.
    pub settings: &'a LoopSettings,
    /// What was recorded, on the grid of the controller's recording.
    pub recorded: &'a Trajectory,
}

/// How DIDIM is run.
#[derive(Debug, Clone, PartialEq)]
pub struct DidimSettings {
    /// The inverse dynamic or the power model.
    pub equations: Equations,
    /// Rows.
    pub observe: ObserveSettings,
    /// Estimator of each iteration.
    pub estimate: EstimateSettings,
    /// Most iterations.
    pub iterations: usize,
    /// Relative change of the parameters (norm of the change over the norm, each divided by its sigma) below which
    /// it has converged.
    pub tolerance: f64,
}

impl Default for DidimSettings {
    fn default() -> Self {
        Self {
            equations: Equations::Torque,
            observe: ObserveSettings::default(),
            estimate: EstimateSettings::default(),
            iterations: 6,
            tolerance: 1e-3,
        }
    }
}

/// What DIDIM gives.
#[derive(Debug, Clone, PartialEq)]
pub struct DidimEstimate {
    /// The estimate of the last iteration.
    pub estimate: Estimate,
    /// Relative change of the parameters in each iteration.
    pub changes: Vec<f64>,
    /// Whether the last change was below the tolerance.
    pub converged: bool,
    /// Where a set of parameters could not be simulated and the last that could was kept: why.
    pub stopped: Option<String>,
}

/// Why there is no DIDIM estimate.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum DidimError {
    /// The start parameters cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The simulated motions cannot be observed.
    #[error(transparent)]
    Observe(#[from] ObserveError),
}

/// Simulated states of every experiment with parameters `chi`, and the measured torques: motions for an observation,
/// and without the torques the instruments of an instrumental-variable estimate.
///
/// # Errors
/// Parameters that cannot be simulated.
pub fn simulated_motions(
    model: &dyn Model,
    experiments: &[Experiment<'_>],
    chi: &[f64],
) -> Result<Vec<Motion>, SimulationError> {
    experiments
        .iter()
        .map(|experiment| {
            let settings = LoopSettings { sensors: SensorSettings::default(), ..experiment.settings.clone() };
            let mut plant = Plant::new(model, chi)?;
            let mut motion = simulate(&mut plant, experiment.reference, &settings, &mut |_| {})?.truth;
            let (expected, found) = (motion.q[0].len(), experiment.recorded.time.len());
            if expected != found {
                return Err(SimulationError::Length { what: "recorded rows", expected, found });
            }
            motion.torque.clone_from(&experiment.recorded.torque);
            Ok(motion)
        })
        .collect()
}

/// Runs DIDIM from parameters `start`, such as a first identification or values from drawings.
///
/// # Errors
/// Start parameters that cannot be simulated, motions that cannot be observed.
pub fn didim(
    model: &dyn Model,
    experiments: &[Experiment<'_>],
    start: &[f64],
    settings: &DidimSettings,
) -> Result<DidimEstimate, DidimError> {
    let mut chi = start.to_vec();
    let mut changes: Vec<f64> = Vec::new();
    let mut last: Option<Estimate> = None;
    // Simulated states have no noise to correct for; the noise of the torques shows in the rows.
    let rows =
        ObserveSettings { keep_rows: true, acceleration_noise: Vec::new(), ..settings.observe.clone() };
    for _ in 0..settings.iterations.max(1) {
        let motions = match simulated_motions(model, experiments, &chi) {
            Ok(motions) => motions,
            Err(error) => {
                let Some(estimate) = last else { return Err(error.into()) };
                let stopped = Some(error.to_string());
                return Ok(DidimEstimate { estimate, changes, converged: false, stopped });
            }
        };
        let observation = observe(model, &motions, settings.equations, None, &rows, None)?;
        let found = estimate(&observation, &settings.estimate);
        let next = found.chi();
        let change = relative_change(&found, &chi, &next);
        changes.push(change);
        chi = next;
        last = Some(found);
        if change < settings.tolerance {
            break;
        }
    }
    let converged = changes.last().is_some_and(|&change| change < settings.tolerance);
    match last {
        Some(estimate) => Ok(DidimEstimate { estimate, changes, converged, stopped: None }),
        // The loop runs once at least and leaves an estimate or returns.
        None => {
            Err(SimulationError::Setting { what: "iterations", expected: "1 or more", found: 0.0 }.into())
        }
    }
}

fn relative_change(estimate: &Estimate, before: &[f64], after: &[f64]) -> f64 {
    let (mut moved, mut size) = (0.0, 0.0);
    for (parameter, (a, b)) in estimate.parameters.iter().zip(before.iter().zip(after)) {
        if let Some(sigma) = parameter.sigma.filter(|s| *s > 0.0) {
            moved += ((a - b) / sigma).powi(2);
            size += (b / sigma).powi(2);
        }
    }
    if size > 0.0 { (moved / size).sqrt() } else { 0.0 }
}
