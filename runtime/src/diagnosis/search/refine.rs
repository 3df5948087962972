//! Shapes between the values of a grid.

use crate::diagnosis::candidates::candidate::{Candidate, make};
use crate::diagnosis::candidates::trial::{Trial, columns};
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::rules::{MOST_EVALUATIONS, SMALLEST_STEP};
use crate::diagnosis::search::state::Search;
use crate::parallel;

impl Search<'_> {
    /// Narrow resonances fall between the values of a grid: the best shape of every compliant transmission is
    /// refined on what nothing else explains.
    pub(in crate::diagnosis) fn polish(&mut self, threads: usize) {
        let (model, regression, candidates) = (&self.model, &self.model.fast, &self.fast);
        let polished = parallel::map(threads, candidates.len(), |k| {
            let candidate = &candidates[k];
            candidate.fixed?;
            let start = regression.best_trial(candidate)?;
            let shape = self.refined(regression, candidate, &candidate.trials[start].shape);
            let (effect, place, design) = (candidate.effect, candidate.place, &regression.design);
            let columns = columns(&model.context, design, effect, place, &shape, model.change);
            Some(Trial::new(design, shape, columns))
        });
        for (candidate, trial) in self.fast.iter_mut().zip(polished) {
            candidate.trials.extend(trial);
        }
    }

    /// The shape near `start` that explains most of all motion.
    pub(in crate::diagnosis) fn refined(
        &self,
        regression: &Regression,
        candidate: &Candidate,
        start: &[f64],
    ) -> Vec<f64> {
        let context = &self.model.context;
        let gain = |shape: &[f64]| -> f64 {
            let (effect, place, shape) = (candidate.effect, candidate.place, [shape.to_vec()]);
            let one = make(context, &regression.design, effect, place, &shape, self.model.change);
            regression.whole_gain(&one)
        };
        let grid: Vec<&[f64]> = candidate.trials.iter().map(|t| t.shape.as_slice()).collect();
        let search = candidate.effect.form().shape_search(candidate.place, &context.scales, &grid);
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
        shape
    }
}
