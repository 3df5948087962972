//! Shapes between the values of a grid.

use crate::diagnosis::candidates::candidate::{Candidate, make};
use crate::diagnosis::candidates::trial::{Trial, columns};
use crate::diagnosis::judging::partial_regression::{best_trial, whole_gain};
use crate::diagnosis::search::state::{Search, Side};
use crate::parallel;

/// Shapes that a refinement tries at most.
const MOST_EVALUATIONS: usize = 80;

impl Search<'_, '_> {
    /// Narrow resonances fall between the values of a grid: the best shape of every compliant transmission is
    /// refined on what nothing else explains.
    pub(in crate::diagnosis) fn polish(&mut self, threads: usize) {
        let (this, fast) = (&*self, &self.fast);
        let polished = parallel::map(threads, fast.candidates.len(), |k| {
            let candidate = &fast.candidates[k];
            candidate.fixed?;
            let start = best_trial(&fast.design, &fast.fit, &fast.sigma, candidate)?;
            let shape = this.refined(fast, candidate, &candidate.trials[start].shape);
            let columns =
                columns(this.context, &fast.design, candidate.effect, candidate.place, &shape, this.change);
            Some(Trial::new(&fast.design, shape, columns))
        });
        for (candidate, trial) in self.fast.candidates.iter_mut().zip(polished) {
            candidate.trials.extend(trial);
        }
    }

    /// The shape near `start` that explains most of all motion.
    pub(in crate::diagnosis) fn refined(
        &self,
        side: &Side,
        candidate: &Candidate,
        start: &[f64],
    ) -> Vec<f64> {
        let gain = |shape: &[f64]| -> f64 {
            let one = make(
                self.context,
                &side.design,
                candidate.effect,
                candidate.place,
                &[shape.to_vec()],
                self.change,
            );
            whole_gain(&side.design, &side.fit, &side.sigma, &one)
        };
        let grid: Vec<&[f64]> = candidate.trials.iter().map(|t| t.shape.as_slice()).collect();
        let search = candidate.effect.form().shape_search(candidate.place, &self.context.scales, &grid);
        // Pattern search (Hooke and Jeeves 1961).
        let moves = search.moves(start.len());
        let mut shape = start.to_vec();
        let mut value = gain(&shape);
        let mut size = 1.0;
        let mut evaluations = 0;
        while size > 0.02 && evaluations < MOST_EVALUATIONS {
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
