//! The noise of a recording's torques within a band: what no model explains.

use crate::signal::welch;

/// Length of a segment of the spectrum, s.
const SEGMENT: f64 = 2.0;
/// Where the noise is read, in units of the band: above the motion, and not far above the band.
const READ: [f64; 2] = [2.0, 4.0];
/// Highest frequency that is read, in units of the rate: the filters of a recording bend the spectrum above.
const HIGHEST: f64 = 0.45;
/// Fewest lines of the spectrum that a level is read from.
const FEWEST: usize = 4;

/// Variance of the noise of one row of `band` Hz, from what a model leaves of a torque at the full rate.
///
/// Between two and four times the band nothing moves; the median density found there is taken to reach down through
/// the band, as white noise does. The median passes over lines such as those of a ripple. Noise that the positions
/// bring into the prediction falls off above the band and is not counted; where a controller answers to the noise of
/// its encoders, torques are rougher above the band than in it, and the level is too high: what is reported of it is
/// capped at what the model leaves. `None` where the signal is too short or its rate too low.
pub(super) fn variance(residual: &[f64], rate: f64, band: f64) -> Option<f64> {
    let spectrum = welch(residual, rate, ((SEGMENT * rate) as usize).max(16)).ok()?;
    let [from, to] = [READ[0] * band, (READ[1] * band).min(HIGHEST * rate)];
    let mut read: Vec<f64> = spectrum
        .frequency
        .iter()
        .zip(&spectrum.density)
        .filter(|(f, _)| (from..=to).contains(f))
        .map(|(_, density)| *density)
        .collect();
    if read.len() < FEWEST {
        return None;
    }
    let middle = read.len() / 2;
    let (_, median, _) = read.select_nth_unstable_by(middle, f64::total_cmp);
    Some(*median * band)
}
