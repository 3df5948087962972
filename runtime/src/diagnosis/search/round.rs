//! What a round of judging works with and comes to.

use crate::diagnosis::judging::judge::Verdict;
use crate::diagnosis::search::term::Rival;
use crate::effects::{EffectKind, Place, SmoothingWindow};
use std::cmp::Ordering;

/// What passed a round: the window of its rows, the candidate's index there, and its verdict.
pub(in crate::diagnosis) struct Winner {
    pub window: SmoothingWindow,
    pub index: usize,
    pub verdict: Verdict,
    pub significance: f64,
    pub confidence: f64,
    /// Factor on the standard deviations of its numbers.
    pub inflation: f64,
    pub rivals: Vec<Rival>,
}

/// Two laws on different joints that the recording cannot tell apart.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::diagnosis) struct Tie {
    pub effects: [EffectKind; 2],
    pub places: [Place; 2],
}

/// What a round of judging came to.
pub(in crate::diagnosis) struct Round {
    pub winner: Option<Winner>,
    /// Laws that would have won, were they not tied with another.
    pub ties: Vec<Tie>,
}

/// A candidate of a round: the window of its rows, its index there, and its verdict.
pub(in crate::diagnosis) struct Ranked {
    pub window: SmoothingWindow,
    pub index: usize,
    pub verdict: Verdict,
}

impl Ranked {
    /// The order of a round: what gains more on held-out motion comes first.
    pub fn more_first(&self, other: &Self) -> Ordering {
        other.verdict.total().total_cmp(&self.verdict.total())
    }
}
