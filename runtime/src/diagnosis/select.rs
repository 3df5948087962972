//! Which candidate of a round holds.

use super::candidate::{Candidate, Pace};
use super::evidence::{block_evidence, doubt, waveform_evidence};
use super::judge::{Verdict, holds_forward, judge, single_motion};
use super::parallel;
use super::search::{Rival, Search, Side};
use super::settings::Settings;
use super::significance::Evidence;
use crate::effects::EffectKind;

/// A law gives way to the one that it extends where that one makes this share of its gain.
const SIMPLER_DOES: f64 = 0.9;
/// Most candidates of a round whose evidence is worked out.
const MOST_CHECKED: usize = 30;

/// What passed a round: the side it is on, the candidate's index, and its verdict.
pub(super) struct Winner {
    pub pace: Pace,
    pub index: usize,
    pub verdict: Verdict,
    pub significance: f64,
    pub confidence: f64,
    pub rivals: Vec<Rival>,
}

impl Search<'_, '_> {
    /// The best candidate that holds, among those on `joint` where one is given.
    pub(super) fn best(&self, settings: &Settings, joint: Option<usize>) -> Option<Winner> {
        let mut ranked: Vec<(Pace, usize, Verdict)> = Vec::new();
        for which in [Pace::Slow, Pace::Fast] {
            let side = self.side(which);
            let verdicts = parallel::map(self.threads, side.candidates.len(), |index| {
                let candidate = &side.candidates[index];
                if joint.is_some_and(|j| !candidate.own.contains(&j)) || self.settled(candidate) {
                    return None;
                }
                judge(&side.design, &side.fit, &side.folds, &side.sigma, candidate)
            });
            ranked.extend(verdicts.into_iter().enumerate().filter_map(|(k, v)| Some((which, k, v?))));
        }
        ranked.sort_by(|a, b| b.2.total().total_cmp(&a.2.total()));
        let holding: Vec<usize> = (0..ranked.len())
            .filter(|&k| {
                let (which, index, verdict) = &ranked[k];
                let side = self.side(*which);
                holds(side, &side.candidates[*index], verdict, settings)
            })
            .take(MOST_CHECKED)
            .collect();
        let evidence = parallel::map(self.threads, holding.len(), |h| {
            let (which, index, verdict) = &ranked[holding[h]];
            let side = self.side(*which);
            self.evidence(side, &side.candidates[*index], verdict)
        });
        let own = |k: usize| &self.side(ranked[k].0).candidates[ranked[k].1].own;
        for (h, &k) in holding.iter().enumerate() {
            let (which, index, verdict) = &ranked[k];
            let side = self.side(*which);
            let candidate = &side.candidates[*index];
            // Whatever explains more of a joint than something that is no accident is no accident either.
            let confidence = (h..holding.len())
                .filter(|&l| *own(holding[l]) == candidate.own)
                .map(|l| evidence[l].1)
                .fold(0.0, f64::max);
            if confidence < settings.least_confidence {
                continue;
            }
            if single_motion(&side.design)
                && !holds_forward(&side.design, &side.sigma, candidate, verdict.trial, settings.least_share)
            {
                continue;
            }
            if self.simpler_does(&ranked, candidate, verdict) {
                continue;
            }
            let rivals = ranked
                .iter()
                .enumerate()
                .filter(|(i, (p, c, _))| {
                    *i != k && self.side(*p).candidates[*c].own.iter().any(|j| candidate.own.contains(j))
                })
                .take(5)
                .map(|(_, (p, c, v))| {
                    let rival = &self.side(*p).candidates[*c];
                    let comparable =
                        p == which && rival.own == candidate.own && holds(side, rival, v, settings);
                    let doubt = if comparable {
                        let (law, rival) = ((candidate, verdict.trial), (rival, v.trial));
                        doubt(&side.design, &side.fit, &side.folds, &side.sigma, law, rival)
                    } else {
                        0.0
                    };
                    Rival { effect: rival.effect, place: rival.place, share: v.share, doubt }
                })
                .collect();
            return Some(Winner {
                pace: *which,
                index: *index,
                verdict: verdict.clone(),
                significance: evidence[h].0.significance,
                confidence,
                rivals,
            });
        }
        None
    }

    /// Whether the simpler law of which this one is an extension explains nearly as much at the same place.
    fn simpler_does(&self, ranked: &[(Pace, usize, Verdict)], more: &Candidate, verdict: &Verdict) -> bool {
        let Some(simpler) = simpler_than(more.effect) else { return false };
        ranked.iter().any(|(which, index, found)| {
            let candidate = &self.side(*which).candidates[*index];
            candidate.effect == simpler
                && candidate.place == more.place
                && found.total() > SIMPLER_DOES * verdict.total()
        })
    }

    /// Evidence for a candidate, and the confidence that it gives after all that was tried.
    fn evidence(&self, side: &Side, candidate: &Candidate, verdict: &Verdict) -> (Evidence, f64) {
        let tries = self.slow.candidates.len() + self.fast.candidates.len();
        let found = if candidate.fixed.is_some() {
            waveform_evidence(&side.design, &side.fit, &side.sigma, candidate, verdict.trial)
        } else {
            block_evidence(&side.design, &side.fit, &side.folds, &side.sigma, candidate, verdict)
        };
        // Free shapes are chosen on other motion than they are judged on; those of a waveform, and of a single
        // motion's stretches, are not.
        let chosen_here = candidate.fixed.is_some() || single_motion(&side.design);
        (found, found.confidence(if chosen_here { tries * candidate.trials.len() } else { tries }))
    }
}

/// The law that another one extends, and that it comes back to where its own number vanishes.
fn simpler_than(effect: EffectKind) -> Option<EffectKind> {
    match effect {
        // Play is one number more than a spring.
        EffectKind::Backlash => Some(EffectKind::JointElasticity),
        // A level that changes slowly, against one that has changed since the baseline.
        EffectKind::FrictionDrift => Some(EffectKind::FrictionLevelChange),
        _ => None,
    }
}

fn holds(side: &Side, candidate: &Candidate, verdict: &Verdict, settings: &Settings) -> bool {
    let positive = verdict.held_out.iter().filter(|g| **g > 0.0).count();
    let folds = verdict.held_out.len();
    // Of many stretches of one motion a few may be untouched by an effect.
    let needed = if candidate.fixed.is_some() {
        folds / 2 + 1
    } else if side.design.in_stretches() {
        folds - folds / 4
    } else {
        folds - folds / 6
    };
    // A gain in prediction without one in the fit is an accident of extrapolation.
    verdict.share >= settings.least_share
        && verdict.fitted_share >= 0.5 * settings.least_share
        && positive >= needed
}
