//! What is searched for, and how long.

use super::information::{Criterion, Identification};
use super::point_to_point::Profile;
use crate::simulation::SimulationError;

/// The family of motions that is searched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MotionKind {
    /// Fourier series.
    Fourier {
        /// Number of harmonics, 2 or more.
        harmonics: usize,
        /// Length of a period, s.
        period: f64,
        /// Periods of the motion.
        periods: usize,
    },
    /// Points joined by a profile.
    PointToPoint {
        /// Number of points, 2 or more.
        points: usize,
        /// How they are joined.
        profile: Profile,
        /// Stop at each point, s.
        pause: f64,
    },
}

/// What to search, and how long.
#[derive(Debug, Clone, PartialEq)]
pub struct ExcitationSettings {
    /// Family of motions.
    pub kind: MotionKind,
    /// What the motions are for.
    pub identification: Identification,
    /// What makes motions better.
    pub criterion: Criterion,
    /// The sets of section IV.B: `sets` motions, in motion k (from 0) joints 1 to k stand still. 1 is a single
    /// motion of all joints, n makes W block-triangular.
    pub sets: usize,
    /// Random starts for each motion.
    pub starts: usize,
    /// Candidate motions tried from each start.
    pub evaluations: usize,
    /// Share of every limit that may be used, in (0, 1].
    pub share: f64,
    /// Share of the position range that may be used, about its middle, in (0, 1]; where `share` is less, that holds.
    pub reach: f64,
    /// The same seed gives the same motions.
    pub seed: u64,
}

impl Default for ExcitationSettings {
    /// One random Fourier motion of 8 s that was not searched for, within 90 % of the limits.
    fn default() -> Self {
        Self {
            kind: MotionKind::Fourier { harmonics: 5, period: 8.0, periods: 1 },
            identification: Identification::Idim,
            criterion: Criterion::Determinant,
            sets: 1,
            starts: 1,
            evaluations: 0,
            share: 0.9,
            reach: 1.0,
            seed: 1,
        }
    }
}

/// Longest period and pause, s: torques are looked at densely, and a robot is not excited for hours.
const LONGEST: f64 = 3600.0;

/// Whether the settings can be searched for a robot of `n` joints.
pub(super) fn check(settings: &ExcitationSettings, n: usize) -> Result<(), SimulationError> {
    let setting = |what, expected, found| Err(SimulationError::Setting { what, expected, found });
    match settings.kind {
        MotionKind::Fourier { harmonics, period, periods } => {
            if !(2..=64).contains(&harmonics) {
                return setting("number of harmonics", "2 to 64", harmonics as f64);
            }
            if !(period > 0.0 && period <= LONGEST) {
                return setting("period", "positive, at most 3600 s", period);
            }
            if !(1..=1000).contains(&periods) {
                return setting("number of periods", "1 to 1000", periods as f64);
            }
        }
        MotionKind::PointToPoint { points, pause, .. } => {
            if !(2..=1000).contains(&points) {
                return setting("number of points", "2 to 1000", points as f64);
            }
            if !(0.0..=LONGEST).contains(&pause) {
                return setting("pause", "0 to 3600 s", pause);
            }
        }
    }
    if settings.sets == 0 || settings.sets > n {
        return setting("number of sets", "1 to the number of joints", settings.sets as f64);
    }
    if settings.starts == 0 {
        return setting("number of starts", "1 or more", 0.0);
    }
    Ok(())
}
