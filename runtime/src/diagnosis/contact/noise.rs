//! What the residuals of joints do by themselves.

use crate::diagnosis::contact::half_waves::Widths;
use crate::diagnosis::contact::largest::{Chances, Law};
use crate::diagnosis::contact::memory::Spread;
use crate::diagnosis::contact::white::{Scratch, White};

/// What the residual of every joint does by itself, where nothing pushes.
pub(in crate::diagnosis) struct Noise {
    /// By joint; `None` where there are too few rows.
    pub(super) joints: Vec<Option<Own>>,
    pub(super) chances: Chances,
}

/// The same of one joint.
pub(super) struct Own {
    /// Of means of the residual as it is.
    pub spread: Spread,
    /// Beside the model.
    pub white: White,
    pub widths: Widths,
    pub law: Law,
}

impl Noise {
    fn of(&self, joint: usize) -> Option<&Own> {
        self.joints.get(joint)?.as_ref()
    }

    /// Standard deviation of a mean of a joint's residual over so many rows.
    pub fn sigma(&self, joint: usize, rows: usize) -> Option<f64> {
        self.of(joint).map(|own| own.spread.of_mean(rows))
    }

    /// Mean of what pushes a joint over places of a motion, N.m or N, beside all that the model makes of it: that of the half
    /// wave which fits best, and its standard deviation; `None` where too few rows tell.
    pub fn pushed(&self, joint: usize, motion: usize, places: [usize; 2]) -> Option<[f64; 2]> {
        let Own { white, widths, .. } = self.of(joint)?;
        let places = places[0]..places[1] + 1;
        let width = widths.of(places.len());
        let wave = white.half_wave(motion, places, &mut Scratch::default())?;
        Some([wave[0], width * wave[1]].map(|x| x * std::f64::consts::FRAC_2_PI))
    }

    /// Probability that the means of joints, `(joint, standard deviations from zero)`, come as far in one of all windows of
    /// the recording by accident.
    pub fn doubt(&self, means: impl Iterator<Item = (usize, f64)>) -> f64 {
        let surprise =
            |(joint, deviations): (usize, f64)| Some(self.of(joint)?.law.surprise(deviations * deviations));
        self.chances.of_all(means.filter_map(surprise).sum())
    }
}
