//! What of an effect can be seen at all: the torque that the standard parameters cannot take over, beside the noise.

use dynid_runtime::model::Model;
use dynid_runtime::recording::Trajectory;

use crate::failure::Failure;
use crate::residual::{beside, observed, parameters, residuals};

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
        let (_, plain) = observed(model, without, band)?;
        let (_, seen) = observed(model, with, band)?;
        let known = parameters(&plain);
        let own = if change { known.clone() } else { parameters(&seen) };
        let (before, after) = (residuals(&plain, &known), residuals(&seen, &own));
        for (most, (r, r0)) in most.iter_mut().zip(after.into_iter().zip(before)) {
            *most = most.max(beside(r, r0));
        }
    }
    Ok(most)
}
