//! What a diagnosis starts from: motions whose times run as the robot did, the standard model on them, the skew of the
//! torques; and the recordings that it refuses.

use super::error::DiagnosisError;
use super::judging::skew::{Skew, usual_deviation};
use super::large_error::{LargeError, large_error};
use super::motions::Motions;
use super::rate::{WrongRate, corrected, factor, is_explained};
use super::rows::context::Context;
use super::rows::design::Design;
use super::rows::fit::Fit;
use super::rows::motion::{Moving, left_over};
use super::rows::scales::scales_of_target;
use super::rules;
use super::settings::Settings;
use crate::model::{JointIndex, Model};
use crate::recording::Trajectory;
use std::sync::Arc;

/// Everything that is computed once, before contacts and effects are looked for.
pub(super) struct Prepared {
    pub motions: Motions,
    /// Base parameters of the standard model, fitted before the skew was taken out.
    pub chi: Vec<f64>,
    /// Standard deviation of its residual, per joint.
    pub sigma: Vec<f64>,
    /// Skew of the torques that was taken out of the motions, s.
    pub delay: f64,
    /// Slow rows that leave nothing out but standstills.
    pub aligned: Design,
    /// Standard deviations of the base parameters.
    pub chi_sigma: Vec<f64>,
    /// How much each joint moves.
    pub moving: Moving,
    /// Times that were wrong by a factor, and were corrected before anything else.
    pub rate: Option<WrongRate>,
    /// Numbers of joints that are far off.
    pub large_error: Option<LargeError>,
}

/// The standard model on all rows, not yet judged.
struct Fitted {
    motions: Motions,
    aligned: Design,
    fit: Fit,
    moving: Moving,
}

impl Prepared {
    /// Prepares the motions, refuses what cannot be diagnosed, and takes the skew of the torques out.
    ///
    /// # Errors
    /// [`DiagnosisError`] where there is no motion, or too little of it, or it does not excite the standard model, or
    /// the standard model does not describe it.
    pub fn new(
        model: &dyn Model,
        trajectories: &[Trajectory],
        baseline: &[Trajectory],
        settings: &Settings,
    ) -> Result<Self, DiagnosisError> {
        if trajectories.is_empty() {
            return Err(DiagnosisError::NoMotion);
        }
        let joints = model.robot().joints();
        if let Some(other) = baseline.iter().find(|t| t.position.len() != joints) {
            return Err(DiagnosisError::OtherBaseline { given: other.position.len(), joints });
        }
        let fitted = Fitted::new(model, trajectories, baseline, settings)?;
        let declared = (&fitted.aligned, &fitted.fit);
        if !fitted.moving.judged.contains(&true) || is_explained(declared) {
            return Self::judged(model, fitted);
        }
        let is_old: Vec<bool> = fitted.aligned.segments.iter().map(|s| !s.is_target).collect();
        let has_baseline = is_old.contains(&true);
        let before =
            has_baseline.then(|| Fit::new(&fitted.aligned, &fitted.fit.sigma, is_old)).transpose()?;
        let large_error = large_error(model, &fitted.motions, declared, before.as_ref());
        let known = before.map(|before| before.as_prior(&fitted.aligned));
        let rate = factor(model, &fitted.motions, &fitted.fit, known)?;
        // Each is the other one's rival.
        if let Some((factor, left)) = rate
            && large_error.as_ref().is_none_or(|other| left < other.left)
        {
            let wrong = WrongRate::new(factor, &fitted.aligned, &fitted.fit)?;
            // A rate at which nothing can be made of the motion is not the right one, nor is one that leads back to the declared.
            let recordings = (trajectories, baseline);
            if let Ok(corrected) = Self::at_the_right_rate(model, recordings, settings, wrong)
                && corrected.rate.as_ref().is_some_and(|wrong| wrong.logarithm.abs() > rules::RATE_LEAST)
            {
                return Ok(corrected);
            }
        }
        Ok(Self { large_error, ..Self::judged(model, fitted)? })
    }

    /// With times that run as the robot did; the factor is refined on the way.
    fn at_the_right_rate(
        model: &dyn Model,
        (trajectories, baseline): (&[Trajectory], &[Trajectory]),
        settings: &Settings,
        mut wrong: WrongRate,
    ) -> Result<Self, DiagnosisError> {
        loop {
            let faster = corrected(trajectories, wrong.logarithm.exp());
            let mut prepared = Self::judged(model, Fitted::new(model, &faster, baseline, settings)?)?;
            let right = wrong.refine(&prepared.context(model)?, prepared.aligned.clone())?;
            if right {
                prepared.rate = Some(wrong);
                return Ok(prepared);
            }
        }
    }

    /// Refuses what cannot be diagnosed, and takes the skew of the torques out.
    fn judged(model: &dyn Model, fitted: Fitted) -> Result<Self, DiagnosisError> {
        let Fitted { motions, aligned, fit, moving } = fitted;
        check_fit(&aligned, &fit)?;
        let chi = fit.chi.iter().take(aligned.parameters).copied().collect();
        let chi_sigma = fit.variances().iter().take(aligned.parameters).map(|v| v.max(0.0).sqrt()).collect();
        let (sigma, rate, large_error) = (fit.sigma, None, None);
        let delay = motions.settings().reference.as_ref().map_or(0.0, |r| r.delay());
        let mut prepared = Self { motions, chi, sigma, delay, aligned, chi_sigma, moving, rate, large_error };
        // Without motion there is no skew to be seen.
        if prepared.moving.judged.contains(&true) {
            prepared.take_out_skew(model)?;
        }
        Ok(prepared)
    }

    /// The model and the motions, at the standard parameters.
    ///
    /// # Errors
    /// [`DiagnosisError::Model`] where the recursive model cannot be built.
    pub fn context<'a>(&'a self, model: &'a dyn Model) -> Result<Context<'a>, DiagnosisError> {
        let signals = &self.motions.signals;
        let scales = scales_of_target(model, signals, &self.chi, &self.motions.slowest);
        let context = Context::new(model, signals, scales, self.chi.clone())?;
        let settings = self.motions.settings();
        Ok(context.on(settings.threads).beside(settings.reference.clone()))
    }

    /// Takes out the skew of the torques: of a baseline, which a reference knows, and of the recording, which may have another.
    fn take_out_skew(&mut self, model: &dyn Model) -> Result<(), DiagnosisError> {
        let of_reference = self.motions.settings().reference.as_ref().map(|r| r.delay());
        if of_reference.is_none() && self.motions.signals.iter().any(|s| !s.is_target) {
            self.take_out_skew_of(model, false, 0.0)?;
        }
        self.delay = self.take_out_skew_of(model, true, of_reference.unwrap_or(0.0))?;
        Ok(())
    }

    /// A skew of more than a part of a sample is taken out of the motions themselves: what is to be expected of it, as one
    /// from noise would be wrong for other motion. The robot may carry more than a reference knows of, or than it did in its
    /// baseline, and the torque of that is no skew: every parameter is free to be another one. `before` has been taken out of
    /// them, s; returns all that then is.
    fn take_out_skew_of(
        &mut self,
        model: &dyn Model,
        of_target: bool,
        before: f64,
    ) -> Result<f64, DiagnosisError> {
        let mut delay = before;
        for _ in 0..rules::DELAY_ROUNDS {
            let (mut rows, mut context) = (self.aligned.clone(), self.context(model)?);
            if let Some(prior) = rows.prior.take() {
                rows.prior = Some(Arc::new(prior.loosened(rules::LOOSE_REFERENCE)));
                let fit = Fit::weighted(&rows, &self.sigma)?;
                let chi = fit.chi.iter().take(rows.parameters).copied().collect();
                context.update(chi);
            }
            let wanted = |k: usize| context.signals[k].is_target == of_target;
            if of_target && !context.is_alone() {
                rows.free_in(wanted);
            }
            let found = Skew::of(&context, rows, wanted)?.expected(delay - before, usual_deviation(&context));
            let more = before + found - delay;
            if more.abs() * context.rate() < rules::DELAY_TAKEN_OUT {
                break;
            }
            delay += more;
            for motion in self.motions.signals.iter_mut().filter(|s| s.is_target == of_target) {
                motion.set_delay(delay)?;
            }
            self.aligned = self.motions.aligned(model);
        }
        Ok(delay)
    }
}

impl Fitted {
    /// Fits the standard model to the rows of what moves, and refuses motions that tell nothing.
    fn new(
        model: &dyn Model,
        trajectories: &[Trajectory],
        baseline: &[Trajectory],
        settings: &Settings,
    ) -> Result<Self, DiagnosisError> {
        let mut motions = Motions::new(model, trajectories, baseline, settings)?;
        let mut aligned = motions.aligned(model);
        let reference = motions.settings().reference.as_ref();
        let moving = Moving::of(&aligned, reference.map(|r| r.knows_friction(model.robot())));
        if moving.fitted.contains(&false) {
            motions.hold_still(&moving.fitted);
            aligned = motions.aligned(model);
        }
        let mut fit = Fit::weighted(&aligned, &vec![1.0; aligned.joints])?;
        motions.left_over = check_rows(model, &aligned, &fit, &moving)?;
        if !motions.left_over.is_empty() {
            aligned = motions.aligned(model);
            fit = Fit::weighted(&aligned, &vec![1.0; aligned.joints])?;
        }
        if motions.hold_out_what_others_show(&aligned, &fit.sigma) {
            aligned = motions.aligned(model);
            fit = Fit::weighted(&aligned, &fit.sigma)?;
        }
        motions.leave_out_untold(&mut aligned, &fit.sigma)?;
        Ok(Self { motions, aligned, fit, moving })
    }
}

/// Refuses motions that tell nothing. Returns the base parameters that are left out because the motion does not
/// determine them, where they are so many, or joints stand still, that small ones would be made up from noise.
fn check_rows(
    model: &dyn Model,
    design: &Design,
    fit: &Fit,
    moving: &Moving,
) -> Result<Vec<usize>, DiagnosisError> {
    if !moving.fitted.contains(&true) {
        // At rest beside a reference nothing is fitted: its parameters are known.
        let known = design.prior.is_some() && moving.friction_known.contains(&true);
        return if known { Ok(Vec::new()) } else { Err(nothing_moves(model, moving)) };
    }
    let parameters = design.parameters - design.known.len();
    let is_free = |k: &usize| *k < design.parameters && design.known.iter().all(|(known, _)| known != k);
    let free: Vec<usize> = fit.undetermined(rules::UNDETERMINED).into_iter().filter(|k| is_free(k)).collect();
    let few =
        free.len() * rules::PARAMETERS_PER_UNDETERMINED <= parameters && !moving.fitted.contains(&false);
    let left_over = match &design.prior {
        _ if few => Vec::new(),
        // What a reference knows needs no motion.
        Some(_) => free.clone(),
        None => left_over(design, &fit.sigma).into_iter().filter(is_free).collect(),
    };
    let known = fit.known_beforehand(design).floor() as usize;
    let not_fitted = known + if few { free.len() } else { left_over.len() };
    let (rows, fitted) = (design.rows.len(), parameters.saturating_sub(not_fitted).max(1));
    let needed = rules::ROWS_PER_PARAMETER * fitted;
    if rows < needed {
        return Err(DiagnosisError::TooShort {
            rows,
            parameters: fitted,
            times: needed.div_ceil(rows.max(1)),
        });
    }
    Ok(left_over)
}

/// What is said where nothing moves.
pub(super) fn nothing_moves(model: &dyn Model, moving: &Moving) -> DiagnosisError {
    let most = moving.rows.iter().enumerate().max_by_key(|(_, rows)| **rows);
    let (joint, rows) = most.map_or((0, 0), |(j, rows)| (model.robot().joint_number(JointIndex(j)).0, *rows));
    DiagnosisError::NothingMoves { joint, rows, needed: rules::LEAST_ROWS }
}

/// Refuses recordings that the standard model has nothing to do with.
fn check_fit(design: &Design, fit: &Fit) -> Result<(), DiagnosisError> {
    if design.rows.is_empty() {
        return Ok(());
    }
    let (mut left, mut all) = (0.0, 0.0);
    for (j, s) in fit.sigma.iter().enumerate() {
        let rows = design.of_joint(j);
        left += s * s * rows.len() as f64;
        all += rows.map(|r| design.torque(r).powi(2)).sum::<f64>();
    }
    let explained = 100.0 * (1.0 - left / all.max(1e-300));
    if explained < rules::LEAST_EXPLAINED_BY_MODEL {
        return Err(DiagnosisError::AnotherRobot { explained });
    }
    Ok(())
}
