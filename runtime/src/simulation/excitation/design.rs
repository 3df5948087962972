//! Search for motions that make the parameters observable, within the robot's limits.

use std::sync::atomic::{AtomicUsize, Ordering};

use nalgebra::DMatrix;

use super::ExcitingMotion;
use super::evolution::{Found, maximise};
use super::fourier::{FourierJoint, FourierMotion};
use super::information::{Criterion, Identification, Observer, condition, log_determinant};
use super::limits::{Limits, peak_torque_share};
use super::point_to_point::{PointToPointMotion, Profile};
use crate::model::Model;
use crate::simulation::SimulationError;

/// The family of motions that is searched.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum MotionKind {
    /// Fourier series.
    Fourier {
        /// Number of harmonics, 2 or more.
        harmonics: usize,
        /// Length of a period, s.
        period: f64,
        /// Periods of the motion.
        periods: usize,
    },
    /// Points joined by a profile.
    PointToPoint {
        /// Number of points, 2 or more.
        points: usize,
        /// How they are joined.
        profile: Profile,
        /// Stop at each point, s.
        pause: f64,
    },
}

/// What to search, and how long.
#[derive(Debug, Clone, PartialEq)]
pub struct ExcitationSettings {
    /// Family of motions.
    pub kind: MotionKind,
    /// What the motions are for.
    pub identification: Identification,
    /// What makes motions better.
    pub criterion: Criterion,
    /// The sets of section IV.B: `sets` motions, in motion k (from 0) joints 1 to k stand still. 1 is a single
    /// motion of all joints, n makes W block-triangular.
    pub sets: usize,
    /// Random starts for each motion.
    pub starts: usize,
    /// Candidate motions tried from each start.
    pub evaluations: usize,
    /// Share of every limit that may be used, in (0, 1].
    pub share: f64,
    /// Share of the position range that may be used, about its middle, in (0, 1]; where `share` is less, that holds.
    pub reach: f64,
    /// The same seed gives the same motions.
    pub seed: u64,
}

impl Default for ExcitationSettings {
    /// One random Fourier motion of 8 s that was not searched for, within 90 % of the limits.
    fn default() -> Self {
        Self {
            kind: MotionKind::Fourier { harmonics: 5, period: 8.0, periods: 1 },
            identification: Identification::Idim,
            criterion: Criterion::Determinant,
            sets: 1,
            starts: 1,
            evaluations: 0,
            share: 0.9,
            reach: 1.0,
            seed: 1,
        }
    }
}

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
    let size = robot.base.len();
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
        let runs = run_starts(&observer, &family, settings, set, &known, &tell);
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

/// Longest period and pause, s: torques are looked at densely, and a robot is not excited for hours.
const LONGEST: f64 = 3600.0;

fn check(settings: &ExcitationSettings, n: usize) -> Result<(), SimulationError> {
    let setting = |what, expected, found| Err(SimulationError::Setting { what, expected, found });
    match settings.kind {
        MotionKind::Fourier { harmonics, period, periods } => {
            if !(2..=64).contains(&harmonics) {
                return setting("number of harmonics", "2 to 64", harmonics as f64);
            }
            if !(period > 0.0 && period <= LONGEST) {
                return setting("period", "positive, at most 3600 s", period);
            }
            if !(1..=1000).contains(&periods) {
                return setting("number of periods", "1 to 1000", periods as f64);
            }
        }
        MotionKind::PointToPoint { points, pause, .. } => {
            if !(2..=1000).contains(&points) {
                return setting("number of points", "2 to 1000", points as f64);
            }
            if !(0.0..=LONGEST).contains(&pause) {
                return setting("pause", "0 to 3600 s", pause);
            }
        }
    }
    if settings.sets == 0 || settings.sets > n {
        return setting("number of sets", "1 to the number of joints", settings.sets as f64);
    }
    if settings.starts == 0 {
        return setting("number of starts", "1 or more", 0.0);
    }
    Ok(())
}

/// Runs every start, on as many threads as there are processors; the outcome does not depend on their number.
fn run_starts(
    observer: &Observer<'_>,
    family: &Family<'_>,
    settings: &ExcitationSettings,
    set: usize,
    known: &DMatrix<f64>,
    tell: &(dyn Fn(usize) + Sync),
) -> Vec<(Vec<f64>, Found)> {
    let workers = std::thread::available_parallelism().map_or(1, |x| x.get()).min(settings.starts);
    let one = |start: usize| {
        let seed = settings.seed.wrapping_mul(1_000_003).wrapping_add((set * 1009 + start) as u64);
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
    };
    std::thread::scope(|scope| {
        let handles: Vec<_> = (0..workers)
            .map(|worker| {
                let one = &one;
                let starts = (worker..settings.starts).step_by(workers);
                scope.spawn(move || starts.map(|s| (s, one(s))).collect::<Vec<_>>())
            })
            .collect();
        let mut runs: Vec<(usize, (Vec<f64>, Found))> =
            handles.into_iter().filter_map(|handle| handle.join().ok()).flatten().collect();
        runs.sort_by_key(|run| run.0);
        runs.into_iter().map(|run| run.1).collect()
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
fn slow_down(
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

/// How a point of the search space becomes a motion within the limits.
struct Family<'a> {
    kind: MotionKind,
    limits: &'a Limits,
    /// Joints 0 .. fixed stand still.
    fixed: usize,
}

impl Family<'_> {
    fn unknowns(&self) -> usize {
        let n = self.limits.position.len();
        let moving = n - self.fixed;
        match self.kind {
            // Where the fixed joints stand, then for each moving one its series, its place and its size.
            MotionKind::Fourier { harmonics, .. } => self.fixed + moving * (2 * (harmonics - 1) + 2),
            MotionKind::PointToPoint { points, .. } => self.fixed + moving * points,
        }
    }

    fn random_start(&self, seed: u64) -> Vec<f64> {
        use rand::{RngExt, SeedableRng};
        let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
        (0..self.unknowns()).map(|_| random.random_range(-1.0..1.0)).collect()
    }

    fn motion(&self, unknowns: &[f64]) -> ExcitingMotion {
        let n = self.limits.position.len();
        let (stands, series) = unknowns.split_at(self.fixed);
        let place = |j: usize, x: f64| {
            let [low, high] = self.limits.position[j];
            0.5 * (low + high) + 0.5 * (high - low) * x.tanh()
        };
        match self.kind {
            MotionKind::Fourier { harmonics, period, periods } => {
                let each = 2 * (harmonics - 1) + 2;
                let joints = (0..n)
                    .map(|j| match j.checked_sub(self.fixed) {
                        None => {
                            FourierJoint { center: place(j, stands[j]), cosine: Vec::new(), sine: Vec::new() }
                        }
                        Some(k) => self.fourier_joint(j, period, &series[k * each..][..each]),
                    })
                    .collect();
                ExcitingMotion::Fourier(FourierMotion { period, periods, joints })
            }
            MotionKind::PointToPoint { points, profile, pause } => {
                let list = (0..points)
                    .map(|p| {
                        (0..n)
                            .map(|j| match j.checked_sub(self.fixed) {
                                None => place(j, stands[j]),
                                Some(k) => place(j, series[k * points + p]),
                            })
                            .collect()
                    })
                    .collect();
                ExcitingMotion::PointToPoint(PointToPointMotion::within(
                    list,
                    profile,
                    pause,
                    &self.limits.velocity,
                    &self.limits.acceleration,
                ))
            }
        }
    }

    /// A series whose rigorous bounds fill a part of the limits that is itself searched.
    fn fourier_joint(&self, j: usize, period: f64, unknowns: &[f64]) -> FourierJoint {
        let (coefficients, rest) = unknowns.split_at(unknowns.len() - 2);
        let (cosine, sine) = coefficients.split_at(coefficients.len() / 2);
        let mut joint = FourierJoint::at_rest_at_start(0.0, cosine, sine);
        let shape = joint.bounds(period);
        let [low, high] = self.limits.position[j];
        let reach = 0.5 * (shape.position[1] - shape.position[0]);
        let largest = (0.5 * (high - low) / reach)
            .min(self.limits.velocity[j] / shape.velocity)
            .min(self.limits.acceleration[j] / shape.acceleration);
        if !largest.is_finite() {
            joint.scale(0.0);
            joint.center = 0.5 * (low + high);
            return joint;
        }
        let size = largest * (0.1 + 0.9 / (1.0 + (-rest[1] - 1.0).exp()));
        joint.scale(size);
        let middle = 0.5 * (shape.position[0] + shape.position[1]) * size;
        let room = (0.5 * (high - low) - reach * size).max(0.0);
        joint.center = 0.5 * (low + high) + room * rest[0].tanh() - middle;
        joint
    }
}
