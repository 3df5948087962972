//! Earlier laws, once another has joined the model.
//!
//! With a new law in the model an earlier one may turn out to have been its imitator. One that lies on its joints, or that
//! lost a part of its squares to it, is taken out, and the best explanation of its joints is put in its place.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::rules::KEPT_BESIDE;
use crate::diagnosis::search::round::Winner;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::search::term::Accepted;
use crate::diagnosis::settings::Settings;
use crate::effects::EffectKind;

impl Search<'_> {
    /// Squares that each law of the model alone explains, in units that stay the same when other joints become less noisy;
    /// nothing for a law whose amplitude is not free.
    pub(in crate::diagnosis) fn own_squares(&self) -> Vec<Option<f64>> {
        let of_term = |(k, term): (usize, &Accepted)| {
            let regression = self.model.regression(term.effect.properties().window);
            let columns = regression.term_columns.get(k).filter(|c| !c.is_empty())?;
            let sigma = regression.sigma[*term.shows_on.first()?];
            Some(regression.fit.wald(columns.clone())? * sigma * sigma)
        };
        self.model.terms.iter().enumerate().map(of_term).collect()
    }

    /// Looks at laws that may have imitated those that joined the model after them; `before` are the squares that they
    /// explained before.
    ///
    /// # Errors
    /// [`SingularDesign`] where a model on the way has no fit.
    pub(in crate::diagnosis) fn reconsider(
        &mut self,
        before: &[Option<f64>],
        settings: &Settings,
    ) -> Result<(), SingularDesign> {
        let mut doubted = self.doubted(before);
        if !doubted.contains(&true) {
            return Ok(());
        }
        let mut k = 0;
        while k + 1 < self.model.terms.len() {
            if !doubted[k] {
                k += 1;
                continue;
            }
            let old = self.model.terms.remove(k);
            match self.in_place_of(&old, settings)? {
                Some(term) => {
                    self.model.terms.insert(k, term);
                    k += 1;
                }
                None => {
                    // What no longer holds is left out for good, or it might come and go for ever; those after it move
                    // up, and all are considered anew. A law over any variables is looked for once more in what is then
                    // left.
                    if old.effect != EffectKind::FreeForm {
                        self.rejected.push(old);
                    }
                    doubted.fill(true);
                    k = 0;
                }
            }
        }
        self.refit_and_update()
    }

    /// Which laws may have imitated one of those after `before`.
    fn doubted(&self, before: &[Option<f64>]) -> Vec<bool> {
        let (old, new) = self.model.terms.split_at(before.len());
        let after = self.own_squares();
        let of_term = |(k, term): (usize, &Accepted)| {
            let beside = new.iter().any(|n| n.own.iter().any(|j| term.own.contains(j)));
            let kept = match (before[k], after[k]) {
                (Some(before), Some(after)) => after >= KEPT_BESIDE * before,
                _ => false,
            };
            beside || !kept
        };
        let mut doubted: Vec<bool> = old.iter().enumerate().map(of_term).collect();
        doubted.resize(self.model.terms.len(), true);
        doubted
    }

    /// The best explanation of the joints of a law that was taken out of the model: itself, another, or none.
    fn in_place_of(
        &mut self,
        old: &Accepted,
        settings: &Settings,
    ) -> Result<Option<Accepted>, SingularDesign> {
        let joint = (old.own.len() < self.model.slow.design.joints).then(|| old.own[0]);
        // Only candidates on its joint are looked at until all have been considered.
        self.model.refit()?;
        self.update(joint);
        // What was certain when it joined stays up to a higher level: its variation is estimated anew in each round.
        let lenient = Settings { least_confidence: settings.confidence_to_stay(), ..settings.clone() };
        let winner = self.best(&lenient, joint, 1)?.winner;
        let same = |w: &Winner| {
            let candidate = &self.candidates(w.window)[w.index];
            candidate.effect == old.effect && candidate.place == old.place
        };
        let holds = |w: &Winner| same(w) || w.confidence >= settings.least_confidence;
        let replacement = winner.filter(holds).map(|w| self.accept(&w));
        Ok(match replacement {
            Some(new) if new.effect == old.effect && new.place == old.place => Some(Accepted {
                shape: new.shape,
                modes: new.modes,
                explained_fraction: new.explained_fraction,
                rivals: new.rivals,
                ..old.clone()
            }),
            other => other,
        })
    }
}
