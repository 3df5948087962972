//! Two laws of one joint that show only together.
//!
//! What one of them leaves makes the residual remember and hides the other: on a short recording neither is certain
//! alone. With one of them in the model, the other can be, and then the first beside it.

use crate::diagnosis::search::select::Winner;
use crate::diagnosis::search::state::{Accepted, Search};
use crate::diagnosis::settings::Settings;
use crate::parallel;

/// A law is tried as the first of a pair where an accident comes as far less often than this.
const LIKELY: f64 = 0.01;

impl Search<'_, '_> {
    /// Two laws of a joint, each certain and holding beside the other, where none is certain alone.
    pub(in crate::diagnosis) fn pair(&mut self, settings: &Settings) -> Option<[Accepted; 2]> {
        if !self.slow.design.short {
            return None;
        }
        let firsts = self.likely(settings);
        let found = firsts.iter().find_map(|first| {
            let second = self.beside(first, settings, firsts.len())?;
            let again = self.beside(&second, settings, firsts.len())?;
            let same = again.effect == first.effect && again.place == first.place;
            same.then_some([again, second])
        });
        self.refit_and_update();
        found
    }

    /// Laws of one joint that are no likely accident, as first laws of a pair.
    fn likely(&self, settings: &Settings) -> Vec<Accepted> {
        let mut ranked = self.ranked(None);
        ranked.retain(|r| self.of(r).1.own.len() == 1 && r.verdict.share >= settings.least_share);
        let evidence = parallel::map(self.threads, ranked.len(), |k| self.evidence(&ranked[k]));
        ranked
            .iter()
            .zip(evidence)
            .filter(|(_, evidence)| evidence.tail < LIKELY)
            .map(|(first, evidence)| {
                self.as_term(&Winner {
                    window: first.window,
                    index: first.index,
                    verdict: first.verdict.clone(),
                    significance: evidence.significance,
                    confidence: 0.0,
                    rivals: Vec::new(),
                })
            })
            .collect()
    }

    /// The best law of the joint of `law` with it in the model, where the candidates are looked through `rounds` times.
    /// Leaves the candidates prepared for that.
    fn beside(&mut self, law: &Accepted, settings: &Settings, rounds: usize) -> Option<Accepted> {
        let joint = Some(law.own[0]);
        self.terms.push(law.clone());
        self.refit();
        self.prepare(joint);
        let found = self.best(settings, joint, rounds).map(|winner| self.accept(&winner));
        self.terms.pop();
        found
    }
}
