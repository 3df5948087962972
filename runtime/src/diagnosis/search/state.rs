//! Forward selection of effects with refinement of their shapes, and backward pruning.
//!
//! Every candidate is judged after all standard parameters have been refitted with it, on motion that was held back.

use crate::diagnosis::DiagnosisError;
use crate::diagnosis::candidates::candidate::{Candidate, Pace, build, make, pace, proposals};
use crate::diagnosis::candidates::spectrum::{order_spectrum, peaks};
use crate::diagnosis::candidates::trial::{columns, delay_columns, dense_columns};
use crate::diagnosis::judging::folds::{Fold, folds, single_motion};
use crate::diagnosis::judging::held_back::hold_back;
use crate::diagnosis::judging::judge::{holds_forward, judge};
use crate::diagnosis::judging::partial_regression::is_shown;
use crate::diagnosis::outcome::OrderSpectrum;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::{Fit, fit_weighted};
use crate::diagnosis::search::line::{JointLines, all_lines};
use crate::diagnosis::search::select::Winner;
use crate::diagnosis::settings::{Progress, Settings};
use crate::effects::{EffectKind, Form, Place};
use crate::parallel;

/// An accepted effect.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Accepted {
    pub effect: EffectKind,
    pub place: Place,
    pub own: Vec<usize>,
    pub shape: Vec<f64>,
    pub fixed: Option<f64>,
    pub significance: f64,
    pub confidence: f64,
    /// Share of what held-back motion left open when it was accepted: what its rivals' shares compare with.
    pub share: f64,
    pub rivals: Vec<Rival>,
}

/// Another explanation of what an accepted effect explains.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Rival {
    pub effect: EffectKind,
    pub place: Place,
    pub share: f64,
    /// Probability that it is only by accident that it explains less, where it holds at all and acts on the same
    /// joints; else 0.
    pub doubt: f64,
}

/// The rows at one pace with everything that is fitted on them.
pub(in crate::diagnosis) struct Side {
    pub design: Design,
    pub sigma: Vec<f64>,
    pub fit: Fit,
    pub folds: Vec<Fold>,
    pub candidates: Vec<Candidate>,
    /// y without any term of fixed amplitude.
    measured: Vec<f64>,
    /// Columns that are always there: base parameters and nuisances.
    fixed_columns: usize,
    /// Columns of each term; empty where its amplitude is fixed.
    pub term_columns: Vec<std::ops::Range<usize>>,
}

impl Side {
    fn refit(&mut self) {
        self.design.refresh_from(self.fixed_columns);
        self.fit = fit_weighted(&self.design, &mut self.sigma, |_| true);
        self.folds = folds(&self.design, &self.sigma);
    }

    /// Puts exactly these terms into the design.
    pub fn set_terms(&mut self, context: &Context<'_>, terms: &[Accepted], change: bool) {
        self.design.columns.truncate(self.fixed_columns);
        self.design.y.clone_from(&self.measured);
        self.term_columns.clear();
        for term in terms {
            let start = self.design.columns.len();
            for column in dense_columns(context, &self.design, term.effect, term.place, &term.shape, change) {
                match term.fixed {
                    Some(a) => self.design.y.iter_mut().zip(&column).for_each(|(y, c)| *y -= a * c),
                    None => self.design.push(column),
                }
            }
            self.term_columns.push(start..self.design.columns.len());
        }
        self.refit();
    }
}

/// The search's state and outcome.
pub(in crate::diagnosis) struct Search<'c, 'a> {
    pub context: &'c mut Context<'a>,
    pub slow: Side,
    pub fast: Side,
    pub terms: Vec<Accepted>,
    /// What was taken out again.
    pub rejected: Vec<Accepted>,
    /// Ripple that stands out as a line, per joint.
    pub lines: Vec<JointLines>,
    pub spectra: Vec<OrderSpectrum>,
    pub tried: usize,
    pub change: bool,
    slowest: Vec<f64>,
    pub threads: usize,
}

/// Effects whose columns follow the standard parameters.
fn follows_parameters(effect: EffectKind) -> bool {
    matches!(
        effect,
        EffectKind::LoadDependentFriction
            | EffectKind::TorqueConstantError
            | EffectKind::TorqueSaturation
            | EffectKind::FrictionLevelChange
    )
}

/// Largest error, in units of its number, along the way to which derivatives are taken.
const LARGEST_ERROR: f64 = 0.7;

impl<'c, 'a> Search<'c, 'a> {
    pub fn new(
        context: &'c mut Context<'a>,
        slow: Design,
        fast: Design,
        slowest: Vec<f64>,
        change: bool,
        settings: &Settings,
        progress: &dyn Progress,
    ) -> Result<Self, DiagnosisError> {
        let make_side = |mut design: Design, context: &Context<'_>| {
            for column in delay_columns(context, &design) {
                design.push(column);
            }
            design.refresh();
            let mut sigma = vec![1.0; design.joints];
            let fit = fit_weighted(&design, &mut sigma, |_| true);
            let folds = folds(&design, &sigma);
            let (measured, fixed_columns) = (design.y.clone(), design.columns.len());
            Side {
                design,
                sigma,
                fit,
                folds,
                candidates: Vec::new(),
                measured,
                fixed_columns,
                term_columns: vec![],
            }
        };
        let slow = make_side(slow, context);
        let fast = make_side(fast, context);
        let mut search = Self {
            context,
            slow,
            fast,
            terms: Vec::new(),
            rejected: Vec::new(),
            lines: Vec::new(),
            spectra: Vec::new(),
            tried: 0,
            change,
            slowest,
            threads: settings.threads,
        };
        search.propose(settings, progress);
        Ok(search)
    }

    /// Builds all candidates.
    fn propose(&mut self, settings: &Settings, progress: &dyn Progress) {
        progress.at(0.15, "order spectra");
        self.spectra = self.order_spectra();
        self.lines = all_lines(self.context, &self.spectra, &self.slowest, self.threads);
        let orders: Vec<Vec<f64>> = self.spectra.iter().map(|s| peaks(s, 2)).collect();
        let slow = proposals(self.context, Pace::Slow, self.change, &orders);
        let mut fast = proposals(self.context, Pace::Fast, self.change, &orders);
        if settings.fast_window >= settings.slow_window {
            // The recording is too slow to hold the ringing and the bursts of compliant transmissions.
            fast.retain(|(effect, ..)| !matches!(effect.form(), Form::Compliance(_)));
        }
        self.tried = slow.iter().chain(&fast).map(|p| p.2.len()).sum();
        let (context, change, threads) = (&*self.context, self.change, self.threads);
        self.slow.candidates = build(context, &self.slow.design, &slow, change, threads, &|done| {
            progress.at(0.2 + 0.15 * done, "slow effects");
        });
        self.fast.candidates = build(context, &self.fast.design, &fast, change, threads, &|done| {
            progress.at(0.35 + 0.2 * done, "fast effects");
        });
        // What this motion cannot show is not tried.
        for side in [&mut self.slow, &mut self.fast] {
            let (design, fit, sigma) = (&side.design, &side.fit, &side.sigma);
            side.candidates.retain(|c| is_shown(design, fit, sigma, c));
        }
    }

    fn order_spectra(&self) -> Vec<OrderSpectrum> {
        let context = &*self.context;
        let joint_of_frame = context.model.robot().joint_of_frame();
        let number = |j: usize| 1 + joint_of_frame.iter().position(|f| *f == Some(j)).unwrap_or(j);
        parallel::map(self.threads, self.slow.design.joints, |j| {
            let scale = context.scales[j];
            let residual: Vec<Vec<f64>> = context
                .signals
                .iter()
                .zip(&context.torques)
                .map(|(s, m)| s.torque[j].iter().zip(&m.total[j]).map(|(y, t)| y - t).collect())
                .collect();
            let slowest = 3.0 * self.slowest[j];
            order_spectrum(j, number(j), context.signals, &residual, scale.gear, scale.range, slowest)
        })
    }

    /// Adds effects as long as one improves held-back motion; takes out what does not hold beside the others.
    pub fn run(&mut self, settings: &Settings, progress: &dyn Progress) {
        loop {
            self.extend(settings, progress);
            progress.at(0.87, "pruning");
            let rejected = self.prune(settings);
            if rejected.is_empty() {
                break;
            }
            self.rejected.extend(rejected);
            self.settle();
        }
    }

    fn extend(&mut self, settings: &Settings, progress: &dyn Progress) {
        while self.terms.len() < settings.most_effects {
            let done = self.terms.len() as f64 / settings.most_effects as f64;
            progress.at(0.6 + 0.25 * done, "held-out tests");
            let mut winner = self.best(settings, None, 1);
            // Compliant transmissions of neighbours ring alike: which one it is shows when both are tuned.
            if winner.as_ref().is_none_or(|w| self.side(w.pace).candidates[w.index].fixed.is_some()) {
                self.polish(settings.threads);
                winner = self.best(settings, None, 1);
            }
            let found = match winner {
                Some(winner) => vec![self.accept(&winner)],
                None => match self.pair(settings) {
                    Some(pair) => pair.into(),
                    None => self.next_line().into_iter().collect(),
                },
            };
            if found.is_empty() {
                break;
            }
            self.terms.extend(found);
            self.settle();
            self.reconsider(settings);
        }
    }

    /// Takes the given effects as known, on a joint where one is given: only shapes and amplitudes are fitted.
    pub fn force(&mut self, known: &[(EffectKind, Option<usize>)]) {
        for &(effect, joint) in known {
            if matches!(effect.form(), Form::Compliance(_)) {
                self.polish(self.threads);
            }
            let which = pace(effect);
            let side = self.side(which);
            let best = side
                .candidates
                .iter()
                .enumerate()
                .filter(|(_, c)| c.effect == effect && joint.is_none_or(|j| c.own.contains(&j)))
                .filter_map(|(k, c)| {
                    judge(&side.design, &side.fit, &side.folds, &side.sigma, c).map(|v| (k, v))
                })
                .max_by(|a, b| a.1.gain.total_cmp(&b.1.gain));
            if let Some((index, verdict)) = best {
                let winner = Winner {
                    pace: which,
                    index,
                    verdict,
                    significance: 0.0,
                    confidence: 0.5,
                    rivals: vec![],
                };
                let term = self.accept(&winner);
                self.terms.push(term);
                self.settle();
            }
        }
    }

    /// Puts the terms into both designs, and lets loads follow the standard parameters.
    pub fn refit(&mut self) {
        let bent = self.terms.iter().any(|t| matches!(t.effect.form(), Form::Sensitivity(_)));
        for _ in 0..if bent { 4 } else { 2 } {
            self.slow.set_terms(self.context, &self.terms, self.change);
            let chi = self.slow.fit.chi.iter().take(self.slow.design.parameters).copied().collect();
            self.context.update(chi);
            // An error that is not small bends its own column: derivatives are taken along the way to it.
            for (term, columns) in self.terms.iter_mut().zip(&self.slow.term_columns) {
                if matches!(term.effect.form(), Form::Sensitivity(_)) {
                    term.shape = columns
                        .clone()
                        .map(|c| self.slow.fit.chi[c].clamp(-LARGEST_ERROR, LARGEST_ERROR))
                        .collect();
                }
            }
        }
        self.slow.set_terms(self.context, &self.terms, self.change);
        self.fast.set_terms(self.context, &self.terms, self.change);
    }

    /// Refits, and prepares the candidates for what is left.
    pub fn settle(&mut self) {
        self.refit();
        self.prepare(None);
    }

    /// Prepares the candidates, those on `joint` where one is given, for what the model as it is leaves.
    pub fn prepare(&mut self, joint: Option<usize>) {
        let (context, change) = (&*self.context, self.change);
        for side in [&mut self.slow, &mut self.fast] {
            let (design, first) = (&side.design, side.fixed_columns);
            parallel::for_each(self.threads, &mut side.candidates, |candidate| {
                if joint.is_some_and(|j| !candidate.own.contains(&j)) {
                    return;
                }
                for trial in &mut candidate.trials {
                    if follows_parameters(candidate.effect) {
                        trial.columns =
                            columns(context, design, candidate.effect, candidate.place, &trial.shape, change);
                        trial.refresh(design);
                    } else {
                        trial.refresh_from(design, first);
                    }
                }
            });
        }
    }

    /// What the model with all terms leaves of the torques on the rows of another design of the same motions.
    pub fn residual_on(&self, design: &Design) -> Vec<f64> {
        let mut residual = design.y.clone();
        let mut subtract = |column: &[f64], x: f64| {
            residual.iter_mut().zip(column).for_each(|(r, c)| *r -= c * x);
        };
        let chi = &self.slow.fit.chi;
        for (column, &x) in design.columns.iter().zip(chi.iter()) {
            subtract(column, x);
        }
        for column in delay_columns(self.context, design) {
            subtract(&column, chi[design.parameters]);
        }
        for (term, range) in self.terms.iter().zip(&self.slow.term_columns) {
            let columns =
                dense_columns(self.context, design, term.effect, term.place, &term.shape, self.change);
            for (k, column) in columns.iter().enumerate() {
                subtract(column, term.fixed.unwrap_or_else(|| chi[range.start + k]));
            }
        }
        residual
    }

    /// Candidates that are tried, each with all of its shapes.
    pub fn tries(&self) -> usize {
        self.slow.candidates.len() + self.fast.candidates.len()
    }

    /// Whether a candidate is in the model already, or has been taken out of it.
    pub fn settled(&self, candidate: &Candidate) -> bool {
        let same = |t: &Accepted| t.place == candidate.place && t.effect == candidate.effect;
        candidate.effect != EffectKind::TorqueRipple && self.terms.iter().any(same)
            || self.rejected.iter().any(same)
    }

    pub fn side(&self, pace: Pace) -> &Side {
        if pace == Pace::Slow { &self.slow } else { &self.fast }
    }

    /// The winner as a term, its shape refined on all motion.
    pub fn accept(&self, winner: &Winner) -> Accepted {
        let side = self.side(winner.pace);
        let mut term = self.as_term(winner);
        term.shape = self.refined(side, &side.candidates[winner.index], &term.shape);
        term
    }

    /// The winner as a term, with the shape of the grid.
    pub fn as_term(&self, winner: &Winner) -> Accepted {
        let candidate = &self.side(winner.pace).candidates[winner.index];
        Accepted {
            effect: candidate.effect,
            place: candidate.place,
            own: candidate.own.clone(),
            shape: candidate.trials[winner.verdict.trial].shape.clone(),
            fixed: candidate.fixed,
            significance: winner.significance,
            confidence: winner.confidence,
            share: winner.verdict.share,
            rivals: winner.rivals.clone(),
        }
    }

    /// With a new effect in the model an earlier one may turn out to have been its imitator: each is taken out, and
    /// the best explanation of its joints is put in its place.
    fn reconsider(&mut self, settings: &Settings) {
        if self.terms.len() < 2 {
            return;
        }
        for k in 0..self.terms.len() - 1 {
            let old = self.terms.remove(k);
            self.settle();
            let joint = (old.own.len() < self.slow.design.joints).then(|| old.own[0]);
            let replacement = self.best(settings, joint, 1).map(|w| self.accept(&w));
            let keep = match replacement {
                None if self.is_line(&old) => Some(old.clone()),
                Some(new) if new.effect == old.effect && new.place == old.place => {
                    Some(Accepted { shape: new.shape, share: new.share, rivals: new.rivals, ..old.clone() })
                }
                other => other,
            };
            if let Some(term) = keep {
                self.terms.insert(k, term);
                self.settle();
            } else {
                // What no longer holds is left out for good, or it might come and go for ever; those after it move up.
                self.rejected.push(old);
                return self.reconsider(settings);
            }
        }
    }

    /// Takes out what no longer earns its place beside the others, and returns it.
    fn prune(&mut self, settings: &Settings) -> Vec<Accepted> {
        let mut rejected = Vec::new();
        let mut k = 0;
        while k < self.terms.len() {
            let error = |search: &Self, term: &Accepted| {
                let side = search.side(pace(term.effect));
                hold_back(&side.design, &side.sigma, false).error_on(&term.own)
            };
            let with = error(self, &self.terms[k]);
            let term = self.terms.remove(k);
            self.refit();
            let without = error(self, &term);
            let side = self.side(pace(term.effect));
            let candidate = make(
                self.context,
                &side.design,
                term.effect,
                term.place,
                std::slice::from_ref(&term.shape),
                self.change,
            );
            let worth =
                judge(&side.design, &side.fit, &side.folds, &side.sigma, &candidate).is_some_and(|v| {
                    (v.share >= 0.6 * settings.least_share || self.is_line(&term)) && v.total() > 0.0
                });
            let better = if single_motion(&side.design) {
                holds_forward(&side.design, &side.sigma, &candidate, 0)
            } else {
                with < without
            };
            if worth && better {
                self.terms.insert(k, term);
                k += 1;
            } else {
                rejected.push(term);
            }
            self.refit();
        }
        rejected
    }
}
