//! How good a candidate is on motion that it was not fitted to.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::folds::{Fold, forward_cuts};
use crate::diagnosis::judging::hull::{Beyond, Curve};
use crate::diagnosis::judging::partial_regression::{BySegment, Residualised};
use crate::diagnosis::judging::prediction::Prediction;
use crate::diagnosis::judging::regression::{Regression, is_beyond};
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rules::{AIC_PENALTY, LOST, MOST_OF_WHAT_IS_OPEN};
use nalgebra::DVector;

/// The verdict on a candidate.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Verdict {
    /// Index of the best shape over all motion.
    pub trial: usize,
    /// In sample, in units of the noise variance.
    pub gain: f64,
    /// Held out, in units of the noise variance, one value per fold.
    pub held_out: Vec<f64>,
    /// Folds that it makes worse, by more than the error of the parameters that were fitted elsewhere.
    pub lost: usize,
    /// Joints that it shows on: its own, or another one where it explains more, through the parameters that joints share.
    pub shows_on: Vec<usize>,
    /// Held-out gain as a fraction of the held-out squares of these joints.
    pub explained_fraction: f64,
    /// In-sample gain as a fraction of the squares of these joints.
    pub fitted_fraction: f64,
}

impl Verdict {
    /// Held-out gain of all folds.
    pub fn total(&self) -> f64 {
        self.held_out.iter().sum()
    }
}

/// The best shape of a candidate on the segments of a fit.
struct Best {
    trial: usize,
    gain: f64,
    amplitude: DVector<f64>,
    part: Residualised,
}

/// The shape whose gain is largest after a penalty for its numbers.
fn best_shape(fit: &Fit, candidate: &Candidate) -> Option<Best> {
    let worth = |gain: f64, numbers: usize| gain - AIC_PENALTY * numbers as f64;
    let mut best: Option<Best> = None;
    for (trial, columns) in candidate.trials.iter().enumerate() {
        let Some(part) = fit.project_out(columns) else { continue };
        let Some((amplitude, gain)) = part.solve(candidate) else { continue };
        let best_yet = best.as_ref().map(|b| worth(b.gain, b.amplitude.len()));
        if best_yet.is_none_or(|yet| worth(gain, amplitude.len()) > yet) {
            best = Some(Best { trial, gain, amplitude, part });
        }
    }
    best
}

impl Regression {
    /// Judges a candidate: the best shape is chosen anew on each fold's own training motion. `None` where the motion
    /// does not determine it or it gains nothing.
    pub fn judge(&self, candidate: &Candidate) -> Option<Verdict> {
        let best = best_shape(&self.fit, candidate)?;
        if best.gain <= 0.0 {
            return None;
        }
        let (mut held_out, mut lost) = (Vec::new(), 0);
        let mut of_joint = vec![(0.0, 0.0); self.sigma.len()];
        let parts = self
            .design
            .is_single_motion()
            .then(|| self.by_segment(&best.part, &candidate.trials[best.trial]));
        for (fold, left) in self.folds.iter().zip(&self.held_out_squares) {
            let (prediction, curve) = self.fitted(candidate, (&best, parts.as_ref()), fold)?;
            let mut sum = 0.0;
            for (j, s) in self.sigma.iter().enumerate() {
                let [gone, left] = self.on_joint(&prediction, (parts.as_ref(), &curve), (fold, left), j);
                let w = 1.0 / (s * s);
                sum += w * gone;
                of_joint[j].0 += w * gone;
                of_joint[j].1 += w * left;
            }
            // On a single motion nothing but the law is fitted elsewhere.
            let by_parameters = || {
                if parts.is_some() {
                    return 0.0;
                }
                let seen = |j| self.seen(&curve, fold, j).collect();
                let rows: Vec<Vec<usize>> = (0..self.sigma.len()).map(seen).collect();
                prediction.deviation_by_parameters(&self.design, &rows)
            };
            // Motion in which no joint that would show it moves tells nothing.
            lost += usize::from(sum < 0.0 && -sum >= LOST * by_parameters());
            held_out.push(sum);
        }
        let total = held_out.iter().sum::<f64>();
        let share = |joints: &[usize]| {
            let sum = |f: &dyn Fn(usize) -> f64| joints.iter().map(|&j| f(j)).sum::<f64>();
            total.min(sum(&|j| of_joint[j].0)) / sum(&|j| of_joint[j].1).max(1e-300)
        };
        let others = (0..self.sigma.len()).filter(|j| !candidate.own.contains(j)).map(|j| vec![j]);
        let shows_on = [candidate.own.clone()]
            .into_iter()
            .chain(others)
            .max_by(|a, b| share(a).total_cmp(&share(b)))
            .unwrap_or_default();
        let explained_fraction = share(&shows_on);
        // More than all can only be rounding, of columns that the design nearly makes itself.
        if explained_fraction > 1.0 {
            return None;
        }
        let squares = shows_on.iter().map(|&j| self.target_squares(j)).sum::<f64>();
        let fitted_fraction = best.gain / squares.max(1e-300);
        Some(Verdict {
            trial: best.trial,
            gain: best.gain,
            held_out,
            lost,
            shows_on,
            explained_fraction,
            fitted_fraction,
        })
    }

    /// A candidate fitted to the motion that a fold does not hold out, and where it is a curve what it says nothing of.
    fn fitted<'a>(
        &'a self,
        candidate: &'a Candidate,
        (best, parts): (&Best, Option<&BySegment>),
        fold: &'a Fold,
    ) -> Option<(Prediction<'a>, Option<Beyond>)> {
        let prediction = match parts {
            Some(parts) => {
                let amplitude = self.amplitude_from_rest_of_motion(candidate, (&best.part, parts), fold)?;
                Prediction::new(&self.fit, &candidate.trials[best.trial], &best.part, amplitude)
            }
            None if candidate.fixed.is_some() => {
                // A law without free amplitudes has nothing to fit but its shape, which needs all of the motion.
                self.predict_from_others(candidate, &candidate.trials[best.trial], fold)?
            }
            None => {
                let own = best_shape(&fold.fit, candidate)?;
                Prediction::new(&fold.fit, &candidate.trials[own.trial], &own.part, own.amplitude)
            }
        };
        let curve = Curve::of(candidate, prediction.trial);
        let beyond = curve.map(|curve| Beyond::of(&self.design, &curve, &fold.fit.train));
        Some((prediction, beyond))
    }

    /// Rows of a joint that a fold holds out, and the model's curves and the candidate, where it is one, say something of.
    fn seen<'a>(
        &'a self,
        curve: &'a Option<Beyond>,
        fold: &'a Fold,
        joint: usize,
    ) -> impl Iterator<Item = usize> + 'a {
        let seen = |r: &usize| {
            !is_beyond(&self.beyond, *r) && curve.as_ref().is_none_or(|curve| !curve.contains(*r))
        };
        fold.told(&self.design, joint).flat_map(move |g| self.design.ranges[joint][g].clone()).filter(seen)
    }

    /// What a candidate takes of the squares that a fold leaves of a joint, and these, on the rows that are seen.
    fn on_joint(
        &self,
        prediction: &Prediction<'_>,
        (parts, curve): (Option<&BySegment>, &Option<Beyond>),
        (fold, left): (&Fold, &[f64]),
        joint: usize,
    ) -> [f64; 2] {
        let is_curves = curve.as_ref().is_some_and(|curve| curve.joint == joint);
        let mut rows = fold.told(&self.design, joint).flat_map(|g| self.design.ranges[joint][g].clone());
        if is_curves || rows.any(|r| is_beyond(&self.beyond, r)) {
            let rows: Vec<usize> = self.seen(curve, fold, joint).collect();
            return prediction.gain_on(&self.design, joint, &rows);
        }
        let gain = |g: usize| match parts {
            Some(parts) => parts.gain(&prediction.amplitude, joint, g),
            None => prediction.gain(&self.design, joint, g),
        };
        [fold.told(&self.design, joint).map(gain).sum(), left[joint]]
    }

    /// Squared residual of a joint in the recording that is diagnosed, in units of its variance.
    fn target_squares(&self, joint: usize) -> f64 {
        self.target_squares[joint] / (self.sigma[joint] * self.sigma[joint])
    }

    /// Whether a candidate improves motion that it was not fitted to, where there is a single one: each stretch, with
    /// everything, standard parameters included, fitted to the others, on the joints that it `shows_on`. (The others see it
    /// only through parameters that they share, whose extrapolation from a part of a motion is noise.) A law that explains less
    /// than most of what is open must hold forward in time, where parameters are extrapolated, if what comes first shows
    /// them; so must in any case a trend and a curve of many numbers, which go on between stretches that were fitted whatever they are.
    ///
    /// # Errors
    /// [`SingularDesign`] where the time before has no fit.
    pub fn predicts_rest_of_motion(
        &self,
        candidate: &Candidate,
        (trial, shows_on): (usize, &[usize]),
        explained_fraction: f64,
    ) -> Result<bool, SingularDesign> {
        let segments = self.design.segments.len();
        let trial = &candidate.trials[trial];
        let curves: Vec<Curve> = self.curves().into_iter().chain(Curve::of(candidate, trial)).collect();
        let gain = |fit: &Fit, is_held: &dyn Fn(usize) -> bool| {
            let part = fit.project_out(trial)?;
            let (amplitude, _) = part.solve(candidate)?;
            let prediction = Prediction::new(fit, trial, &part, amplitude);
            let held = || (0..segments).filter(|&g| is_held(g));
            let beyond = Beyond::each(&self.design, &curves, &fit.train);
            let of_joint = |&j: &usize| {
                let gone = if beyond.iter().any(|beyond| beyond.joint == j) {
                    let rows = held().flat_map(|g| self.design.ranges[j][g].clone());
                    let seen = |r: &usize| !beyond.iter().any(|beyond| beyond.contains(*r));
                    let rows: Vec<usize> = rows.filter(seen).collect();
                    prediction.gain_on(&self.design, j, &rows)[0]
                } else {
                    held().map(|g| prediction.gain(&self.design, j, g)).sum()
                };
                gone / (self.sigma[j] * self.sigma[j])
            };
            Some(shows_on.iter().map(of_joint).sum::<f64>())
        };
        let mut gains = Vec::new();
        let goes_on = candidate.is_trend() || candidate.effect.form().is_curve();
        if goes_on || self.design.forward && explained_fraction < MOST_OF_WHAT_IS_OPEN {
            for cut in forward_cuts(segments) {
                let before = (0..segments).map(|g| g < cut).collect();
                gains.push(gain(&Fit::new(&self.design, &self.sigma, before)?, &|g| g >= cut));
            }
        } else {
            gains.extend(self.folds.iter().map(|fold| gain(&fold.fit, &|g| fold.test[g])));
        }
        Ok(gains.into_iter().sum::<Option<f64>>().is_some_and(|gain| gain > 0.0))
    }
}
