//! What of an effect can be seen at all: the torque that the standard parameters cannot take over, beside the noise.

use dynid_runtime::estimation::observe::{Equations, Observation, ObserveSettings, observe};
use dynid_runtime::estimation::{EstimateSettings, estimate, per_equation};
use dynid_runtime::model::Model;
use dynid_runtime::recording::Trajectory;
use dynid_runtime::signal::{Preparation, prepare_all};

use crate::failure::Failure;

/// Bands in which is looked, Hz: friction, loads and bodies; ripple and compliance.
const BANDS: [f64; 2] = [25.0, 100.0];

/// For each joint, the torque that an effect leaves after all standard parameters are fitted with it, relative to the
/// noise: sqrt(r² - r0²) / r0 of the residuals r with and r0 without it, on the same motion with the same noise. In
/// the band where it shows most.
///
/// With `change` the parameters are held at those of the recording without the effect.
pub fn visible(
    model: &dyn Model,
    with: &[Trajectory],
    without: &[Trajectory],
    change: bool,
) -> Result<Vec<f64>, Failure> {
    let mut most = vec![0.0_f64; model.robot().joints()];
    for band in BANDS {
        let (plain, known) = fitted(model, without, band)?;
        let (seen, own) = fitted(model, with, band)?;
        let before = residuals(&plain, &known);
        let after = residuals(&seen, if change { &known } else { &own });
        for (most, (r, r0)) in most.iter_mut().zip(after.iter().zip(&before)) {
            let share = (r * r - r0 * r0).max(0.0).sqrt() / r0.max(1e-12);
            *most = most.max(share);
        }
    }
    Ok(most)
}

fn fitted(model: &dyn Model, motions: &[Trajectory], band: f64) -> Result<(Observation, Vec<f64>), Failure> {
    let preparation = Preparation { cutoff: Some((2.0 * band).min(100.0)), ..Preparation::default() };
    let (motions, _) = prepare_all(motions, &preparation)?;
    let settings = ObserveSettings { band, threads: 1, ..ObserveSettings::default() };
    let observation = observe(model, &motions, Equations::Torque, None, &settings, None)?;
    let settings = EstimateSettings { r_sigma: None, block_sigmas: false, ..EstimateSettings::default() };
    let chi = estimate(&observation, &settings).chi();
    Ok((observation, chi))
}

/// Standard deviation of what is left on each joint, N.m or N.
fn residuals(observation: &Observation, chi: &[f64]) -> Vec<f64> {
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
