//! Windows in which joints are pushed, and those in which they may be.

use std::f64::consts::PI;
use std::ops::Range;

/// A window in which joints are pushed.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::diagnosis) struct Pushed {
    /// The one that tells most of it, 0-based.
    pub joint: usize,
    pub motion: usize,
    /// First and last place.
    pub places: [usize; 2],
    /// Standard deviations of both, in places.
    pub edges: [f64; 2],
    /// Amplitude of the half wave over its standard deviation, squared.
    pub square: f64,
    /// Probability that in one of all windows of the recording all joints together come as far by accident.
    pub doubt: f64,
}

/// What may be a push.
#[derive(Clone)]
pub(super) struct Candidate {
    pub pushed: Pushed,
    /// Whether something else tells that it is one.
    pub is_certain: bool,
    /// What each joint that is scanned feels, as a normal deviate, beside the model and the other candidates.
    pub felt: Vec<Option<f64>>,
}

impl Candidate {
    /// Before any look at what joints feel of it.
    pub fn unfelt(pushed: Pushed, is_certain: bool) -> Self {
        Self { pushed, is_certain, felt: Vec::new() }
    }

    pub fn places(&self) -> Range<usize> {
        self.pushed.places[0]..self.pushed.places[1] + 1
    }
}

impl Pushed {
    /// Whether both have a place in common.
    pub fn overlaps(&self, other: &Self) -> bool {
        self.is_near(other.motion, other.places, 0)
    }

    /// Whether places of a motion are next to it.
    pub(super) fn is_near(&self, motion: usize, [from, to]: [usize; 2], gap: usize) -> bool {
        self.motion == motion && from <= self.places[1] + gap && self.places[0] <= to + gap
    }
}

/// Height at a place of half a sine wave over places, zero beside them: as the torque of a push rises and falls.
pub(super) fn half_wave(place: usize, places: &Range<usize>) -> f64 {
    if !places.contains(&place) {
        return 0.0;
    }
    (PI * ((place - places.start) as f64 + 0.5) / places.len() as f64).sin()
}
