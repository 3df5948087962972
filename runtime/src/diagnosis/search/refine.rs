//! Shapes between the values of a grid.

use crate::diagnosis::candidates::candidate::{Candidate, make};
use crate::diagnosis::candidates::trial::{Trial, columns};
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::search::state::Search;
use crate::effects::{EffectKind, Form, Place};
use crate::parallel;

/// Shapes that a refinement tries at most.
const MOST_EVALUATIONS: usize = 80;

/// How a shape parameter is varied.
#[derive(Debug, Clone, Copy)]
enum Step {
    Times(f64),
    Add(f64),
}

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
        let steps: Vec<Step> = match candidate.effect.form() {
            Form::Joint(_) if candidate.effect == EffectKind::TorqueRipple => {
                let Place::Joint(j) = candidate.place else { return start.to_vec() };
                vec![Step::Add(std::f64::consts::PI / context.scales[j].range)]
            }
            Form::Joint(law) => law.refinement().iter().map(|&f| Step::Times(f)).collect(),
            Form::Compliance(_) => {
                vec![Step::Times(1.12), Step::Times(1.9), Step::Add(0.15), Step::Times(1.4)]
            }
            Form::Coupled => vec![Step::Times(1.4)],
            _ => Vec::new(),
        };
        // A law of a joint stays within a step of its grid: a power of nearly 0 is a second Coulomb level.
        let bounds: Vec<(f64, f64)> = match candidate.effect.form() {
            Form::Joint(law) => law
                .refinement()
                .iter()
                .enumerate()
                .map(|(k, f)| {
                    let values = candidate.trials.iter().filter_map(|t| t.shape.get(k));
                    let (low, high) =
                        values.fold((f64::INFINITY, 0.0_f64), |(low, high), &x| (low.min(x), high.max(x)));
                    (low / f, high * f)
                })
                .collect(),
            _ => Vec::new(),
        };
        // Pattern search (Hooke and Jeeves 1961): one parameter at a time, and frequency with rotor, which trade
        // against each other along the ridge of one stiffness.
        let mut moves: Vec<Vec<(usize, f64)>> = Vec::new();
        for k in 0..steps.len().min(start.len()) {
            moves.extend([vec![(k, 1.0)], vec![(k, -1.0)]]);
        }
        if matches!(candidate.effect.form(), Form::Compliance(_)) {
            moves.extend([vec![(0, 0.4), (2, 1.0)], vec![(0, -0.4), (2, -1.0)]]);
        }
        let mut shape = start.to_vec();
        let mut value = gain(&shape);
        let mut size = 1.0;
        let mut evaluations = 0;
        while size > 0.02 && evaluations < MOST_EVALUATIONS {
            let mut better = false;
            for directions in &moves {
                let mut next = shape.clone();
                for &(k, direction) in directions {
                    match steps[k] {
                        Step::Times(f) => {
                            next[k] *= f.powf(direction * size);
                            if let Some(&(low, high)) = bounds.get(k)
                                && low < high
                            {
                                next[k] = next[k].clamp(low, high);
                            }
                        }
                        Step::Add(d) => next[k] = (next[k] + d * direction * size).max(0.0),
                    }
                }
                if matches!(candidate.effect.form(), Form::Compliance(_)) {
                    // The rotor is a part of the inertia that the motor sees.
                    next[2] = next[2].min(0.95);
                }
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
