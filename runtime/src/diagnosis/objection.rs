//! What is said against a finding by evidence that the search has not seen.

use crate::diagnosis::outcome::Finding;
use crate::diagnosis::search::term::Accepted;
use crate::effects::{EffectKind, Place};

/// A law at a place that is not to be named.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Objection {
    pub effect: EffectKind,
    pub place: Place,
    /// Whether it may be there all the same, because the evidence does not tell: it stays a rival of others.
    pub still_possible: bool,
}

impl Objection {
    /// To a law of the model that cannot be what it was taken for.
    pub(super) fn to_term(term: &Accepted) -> Self {
        Self { effect: term.effect, place: term.place, still_possible: false }
    }

    /// To a finding.
    pub fn to(finding: &Finding, still_possible: bool) -> Self {
        Self { effect: finding.term.effect, place: finding.term.place, still_possible }
    }
}
