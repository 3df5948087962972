//! Several laws of one joint that are cases of a more general one.
//!
//! A search that goes forward takes the simpler law first, and what is left of the general one then looks like another of
//! its cases: a drive that loses power only where it drives the load is half friction that grows with the load and half
//! a wrong torque constant. One law that explains what its cases explain together is named in their place, and in that of
//! a law over any variables that was what they left.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::rules::KEPT_BESIDE;
use crate::diagnosis::search::gate::{Outcome, RoundEvidence};
use crate::diagnosis::search::round::Winner;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::search::term::Accepted;
use crate::diagnosis::settings::Settings;
use crate::effects::{EffectKind, Place, SmoothingWindow, named};

impl Search<'_> {
    /// Names one law where two or more of its cases, or it and one of them, were found at the same place.
    ///
    /// # Errors
    /// [`SingularDesign`] where a model on the way has no fit.
    pub(in crate::diagnosis) fn generalise(&mut self, settings: &Settings) -> Result<(), SingularDesign> {
        for general in EffectKind::ALL.into_iter().filter(|e| e.special_cases().next().is_some()) {
            let places: Vec<Place> = self.model.terms.iter().map(|t| t.place).collect();
            for (i, &place) in places.iter().enumerate() {
                if places[..i].contains(&place) {
                    continue;
                }
                let is_case = |t: &Accepted| {
                    let effect = named(t.effect, t.place, &t.shape);
                    let one_of = effect == general || general.special_cases().any(|s| s == effect);
                    t.place == place && one_of
                };
                let what_they_left = |t: &Accepted| t.effect == EffectKind::FreeForm && t.place == place;
                let count =
                    |part: &dyn Fn(&Accepted) -> bool| self.model.terms.iter().filter(|t| part(t)).count();
                let (cases, free) = (count(&is_case), count(&what_they_left));
                let window = general.properties().window;
                let law = |search: &mut Self| search.one_law((general, place), settings);
                let all = |t: &Accepted| is_case(t) || what_they_left(t);
                if cases > 0 && free > 0 && self.put_in_place_of(&all, window, law)? {
                    continue;
                }
                if cases > 1 {
                    self.put_in_place_of(&is_case, window, law)?;
                }
            }
        }
        self.one_curve(settings)
    }

    /// Puts one law in the place of several, if it passes the gate without them and explains as much. Whether it did.
    pub(super) fn put_in_place_of(
        &mut self,
        is_case: &dyn Fn(&Accepted) -> bool,
        window: SmoothingWindow,
        law: impl FnOnce(&mut Self) -> Option<Accepted>,
    ) -> Result<bool, SingularDesign> {
        let sigma = self.model.regression(window).sigma.clone();
        let left = |search: &Self| {
            let regression = search.model.regression(window);
            let residual = regression.residual();
            let of_joint = |(j, s): (usize, &f64)| {
                regression.design.of_joint(j).map(|r| residual[r] * residual[r]).sum::<f64>() / (s * s)
            };
            sigma.iter().enumerate().map(of_joint).sum::<f64>()
        };
        let (before, with_cases) = (self.model.terms.clone(), left(self));
        let first = before.iter().position(is_case).unwrap_or(0);
        self.model.terms.retain(|t| !is_case(t));
        self.refit_and_update()?;
        let without = left(self);
        if let Some(law) = law(self) {
            self.model.terms.insert(first, law);
            self.refit_and_update()?;
            if without - left(self) >= KEPT_BESIDE * (without - with_cases) {
                return Ok(true);
            }
        }
        self.model.terms = before;
        self.refit_and_update()?;
        Ok(false)
    }

    /// The law of a place beside the model as it is, if it passes the gate.
    pub(super) fn one_law(&self, law: (EffectKind, Place), settings: &Settings) -> Option<Accepted> {
        if !settings.may_name(law.0, law.1) {
            return None;
        }
        let ranked = self.ranked(None);
        let k = ranked.iter().position(|r| {
            let candidate = self.of(r).1;
            (candidate.effect, candidate.place) == law
        })?;
        let least_confidence = settings.confidence_to_stay();
        let round = RoundEvidence::new(ranked.len());
        let Outcome::Passes { confidence, significance, inflation } =
            self.judged_by_gate(&round, &ranked, k, least_confidence)
        else {
            return None;
        };
        Some(self.accept(&Winner {
            window: ranked[k].window,
            index: ranked[k].index,
            verdict: ranked[k].verdict.clone(),
            significance,
            confidence,
            inflation,
            rivals: self.rivals(&ranked, k, settings),
        }))
    }
}
