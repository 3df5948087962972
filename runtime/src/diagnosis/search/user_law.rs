//! The place of a user's laws among those of the catalogue.

use crate::diagnosis::rules::TOLD_APART;
use crate::diagnosis::search::round::Ranked;
use crate::diagnosis::search::state::Search;

impl Search<'_> {
    /// The candidates that hold, with a law that the user wrote down before those of the catalogue on its joint that cannot
    /// be told from it: who wrote it has a reason to that no motion shows. The other is told as what it cannot be told from.
    pub(super) fn of_user_first(&self, ranked: &[Ranked], mut holding: Vec<usize>) -> Vec<usize> {
        let of_user: Vec<usize> =
            holding.iter().copied().filter(|&k| self.of(&ranked[k]).1.place.law().is_some()).collect();
        for law in of_user {
            let Some(from) = holding.iter().position(|&k| k == law) else { continue };
            let first = holding[..from].iter().position(|&k| self.is_as_good(&ranked[law], &ranked[k]));
            if let Some(to) = first {
                holding[to..=from].rotate_right(1);
            }
        }
        holding
    }

    /// Whether a law of the catalogue on the joint of a user's law explains more than it only by accident.
    fn is_as_good(&self, law: &Ranked, other: &Ranked) -> bool {
        let ((regression, own), rival) = (self.of(law), self.of(other).1);
        let comparable = law.window == other.window && own.own == rival.own && rival.place.law().is_none();
        let both = ((rival, other.verdict.trial), (own, law.verdict.trial));
        comparable && regression.difference_p_value(both.0, both.1) > TOLD_APART
    }
}
