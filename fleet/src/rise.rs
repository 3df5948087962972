//! Whether a recording has larger errors with the parameters of its robot's reference than with its own.

use dynid_runtime::estimation::Reduced;
use statrs::distribution::{ChiSquared, ContinuousCDF};

/// Chance that a recording of a robot that did not change counts as one with larger errors: a diagnosis of such a one costs
/// time, and has its own gates against naming anything.
const LEVEL: f64 = 1e-3;

/// Errors with other parameters over those with its own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Rise {
    /// Ratio of the root mean squares of the weighted errors.
    pub ratio: f64,
    /// Whether it is more than chance: the squares that the other parameters add, over those of noise that lasts, are
    /// chi squared with a degree of freedom for each parameter where nothing changed (Seber and Lee 2003, section 4.3).
    pub certain: bool,
}

/// How much errors rise with the parameters `chi`; `None` where the recording determines nothing, or has other parameters.
///
/// The parameters of the reference are taken as they are: where its recording was shorter than this one, more recordings
/// than one in a thousand count.
pub fn rise(factor: &Reduced, chi: &[f64]) -> Option<Rise> {
    let own = factor.solve();
    let determined = own.parameters.iter().filter(|p| p.sigma.is_some_and(|sigma| sigma > 0.0)).count();
    if own.degrees_of_freedom == 0 || determined == 0 || own.residual_norm <= 0.0 {
        return None;
    }
    // What this recording does not determine tells nothing.
    let mut chi = chi.to_vec();
    for (value, parameter) in chi.iter_mut().zip(&own.parameters) {
        if parameter.sigma.is_none() {
            *value = parameter.value;
        }
    }
    let with = factor.residual_norm(&chi).ok()?;
    let added = with.powi(2) - own.residual_norm.powi(2);
    let of_noise = own.residual_norm.powi(2) / own.degrees_of_freedom as f64 * own.inflation.max(1.0);
    let limit = ChiSquared::new(determined as f64).ok()?.inverse_cdf(1.0 - LEVEL);
    Some(Rise { ratio: with / own.residual_norm, certain: added / of_noise > limit })
}
