//! What the standard model leaves of a recording.

use dynid_runtime::estimation::observe::{Equations, ObserveSettings, observe};
use dynid_runtime::estimation::{EstimateSettings, choose_bandwidth, estimate, per_equation};
use dynid_runtime::model::Model;
use dynid_runtime::recording::Trajectory;
use dynid_runtime::signal::{Motion, Preparation, prepare_all};

use crate::Failure;

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
    let preparation = Preparation { cutoff: Some(2.0 * band), ..Preparation::default() };
    let (motions, _) = prepare_all(motions, &preparation)?;
    let settings = ObserveSettings { band, threads: 1, ..ObserveSettings::default() };
    let observation = observe(model, &motions, Equations::Torque, None, &settings, None)?;
    let settings = EstimateSettings { r_sigma: None, block_sigmas: false, ..EstimateSettings::default() };
    let chi = known.map_or_else(|| estimate(&observation, &settings).chi(), <[f64]>::to_vec);
    let residual = per_equation(&observation, &chi)
        .iter()
        .enumerate()
        .map(|(joint, relative)| {
            let own = observation.groups.iter().filter(|g| g.equation == joint);
            let (y, rows) =
                own.fold((0.0, 0), |(y, rows), g| (y + g.factor.norm_y().powi(2), rows + g.factor.rows()));
            relative * (y / rows.max(1) as f64).sqrt()
        })
        .collect();
    Ok(Fitted { motions, chi, residual })
}
