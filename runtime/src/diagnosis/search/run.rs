//! Forward selection of effects with refinement of their shapes, and backward pruning.
//!
//! Every candidate is judged after all standard parameters have been refitted with it, on motion that was held out.

use crate::diagnosis::candidates::candidate::make;
use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::hull::Curve;
use crate::diagnosis::large_error::LargeError;
use crate::diagnosis::outcome::StopReason;
use crate::diagnosis::rules::{HIGHEST_CONFIDENCE, KEPT_FRACTION};
use crate::diagnosis::search::body;
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::report::SearchReport;
use crate::diagnosis::search::round::Winner;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::search::term::{Accepted, Rival};
use crate::diagnosis::settings::{Progress, Settings};
use crate::effects::EffectKind;
use crate::far_off::{Number, Wrong};
use crate::parallel;

/// Probability that a rival which leaves as little leaves more by accident alone.
const LEAVES_AS_LITTLE: f64 = 0.5;

impl Search<'_> {
    /// Adds effects as long as one improves held-out motion; takes out what does not hold beside the others.
    ///
    /// # Errors
    /// [`SingularDesign`] where a model on the way has no fit.
    pub fn run(
        &mut self,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<SearchReport, SingularDesign> {
        let mut second_chance = true;
        loop {
            // 1. Forward: the best candidate that holds joins the model, until none does.
            let stop = self.extend(settings, progress)?;
            // What did not hold beside a model that still lacked other laws is tried once more beside the whole of it.
            if second_chance && !self.rejected.is_empty() {
                second_chance = false;
                self.rejected.clear();
                continue;
            }
            // 2. Cases of one more general law were found one after the other.
            self.generalise(&self.settings_of_next(settings))?;
            // 3. Backward: what does not hold beside the others is taken out, for good.
            progress.at(0.87, "pruning");
            let rejected = self.prune(settings)?;
            if rejected.is_empty() {
                // 5. Shapes were found one law after the other.
                self.model.sharpen()?;
                // 6. What is no larger than what nothing explains may be a part of that.
                self.take_out_small()?;
                // 7. Nor is anything named whose own numbers may be zero.
                self.take_out_uncertain(&self.settings_of_next(settings))?;
                // 8. What joined beside a law that is gone must be certain by itself.
                self.take_out_without_first(settings)?;
                // 9. Last, friction that has changed: it is free from the start, and no evidence for anything else.
                self.name_friction_changes(settings)?;
                return Ok(SearchReport { stop, removed: self.rejected.clone() });
            }
            // 4. What is left may now be explained by something else.
            self.rejected.extend(rejected);
            self.refit_and_update()?;
        }
    }

    /// Takes all laws out where none of them is certain enough to be the first.
    fn take_out_without_first(&mut self, settings: &Settings) -> Result<(), SingularDesign> {
        let terms = &mut self.model.terms;
        let is_first = |term: &Accepted| term.confidence >= settings.confidence_of_first(term.effect);
        if terms.is_empty() || terms.iter().any(is_first) {
            return Ok(());
        }
        self.rejected.append(terms);
        self.refit_and_update()
    }

    fn extend(&mut self, settings: &Settings, progress: &dyn Progress) -> Result<StopReason, SingularDesign> {
        while self.model.terms.len() < settings.most_effects {
            let settings = &self.settings_of_next(settings);
            let done = self.model.terms.len() as f64 / settings.most_effects as f64;
            progress.at(0.6 + 0.25 * done, "held-out tests");
            let mut round = self.best(settings, None, 1)?;
            // Compliant transmissions of neighbours ring alike: which one it is shows when both are tuned.
            if round.winner.as_ref().is_none_or(|w| self.candidates(w.window)[w.index].fixed.is_some())
                && self.polish()
            {
                round = self.best(settings, None, 1)?;
            }
            self.ties = round.ties;
            let found = match round.winner {
                Some(winner) => vec![self.accept(&winner)],
                None => self.pair(settings)?.map_or_else(Vec::new, Vec::from),
            };
            if !found.is_empty() {
                let before = self.own_squares();
                if self.join(found)? {
                    self.reconsider(&before, settings)?;
                }
                continue;
            }
            // What the catalogue has no law for.
            let Some(law) = self.free_form(settings)? else { return Ok(StopReason::NoneAccepted) };
            self.model.terms.push(law);
            self.refit_and_update()?;
            self.without_imitators(settings)?;
        }
        Ok(StopReason::EffectLimit(settings.most_effects))
    }

    /// Puts laws into the model, and says whether they stay: with columns that are made of parameters, as loads are, a model may
    /// leave more than it did without a law which bends the parameters. That law is left out for good.
    fn join(&mut self, laws: Vec<Accepted>) -> Result<bool, SingularDesign> {
        let follows = |term: &Accepted| term.effect.properties().follows_parameters;
        let without = self.model.terms.iter().any(follows).then(|| self.model.clone());
        let count = self.model.terms.len();
        self.model.terms.extend(laws);
        self.refit_and_update()?;
        let Some(without) = without else { return Ok(true) };
        let window = self.model.terms[count].effect.properties().window;
        if without.regression(window).gain_against(self.model.regression(window))? > 0.0 {
            return Ok(true);
        }
        let laws = std::mem::replace(&mut self.model, without).terms.split_off(count);
        self.rejected.extend(laws);
        self.update(None);
        Ok(false)
    }

    /// Takes the given effects as known, on a joint where one is given: only shapes and amplitudes are fitted.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn force(&mut self, known: &[(EffectKind, Option<usize>)]) -> Result<SearchReport, SingularDesign> {
        for &(effect, joint) in known {
            if let (EffectKind::FrictionLevelChange, Some(joint)) = (effect, joint) {
                self.take_friction_change(joint)?;
                continue;
            }
            if effect.form().fixed_amplitude().is_some() {
                self.polish();
            }
            let window = effect.properties().window;
            let regression = self.model.regression(window);
            let best = self
                .candidates(window)
                .iter()
                .enumerate()
                .filter(|(_, c)| c.effect == effect && joint.is_none_or(|j| c.own.contains(&j)))
                .filter_map(|(index, c)| Some((index, regression.judge(c)?)))
                .max_by(|a, b| a.1.gain.total_cmp(&b.1.gain));
            if let Some((index, verdict)) = best {
                let winner = Winner {
                    window,
                    index,
                    verdict,
                    significance: 0.0,
                    confidence: 0.5,
                    inflation: 1.0,
                    rivals: vec![],
                };
                let term = self.accept(&winner);
                self.model.terms.push(term);
                self.refit_and_update()?;
            }
        }
        self.model.sharpen()?;
        Ok(SearchReport { stop: StopReason::Given, removed: Vec::new() })
    }

    /// Takes numbers of joints for far off. Each has to earn its place beside all else, and others are found beside them.
    ///
    /// # Errors
    /// As [`Self::run`].
    pub fn take_large_error(&mut self, error: &LargeError) -> Result<(), SingularDesign> {
        let explained_fraction = 1.0 - error.left.exp();
        for &(number, by, ref rivals) in &error.numbers {
            let (effect, place) = number.law();
            let shape = match number.wrong {
                Wrong::Zero => vec![by],
                Wrong::Gain => {
                    self.model.factors[number.joint] = by.exp_m1();
                    Vec::new()
                }
            };
            let rival = |number: &Number| {
                let (effect, place) = number.law();
                let (shape, difference_p_value) = (Vec::new(), LEAVES_AS_LITTLE);
                Rival { effect, place, shape, explained_fraction, difference_p_value }
            };
            let (context, design) = (&self.model.context, &self.model.slow.design);
            let candidate =
                make(context, design, effect, place, std::slice::from_ref(&shape), self.model.change);
            self.model.terms.push(Accepted {
                shows_on: (0..design.joints).collect(),
                confidence: HIGHEST_CONFIDENCE,
                explained_fraction,
                rivals: rivals.iter().map(rival).collect(),
                ..Accepted::tried(&candidate, shape)
            });
        }
        self.refit_and_update()
    }

    /// Takes out what no longer earns its place beside the others, one after the other, and returns it.
    fn prune(&mut self, settings: &Settings) -> Result<Vec<Accepted>, SingularDesign> {
        let mut rejected = Vec::new();
        let mut from = 0;
        loop {
            // Beside the others as they are, all that come later can be asked at once.
            let left = self.model.terms.len().saturating_sub(from);
            let mut earned =
                parallel::map(self.threads(), left, |i| self.earns_its_place(from + i, settings));
            let Some(i) = earned.iter().position(|earned| !matches!(earned, Ok(true))) else {
                return Ok(rejected);
            };
            earned.swap_remove(i)?;
            from += i;
            rejected.push(self.model.terms.remove(from));
            self.model.refit()?;
        }
    }

    /// Whether the model is better with term k than without it.
    fn earns_its_place(&self, k: usize, settings: &Settings) -> Result<bool, SingularDesign> {
        let term = &self.model.terms[k];
        // What differs between days is no matter of held-out motion: there the friction of the day is fitted.
        if term.effect == EffectKind::FrictionLevelChange {
            return Ok(true);
        }
        // Beside what was found later it may be no body any more, as one half of two that cancel.
        if body::of_term(&self.model, term).is_some_and(|(_, is_one)| !is_one) {
            return Ok(false);
        }
        let window = term.effect.properties().window;
        let curves = self.model.regression(window).curves();
        let (with, model) = (held_out_error(&self.model, term, &curves)?, self.model.without(k)?);
        let (without, regression) = (held_out_error(&model, term, &curves)?, model.regression(window));
        if self.model.is_large_error(k) {
            // What the parameters beside it make of it is not what they make of it where they are fitted without.
            return Ok(with * with < (1.0 - KEPT_FRACTION * settings.least_share) * without * without);
        }
        let shape = std::slice::from_ref(&term.shape);
        let candidate =
            make(&model.context, &regression.design, term.effect, term.place, shape, model.change);
        let Some(verdict) = regression.judge(&candidate) else { return Ok(false) };
        let worth =
            verdict.explained_fraction >= KEPT_FRACTION * settings.least_share && verdict.total() > 0.0;
        let better = if regression.design.is_single_motion() {
            let seen = (0, &term.shows_on[..]);
            regression.predicts_rest_of_motion(&candidate, seen, verdict.explained_fraction)?
        } else {
            with < without
        };
        Ok(worth && better)
    }
}

/// Held-out error of the joints of a term, where these curves say something.
fn held_out_error(
    model: &ExtendedModel<'_>,
    term: &Accepted,
    curves: &[Curve],
) -> Result<f64, SingularDesign> {
    Ok(model.regression(term.effect.properties().window).held_out(false, curves)?.error_on(&term.shows_on))
}
