//! Search for motions that make the parameters observable, within the robot's limits.

use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::DMatrix;

use super::evolution::{Found, maximise};
use super::family::Family;
use super::information::{Observer, condition, log_determinant};
use super::limits::{Limits, peak_torque_share};
use super::motion::ExcitingMotion;
use super::settings::{ExcitationSettings, MotionKind, check};
use crate::model::Model;
use crate::parallel;
use crate::simulation::SimulationError;

/// Motions that were found.
#[derive(Debug, Clone, PartialEq)]
pub struct ExcitationPlan {
    /// One motion for each set.
    pub motions: Vec<ExcitingMotion>,
    /// Condition number of the weighted, scaled W of the random start motions that the best ones came from.
    pub condition_before: f64,
    /// The same of `motions`.
    pub condition_after: f64,
    /// log det of (I + information) of the start motions.
    pub log_determinant_before: f64,
    /// The same of `motions`.
    pub log_determinant_after: f64,
    /// `blocks[set][joint]`: whether the columns of the joint's parameters in dh are non-zero in that set.
    pub blocks: Vec<Vec<bool>>,
    /// Largest share of a torque limit that any motion takes; `None` where parameters or limits are not known.
    pub torque_share: Option<f64>,
}

/// Searches exciting motions for a robot. `chi` are base parameters as known before, for the torque limits and the
/// sizes of the parameters. `progress` is told the share done, from several threads.
///
/// Motions are searched one set after the other, each to add most to the information of those before it.
///
/// # Errors
/// Settings out of range; a robot without position, velocity and acceleration limits; a torque limit that even
/// the slowest motion breaks.
pub fn excite(
    model: &dyn Model,
    chi: Option<&[f64]>,
    settings: &ExcitationSettings,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<ExcitationPlan, SimulationError> {
    let robot = model.robot();
    let limits = Limits::of(robot, settings.share, settings.reach)?;
    check(settings, robot.joints())?;
    let samples = match settings.kind {
        MotionKind::Fourier { harmonics, .. } => 24 * harmonics,
        MotionKind::PointToPoint { points, .. } => 24 * (points - 1),
    };
    let observer = Observer::new(model, chi, settings.identification, samples.clamp(60, 400));
    let size = observer.unknowns();
    let mut known = DMatrix::zeros(size, size);
    let mut known_before = DMatrix::zeros(size, size);
    let mut plan = ExcitationPlan {
        motions: Vec::new(),
        condition_before: 0.0,
        condition_after: 0.0,
        log_determinant_before: 0.0,
        log_determinant_after: 0.0,
        blocks: Vec::new(),
        torque_share: None,
    };
    let done = AtomicUsize::new(0);
    let whole = settings.sets.saturating_mul(settings.starts).saturating_mul(settings.evaluations);
    for set in 0..settings.sets {
        let family = Family { kind: settings.kind, limits: &limits, fixed: set };
        let tell = |more: usize| {
            let before = done.fetch_add(more, Ordering::Relaxed);
            progress(((before + more) as f64 / whole as f64).min(1.0));
        };
        let runs = run_starts(&observer, &family, settings, &known, &tell);
        let mut best: Option<&(Vec<f64>, Found)> = None;
        for run in &runs {
            if best.is_none_or(|b| run.1.value > b.1.value) {
                best = Some(run);
            }
        }
        let Some((start, found)) = best else { continue };
        let mut motion = family.motion(&found.point);
        if let Some(chi) = chi {
            let share = slow_down(model, chi, settings.share, &mut motion)?;
            plan.torque_share = Some(plan.torque_share.map_or(share, |s: f64| s.max(share)));
        }
        let mut observer = observer.clone();
        observer.add(&motion, &mut known);
        observer.add(&family.motion(start), &mut known_before);
        plan.blocks.push(observer.blocks(&motion));
        plan.motions.push(motion);
    }
    progress(1.0);
    plan.condition_before = condition(&known_before);
    plan.condition_after = condition(&known);
    plan.log_determinant_before = log_determinant(&known_before);
    plan.log_determinant_after = log_determinant(&known);
    Ok(plan)
}

/// Runs every start over the threads of the machine; the outcome does not depend on their number.
fn run_starts(
    observer: &Observer<'_>,
    family: &Family<'_>,
    settings: &ExcitationSettings,
    known: &DMatrix<f64>,
    tell: &(dyn Fn(usize) + Sync),
) -> Vec<(Vec<f64>, Found)> {
    parallel::map(0, settings.starts, |start| {
        let own = (family.fixed * 1009 + start) as u64;
        let seed = settings.seed.wrapping_mul(1_000_003).wrapping_add(own);
        let genome = family.random_start(seed);
        let mut observer = observer.clone();
        let mut told = 0;
        let found = maximise(
            &genome,
            0.4,
            settings.evaluations,
            seed ^ 0x5EED,
            &mut |candidate| merit(&mut observer, family, settings, known, candidate),
            &mut |used| {
                tell(used - told);
                told = used;
            },
        );
        (genome, found)
    })
}

/// The criterion for what is known with the candidate, less a penalty where it would break a torque limit.
fn merit(
    observer: &mut Observer<'_>,
    family: &Family<'_>,
    settings: &ExcitationSettings,
    known: &DMatrix<f64>,
    candidate: &[f64],
) -> f64 {
    let mut information = known.clone();
    let torque = observer.add(&family.motion(candidate), &mut information);
    settings.criterion.merit(&information) - 200.0 * (torque / settings.share - 1.0).max(0.0)
}

/// Makes a motion slower until its torques keep to the share of the limits at every instant that is looked at.
pub(super) fn slow_down(
    model: &dyn Model,
    chi: &[f64],
    share: f64,
    motion: &mut ExcitingMotion,
) -> Result<f64, SimulationError> {
    let mut taken = peak_torque_share(model, chi, motion)?;
    for _ in 0..60 {
        if taken <= share {
            return Ok(taken);
        }
        motion.stretch(1.05);
        taken = peak_torque_share(model, chi, motion)?;
    }
    Err(SimulationError::TorqueLimit { share: taken })
}
