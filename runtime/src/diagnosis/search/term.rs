//! An effect that became part of the model.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::effects::{EffectKind, Place};

/// A law of the model: effect, place and shape.
pub(super) type Law = (EffectKind, Place, Vec<f64>);

/// An accepted effect.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Accepted {
    pub effect: EffectKind,
    pub place: Place,
    /// Joints (0-based) whose residual it explains.
    pub own: Vec<usize>,
    /// Joints that it shows on, where the errors with and without it are compared.
    pub shows_on: Vec<usize>,
    pub shape: Vec<f64>,
    /// Other shapes in which its search ended, where it has more than one start.
    pub modes: Vec<Mode>,
    /// The amplitude, where the effect's law leaves none free.
    pub fixed: Option<f64>,
    pub significance: f64,
    pub confidence: f64,
    /// Factor on the standard deviations of its numbers: what the residual's memory and the variation between units
    /// add.
    pub inflation: f64,
    /// Fraction of what held-out motion left open when it was accepted: what its rivals' fractions compare with.
    pub explained_fraction: f64,
    pub rivals: Vec<Rival>,
    /// Whether it is certain, has faded before the motion ends, and cannot be told from an event: part of the model, without a
    /// name.
    pub is_transient: bool,
}

impl Accepted {
    /// Which law it is.
    pub(super) fn law(&self) -> Law {
        (self.effect, self.place, self.shape.clone())
    }

    /// The joint of a curve that says nothing of values which no motion has passed; `None` for every other law.
    pub fn curve_on(&self) -> Option<usize> {
        self.own.first().copied().filter(|_| self.effect.form().holds_only_where_seen())
    }

    /// A candidate with a shape, before anything is known of how well it does.
    pub fn tried(candidate: &Candidate, shape: Vec<f64>) -> Self {
        Self {
            effect: candidate.effect,
            place: candidate.place,
            own: candidate.own.clone(),
            shows_on: candidate.own.clone(),
            shape,
            modes: Vec::new(),
            fixed: candidate.fixed,
            significance: 0.0,
            confidence: 0.0,
            inflation: 1.0,
            explained_fraction: 0.0,
            rivals: Vec::new(),
            is_transient: false,
        }
    }
}

/// Another shape that leaves hardly more than the best.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Mode {
    pub shape: Vec<f64>,
    /// Its likelihood as a fraction of all that the search ended in.
    pub weight: f64,
}

/// Another explanation of what an accepted effect explains.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Rival {
    pub effect: EffectKind,
    pub place: Place,
    /// Its shape, where that tells it from others; else empty.
    pub shape: Vec<f64>,
    pub explained_fraction: f64,
    /// Probability that it is only by accident that it explains less, where it holds at all and acts on the same
    /// joints; else 0.
    pub difference_p_value: f64,
}
