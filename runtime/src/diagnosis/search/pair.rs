//! Two laws of one joint that show only together.
//!
//! What one of them leaves makes the residual correlated and hides the other: on a short recording neither is certain
//! alone. With one of them in the model, the other can be, and then the first beside it.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::significance::Evidence;
use crate::diagnosis::rules::{FIRST_OF_PAIR, MOST_FIRSTS};
use crate::diagnosis::search::gate::RoundEvidence;
use crate::diagnosis::search::round::Winner;
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
        Ok(found)
    }

    /// Laws of one joint that are no likely accident, as first laws of a pair.
    fn first_laws(&self, settings: &Settings) -> Vec<Accepted> {
        let mut ranked = self.ranked(None);
        ranked
            .retain(|r| self.of(r).1.own.len() == 1 && r.verdict.explained_fraction >= settings.least_share);
        ranked.truncate(MOST_FIRSTS);
        let round = RoundEvidence::new(ranked.len());
        let evidence = parallel::map(self.threads, ranked.len(), |k| match self.gate(&round, &ranked, k) {
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
