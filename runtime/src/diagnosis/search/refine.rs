//! Shapes between the values of a grid.

use crate::diagnosis::candidates::candidate::{Candidate, make};
use crate::diagnosis::candidates::trial::{Trial, columns};
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::rules::{EXPLAINS_MOST, GATES_AHEAD, MOST_EVALUATIONS, MOST_STARTS, SMALLEST_STEP};
use crate::diagnosis::search::round::Ranked;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::search::term::{Accepted, Law, Mode};
use crate::diagnosis::search::tuning::Tuning;
use crate::diagnosis::settings::Settings;
use crate::effects::ShapeSearch;
use crate::parallel;

impl Search<'_> {
    /// Narrow resonances fall between the values of a grid: the best shape of every compliant transmission is
    /// refined on what nothing else explains. Says whether there was anything to refine.
    pub(in crate::diagnosis) fn polish(&mut self) -> bool {
        let laws: Vec<Law> = self.model.terms.iter().map(Accepted::law).collect();
        if self.polished_beside.contains(&laws) {
            return false;
        }
        self.polished_beside.push(laws);
        let (model, regression, candidates) = (&self.model, &self.model.fast, &self.fast);
        let polished = parallel::map(self.threads(), candidates.len(), |k| {
            let candidate = &candidates[k];
            candidate.fixed?;
            let [best, nearest] = regression.best_and_nearest(candidate)?;
            // What was polished beside other laws is at the end of a valley that they hardly move.
            let from_grid = candidate.trials.iter().take(candidate.shapes).any(|t| t.shape == best);
            let shape = if from_grid { self.refined(regression, candidate, best) } else { best.to_vec() };
            let (effect, place, design) = (candidate.effect, candidate.place, &regression.design);
            let trial = |shape: &[f64]| {
                let columns = columns(&model.context, design, effect, place, shape, model.change);
                Trial::new(design, shape.to_vec(), columns)
            };
            // A sharp resonance beside its place explains less than nothing, and is still alike.
            let mut starts = vec![nearest.to_vec()];
            // What explains anything may explain more at the end of its valley.
            if regression.gain_of(candidate, &trial(&shape)) > 0.0 {
                starts.push(shape.clone());
            }
            let ends = starts.into_iter().map(|shape| {
                let mut tuning = Tuning::beside(model, &Accepted::tried(candidate, shape));
                tuning.run();
                (tuning.shape().to_vec(), tuning.squares())
            });
            let best = ends.min_by(|a, b| a.1.total_cmp(&b.1));
            Some(trial(&best.map_or(shape, |(shape, _)| shape)))
        });
        let any = polished.iter().any(Option::is_some);
        for (candidate, trial) in self.fast.iter_mut().zip(polished) {
            candidate.trials.extend(trial);
        }
        any
    }

    /// Gives the laws that lead a round and explain most of what is open the best shape near that of the grid: what a shape
    /// beside it leaves of a law is loud where the law is, and looks like noise that makes it.
    pub(in crate::diagnosis) fn refine_leading(&mut self, ranked: &mut [Ranked], settings: &Settings) {
        let explains_most = |&k: &usize| {
            let law = &ranked[k];
            self.of(law).1.fixed.is_none() && law.verdict.explained_fraction >= EXPLAINS_MOST
        };
        let holding = self.holding(ranked, settings).into_iter();
        let leading: Vec<usize> = holding.filter(explains_most).take(GATES_AHEAD).collect();
        let refined = parallel::map(self.threads(), leading.len(), |i| {
            let law = &ranked[leading[i]];
            let (regression, candidate) = self.of(law);
            let start = &candidate.trials[law.verdict.trial];
            let shape = self.refined_of_any_form(regression, candidate, start);
            if shape == start.shape {
                return None;
            }
            let (effect, place, design) = (candidate.effect, candidate.place, &regression.design);
            make(&self.model.context, design, effect, place, &[shape], self.model.change).trials.pop()
        });
        for (k, trial) in leading.into_iter().zip(refined) {
            let Some(trial) = trial else { continue };
            let Ranked { window, index, .. } = ranked[k];
            self.candidate_mut(window, index).trials.push(trial);
            let (regression, candidate) = self.of(&ranked[k]);
            if let Some(verdict) = regression.judge(candidate) {
                ranked[k].verdict = verdict;
            }
        }
        ranked.sort_by(Ranked::more_first);
    }

    /// The shape that explains most of all motion near that of a trial, or near the best of the grid of another form of the law
    /// with as many columns: between the values of the grid another form may lead than on them.
    pub(in crate::diagnosis) fn refined_of_any_form(
        &self,
        regression: &Regression,
        candidate: &Candidate,
        start: &Trial,
    ) -> Vec<f64> {
        let search = self.shape_search(candidate, &start.shape);
        let grid = candidate.trials.iter().take(candidate.shapes);
        let mut best_of_others: Vec<(&Trial, f64)> = Vec::new();
        for trial in grid.filter(|trial| trial.columns.len() == start.columns.len()) {
            if search.is_same_form(&trial.shape, &start.shape) {
                continue;
            }
            let gain = regression.gain_of(candidate, trial);
            let of_form = |(other, _): &&mut (&Trial, f64)| search.is_same_form(&trial.shape, &other.shape);
            match best_of_others.iter_mut().find(of_form) {
                Some(best) if best.1 < gain => *best = (trial, gain),
                Some(_) => {}
                None => best_of_others.push((trial, gain)),
            }
        }
        let mut best = self.climbed(regression, candidate, &start.shape);
        for (trial, _) in best_of_others {
            let end = self.climbed(regression, candidate, &trial.shape);
            if end.1 > best.1 {
                best = end;
            }
        }
        best.0
    }

    /// The shape near `start` that explains most of all motion.
    fn refined(&self, regression: &Regression, candidate: &Candidate, start: &[f64]) -> Vec<f64> {
        self.climbed(regression, candidate, start).0
    }

    /// How a shape of a candidate is searched, within those of its form that were tried.
    fn shape_search(&self, candidate: &Candidate, shape: &[f64]) -> ShapeSearch {
        let grid: Vec<&[f64]> = candidate.trials.iter().map(|t| t.shape.as_slice()).collect();
        let (form, scales) = (candidate.effect.form(), &self.model.context.scales);
        form.shape_search_of(candidate.place, scales, &grid, shape)
    }

    /// The shape near `start` that explains most of all motion, and its in-sample gain.
    fn climbed(&self, regression: &Regression, candidate: &Candidate, start: &[f64]) -> (Vec<f64>, f64) {
        let context = &self.model.context;
        let gain = |shape: &[f64]| -> f64 {
            let (effect, place, shape) = (candidate.effect, candidate.place, [shape.to_vec()]);
            let one = make(context, &regression.design, effect, place, &shape, self.model.change);
            regression.whole_gain(&one)
        };
        let search = self.shape_search(candidate, start);
        // Pattern search (Hooke and Jeeves 1961).
        let moves = search.moves(start.len());
        let mut shape = start.to_vec();
        let mut value = gain(&shape);
        let mut size = 1.0;
        let mut evaluations = 0;
        while size > SMALLEST_STEP && evaluations < MOST_EVALUATIONS {
            let mut better = false;
            for along in &moves {
                let next = search.moved(&shape, along, size);
                if next == shape {
                    continue;
                }
                let tried = gain(&next);
                evaluations += 1;
                if tried > value {
                    (shape, value, better) = (next, tried, true);
                }
            }
            if !better {
                size *= 0.5;
            }
        }
        (shape, value)
    }

    /// The best shape of a compliant transmission, and how near others come to it: what rings is in step with a motion at
    /// one frequency and again at the next, so that several shapes of the grid are refined.
    pub(in crate::diagnosis) fn tune(
        &self,
        term: &mut Accepted,
        candidate: &Candidate,
        regression: &Regression,
    ) {
        let mut starts = vec![term.shape.clone()];
        starts.extend(regression.best_of_each(candidate, MOST_STARTS));
        let mut ends = parallel::map(self.threads(), starts.len(), |k| {
            let shape = self.refined(regression, candidate, &starts[k]);
            let mut tuning = Tuning::beside(&self.model, &Accepted { shape, ..term.clone() });
            tuning.run();
            (tuning.shape().to_vec(), tuning.squares())
        });
        ends.sort_by(|a, b| a.1.total_cmp(&b.1));
        let Some((best, least)) = ends.first().cloned() else { return };
        // Noise with a memory has fewer squares to tell shapes apart by than it has rows.
        let memory = 2.0 * term.inflation * term.inflation;
        let likelihood = |squares: f64| ((least - squares) / memory).exp();
        let all: f64 = ends.iter().map(|(_, squares)| likelihood(*squares)).sum();
        term.shape = best;
        let others = ends.into_iter().skip(1);
        term.modes =
            others.map(|(shape, squares)| Mode { shape, weight: likelihood(squares) / all }).collect();
    }
}
