//! Two laws of one joint that show only together.
//!
//! What one of them leaves makes the residual correlated and hides the other: on a short recording neither is certain
//! alone. With one of them in the model, the other can be, and then the first beside it.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::significance::Evidence;
use crate::diagnosis::rules::{FIRST_OF_PAIR, MOST_FIRSTS};
use crate::diagnosis::search::gate::RoundEvidence;
use crate::diagnosis::search::round::{Ranked, Winner};
use crate::diagnosis::search::standing::penalty;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::search::term::Accepted;
use crate::diagnosis::settings::Settings;
use crate::parallel;

impl Search<'_> {
    /// Two laws of a joint, each certain and holding beside the other, where none is certain alone.
    ///
    /// # Errors
    /// [`SingularDesign`] where a model on the way has no fit.
    pub(in crate::diagnosis) fn pair(
        &mut self,
        settings: &Settings,
    ) -> Result<Option<[Accepted; 2]>, SingularDesign> {
        if !self.model.slow.design.short {
            return Ok(None);
        }
        let firsts = self.first_laws(settings);
        let mut found = None;
        for first in &firsts {
            let Some(second) = self.beside(first, settings, firsts.len())? else { continue };
            let Some(again) = self.beside(&second, settings, firsts.len())? else { continue };
            if again.effect == first.effect && again.place == first.place {
                found = Some([again, second]);
                break;
            }
        }
        self.refit_and_update()?;
        match found {
            Some(pair) if !self.one_law_suffices(&pair)? => Ok(Some(pair)),
            _ => Ok(None),
        }
    }

    /// Whether a single law of the joint of a pair, or one that shows there, explains as much, each of their numbers paid
    /// for: it may be one that is not named because another joint could have it as well, and then two laws imitate it.
    fn one_law_suffices(&self, pair: &[Accepted; 2]) -> Result<bool, SingularDesign> {
        let [window, other] = [0, 1].map(|k| pair[k].effect.properties().window);
        if window != other {
            return Ok(false);
        }
        let regression = self.model.regression(window);
        let mut with = self.model.clone();
        with.terms.extend(pair.iter().cloned());
        with.refit()?;
        let columns = &with.regression(window).term_columns[self.model.terms.len()..];
        let amplitudes = columns.iter().map(|columns| columns.len()).sum::<usize>();
        let shapes = pair.iter().map(|law| law.shape.len()).sum::<usize>();
        let penalty = penalty(self.tries());
        let worth = |gain: f64, numbers: usize| gain - penalty * numbers as f64;
        let of_pair = regression.gain_against(with.regression(window))?;
        let joint = pair[0].own[0];
        let shows = |r: &Ranked| r.verdict.shows_on.contains(&joint) || self.of(r).1.own.contains(&joint);
        let same = self.ranked(None).into_iter().filter(|r| r.window == window && shows(r));
        let best_of_one = same.map(|r| {
            let trial = &self.of(&r).1.trials[r.verdict.trial];
            worth(r.verdict.gain, trial.columns.len() + trial.shape.len())
        });
        Ok(best_of_one.fold(f64::NEG_INFINITY, f64::max) >= worth(of_pair, amplitudes + shapes))
    }

    /// Laws of one joint that are no likely accident, as first laws of a pair.
    fn first_laws(&self, settings: &Settings) -> Vec<Accepted> {
        let mut ranked = self.ranked(None);
        ranked.retain(|r| {
            let candidate = self.of(r).1;
            candidate.own.len() == 1
                && r.verdict.explained_fraction >= settings.least_share
                && settings.may_name(candidate.effect, candidate.place)
        });
        ranked.truncate(MOST_FIRSTS);
        let round = RoundEvidence::new(ranked.len());
        let evidence = parallel::map(self.threads(), ranked.len(), |k| match self.gate(&round, &ranked, k) {
            Some(gate) => gate.calibrated.evidence(),
            None => Evidence::NONE,
        });
        ranked
            .iter()
            .zip(evidence)
            .filter(|(_, evidence)| evidence.p_value < FIRST_OF_PAIR)
            .map(|(first, evidence)| {
                self.as_term(&Winner {
                    window: first.window,
                    index: first.index,
                    verdict: first.verdict.clone(),
                    significance: evidence.significance,
                    confidence: 0.0,
                    inflation: 1.0,
                    rivals: Vec::new(),
                })
            })
            .collect()
    }

    /// The best law of the joint of `law` with it in the model, where the candidates are looked through `rounds` times.
    /// Leaves the candidates prepared for that.
    fn beside(
        &mut self,
        law: &Accepted,
        settings: &Settings,
        rounds: usize,
    ) -> Result<Option<Accepted>, SingularDesign> {
        let joint = Some(law.own[0]);
        self.model.terms.push(law.clone());
        self.model.refit()?;
        self.update(joint);
        let found = self.best(settings, joint, rounds)?.winner.map(|winner| self.accept(&winner));
        self.model.terms.pop();
        Ok(found)
    }
}
