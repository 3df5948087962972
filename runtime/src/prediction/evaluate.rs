//! Models on the rows of a recording.

use super::errors::above_noise;
use super::noise::variance;
use super::predictor::{PredictionError, Predictor};
use crate::diagnosis::Errors;
use crate::estimation::observe::{LeftOut, ObserveError, ObserveSettings, RowPlan, row_plans, why_nothing};
use crate::model::Model;
use crate::signal::Motion;

/// What one model leaves of the torques of a recording.
#[derive(Debug, Clone, PartialEq)]
pub struct Prediction {
    /// Relative errors.
    pub errors: Errors,
    /// What of them white noise makes, of the level that what the model leaves has above the band; joint by joint no
    /// more than the error. `None` where that level cannot be read.
    ///
    /// It depends on nothing but the model and the recording, so that it is the same in every comparison. It is an upper
    /// bound: where a controller answers to the noise of its encoders, torques are rougher above the band than in it, and
    /// what a model does not know reaches above the band, too. Noise that equals an error says that nothing of this error
    /// is known to be more than noise.
    pub noise: Option<Errors>,
}

impl Prediction {
    /// The noise, where it makes up a tenth or more of the squared error.
    pub fn noise_matters(&self) -> Option<&Errors> {
        let noise = self.noise.as_ref()?;
        let (part, whole) = (noise.relative_error?, self.errors.relative_error?);
        (part.powi(2) >= NOISE_MATTERS * whole.powi(2)).then_some(noise)
    }

    /// What is left of the errors without the noise, where it can be told.
    pub fn above_noise(&self) -> Option<Errors> {
        Some(above_noise(&self.errors, self.noise.as_ref()?))
    }
}

/// The rows of one joint in one motion, measured and as every model predicts them.
#[derive(Debug, Clone, PartialEq)]
pub struct JointRows {
    /// Index of the motion.
    pub trajectory: usize,
    /// Joint, counted from 0.
    pub joint: usize,
    /// Centre of each row, s.
    pub time: Vec<f64>,
    /// Whether the row is used.
    pub used: Vec<bool>,
    /// N.m or N.
    pub measured: Vec<f64>,
    /// For each model in the order in which they were given.
    pub predicted: Vec<Vec<f64>>,
}

/// Models that were evaluated together: one band, the same rows.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    /// One for each model, in the order in which they were given.
    pub predictions: Vec<Prediction>,
    /// Band of the rows, Hz.
    pub band: f64,
    /// Names of the motions.
    pub trajectories: Vec<String>,
    /// For each motion and joint, the rows used and left out.
    pub left_out: Vec<LeftOut>,
    /// Rows left out because they lie in a window that was excluded.
    pub excluded: usize,
    /// Samples of the motions, all joints counted once.
    pub samples: usize,
    /// The rows, motion by motion, joint by joint.
    pub rows: Vec<JointRows>,
}

/// Share of a squared error from which noise is worth a word.
const NOISE_MATTERS: f64 = 0.1;

impl Evaluation {
    /// Rows used, all joints together.
    pub fn used(&self) -> usize {
        self.left_out.iter().map(|l| l.used).sum()
    }

    /// Rows left out where a joint hardly moves.
    pub fn standing(&self) -> usize {
        self.left_out.iter().map(|l| l.standstill).sum()
    }
}

/// Evaluates models of one robot on the same rows of the same motions.
///
/// `excluded` are windows of time, by the name of their motion, in which something that no model of the robot has part
/// in happened: rows that reach into them are not used.
///
/// # Errors
/// Motions of another robot, settings that mean nothing, an effect that cannot be evaluated, or no row to be used.
pub fn evaluate(
    model: &dyn Model,
    predictors: &[Predictor<'_>],
    motions: &[Motion],
    settings: &ObserveSettings,
    excluded: &[(&str, [f64; 2])],
) -> Result<Evaluation, PredictionError> {
    let joints = model.robot().joints();
    let mut plans = row_plans(model.robot(), motions, settings)?;
    let mut left_out_by_window = 0;
    for (plan, motion) in plans.iter_mut().zip(motions) {
        left_out_by_window += exclude(plan, motion, excluded);
    }
    let mut sums = Sums::new(joints, predictors.len());
    let mut rows = Vec::new();
    for (trajectory, (motion, plan)) in motions.iter().zip(&plans).enumerate() {
        let torques = predictors.iter().map(|p| p.torques(model, motion)).collect::<Result<Vec<_>, _>>()?;
        for joint in 0..joints {
            let predicted: Vec<&[f64]> = torques.iter().map(|t| t[joint].as_slice()).collect();
            let of_joint = joint_rows(trajectory, joint, motion, plan, &predicted);
            sums.add(&of_joint, motion, plan, &predicted);
            rows.push(of_joint);
        }
    }
    let left_out: Vec<LeftOut> = plans.iter().flat_map(|p| p.left_out.clone()).collect();
    if left_out.iter().all(|l| l.used == 0) {
        return Err(ObserveError::NoRows { reason: why_nothing(&plans, motions, settings) }.into());
    }
    Ok(Evaluation {
        predictions: sums.predictions(),
        band: settings.band,
        trajectories: motions.iter().map(|m| m.name.clone()).collect(),
        left_out,
        excluded: left_out_by_window,
        samples: motions.iter().map(|m| m.q.first().map_or(0, Vec::len)).sum(),
        rows,
    })
}

/// Takes the rows that reach into a window out of those used; says how many.
fn exclude(plan: &mut RowPlan, motion: &Motion, windows: &[(&str, [f64; 2])]) -> usize {
    let reach = plan.decimator.support() as f64 / motion.rate;
    let mut count = 0;
    let own: Vec<[f64; 2]> = windows.iter().filter(|(name, _)| *name == motion.name).map(|w| w.1).collect();
    for (used, left_out) in plan.used.iter_mut().zip(&mut plan.left_out) {
        for (used, centre) in used.iter_mut().zip(plan.grid.centres()) {
            let t = motion.start + centre as f64 / motion.rate;
            if *used && own.iter().any(|w| t + reach > w[0] && t - reach < w[1]) {
                *used = false;
                left_out.used -= 1;
                left_out.windows += 1;
                count += 1;
            }
        }
    }
    count
}

/// A signal at the full rate, at the rows of a plan.
pub(super) fn decimated(signal: &[f64], plan: &RowPlan) -> Vec<f64> {
    let from = plan.grid.first.saturating_sub(plan.decimator.support());
    let mut out = vec![0.0; plan.grid.count];
    plan.decimator.decimate_run(&signal[from.min(signal.len())..], &mut out);
    out
}

fn joint_rows(
    trajectory: usize,
    joint: usize,
    motion: &Motion,
    plan: &RowPlan,
    predicted: &[&[f64]],
) -> JointRows {
    let decimated = |signal: &[f64]| decimated(signal, plan);
    JointRows {
        trajectory,
        joint,
        time: plan.grid.centres().map(|c| motion.start + c as f64 / motion.rate).collect(),
        used: plan.used[joint].clone(),
        measured: decimated(&motion.torque[joint]),
        predicted: predicted.iter().map(|p| decimated(p)).collect(),
    }
}

/// Sums of squares per joint.
struct Sums {
    whole: Vec<f64>,
    /// For each model.
    left: Vec<Vec<f64>>,
    /// What noise makes of it; `None` once it could not be read.
    noise: Vec<Option<Vec<f64>>>,
}

impl Sums {
    fn new(joints: usize, models: usize) -> Self {
        Self {
            whole: vec![0.0; joints],
            left: vec![vec![0.0; joints]; models],
            noise: vec![Some(vec![0.0; joints]); models],
        }
    }

    fn add(&mut self, rows: &JointRows, motion: &Motion, plan: &RowPlan, predicted: &[&[f64]]) {
        let j = rows.joint;
        let used = |values: &[f64], other: Option<&[f64]>| -> f64 {
            let each = values.iter().zip(&rows.used).enumerate().filter(|(_, (_, used))| **used);
            each.map(|(k, (v, _))| (v - other.map_or(0.0, |o| o[k])).powi(2)).sum()
        };
        self.whole[j] += used(&rows.measured, None);
        for (left, predicted) in self.left.iter_mut().zip(&rows.predicted) {
            left[j] += used(&rows.measured, Some(predicted));
        }
        let count = rows.used.iter().filter(|used| **used).count();
        if count == 0 {
            return;
        }
        for (noise, predicted) in self.noise.iter_mut().zip(predicted) {
            let residual: Vec<f64> = motion.torque[j].iter().zip(*predicted).map(|(y, p)| y - p).collect();
            let end = residual.len().saturating_sub(motion.edge_samples);
            let level = variance(&residual[motion.edge_samples.min(end)..end], motion.rate, plan.band);
            match (noise.as_mut(), level) {
                (Some(noise), Some(variance)) => noise[j] += variance * count as f64,
                _ => *noise = None,
            }
        }
    }

    fn predictions(&self) -> Vec<Prediction> {
        let of_model = |(left, noise): (&Vec<f64>, &Option<Vec<f64>>)| {
            // Noise that a model has explained is none.
            let capped = |noise: &Vec<f64>| -> Vec<f64> {
                noise.iter().zip(left).map(|(noise, left)| noise.min(*left)).collect()
            };
            let of = |squares: &[f64]| Errors::of_squares(squares, &self.whole);
            Prediction { errors: of(left), noise: noise.as_ref().map(|noise| of(&capped(noise))) }
        };
        self.left.iter().zip(&self.noise).map(of_model).collect()
    }
}
