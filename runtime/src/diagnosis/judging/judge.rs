//! How good a candidate is on motion that it was not fitted to.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::judging::folds::{Fold, cuts, single_motion};
use crate::diagnosis::judging::partial_regression::{Own, change, own_part, rest_of_motion};
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use nalgebra::DVector;

/// What one more number must gain to be worth it, in units of the noise variance (Akaike 1974).
const NUMBER: f64 = 2.0;

/// The verdict on a candidate.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Verdict {
    /// Index of the best shape over all motion.
    pub trial: usize,
    /// In sample, in units of the noise variance.
    pub gain: f64,
    /// Held out, in units of the noise variance, one value per fold.
    pub held_out: Vec<f64>,
    /// Held-out gain as a share of the held-out squares of its own joints.
    pub share: f64,
    /// In-sample gain as a share of the squares of its own joints.
    pub fitted_share: f64,
}

impl Verdict {
    /// Held-out gain of all folds.
    pub fn total(&self) -> f64 {
        self.held_out.iter().sum()
    }
}

/// Judges a candidate: the best shape is chosen anew on each fold's own training motion.
pub(in crate::diagnosis) fn judge(
    design: &Design,
    whole: &Fit,
    folds: &[Fold],
    sigma: &[f64],
    candidate: &Candidate,
) -> Option<Verdict> {
    let everything = vec![true; design.segments.len()];
    let best = |fit: &Fit, train: &[bool]| {
        let mut best: Option<(f64, usize, DVector<f64>, Own)> = None;
        for (k, trial) in candidate.trials.iter().enumerate() {
            let Some(own) = own_part(design, fit, sigma, trial, train) else { continue };
            let Some((a, gain)) = own.solve(candidate) else { continue };
            let worth = |gain: f64, numbers: usize| gain - NUMBER * numbers as f64;
            if best.as_ref().is_none_or(|b| worth(gain, a.len()) > worth(b.0, b.2.len())) {
                best = Some((gain, k, a, own));
            }
        }
        best
    };
    let (gain, trial, _, whole_own) = best(whole, &everything)?;
    if gain <= 0.0 {
        return None;
    }
    let single = single_motion(design);
    let mut held_out = Vec::new();
    let (mut own_gain, mut before) = (0.0, 0.0);
    for fold in folds {
        // Where only one motion is there, refitting all standard parameters to a part of it would drown every
        // candidate in their extrapolation: the candidate's own part is then taken over the whole motion, and only
        // its amplitude is fitted to the rest.
        // A law without free amplitudes has nothing to fit but its shape, which needs all of the motion.
        let (k, a, x) = if candidate.fixed.is_some() && !single {
            let own = own_part(design, &fold.fit, sigma, &candidate.trials[trial], &fold.train)?;
            let (a, _) = own.solve(candidate)?;
            (trial, a, own.x)
        } else if single {
            let own = rest_of_motion(design, whole, sigma, &candidate.trials[trial], &whole_own, &fold.train);
            let (a, _) = own.solve(candidate)?;
            (trial, a, whole_own.x.clone())
        } else {
            let (_, k, a, own) = best(&fold.fit, &fold.train)?;
            (k, a, own.x)
        };
        let fit = if single { whole } else { &fold.fit };
        let d = -(&x * &a);
        let mut sum = 0.0;
        for (j, &s) in sigma.iter().enumerate() {
            let w = 1.0 / (s * s);
            for (g, _) in fold.test.iter().enumerate().filter(|(_, t)| **t) {
                let change = w * change(design, fit, &candidate.trials[k], &a, &d, j, g);
                sum += change;
                if candidate.own.contains(&j) {
                    own_gain += change;
                    before += w * fit.squares(design, j, g);
                }
            }
        }
        held_out.push(sum);
    }
    let share = held_out.iter().sum::<f64>().min(own_gain) / before.max(1e-300);
    // Nobody explains more than there is: the numbers of columns that the design nearly makes itself.
    if share > 1.0 {
        return None;
    }
    let squares = |j: usize| {
        let targets = (0..design.segments.len()).filter(|&g| design.segments[g].is_target);
        targets.map(|g| whole.squares(design, j, g)).sum::<f64>() / (sigma[j] * sigma[j])
    };
    let fitted_share = gain / candidate.own.iter().map(|&j| squares(j)).sum::<f64>().max(1e-300);
    Some(Verdict { trial, gain, held_out, share, fitted_share })
}

/// Whether a candidate improves later time of a single motion when everything, standard parameters included, is fitted
/// to the time before, on its own joints. (The others see it only through parameters that they share, whose
/// extrapolation from a part of a motion is noise.)
pub(in crate::diagnosis) fn holds_forward(
    design: &Design,
    sigma: &[f64],
    candidate: &Candidate,
    trial: usize,
) -> bool {
    let segments = design.segments.len();
    let mut gain = 0.0;
    for cut in cuts(segments) {
        let train: Vec<bool> = (0..segments).map(|g| g < cut).collect();
        let fit = Fit::new(design, sigma, |g| train[g]);
        let trial = &candidate.trials[trial];
        let Some(part) = own_part(design, &fit, sigma, trial, &train) else { return false };
        let Some((a, _)) = part.solve(candidate) else { return false };
        let d = -(&part.x * &a);
        for &j in &candidate.own {
            let weight = 1.0 / (sigma[j] * sigma[j]);
            for g in cut..segments {
                gain += weight * change(design, &fit, trial, &a, &d, j, g);
            }
        }
    }
    gain > 0.0
}
