//! What the standard model leaves of a recording.

use dynid_runtime::estimation::choose_bandwidth;
use dynid_runtime::model::Model;
use dynid_runtime::recording::Trajectory;
use dynid_runtime::signal::Motion;

use crate::failure::Failure;
use crate::residual::{observed, parameters, residuals};

/// Widest band in which is looked, Hz: friction, loads and bodies.
const BAND: f64 = 25.0;

/// A recording's filtered motions, its parameters, and what they leave of each joint's torque, N.m or N.
pub struct Fitted {
    pub motions: Vec<Motion>,
    pub chi: Vec<f64>,
    pub residual: Vec<f64>,
}

/// Fits the standard parameters; with `known` ones only what they leave is worked out.
pub fn fit(model: &dyn Model, motions: &[Trajectory], known: Option<&[f64]>) -> Result<Fitted, Failure> {
    let band = choose_bandwidth(motions)?.band.min(BAND);
    let (motions, observation) = observed(model, motions, band)?;
    let chi = known.map_or_else(|| parameters(&observation), <[f64]>::to_vec);
    let residual = residuals(&observation, &chi);
    Ok(Fitted { motions, chi, residual })
}
