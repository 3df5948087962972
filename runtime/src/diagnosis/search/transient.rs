//! What was there at the beginning of the motion only.
//!
//! Friction that fades within a fraction of the recording may be certain to be there, and still nobody knows whether it drifts
//! or whether something happened then. It is not named. It stays in the model all the same: without it the parameters and the
//! laws that were found would take its part, and predict it for all motion that follows.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::{FADED, LATE};
use crate::diagnosis::search::gate::RoundEvidence;
use crate::diagnosis::search::round::{Ranked, Winner};
use crate::diagnosis::search::state::Search;
use crate::diagnosis::settings::Settings;

/// When columns have faded: nearly none of their squares come later than so many seconds after the beginning of a motion.
pub(in crate::diagnosis) fn faded_after(design: &Design, columns: &[Vec<f64>]) -> f64 {
    let spans = design.spans();
    // Rows since the first one of the motion.
    let ages: Vec<usize> =
        (0..design.rows.len()).map(|r| design.place(r) - spans[design.rows[r].signal].start).collect();
    let squares = |r: usize| columns.iter().map(|c| c[r] * c[r]).sum::<f64>();
    let mut rows: Vec<usize> = (0..ages.len()).collect();
    rows.sort_by_key(|&r| std::cmp::Reverse(ages[r]));
    let all: f64 = rows.iter().map(|&r| squares(r)).sum();
    let mut later = 0.0;
    let last = rows.into_iter().find(|&r| {
        later += squares(r);
        later > FADED * all
    });
    last.map_or(0.0, |r| ages[r] as f64 * design.step)
}

/// Duration of the shortest motion, s.
fn shortest(design: &Design) -> f64 {
    let rows = design.spans().into_iter().map(|span| span.len().saturating_sub(1)).min();
    rows.unwrap_or(0) as f64 * design.step
}

impl Search<'_> {
    /// Makes transients a part of the model, beside laws that were found.
    ///
    /// # Errors
    /// [`SingularDesign`] where a model on the way has no fit.
    pub(in crate::diagnosis) fn keep_transients(
        &mut self,
        settings: &Settings,
    ) -> Result<(), SingularDesign> {
        if self.model.change || self.model.terms.is_empty() {
            return Ok(());
        }
        let settings = &self.settings_of_next(settings);
        while self.model.terms.len() < settings.most_effects {
            let ranked = self.ranked(None);
            let round = RoundEvidence::new(ranked.len());
            let mut holding = self.holding(&ranked, settings).into_iter();
            let Some(winner) = holding.find_map(|k| self.as_transient(&round, &ranked, k, settings)) else {
                return Ok(());
            };
            let mut term = self.accept(&winner);
            term.is_transient = true;
            self.model.terms.push(term);
            self.refit_and_update()?;
        }
        Ok(())
    }

    /// A candidate of a round that is certain to be there, an event for all that is known, and has faded before the motion ends.
    fn as_transient(
        &self,
        round: &RoundEvidence,
        ranked: &[Ranked],
        k: usize,
        settings: &Settings,
    ) -> Option<Winner> {
        let candidate = self.of(&ranked[k]).1;
        if !settings.may_name(candidate.effect, candidate.place) {
            return None;
        }
        let gate = self.gate_of_any(round, ranked, k).filter(|gate| gate.is_event)?;
        let evidence = gate.calibrated.evidence();
        let confidence = evidence.confidence(self.tries());
        let design = &self.of(&ranked[k]).0.design;
        if confidence < settings.least_confidence
            || faded_after(design, &self.columns(&ranked[k])) > (1.0 - LATE) * shortest(design)
        {
            return None;
        }
        let Ranked { window, index, ref verdict } = ranked[k];
        Some(Winner {
            window,
            index,
            verdict: verdict.clone(),
            significance: evidence.significance,
            confidence,
            inflation: gate.inflation(),
            rivals: Vec::new(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use approx::assert_relative_eq;

    #[test]
    fn what_decays_has_faded_after_twice_its_time_constant_and_what_grows_never() {
        let rows = 400;
        let decaying: Vec<f64> = (0..2 * rows).map(|r| (-((r % rows) as f64) * 0.02).exp()).collect();
        let growing: Vec<f64> = decaying.iter().map(|x| 1.0 - x).collect();
        let columns = vec![decaying, growing];
        let design = Design::made_up(1, &[(0, true), (1, true)], rows, columns.clone(), vec![0.0; 2 * rows]);
        // Squares after t are exp(-2 t / tau) of all.
        let tau = design.step / 0.02;
        assert_relative_eq!(
            faded_after(&design, &columns[..1]),
            -0.5 * FADED.ln() * tau,
            max_relative = 0.02
        );
        assert!(faded_after(&design, &columns[1..]) > (1.0 - LATE) * shortest(&design));
        assert_relative_eq!(shortest(&design), (rows - 1) as f64 * design.step, max_relative = 1e-12);
    }
}
