//! Times that are wrong by a factor, scanned over factors before anything else.
//!
//! Where the robot moved f times faster than the times say, speeds are f and accelerations f² times those that are
//! differentiated. Inertias can take a part of this over, but not where the same first moments make gravity torques
//! and inertial ones. The model is linear in its parameters at every f, so that each factor is one fit; a law that is
//! linearised at f = 1 sees nothing of a factor of two, and less of one of a thousand.

use super::candidates::trial::dense_columns;
use super::error::SingularDesign;
use super::explanation::curves::noise_floor;
use super::judging::held_out::HeldOutSquares;
use super::motions::Motions;
use super::outcome::{Errors, Estimated};
use super::rows::context::Context;
use super::rows::design::Design;
use super::rows::fit::Fit;
use super::rows::prior::Prior;
use super::rules::{
    RATE_FACTORS, RATE_LEAST, RATE_LEAVES, RATE_REFINED, RATE_ROUNDS, RATE_SPAN, RATE_WORSENS,
};
use crate::effects::{EffectKind, Place};
use crate::model::Model;
use crate::recording::Trajectory;
use crate::statistics::golden;
use std::sync::Arc;

/// The law of an error that is small.
pub(super) const LAW: (EffectKind, Place) = (EffectKind::WrongSampleRate, Place::Variant(0));

/// Times that were found to be wrong, and were corrected.
#[derive(Debug, Clone)]
pub(super) struct WrongRate {
    /// Logarithm of how many times faster the robot moved.
    pub logarithm: f64,
    /// Its standard deviation.
    pub sigma: f64,
    /// The standard model at the times as they were declared.
    pub declared: Estimated,
    /// Its errors on held-out motion.
    pub errors: Errors,
    refined: usize,
}

impl WrongRate {
    /// A factor, and what the standard model was at the declared rate.
    ///
    /// # Errors
    /// [`SingularDesign`] where a split has no fit.
    pub fn new(factor: f64, design: &Design, fit: &Fit) -> Result<Self, SingularDesign> {
        let p = design.parameters;
        let declared = Estimated {
            chi: fit.chi.iter().take(p).copied().collect(),
            sigma: fit.variances().iter().take(p).map(|v| v.max(0.0).sqrt()).collect(),
        };
        let beside_baseline = design.segments.iter().any(|s| !s.is_target);
        let errors = HeldOutSquares::of(design, &fit.sigma, beside_baseline, &[])?.errors();
        Ok(Self { logarithm: factor.ln(), sigma: 0.0, declared, errors, refined: 0 })
    }

    /// Estimates what is still wrong on rows at nearly the right rate; whether that is no more than its own standard
    /// deviation.
    ///
    /// # Errors
    /// [`SingularDesign`] where there is no fit.
    pub fn refine(&mut self, context: &Context<'_>, mut design: Design) -> Result<bool, SingularDesign> {
        let (effect, place) = LAW;
        for column in dense_columns(context, &design, effect, place, &[], !context.is_alone()) {
            design.push(column);
        }
        design.refresh();
        let fit = Fit::weighted(&design, &vec![1.0; design.joints])?;
        let last = design.columns.len() - 1;
        let more = fit.chi[last];
        self.sigma = fit.variances()[last].max(0.0).sqrt();
        if more.abs() <= self.sigma || self.refined >= RATE_ROUNDS {
            return Ok(true);
        }
        self.logarithm += more;
        self.refined += 1;
        Ok(false)
    }
}

/// The trajectories in a time that runs so many times faster.
pub(super) fn corrected(trajectories: &[Trajectory], factor: f64) -> Vec<Trajectory> {
    let mut corrected = trajectories.to_vec();
    for motion in &mut corrected {
        motion.time.iter_mut().for_each(|t| *t /= factor);
        // What was written beside the positions belongs to the time that was declared.
        motion.velocity = None;
    }
    corrected
}

/// Whether half of what the standard model leaves of every joint is noise: no error of a large factor or angle leaves so little.
pub(super) fn is_explained((design, fit): (&Design, &Fit)) -> bool {
    let noise = |j: usize| noise_floor(design, fit, j) / fit.sigma[j].max(f64::MIN_POSITIVE);
    (0..design.joints).all(|j| design.of_joint(j).is_empty() || noise(j).powi(2) > RATE_LEAVES)
}

/// The factor by which the robot moved faster than the times say, where one other than 1 leaves less than half of what
/// the standard model leaves, on no joint more, with the logarithm of the part that it leaves in the mean over joints. Beside a
/// baseline that model is known as far as the motions from `before` tell it.
///
/// # Errors
/// [`SingularDesign`] where there is no fit.
pub(super) fn factor(
    model: &dyn Model,
    motions: &Motions,
    declared: &Fit,
    before: Option<Prior>,
) -> Result<Option<(f64, f64)>, SingularDesign> {
    let (targets, before) = (motions.of_target(), before.map(Arc::new));
    let spread = |logarithm: f64| -> Result<Vec<f64>, SingularDesign> {
        let mut rows = targets.faster(logarithm.exp()).aligned(model);
        if before.is_some() {
            rows.prior.clone_from(&before);
        }
        Ok(Fit::weighted(&rows, &declared.sigma)?.sigma)
    };
    let at_declared = if before.is_some() { spread(0.0)? } else { declared.sigma.clone() };
    // Squares of each joint relative to those at the declared rate.
    let left = |logarithm: f64| -> Result<Vec<f64>, SingularDesign> {
        let both = spread(logarithm)?.into_iter().zip(&at_declared);
        Ok(both.map(|(s, s0)| if *s0 > 0.0 { (s / s0).powi(2) } else { 1.0 }).collect())
    };
    let mean = |squares: &[f64]| squares.iter().map(|s| s.ln()).sum::<f64>() / squares.len().max(1) as f64;
    let mut best = (0.0, 0.0);
    for factor in RATE_FACTORS {
        let value = mean(&left(factor.ln())?);
        if value < best.1 {
            best = (factor.ln(), value);
        }
    }
    if best.0 == 0.0 {
        return Ok(None);
    }
    // Golden sections around the best of them.
    let around = [best.0 - RATE_SPAN, best.0 + RATE_SPAN];
    let found = golden::least(around, RATE_REFINED, |logarithm| Ok(mean(&left(logarithm)?)))?;
    let squares = left(found)?;
    let certain = found.abs() > RATE_LEAST
        && mean(&squares) < RATE_LEAVES.ln()
        && squares.iter().all(|s| *s < RATE_WORSENS);
    Ok(certain.then(|| (found.exp(), mean(&squares))))
}
