//! Laws that explain a change of friction as well as another level of it does, or better.
//!
//! Friction is free in the recording from the start, and a law is asked what it explains beyond that. One that friction makes
//! most of, as friction that bends does, is then seen by its smallest part, while the change itself is certain: which of the
//! two it is called is another question, asked of both in the same place.

use crate::diagnosis::candidates::candidate::{Candidate, make};
use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::judge::Verdict;
use crate::diagnosis::rules::{COMPARABLE, RIVALS, TOLD_APART};
use crate::diagnosis::search::bends::is_bend;
use crate::diagnosis::search::friction_change::Changed;
use crate::diagnosis::search::round::{Ranked, Winner};
use crate::diagnosis::search::state::Search;
use crate::diagnosis::search::term::{Accepted, Rival};
use crate::diagnosis::settings::Settings;
use crate::effects::{EffectKind, EffectTerm, Place, SmoothingWindow};

/// What there is in the place of a change of the level of friction.
pub(super) enum InPlaceOfLevel {
    /// A law that explains more.
    Law(Box<Accepted>),
    /// Nothing better; laws that explain no less but by accident.
    Level(Vec<Rival>),
}

/// A change of the level of friction on the rows of a window.
struct Level {
    window: SmoothingWindow,
    candidate: Candidate,
    verdict: Option<Verdict>,
}

impl Search<'_> {
    /// Compares a change of the friction of a joint from these viscous and Coulomb coefficients, as certain as `found`, with the
    /// laws that act on the joint, each in the place of the friction that is free in the recording. Where one of them is
    /// better that friction is no longer free; else the model is as it was.
    ///
    /// # Errors
    /// [`SingularDesign`] where the model without that friction has no fit.
    pub(super) fn in_place_of_level(
        &mut self,
        found: &Changed,
        before: [f64; 2],
        settings: &Settings,
    ) -> Result<InPlaceOfLevel, SingularDesign> {
        let &Changed { joint, significance, confidence, .. } = found;
        let inflation = self.inflation_of_friction(joint, significance);
        let with_level = self.model.clone();
        self.take_over_friction(joint, 2);
        self.model.refit()?;
        self.update(Some(joint));
        let levels = [SmoothingWindow::Slow, SmoothingWindow::Fast].map(|w| self.level(joint, before, w));
        let mut ranked = self.ranked(Some(joint));
        let level_of = |law: &Ranked| levels.iter().find(|level| level.window == law.window);
        // What explains much less is not in the way of the others.
        ranked.retain(|law| {
            let gain = level_of(law).and_then(|level| Some(level.verdict.as_ref()?.gain));
            gain.is_some_and(|gain| law.verdict.gain >= COMPARABLE * gain) && self.may_be(law, settings)
        });
        let holding = self.holding(&ranked, settings);
        let ahead = |&k: &usize| {
            let accident = level_of(&ranked[k]).map_or(1.0, |level| self.ahead_of_level(&ranked[k], level));
            ranked.len() as f64 * accident <= TOLD_APART
        };
        if let Some(k) = holding.iter().copied().find(ahead) {
            let Ranked { window, index, ref verdict } = ranked[k];
            return Ok(InPlaceOfLevel::Law(Box::new(self.accept(&Winner {
                window,
                index,
                verdict: verdict.clone(),
                significance,
                confidence,
                inflation,
                rivals: self.rivals(&ranked, k, settings),
            }))));
        }
        let rival = |&k: &usize| {
            let (law, candidate) = (&ranked[k], self.of(&ranked[k]).1);
            let difference_p_value = level_of(law).map_or(0.0, |level| self.behind_level(law, level));
            let explained_fraction = law.verdict.explained_fraction;
            let (effect, place, shape) = (candidate.effect, candidate.place, Vec::new());
            Rival { effect, place, shape, explained_fraction, difference_p_value }
        };
        let rivals =
            holding.iter().take(RIVALS).map(rival).filter(|r| r.difference_p_value > TOLD_APART).collect();
        self.model = with_level;
        self.update(Some(joint));
        Ok(InPlaceOfLevel::Level(rivals))
    }

    /// A change of the level of a joint's friction on the rows of a window.
    fn level(&self, joint: usize, before: [f64; 2], window: SmoothingWindow) -> Level {
        let (effect, place) = (EffectKind::FrictionLevelChange, Place::Joint(joint));
        let regression = self.model.regression(window);
        let shape = [before.to_vec()];
        let candidate =
            make(&self.model.context, &regression.design, effect, place, &shape, self.model.change);
        let verdict = regression.judge(&candidate);
        Level { window, candidate, verdict }
    }

    /// Whether a law may be named, and is a new one: what the friction of a joint does in the baseline it does more of where there
    /// is more of it, and that is its level.
    fn may_be(&self, law: &Ranked, settings: &Settings) -> bool {
        let Candidate { effect, place, .. } = *self.of(law).1;
        let stands = |term: &EffectTerm| {
            term.place == place && (term.effect == effect || is_bend(term.effect) && is_bend(effect))
        };
        let mut before = self.model.context.reference.iter().flat_map(|reference| reference.standing());
        settings.may_name(effect, place) && !before.any(stands) && self.can_be(law, 1.0)
    }

    /// Probability that a law explains more than a level by accident.
    fn ahead_of_level(&self, law: &Ranked, level: &Level) -> f64 {
        let (regression, candidate) = self.of(law);
        regression.difference_p_value((candidate, law.verdict.trial), (&level.candidate, 0))
    }

    /// Probability that a law explains less than a level by accident.
    fn behind_level(&self, law: &Ranked, level: &Level) -> f64 {
        let (regression, candidate) = self.of(law);
        regression.difference_p_value((&level.candidate, 0), (candidate, law.verdict.trial))
    }
}
