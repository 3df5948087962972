//! Which candidate of a round holds.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::judging::evidence::{block_evidence, doubt, waveform_evidence};
use crate::diagnosis::judging::folds::single_motion;
use crate::diagnosis::judging::judge::{Verdict, holds_forward, judge};
use crate::diagnosis::judging::significance::Evidence;
use crate::diagnosis::search::state::{Rival, Search, Side};
use crate::diagnosis::settings::Settings;
use crate::effects::SmoothingWindow;
use crate::parallel;

/// A law gives way to the one that it extends where that one makes this share of its gain.
const SIMPLER_DOES: f64 = 0.9;
/// Most candidates of a round whose evidence is worked out.
const MOST_CHECKED: usize = 30;

/// What passed a round: the side it is on, the candidate's index, and its verdict.
pub(in crate::diagnosis) struct Winner {
    pub pace: SmoothingWindow,
    pub index: usize,
    pub verdict: Verdict,
    pub significance: f64,
    pub confidence: f64,
    pub rivals: Vec<Rival>,
}

/// A candidate of a round: the side it is on, its index there, and its verdict.
pub(in crate::diagnosis) struct Ranked {
    pub pace: SmoothingWindow,
    pub index: usize,
    pub verdict: Verdict,
}

impl Search<'_, '_> {
    /// The best candidate that holds, among those on `joint` where one is given; the candidates have been looked
    /// through `rounds` times.
    pub(in crate::diagnosis) fn best(
        &self,
        settings: &Settings,
        joint: Option<usize>,
        rounds: usize,
    ) -> Option<Winner> {
        let ranked = self.ranked(joint);
        let holding = self.holding(&ranked, settings);
        let tries = rounds * self.tries();
        for (h, (k, evidence)) in holding.iter().enumerate() {
            let (side, candidate) = self.of(&ranked[*k]);
            let verdict = &ranked[*k].verdict;
            // Whatever explains more of a joint than something that is no accident is no accident either.
            let confidence = holding[h..]
                .iter()
                .filter(|(l, _)| self.of(&ranked[*l]).1.own == candidate.own)
                .map(|(_, evidence)| evidence.confidence(tries))
                .fold(0.0, f64::max);
            if confidence < settings.least_confidence {
                continue;
            }
            if single_motion(&side.design)
                && !holds_forward(&side.design, &side.sigma, candidate, verdict.trial)
            {
                continue;
            }
            if self.simpler_does(&ranked, candidate, verdict) {
                continue;
            }
            return Some(Winner {
                pace: ranked[*k].pace,
                index: ranked[*k].index,
                verdict: verdict.clone(),
                significance: evidence.significance,
                confidence,
                rivals: self.rivals(&ranked, *k, settings),
            });
        }
        None
    }

    /// Candidates, on `joint` where one is given, that are not settled: those that gain most on held-back motion first.
    pub(in crate::diagnosis) fn ranked(&self, joint: Option<usize>) -> Vec<Ranked> {
        let mut ranked = Vec::new();
        for pace in [SmoothingWindow::Slow, SmoothingWindow::Fast] {
            let side = self.side(pace);
            let verdicts = parallel::map(self.threads, side.candidates.len(), |index| {
                let candidate = &side.candidates[index];
                if joint.is_some_and(|j| !candidate.own.contains(&j)) || self.settled(candidate) {
                    return None;
                }
                judge(&side.design, &side.fit, &side.folds, &side.sigma, candidate)
            });
            let judged = verdicts.into_iter().enumerate();
            ranked.extend(judged.filter_map(|(index, v)| Some(Ranked { pace, index, verdict: v? })));
        }
        ranked.sort_by(|a, b| b.verdict.total().total_cmp(&a.verdict.total()));
        ranked
    }

    /// The first of them that hold, by their place in the ranking, and the evidence for each.
    pub(in crate::diagnosis) fn holding(
        &self,
        ranked: &[Ranked],
        settings: &Settings,
    ) -> Vec<(usize, Evidence)> {
        let holding: Vec<usize> = (0..ranked.len())
            .filter(|&k| {
                let (side, candidate) = self.of(&ranked[k]);
                holds(side, candidate, &ranked[k].verdict, settings)
            })
            .take(MOST_CHECKED)
            .collect();
        let evidence = parallel::map(self.threads, holding.len(), |h| self.evidence(&ranked[holding[h]]));
        holding.into_iter().zip(evidence).collect()
    }

    pub(in crate::diagnosis) fn of(&self, ranked: &Ranked) -> (&Side, &Candidate) {
        let side = self.side(ranked.pace);
        (side, &side.candidates[ranked.index])
    }

    pub(in crate::diagnosis) fn evidence(&self, ranked: &Ranked) -> Evidence {
        let (side, candidate) = self.of(ranked);
        if candidate.fixed.is_some() {
            waveform_evidence(&side.design, &side.fit, &side.sigma, candidate, ranked.verdict.trial)
        } else {
            block_evidence(&side.design, &side.fit, &side.folds, &side.sigma, candidate, &ranked.verdict)
        }
    }

    /// Other explanations of the joints of a candidate.
    fn rivals(&self, ranked: &[Ranked], winner: usize, settings: &Settings) -> Vec<Rival> {
        let (side, candidate) = self.of(&ranked[winner]);
        ranked
            .iter()
            .enumerate()
            .filter(|(k, r)| *k != winner && self.of(r).1.own.iter().any(|j| candidate.own.contains(j)))
            .take(5)
            .map(|(_, other)| {
                let rival = self.of(other).1;
                let comparable = other.pace == ranked[winner].pace
                    && rival.own == candidate.own
                    && holds(side, rival, &other.verdict, settings);
                let doubt = if comparable {
                    let law = (candidate, ranked[winner].verdict.trial);
                    let rival = (rival, other.verdict.trial);
                    doubt(&side.design, &side.fit, &side.folds, &side.sigma, law, rival)
                } else {
                    0.0
                };
                Rival { effect: rival.effect, place: rival.place, share: other.verdict.share, doubt }
            })
            .collect()
    }

    /// Whether the simpler law of which this one is an extension explains nearly as much at the same place.
    fn simpler_does(&self, ranked: &[Ranked], more: &Candidate, verdict: &Verdict) -> bool {
        let Some(simpler) = more.effect.special_case() else { return false };
        ranked.iter().any(|other| {
            let candidate = self.of(other).1;
            candidate.effect == simpler
                && candidate.place == more.place
                && other.verdict.total() > SIMPLER_DOES * verdict.total()
        })
    }
}

/// Whether a candidate explains enough, nearly everywhere, of what was fitted and of what was held back.
fn holds(side: &Side, candidate: &Candidate, verdict: &Verdict, settings: &Settings) -> bool {
    let positive = verdict.held_out.iter().filter(|g| **g > 0.0).count();
    let folds = verdict.held_out.len();
    // Of many stretches of one motion a few may be untouched by an effect.
    let needed = if side.design.short {
        // Its evidence is the residual's memory, not how many stretches agree.
        0
    } else if candidate.fixed.is_some() {
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
