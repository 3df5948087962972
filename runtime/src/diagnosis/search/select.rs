//! Which candidate of a round holds.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::candidates::gains::weighed_with_gains;
use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::judge::Verdict;
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::rules::{
    FITTED_TO_HELD_OUT, GATES_AHEAD, MOST_CHECKED, MOTIONS_PER_LOSS, RIVALS, STRETCHES_PER_LOSS,
};
use crate::diagnosis::search::body;
use crate::diagnosis::search::gate::{Outcome, RoundEvidence};
use crate::diagnosis::search::round::{Ranked, Round, Tie, Winner};
use crate::diagnosis::search::standing::Standing;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::search::term::{Accepted, Rival};
use crate::diagnosis::settings::Settings;
use crate::effects::{Form, SmoothingWindow, ToldBy};
use crate::parallel;

/// How a candidate comes out of the gate.
enum Weight {
    /// It may be named.
    Named {
        confidence: f64,
        significance: f64,
        /// Factor on its standard deviations.
        inflation: f64,
    },
    /// It cannot be told from a law at another place.
    Tied(Tie),
    /// It is no more than the variation that is there anyway, or a rival explains more.
    Fails,
}

impl Search<'_> {
    /// The best candidate that holds, among those on `joint` where one is given; the candidates have been looked
    /// through `rounds` times.
    ///
    /// # Errors
    /// [`SingularDesign`] where a part of the motion has no fit.
    pub(in crate::diagnosis) fn best(
        &mut self,
        settings: &Settings,
        joint: Option<usize>,
        rounds: usize,
    ) -> Result<Round, SingularDesign> {
        let mut ties = Vec::new();
        let mut ranked = self.ranked(joint);
        self.refine_leading(&mut ranked, settings);
        let evidence_of_round = RoundEvidence::new(ranked.len());
        let holding = self.in_order(&ranked, self.holding(&ranked, settings));
        for (at, &k) in holding.iter().enumerate() {
            if at % GATES_AHEAD == 0 {
                // Several gates at once: mostly the first that holds is not the first.
                let next = &holding[at..holding.len().min(at + GATES_AHEAD)];
                parallel::map(self.threads(), next.len(), |i| {
                    self.gate(&evidence_of_round, &ranked, next[i])
                });
            }
            let (regression, candidate) = self.of(&ranked[k]);
            if !settings.may_name(candidate.effect, candidate.place) {
                continue;
            }
            let verdict = &ranked[k].verdict;
            let Some(most) = self.waveform_confidence(&ranked[k], rounds, settings) else { continue };
            if regression.design.is_single_motion()
                && !regression.predicts_rest_of_motion(
                    candidate,
                    (verdict.trial, &verdict.shows_on),
                    verdict.explained_fraction,
                )?
            {
                continue;
            }
            let level = (settings.least_confidence, rounds);
            if self
                .nested_case_that_suffices(&ranked, k)
                .is_some_and(|nested| !self.has_rival_elsewhere(&evidence_of_round, &ranked, nested, level))
            {
                continue;
            }
            // On one joint alone a law's rivals on others are not seen: what was tied with one stays so.
            if joint.is_some() && self.is_tied(candidate) {
                continue;
            }
            let weight = self.weight(&evidence_of_round, &ranked, k, level);
            let (confidence, significance, inflation) = match weight {
                Weight::Named { confidence, significance, inflation } => {
                    (confidence, significance, inflation)
                }
                Weight::Tied(tie) => {
                    ties.push(tie);
                    continue;
                }
                Weight::Fails => continue,
            };
            if !self.can_be(&ranked[k], inflation) {
                continue;
            }
            let winner = Some(Winner {
                window: ranked[k].window,
                index: ranked[k].index,
                verdict: verdict.clone(),
                significance,
                confidence: confidence.min(most),
                inflation,
                rivals: self.rivals(&ranked, k, settings),
            });
            return Ok(Round { winner, ties });
        }
        Ok(Round { winner: None, ties })
    }

    /// What the variation that is there anyway says of a candidate of a round, and its rivals at other places, at a
    /// confidence over so many rounds.
    fn weight(&self, round: &RoundEvidence, ranked: &[Ranked], k: usize, level: (f64, usize)) -> Weight {
        let least = level_of_round(level);
        let gate = self.judged_by_gate(round, ranked, k, least);
        let Outcome::Passes { confidence, significance, inflation } = gate else { return Weight::Fails };
        let confidence = 1.0 - level.1.max(1) as f64 * (1.0 - confidence);
        if !self.is_told_from_simpler(round, ranked, k, least)
            || !self.is_told_from_noise(round, ranked, k, least)
        {
            return Weight::Fails;
        }
        match self.standing(round, ranked, k, least) {
            Standing::Ahead => Weight::Named { confidence, significance, inflation },
            Standing::Tied(rival) => {
                let (candidate, rival) = (self.of(&ranked[k]).1, self.of(&ranked[rival]).1);
                Weight::Tied(Tie {
                    effects: [candidate.effect, rival.effect],
                    places: [candidate.place, rival.place],
                })
            }
            Standing::Beaten => Weight::Fails,
        }
    }

    /// Whether a candidate of a round is there, but not told from a law at another place.
    fn has_rival_elsewhere(
        &self,
        round: &RoundEvidence,
        ranked: &[Ranked],
        k: usize,
        level: (f64, usize),
    ) -> bool {
        let least = level_of_round(level);
        matches!(self.judged_by_gate(round, ranked, k, least), Outcome::Passes { .. })
            && self.standing(round, ranked, k, least) != Standing::Ahead
    }

    /// Whether a ranked candidate is a law that can be, with its standard deviations as much larger.
    pub(super) fn can_be(&self, ranked: &Ranked, inflation: f64) -> bool {
        let (regression, candidate) = self.of(ranked);
        let Some(part) = regression.fit.project_out(&candidate.trials[ranked.verdict.trial]) else {
            return false;
        };
        part.solve(candidate).is_some_and(|(amplitude, _)| {
            let mut information = part.information().clone();
            if self.model.change && matches!(candidate.effect.form(), Form::Body(_)) {
                let trial = &candidate.trials[ranked.verdict.trial];
                let of_each_joint = part.of_each_joint(&regression.fit, trial, &amplitude);
                information = weighed_with_gains(&information, &of_each_joint);
            }
            let fitted = (&information, &amplitude);
            body::can_be(&self.model.context, candidate.effect.form(), fitted, inflation)
        })
    }

    /// Candidates, on `joint` where one is given, that are not excluded: those that gain most on held-out motion first.
    pub(in crate::diagnosis) fn ranked(&self, joint: Option<usize>) -> Vec<Ranked> {
        let mut ranked = Vec::new();
        for window in [SmoothingWindow::Slow, SmoothingWindow::Fast] {
            let (regression, candidates) = (self.model.regression(window), self.candidates(window));
            let verdicts = parallel::map(self.threads(), candidates.len(), |index| {
                let candidate = &candidates[index];
                if joint.is_some_and(|j| !candidate.own.contains(&j)) || self.is_excluded(candidate) {
                    return None;
                }
                regression.judge(candidate)
            });
            let judged = verdicts.into_iter().enumerate();
            ranked.extend(judged.filter_map(|(index, v)| Some(Ranked { window, index, verdict: v? })));
        }
        ranked.sort_by(Ranked::more_first);
        ranked
    }

    /// The first of them that hold, by their place in the ranking.
    pub(super) fn holding(&self, ranked: &[Ranked], settings: &Settings) -> Vec<usize> {
        (0..ranked.len())
            .filter(|&k| {
                let (regression, candidate) = self.of(&ranked[k]);
                holds(regression, candidate, &ranked[k].verdict, settings)
            })
            .take(MOST_CHECKED)
            .collect()
    }

    /// The regression of a ranked candidate, and the candidate.
    pub(in crate::diagnosis) fn of(&self, ranked: &Ranked) -> (&Regression, &Candidate) {
        (self.model.regression(ranked.window), &self.candidates(ranked.window)[ranked.index])
    }

    /// How sure it is that a law without a free amplitude is there, by its waveform; 1 for all others, `None` where it is
    /// not sure enough.
    fn waveform_confidence(&self, ranked: &Ranked, rounds: usize, settings: &Settings) -> Option<f64> {
        let (regression, candidate) = self.of(ranked);
        if candidate.fixed.is_none() {
            return Some(1.0);
        }
        let evidence = regression.waveform_evidence(candidate, ranked.verdict.trial);
        Some(evidence.confidence(rounds * self.tries())).filter(|c| *c >= settings.least_confidence)
    }

    /// Other explanations of the joints of a candidate.
    pub(super) fn rivals(&self, ranked: &[Ranked], winner: usize, settings: &Settings) -> Vec<Rival> {
        let winner = &ranked[winner];
        let (regression, candidate) = self.of(winner);
        let rivals = ranked.iter().filter(|r| {
            (r.window, r.index) != (winner.window, winner.index)
                && self.of(r).1.own.iter().any(|j| candidate.own.contains(j))
        });
        let rivals: Vec<&Ranked> = rivals.take(RIVALS).collect();
        parallel::map(self.threads(), rivals.len(), |r| {
            let other = rivals[r];
            let rival = self.of(other).1;
            let comparable = other.window == winner.window
                && rival.own == candidate.own
                && holds(regression, rival, &other.verdict, settings);
            let difference_p_value = if comparable {
                let (law, rival) = ((candidate, winner.verdict.trial), (rival, other.verdict.trial));
                regression.difference_p_value(law, rival)
            } else {
                0.0
            };
            let explained_fraction = other.verdict.explained_fraction;
            let (effect, place, shape) = (rival.effect, rival.place, Vec::new());
            Rival { effect, place, shape, explained_fraction, difference_p_value }
        })
    }

    /// The nested special case of a law, by its place in the ranking, that explains nearly as much at the same place. Where
    /// the law's amplitudes tell whether it is mostly that case, they decide.
    fn nested_case_that_suffices(&self, ranked: &[Ranked], k: usize) -> Option<usize> {
        let (regression, more) = self.of(&ranked[k]);
        let Some(ToldBy::Gain(suffices)) = more.effect.properties().special_case.map(|case| case.told_by)
        else {
            return None;
        };
        let trial = &more.trials[ranked[k].verdict.trial];
        let amplitude = regression.fit.project_out(trial).and_then(|part| part.solve(more));
        let mostly = match (more.effect.form(), amplitude) {
            (Form::Joint(law) | Form::Heard(law), Some((amplitude, _))) => {
                law.is_mostly_special(amplitude.as_slice())
            }
            _ => None,
        };
        let least = match mostly {
            Some(false) => return None,
            Some(true) => 0.0,
            None => suffices * ranked[k].verdict.total(),
        };
        ranked.iter().position(|other| {
            let candidate = self.of(other).1;
            let nested = more.effect.special_cases().any(|nested| nested == candidate.effect);
            nested && candidate.place == more.place && other.verdict.total() > least
        })
    }

    /// Whether the last round over all joints could not tell a candidate from another.
    fn is_tied(&self, candidate: &Candidate) -> bool {
        let law = (candidate.effect, candidate.place);
        self.ties.iter().any(|tie| (0..2).any(|k| (tie.effects[k], tie.places[k]) == law))
    }

    /// The winner as a term, its shape refined on all motion.
    pub(in crate::diagnosis) fn accept(&self, winner: &Winner) -> Accepted {
        let mut term = self.as_term(winner);
        let candidate = &self.candidates(winner.window)[winner.index];
        if candidate.fixed.is_some() {
            self.tune(&mut term, candidate, self.model.regression(winner.window));
        } else {
            let (regression, start) =
                (self.model.regression(winner.window), &candidate.trials[winner.verdict.trial]);
            term.shape = self.refined_of_any_form(regression, candidate, start);
        }
        term
    }

    /// The winner as a term, with the shape of the grid.
    pub(in crate::diagnosis) fn as_term(&self, winner: &Winner) -> Accepted {
        let candidate = &self.candidates(winner.window)[winner.index];
        let shape = candidate.trials[winner.verdict.trial].shape.clone();
        Accepted {
            shows_on: winner.verdict.shows_on.clone(),
            significance: winner.significance,
            confidence: winner.confidence,
            inflation: winner.inflation,
            explained_fraction: winner.verdict.explained_fraction,
            rivals: winner.rivals.clone(),
            ..Accepted::tried(candidate, shape)
        }
    }
}

/// The confidence that is asked for where the candidates have been looked through so many times.
fn level_of_round((least_confidence, rounds): (f64, usize)) -> f64 {
    1.0 - (1.0 - least_confidence) / rounds.max(1) as f64
}

/// Whether a candidate explains enough, in nearly all folds, of what was fitted and of what was held out.
fn holds(regression: &Regression, candidate: &Candidate, verdict: &Verdict, settings: &Settings) -> bool {
    let folds = verdict.held_out.len();
    let needed = if regression.design.short {
        // Its evidence is a test against correlated noise, not how many stretches agree.
        0
    } else if candidate.fixed.is_some() {
        folds / 2 + 1
    } else if regression.design.in_stretches() {
        folds - folds / STRETCHES_PER_LOSS
    } else {
        folds - folds / MOTIONS_PER_LOSS
    };
    verdict.explained_fraction >= settings.least_share
        && verdict.fitted_fraction >= FITTED_TO_HELD_OUT * settings.least_share
        && folds - verdict.lost >= needed
}
