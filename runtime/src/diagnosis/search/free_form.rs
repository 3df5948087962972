//! What no law of the catalogue explains: a law over the variables that order it.
//!
//! It is tried on joints of which much stays unexplained when the catalogue has nothing more to say, and must explain
//! most of that. The fewest variables that do are taken: a second one must stand out of what blocks of motion differ by.
//! It passes the same gate as every law, all variables and pairs counted. A law of the catalogue that explains nearly as
//! much is not displaced by it; one that explains much less was its imitator.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::candidates::free_form::{Judged, Screened, screen};
use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::rules::{FREE_FORM_SHARE, NEARLY_AS_MUCH, RIVALS, SLOW_PART_OF_REMAINS, TOLD_APART};
use crate::diagnosis::search::round::Winner;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::search::term::{Accepted, Rival};
use crate::diagnosis::settings::Settings;
use crate::effects::{EffectKind, Place, SmoothingWindow};
use crate::parallel;

impl Search<'_> {
    /// A law over any variables that holds, where the catalogue has none.
    ///
    /// # Errors
    /// [`SingularDesign`] where a part of the motion has no fit.
    pub(in crate::diagnosis) fn free_form(
        &mut self,
        settings: &Settings,
    ) -> Result<Option<Accepted>, SingularDesign> {
        if !self.beyond_catalogue {
            return Ok(None);
        }
        let (model, regression) = (&self.model, &self.model.slow);
        let residual = regression.residual();
        let wanted = |j: usize| {
            let place = Place::Joint(j);
            settings.may_name(EffectKind::FreeForm, place)
                && !self.rejected.iter().any(|t| t.effect == EffectKind::FreeForm && t.place == place)
                && slow_part(regression, &residual, j) >= SLOW_PART_OF_REMAINS
        };
        let joints: Vec<usize> = (0..regression.design.joints).filter(|&j| wanted(j)).collect();
        let (mut chosen, mut tried): (Vec<(Judged, Vec<Rival>)>, usize) = (Vec::new(), 0);
        for j in joints {
            let screened = screen(&model.context, regression, j, model.change, self.threads());
            let tried_here = screened.tried;
            tried += tried_here;
            let firsts = [&screened.single, &screened.pairs].into_iter().filter_map(|list| list.first());
            let most = |(gain, share): (f64, f64), law: &Judged| {
                (gain.max(law.verdict.total()), share.max(law.verdict.explained_fraction))
            };
            let (most_gained, largest_share) = firsts.fold((0.0, 0.0), most);
            let least = settings.least_share.max(FREE_FORM_SHARE * slow_part(regression, &residual, j));
            let mut laws = fewest_variables(regression, screened, least);
            if laws.first().is_none_or(|law| law.verdict.explained_fraction < least) {
                continue;
            }
            if !self.catalogue_says(regression, &laws[0], [most_gained, largest_share], (j, tried_here)) {
                let rivals = not_told_from_first(regression, &laws, self.threads());
                chosen.push((laws.swap_remove(0), rivals));
            }
        }
        if chosen.is_empty() {
            return Ok(None);
        }
        let (first, places) = (self.slow.len(), chosen.len());
        let mut rivals = Vec::new();
        for (law, others) in chosen {
            rivals.push(others);
            self.slow.push(law.candidate);
        }
        self.more_tries = tried.saturating_sub(places);
        let winner = self.best(settings, None, 1).map(|round| round.winner);
        let found = winner.map(|winner| {
            winner.filter(|w| w.window == SmoothingWindow::Slow && w.index >= first).map(|w: Winner| {
                let mut term = self.as_term(&w);
                term.rivals.splice(0..0, std::mem::take(&mut rivals[w.index - first]));
                term
            })
        });
        self.more_tries = 0;
        self.slow.truncate(first);
        found
    }

    /// Whether a law of the catalogue on a joint explains nearly as much as the most that laws over any variables do (the gain, and
    /// the share), even where it is not certain or was told as small: what it says with fewer numbers is no new law. One that
    /// needs no more numbers than it, and is certainly ahead of it, is.
    fn catalogue_says(
        &self,
        regression: &Regression,
        law: &Judged,
        most: [f64; 2],
        (joint, tried): (usize, usize),
    ) -> bool {
        let small = |candidate: &Candidate| candidate.own.contains(&joint) && self.rival_of_small(candidate);
        let small = [SmoothingWindow::Slow, SmoothingWindow::Fast].into_iter().flat_map(|window| {
            let candidates = self.candidates(window).iter().filter(|c| small(c));
            candidates.filter_map(move |c| Some((window, c, self.model.regression(window).judge(c)?)))
        });
        let ranked = self.ranked(Some(joint));
        let ranked = ranked.iter().map(|r| (r.window, self.of(r).1, r.verdict.clone()));
        ranked.chain(small).any(|(window, candidate, verdict)| {
            // On rows of another width gains have other units, and those of more joints are of more.
            let is_nearly_as_much = if window == SmoothingWindow::Slow && candidate.own == [joint] {
                verdict.total() >= NEARLY_AS_MUCH * most[0]
            } else {
                verdict.explained_fraction >= NEARLY_AS_MUCH * most[1]
            };
            let numbers = || {
                let trial = &candidate.trials[verdict.trial];
                trial.shape.len() + trial.columns.len()
            };
            let is_ahead = || {
                let (law, rival) = ((&law.candidate, law.verdict.trial), (candidate, verdict.trial));
                regression.difference_p_value(law, rival) * tried as f64 <= TOLD_APART
            };
            let is_simpler =
                || window == SmoothingWindow::Slow && law.law.amplitudes() <= numbers() && is_ahead();
            is_nearly_as_much && !is_simpler()
        })
    }

    /// Takes out what the last term of the model, a law over any variables, shows to have been its imitators: laws of
    /// the catalogue on its joint that explain much less than it and do not hold beside it.
    ///
    /// # Errors
    /// As [`Self::free_form`].
    pub(in crate::diagnosis) fn without_imitators(
        &mut self,
        settings: &Settings,
    ) -> Result<(), SingularDesign> {
        let lenient = Settings { least_confidence: settings.confidence_to_stay(), ..settings.clone() };
        let mut k = 0;
        while k + 1 < self.model.terms.len() {
            let joint = self.model.terms[self.model.terms.len() - 1].own[0];
            let old = self.model.terms[k].clone();
            if !old.own.contains(&joint) || old.effect == EffectKind::FreeForm || self.suffices(k, joint)? {
                k += 1;
                continue;
            }
            self.model.terms.remove(k);
            self.refit_and_update()?;
            let alone = (old.own.len() < self.model.slow.design.joints).then_some(joint);
            let still = self.best(&lenient, alone, 1)?.winner.is_some_and(|w| {
                let candidate = &self.candidates(w.window)[w.index];
                candidate.effect == old.effect && candidate.place == old.place
            });
            if still {
                self.model.terms.insert(k, old);
                self.refit_and_update()?;
                k += 1;
            } else {
                self.rejected.push(old);
            }
        }
        Ok(())
    }

    /// Whether term `k` alone explains nearly as much of a joint's held-out motion as it and the last term together.
    fn suffices(&mut self, k: usize, joint: usize) -> Result<bool, SingularDesign> {
        let (terms, curves) = (self.model.terms.clone(), self.model.slow.curves());
        let mut left = |without: &[usize]| -> Result<f64, SingularDesign> {
            let keep = |i: &usize| !without.contains(i);
            self.model.terms = (0..terms.len()).filter(keep).map(|i| terms[i].clone()).collect();
            self.model.refit()?;
            Ok(self.model.slow.held_out(false, &curves)?.left[joint])
        };
        let last = terms.len() - 1;
        let (nothing, alone, both) = (left(&[k, last])?, left(&[last])?, left(&[])?);
        Ok(nothing - alone >= NEARLY_AS_MUCH * (nothing - both))
    }
}

/// The law over the fewest variables that explains at least so much and that no other is certainly ahead of, and after it the
/// others over as many, those that gain most first.
fn fewest_variables(regression: &Regression, screened: Screened, least: f64) -> Vec<Judged> {
    let Screened { single, pairs, tried } = screened;
    let ahead = |a: &Judged, b: &Judged| {
        let law = |j: &Judged| j.verdict.trial;
        let p = regression.difference_p_value((&a.candidate, law(a)), (&b.candidate, law(b)));
        a.verdict.total() > b.verdict.total() && p * tried as f64 <= TOLD_APART
    };
    let two = match (single.first(), pairs.first()) {
        (Some(one), Some(two)) => one.verdict.explained_fraction < least || ahead(two, one),
        (one, _) => one.is_none(),
    };
    if two { pairs } else { single }
}

/// Those of the next laws that cannot be told from the first.
fn not_told_from_first(regression: &Regression, laws: &[Judged], threads: usize) -> Vec<Rival> {
    let Some((best, others)) = laws.split_first() else { return Vec::new() };
    let others = &others[..others.len().min(RIVALS)];
    let differences = parallel::map(threads, others.len(), |k| {
        let [law, rival] = [best, &others[k]].map(|judged| (&judged.candidate, judged.verdict.trial));
        regression.difference_p_value(law, rival)
    });
    let rival = |(other, difference_p_value): (&Judged, f64)| Rival {
        effect: EffectKind::FreeForm,
        place: best.candidate.place,
        shape: other.law.shape(),
        explained_fraction: other.verdict.explained_fraction,
        difference_p_value,
    };
    others.iter().zip(differences).filter(|(_, p)| *p > TOLD_APART).map(rival).collect()
}

/// Part of a joint's residual that is the same two rows later, whose windows do not overlap: no more of it can depend on
/// what changes as slowly as the motion.
pub(in crate::diagnosis) fn slow_part(regression: &Regression, residual: &[f64], joint: usize) -> f64 {
    let design = &regression.design;
    let (mut products, mut squares) = (0.0, 0.0);
    for g in design.target_segments() {
        let range = design.ranges[joint][g].clone();
        let spacing = design.spacing(design.segments[g].signal);
        for t in range.start..range.end.saturating_sub(2) {
            if design.rows[t + 2].centre - design.rows[t].centre == 2 * spacing {
                products += residual[t] * residual[t + 2];
                squares += residual[t] * residual[t];
            }
        }
    }
    if squares > 0.0 { products / squares } else { 0.0 }
}

#[cfg(test)]
#[path = "free_form_tests.rs"]
mod tests;
