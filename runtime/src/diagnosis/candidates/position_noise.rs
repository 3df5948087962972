//! Noise of the positions: acceleration that asks for a torque which nobody feels.
//!
//! Less of it is there the higher the frequency: above some the recorded acceleration is mostly noise. What the torque lacks
//! is then in phase with the acceleration, as it is far from the resonance of a compliant transmission; near it the
//! resonance turns the phase.

use crate::diagnosis::candidates::trial::{dense, gathered};
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::series::Series;
use crate::diagnosis::rules::NOISE_OCTAVES;
use crate::signal::Butterworth;

/// Torques of what each joint's acceleration has above the beginning of each octave, as columns on all rows: any course
/// over frequency can be made of them.
pub(in crate::diagnosis) fn position_noise(context: &Context<'_>, design: &Design) -> Vec<Vec<f64>> {
    let of_octave = |octave: &f64| {
        let above = |k| (0..design.joints).map(|j| above(context, k, j, octave / design.step)).collect();
        gathered(context, design, |_| false, above)
    };
    NOISE_OCTAVES.iter().flat_map(of_octave).map(|column| dense(design, &column)).collect()
}

/// The torques of what a joint's acceleration has above a frequency, Hz, in a motion.
fn above(context: &Context<'_>, k: usize, j: usize, cutoff: f64) -> Series {
    let s = &context.signals[k];
    let low = Butterworth::low_pass(2, cutoff, s.rate).and_then(|filter| filter.zero_phase(&s.ddq[j]));
    // A motion that is too short to be filtered has nothing above.
    let low = low.unwrap_or_else(|_| s.ddq[j].clone());
    let high: Vec<f64> = s.ddq[j].iter().zip(&low).map(|(all, low)| all - low).collect();
    context.inertial(k, j, &high)
}
