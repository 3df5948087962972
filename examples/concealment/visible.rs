//! What of an effect can be seen at all: the torque that the standard parameters cannot take over, beside the noise.

use dynid_runtime::model::Model;
use dynid_runtime::recording::Trajectory;

use crate::failure::Failure;
use crate::residual::{beside, observed, parameters, residuals};

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

/// A robot in which nothing is hidden, in a band.
struct InBand {
    band: f64,
    /// Residuals of a recording with the nominal noise.
    noise: Vec<f64>,
    /// Parameters, and what they leave without noise.
    chi: Vec<f64>,
    left: Vec<f64>,
}

/// A robot in which nothing is hidden: what hidden effects are compared with.
pub struct Plain([InBand; BANDS.len()]);

impl Plain {
    /// From a recording with the `nominal` noise, and the same motions with less.
    pub fn of(model: &dyn Model, nominal: &[Trajectory], seen: &Seen) -> Result<Self, Failure> {
        let in_band = |band| -> Result<InBand, Failure> {
            let (_, recorded) = observed(model, nominal, band)?;
            let noise = residuals(&recorded, &parameters(&recorded));
            let (chi, left) = seen.left(model, band, None)?;
            Ok(InBand { band, noise, chi, left })
        };
        let [low, high] = BANDS;
        Ok(Self([in_band(low)?, in_band(high)?]))
    }
}

/// For each joint, the torque that an effect leaves after all standard parameters are fitted with it, relative to the
/// noise: sqrt(r² - s²) / r0, where r0 is the residual of a nominal recording without the effect, and r and s are what the
/// parameters leave with it and without it of motion without noise. In the band where it shows most. (A wrong time
/// base moves the band, and the noise in it: that is nothing to be seen.)
///
/// Where it is a `change` the parameters are held at those without the effect.
pub fn visible(model: &dyn Model, with: &Seen, plain: &Plain, change: bool) -> Result<Vec<f64>, Failure> {
    let mut most = vec![0.0_f64; model.robot().joints()];
    for InBand { band, noise, chi, left } in &plain.0 {
        let (_, after) = with.left(model, *band, change.then_some(chi))?;
        for (joint, most) in most.iter_mut().enumerate() {
            *most = most.max(beside(after[joint], left[joint], noise[joint]));
        }
    }
    Ok(most)
}
