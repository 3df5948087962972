//! What is said against a finding by evidence that the search has not seen.

use crate::diagnosis::outcome::{Diagnosis, Finding};
use crate::diagnosis::rules::{SHOWS_IN_ALL, SWING_LEVEL};
use crate::diagnosis::search::term::Accepted;
use crate::effects::{EffectKind, Form, Place};
use statrs::distribution::{ChiSquared, ContinuousCDF};

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

/// Laws that make motion which was held out worse, once nothing is fitted beside them that is never named; where only all
/// together do so, as beside a transient, one that hardly makes its own joints better.
pub(super) fn harmful(diagnosis: &Diagnosis) -> Vec<Objection> {
    let judged = || diagnosis.findings.iter().filter(|f| f.without.is_some());
    let harms = |f: &&Finding| f.held_out_after > f.held_out_before;
    let mut harmful: Vec<&Finding> = judged().filter(harms).collect();
    if harmful.is_empty() && diagnosis.held_out.after > diagnosis.held_out.before {
        let left = |f: &Finding| f.held_out_after / f.held_out_before.max(1e-300);
        let hardly_helps = judged().filter(|f| left(f) > SHOWS_IN_ALL);
        harmful.extend(hardly_helps.max_by(|a, b| left(a).total_cmp(&left(b))));
    }
    harmful.into_iter().map(|f| Objection::to(f, false)).collect()
}

/// Laws over any variables whose swing their amplitudes may make by accident. Of all differences that so many amplitudes make
/// the largest was looked for, so that it is as certain as all of them are at once (Scheffé 1953). The search has tested whether
/// the amplitudes are zero, and not whether more than a level and friction of the joint remains of them.
pub(super) fn no_larger_than_accidents(diagnosis: &Diagnosis) -> Vec<Objection> {
    let is_accident = |f: &&Finding| {
        let swing = f.parameters.get("swing").filter(|_| matches!(f.term.effect.form(), Form::Free));
        swing.is_some_and(|swing| swing.value <= largest_accident(f.term.amplitude.len()) * swing.sigma)
    };
    diagnosis.findings.iter().filter(is_accident).map(|f| Objection::to(f, false)).collect()
}

/// How many of its standard deviations the largest difference of so many amplitudes is at most by accident.
fn largest_accident(amplitudes: usize) -> f64 {
    let squares = ChiSquared::new(amplitudes as f64).map(|law| law.inverse_cdf(1.0 - SWING_LEVEL));
    squares.map_or(f64::INFINITY, f64::sqrt)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::normal;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    #[test]
    fn of_amplitudes_that_are_noise_one_swing_of_twenty_is_more_than_an_accident() {
        let mut rng = Pcg64::seed_from_u64(11);
        // Of independent amplitudes of one size, the largest contrast is along them all.
        let mut largest = || (0..6).map(|_| normal(&mut rng).powi(2)).sum::<f64>().sqrt();
        let more = (0..4000).filter(|_| largest() > largest_accident(6)).count();
        // Four standard deviations of two hundred.
        assert!((145..=255).contains(&more), "{more} of 4000");
    }
}
