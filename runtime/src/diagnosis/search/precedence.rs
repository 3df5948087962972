//! Which of two laws of a joint is named that cannot be told from each other; the other is told as what it cannot be told
//! from.

use crate::diagnosis::rules::TOLD_APART;
use crate::diagnosis::search::round::Ranked;
use crate::diagnosis::search::state::Search;
use crate::effects::Form;

impl Search<'_> {
    /// The candidates that hold, in the order in which they are considered: those that gain most first, but
    /// - a law that the user wrote down before those of the catalogue that cannot be told from it: who wrote it has a
    ///   reason to that no motion shows;
    /// - a curve before one of many forms of its special case: a balancer with its lever says more than that the torque
    ///   follows a curve, and must show it.
    pub(super) fn in_order(&self, ranked: &[Ranked], mut holding: Vec<usize>) -> Vec<usize> {
        let of_user = |k: usize| self.of(&ranked[k]).1.place.law().is_some();
        let first: Vec<usize> = holding.iter().copied().filter(|&k| of_user(k)).collect();
        for law in first {
            self.put_before(ranked, &mut holding, law, |other| !of_user(other));
        }
        for general in holding.clone() {
            self.put_before(ranked, &mut holding, general, |other| self.is_form_of(ranked, other, general));
        }
        holding
    }

    /// Puts a law before the first of the `others` that it cannot be told from.
    fn put_before(
        &self,
        ranked: &[Ranked],
        holding: &mut [usize],
        law: usize,
        others: impl Fn(usize) -> bool,
    ) {
        let Some(from) = holding.iter().position(|&k| k == law) else { return };
        let is_first = |&k: &usize| others(k) && self.is_as_good(&ranked[law], &ranked[k]);
        if let Some(to) = holding[..from].iter().position(is_first) {
            holding[to..=from].rotate_right(1);
        }
    }

    /// Whether a law on the joint of another explains more than it only by accident.
    fn is_as_good(&self, law: &Ranked, other: &Ranked) -> bool {
        let ((regression, own), rival) = (self.of(law), self.of(other).1);
        let comparable = law.window == other.window && own.own == rival.own;
        let both = ((rival, other.verdict.trial), (own, law.verdict.trial));
        comparable && regression.difference_p_value(both.0, both.1) > TOLD_APART
    }

    /// Whether a law is one of many forms of a special case of another.
    fn is_form_of(&self, ranked: &[Ranked], law: usize, general: usize) -> bool {
        let [law_of, general] = [law, general].map(|k| self.of(&ranked[k]).1);
        let shape = &law_of.trials[ranked[law].verdict.trial].shape;
        let is_form = matches!(law_of.effect.form(), Form::Joint(law) if law.is_form_of_many(shape));
        is_form && general.place == law_of.place && general.effect.special_cases().any(|s| s == law_of.effect)
    }
}
