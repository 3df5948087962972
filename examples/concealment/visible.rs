//! What of an effect can be seen at all: the torque that the standard parameters cannot take over, beside the noise.

use dynid_runtime::model::Model;
use dynid_runtime::recording::Trajectory;

use crate::failure::Failure;
use crate::residual::{observed, parameters, residuals};

/// Bands in which is looked, Hz: friction, loads and bodies; ripple and compliance.
const BANDS: [f64; 2] = [25.0, 100.0];

/// The same motions of one robot with the noise of torques alone, and without noise.
pub struct Seen {
    pub recorded: Vec<Trajectory>,
    pub without_noise: Vec<Trajectory>,
}

impl Seen {
    /// Parameters, fitted to the recording where they are not `known`, and what they leave of each joint without noise.
    fn left(
        &self,
        model: &dyn Model,
        band: f64,
        known: Option<&[f64]>,
    ) -> Result<(Vec<f64>, Vec<f64>), Failure> {
        let chi = match known {
            Some(chi) => chi.to_vec(),
            None => parameters(&observed(model, &self.recorded, band)?.1),
        };
        let left = residuals(&observed(model, &self.without_noise, band)?.1, &chi);
        Ok((chi, left))
    }
}

/// For each joint, the torque that an effect leaves after all standard parameters are fitted with it, relative to the
/// noise: sqrt(r² - s²) / r0, where r0 is the residual of a `nominal` recording without the effect, and r and s are what the
/// parameters leave with it and without it of motion without noise. In the band where it shows most. (A wrong time
/// base moves the band, and the noise in it: that is nothing to be seen.)
///
/// Where it is a `change` the parameters are held at those without the effect.
pub fn visible(
    model: &dyn Model,
    with: &Seen,
    without: &Seen,
    (nominal, change): (&[Trajectory], bool),
) -> Result<Vec<f64>, Failure> {
    let mut most = vec![0.0_f64; model.robot().joints()];
    for band in BANDS {
        let (_, recorded) = observed(model, nominal, band)?;
        let noise = residuals(&recorded, &parameters(&recorded));
        let (known, before) = without.left(model, band, None)?;
        let (_, after) = with.left(model, band, change.then_some(&known))?;
        for (joint, most) in most.iter_mut().enumerate() {
            let left = after[joint].powi(2) - before[joint].powi(2);
            *most = most.max(left.max(0.0).sqrt() / noise[joint].max(1e-12));
        }
    }
    Ok(most)
}
