//! What the standard model leaves of recordings in a band.

use dynid_runtime::estimation::observe::{Equations, Observation, ObserveSettings, observe};
use dynid_runtime::estimation::{EstimateSettings, estimate, per_equation};
use dynid_runtime::model::Model;
use dynid_runtime::recording::Trajectory;
use dynid_runtime::signal::{Motion, Preparation, prepare_all};

use crate::failure::Failure;

/// Torque equations in a band, Hz, and the filtered motions that they are sampled from.
pub fn observed(
    model: &dyn Model,
    motions: &[Trajectory],
    band: f64,
) -> Result<(Vec<Motion>, Observation), Failure> {
    let preparation = Preparation { cutoff: Some((2.0 * band).min(100.0)), ..Preparation::default() };
    let (motions, _) = prepare_all(motions, &preparation)?;
    let settings = ObserveSettings { band, threads: 1, ..ObserveSettings::default() };
    let observation = observe(model, &motions, Equations::Torque, None, &settings, None)?;
    Ok((motions, observation))
}

/// The standard parameters that explain the equations best.
pub fn parameters(observation: &Observation) -> Vec<f64> {
    let settings = EstimateSettings { r_sigma: None, block_sigmas: false, ..EstimateSettings::default() };
    estimate(observation, &settings).chi()
}

/// Standard deviation of what parameters leave on each joint, N.m or N.
pub fn residuals(observation: &Observation, chi: &[f64]) -> Vec<f64> {
    per_equation(observation, chi)
        .iter()
        .enumerate()
        .map(|(joint, relative)| {
            let own = observation.groups.iter().filter(|g| g.equation == joint);
            let (y, rows) =
                own.fold((0.0, 0), |(y, rows), g| (y + g.factor.norm_y().powi(2), rows + g.factor.rows()));
            relative.unwrap_or_default() * (y / rows.max(1) as f64).sqrt()
        })
        .collect()
}

/// What of a torque stands out of the `noise` where r is left with it and s without: sqrt(r² - s²) / noise.
pub fn beside(r: f64, s: f64, noise: f64) -> f64 {
    (r * r - s * s).max(0.0).sqrt() / noise.max(1e-12)
}
