//! What a search works on: the model as it is, the candidates on the rows of both windows, and what was taken out.

use crate::diagnosis::candidates::candidate::{Candidate, build, proposals};
use crate::diagnosis::candidates::spectrum::{order_spectrum, peaks};
use crate::diagnosis::candidates::trial::columns;
use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::objection::Objection;
use crate::diagnosis::outcome::OrderSpectrum;
use crate::diagnosis::rows::signals::Signals;
use crate::diagnosis::rules::{PEAKS, SPECTRUM_STANDSTILL_FACTOR};
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::line::{JointLines, all_lines};
use crate::diagnosis::search::round::Tie;
use crate::diagnosis::search::small_law::SmallLaw;
use crate::diagnosis::search::term::{Accepted, Law};
use crate::diagnosis::settings::{Progress, Settings};
use crate::effects::{EffectKind, Place, SmoothingWindow, UserLaw};
use crate::model::JointIndex;
use crate::parallel;

/// The search's state.
pub(in crate::diagnosis) struct Search<'a> {
    pub model: ExtendedModel<'a>,
    /// Laws of the user that this motion cannot show.
    pub untried: Vec<UserLaw>,
    /// Candidates on the slow rows.
    pub slow: Vec<Candidate>,
    /// Candidates on the fast rows.
    pub fast: Vec<Candidate>,
    /// What was taken out again.
    pub rejected: Vec<Accepted>,
    /// Laws that the last round could not tell from one on another joint.
    pub ties: Vec<Tie>,
    /// Whether laws over any variables are tried where the catalogue has none.
    pub beyond_catalogue: bool,
    /// What is certainly there and too small to be named: friction that changed, laws that are no larger than what stays
    /// unexplained.
    pub small: Vec<SmallLaw>,
    pub spectra: Vec<OrderSpectrum>,
    /// Ripple that stands out as a line, per joint.
    pub lines: Vec<JointLines>,
    /// Effects at places, with all of their shapes.
    pub tried: usize,
    /// Laws that were tried beside the candidates, to find some of these.
    pub more_tries: usize,
    /// Laws beside which the shapes of compliant transmissions have been refined: refined once more they end where they
    /// are.
    pub(super) polished_beside: Vec<Vec<Law>>,
}

impl<'a> Search<'a> {
    /// Builds all candidates; `slowest` are the speeds of standstill, per joint.
    pub fn new(
        model: ExtendedModel<'a>,
        slowest: &[f64],
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Self {
        progress.at(0.15, "order spectra");
        let (threads, change) = (model.context.threads, model.change);
        let spectra = order_spectra(&model, slowest, threads);
        let mut lines = all_lines(&model.context, &spectra, slowest, threads);
        for (j, lines) in lines.iter_mut().enumerate() {
            if !settings.may_name(EffectKind::TorqueRipple, Place::Joint(j)) {
                lines.lines.clear();
            }
        }
        let orders: Vec<Vec<f64>> = spectra.iter().map(|s| peaks(s, PEAKS)).collect();
        let context = &model.context;
        let seen = (orders.as_slice(), settings.laws.as_slice());
        let slow = proposals(context, SmoothingWindow::Slow, change, seen);
        let mut fast = proposals(context, SmoothingWindow::Fast, change, seen);
        if settings.fast_window >= settings.slow_window {
            // The recording is too slow to hold the ringing and the bursts of compliant transmissions.
            fast.retain(|(effect, ..)| !effect.form().is_fast_only());
        }
        let tried = slow.iter().chain(&fast).map(|p| p.2.len()).sum();
        let mut slow = build(context, &model.slow.design, &slow, change, threads, &|done| {
            progress.at(0.2 + 0.15 * done, "slow effects");
        });
        let mut fast = build(context, &model.fast.design, &fast, change, threads, &|done| {
            progress.at(0.35 + 0.2 * done, "fast effects");
        });
        // What this motion cannot show is not tried.
        let wanted = |c: &Candidate| !settings.excluded.contains(&(c.effect, c.place));
        slow.retain(|c| wanted(c) && model.slow.is_identifiable(c));
        fast.retain(|c| wanted(c) && model.fast.is_identifiable(c));
        let is_tried = |law: &UserLaw| slow.iter().any(|c: &Candidate| c.place == Place::Law(*law));
        let untried = settings.laws.iter().copied().filter(|law| !is_tried(law)).collect();
        Self {
            model,
            untried,
            slow,
            fast,
            rejected: Vec::new(),
            ties: Vec::new(),
            beyond_catalogue: false,
            small: Vec::new(),
            spectra,
            lines,
            tried,
            more_tries: 0,
            polished_beside: Vec::new(),
        }
    }

    /// Goes on from a model without effects with what was found, but for what there are objections to: where that is still
    /// possible it stays a rival of others. Changes of friction and transients come last, and so once more.
    ///
    /// # Errors
    /// [`SingularDesign`] where there is no fit.
    pub fn go_on_without(
        &mut self,
        objections: &[Objection],
        without_effects: ExtendedModel<'a>,
    ) -> Result<(), SingularDesign> {
        let against = |law: (EffectKind, Place)| objections.iter().find(|o| (o.effect, o.place) == law);
        let mut found = std::mem::replace(&mut self.model, without_effects).terms;
        found.retain(|t| {
            t.effect != EffectKind::FrictionLevelChange
                && !t.is_transient
                && against((t.effect, t.place)).is_none()
        });
        self.model.terms = found;
        self.rejected.clear();
        self.ties.clear();
        self.small.clear();
        for candidates in [&mut self.slow, &mut self.fast] {
            candidates.retain(|c| against((c.effect, c.place)).is_none_or(|o| o.still_possible));
        }
        for (j, lines) in self.lines.iter_mut().enumerate() {
            if against((EffectKind::TorqueRipple, Place::Joint(j))).is_some() {
                lines.lines.clear();
            }
        }
        self.refit_and_update()
    }

    /// Threads to work on.
    pub(super) fn threads(&self) -> usize {
        self.model.context.threads
    }

    /// Settings with the confidence that the next law needs.
    pub fn settings_of_next(&self, settings: &Settings) -> Settings {
        if self.model.terms.is_empty() { settings.clone() } else { settings.beside_laws() }
    }

    /// The candidates on the rows of a window.
    pub fn candidates(&self, window: SmoothingWindow) -> &[Candidate] {
        match window {
            SmoothingWindow::Slow => &self.slow,
            SmoothingWindow::Fast => &self.fast,
        }
    }

    /// One of them.
    pub fn candidate_mut(&mut self, window: SmoothingWindow, index: usize) -> &mut Candidate {
        match window {
            SmoothingWindow::Slow => &mut self.slow[index],
            SmoothingWindow::Fast => &mut self.fast[index],
        }
    }

    /// Refits the model, and prepares the candidates for what it leaves.
    ///
    /// # Errors
    /// [`SingularDesign`] where there is no fit.
    pub fn refit_and_update(&mut self) -> Result<(), SingularDesign> {
        self.model.refit()?;
        self.update(None);
        Ok(())
    }

    /// Prepares the candidates, those on `joint` where one is given, for what the model as it is leaves.
    pub fn update(&mut self, joint: Option<usize>) {
        let model = &self.model;
        for (candidates, regression) in [(&mut self.slow, &model.slow), (&mut self.fast, &model.fast)] {
            let (design, first) = (&regression.design, regression.fixed_columns());
            parallel::for_each(model.context.threads, candidates, |candidate| {
                if joint.is_some_and(|j| !candidate.own.contains(&j)) {
                    return;
                }
                let (effect, place) = (candidate.effect, candidate.place);
                for trial in &mut candidate.trials {
                    if effect.properties().follows_parameters {
                        trial.columns =
                            columns(&model.context, design, effect, place, &trial.shape, model.change);
                        trial.refresh(design);
                    } else {
                        trial.refresh_from(design, first);
                    }
                }
            });
        }
    }

    /// Candidates that are tried, each with all of its shapes.
    pub fn tries(&self) -> usize {
        self.slow.len() + self.fast.len() + self.more_tries
    }

    /// Whether a candidate of the catalogue could only take the place of a law that was told as small: all that hold beside
    /// it were in the model when it was taken out.
    pub(super) fn rival_of_small(&self, candidate: &Candidate) -> bool {
        let free = candidate.effect == EffectKind::FreeForm;
        !self.model.change && !free && self.small.iter().any(|s| s.own == candidate.own)
    }

    /// Whether a candidate is in the model already, or has been taken out of it.
    pub fn is_excluded(&self, candidate: &Candidate) -> bool {
        let same = |t: &Accepted| t.place == candidate.place && t.effect == candidate.effect;
        // Where the special case was enough, the general one would take its place by what is left of it.
        let simpler = |t: &Accepted| candidate.effect.special_cases().any(|s| s == t.effect);
        // What a special case has beside its general law is what that one leaves, and would take its place in turn.
        let more_general = |t: &Accepted| t.effect.special_cases().any(|s| s == candidate.effect);
        let related = |t: &Accepted| t.place == candidate.place && (simpler(t) || more_general(t));
        if self.model.terms.iter().any(related) {
            return true;
        }
        !candidate.effect.properties().repeats && self.model.terms.iter().any(same)
            || self.rejected.iter().any(same)
            || self.rival_of_small(candidate)
    }
}

/// Order spectra of what the standard model leaves of each joint's torque.
fn order_spectra(model: &ExtendedModel<'_>, slowest: &[f64], threads: usize) -> Vec<OrderSpectrum> {
    let context = &model.context;
    parallel::map(threads, model.slow.design.joints, |j| {
        let of_motion = |(k, s): (usize, &Signals)| -> Vec<f64> {
            s.torque[j].iter().zip(&context.torques(k).total[j]).map(|(y, t)| y - t).collect()
        };
        let residual: Vec<Vec<f64>> = context.signals.iter().enumerate().map(of_motion).collect();
        let scale = &context.scales[j];
        let slowest = SPECTRUM_STANDSTILL_FACTOR * slowest[j];
        let mut spectrum = order_spectrum(j, context.signals, &residual, scale, slowest);
        spectrum.joint = context.model.robot().joint_number(JointIndex(j)).0;
        spectrum
    })
}
