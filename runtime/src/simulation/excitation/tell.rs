//! The motion that tells laws of one joint apart: the best of a family by a T-optimality criterion (Atkinson and Fedorov
//! 1975), see [`crate::diagnosis::distances`].

use super::design::{excite, slow_down};
use super::limits::Limits;
use super::motion::ExcitingMotion;
use super::settings::ExcitationSettings;
use super::strokes::{Candidate, family};
use crate::diagnosis::{DiagnosisError, Distances, Question, distances, typical_laws};
use crate::effects::{EffectKind, EffectTerm};
use crate::model::{Model, Robot};
use crate::parallel;
use crate::signal::Motion;
use crate::simulation::{Reference, SimulationError};

/// Rows a second at which motions are looked at, Hz: what a controller records, and twenty times what rows hold.
const RATE: f64 = 500.0;
/// Size of a law, as a share of its joint's Coulomb friction, and in multiples of the torque noise where there is less.
const SHARE: f64 = 0.5;
const NOISES: f64 = 3.0;

/// What is asked for.
#[derive(Debug, Clone, PartialEq)]
pub struct TellSettings {
    /// Laws that are to be told apart.
    pub effects: Vec<EffectKind>,
    /// Joint (0-based) that has one of them.
    pub joint: usize,
    /// Share of every limit that may be used, in (0, 1].
    pub share: f64,
    /// Share of the position range that may be used, in (0, 1].
    pub reach: f64,
    /// The same seed gives the same ordinary motion beside them.
    pub seed: u64,
}

/// A motion that was looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct Told {
    /// What it is.
    pub what: String,
    /// The motion.
    pub motion: ExcitingMotion,
    /// How far apart it puts the laws.
    pub distances: Distances,
}

/// The motions that were looked at.
#[derive(Debug, Clone, PartialEq)]
pub struct TellPlan {
    /// The laws as they were taken to be.
    pub laws: Vec<EffectTerm>,
    /// The size of each, N.m or N: its largest torque in an ordinary motion.
    pub size: f64,
    /// Noise of the joint's torque, 1 sigma, N.m or N.
    pub noise: f64,
    /// An ordinary exciting motion, for comparison.
    pub ordinary: Told,
    /// All of the family, the best first.
    pub candidates: Vec<Told>,
}

/// Why there is no such motion.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum TellError {
    /// A law that the joint cannot have, or that makes no torque there.
    #[error("{0} is no law of that joint alone, or makes no torque there")]
    NoLaw(&'static str),
    /// No motion of the family fits into the limits.
    #[error("no motion of that joint fits into the limits")]
    NoMotion,
    /// The robot has no limits, or none that a motion keeps.
    #[error(transparent)]
    Motion(#[from] SimulationError),
    /// The motions cannot be looked at.
    #[error(transparent)]
    Rows(#[from] DiagnosisError),
}

/// Chooses the motion of one joint on which laws differ most from each other, each from the span of the other's columns and
/// the standard parameters. `chi` are base parameters as known before, for loads, friction and torque limits.
///
/// # Errors
/// [`TellError`].
pub fn tell(model: &dyn Model, chi: Option<&[f64]>, settings: &TellSettings) -> Result<TellPlan, TellError> {
    let robot = model.robot();
    let limits = Limits::of(robot, settings.share, settings.reach)?;
    let noise = nominal_noise(robot);
    let known = chi.map_or_else(|| vec![0.0; robot.base.len()], <[f64]>::to_vec);
    let ordinary = ordinary(model, chi, (settings.share, settings.reach), settings.seed)?;
    let usual = looked_at(&ordinary);
    let size = size_of(model, (&known, &noise), settings.joint);
    let typical = typical_laws((model, &known), settings.joint, &settings.effects, size, &usual)?;
    let of = |(law, effect): (Option<EffectTerm>, &EffectKind)| law.ok_or(TellError::NoLaw(effect.id()));
    let laws: Vec<EffectTerm> =
        typical.into_iter().zip(&settings.effects).map(of).collect::<Result<_, _>>()?;
    let question = Question { model, chi: &known, noise: &noise, laws: &laws };
    let told = |Candidate { what, motion }: Candidate| {
        let distances = distances(&question, &looked_at(&motion))?;
        Ok::<_, DiagnosisError>(Told { what, motion, distances })
    };
    let mut motions = Vec::new();
    for mut candidate in family(&limits, settings.joint) {
        // One that even slowly breaks a torque limit is none.
        if chi.is_none_or(|chi| slow_down(model, chi, settings.share, &mut candidate.motion).is_ok()) {
            motions.push(candidate);
        }
    }
    let all = parallel::map(0, motions.len(), |k| told(motions[k].clone()));
    // A motion without rows, or without a fit, tells nothing.
    let mut candidates: Vec<Told> = all.into_iter().filter_map(Result::ok).collect();
    candidates.sort_by(|a, b| b.distances.least().total_cmp(&a.distances.least()));
    if candidates.is_empty() {
        return Err(TellError::NoMotion);
    }
    let ordinary = told(Candidate { what: "an ordinary exciting motion".to_owned(), motion: ordinary })?;
    Ok(TellPlan { size, noise: noise[settings.joint], laws, ordinary, candidates })
}

/// A law of a joint (0-based) as it may be in a robot with the base parameters `chi`: of the middle of its shapes for an
/// ordinary motion within the limits, and as large there as `size`, N.m or N, or as [`tell`] takes laws to be.
///
/// # Errors
/// [`TellError`], among them a robot without limits.
pub fn typical_law(
    model: &dyn Model,
    chi: &[f64],
    (effect, joint): (EffectKind, usize),
    size: Option<f64>,
) -> Result<EffectTerm, TellError> {
    let usual = ordinary(model, Some(chi), (1.0, 1.0), 0)?;
    let size = size.unwrap_or_else(|| size_of(model, (chi, &nominal_noise(model.robot())), joint));
    let mut laws = typical_laws((model, chi), joint, &[effect], size, &looked_at(&usual))?;
    laws.pop().flatten().ok_or(TellError::NoLaw(effect.id()))
}

/// Noise of the torques, 1 sigma, as the robot says.
fn nominal_noise(robot: &Robot) -> Vec<f64> {
    match &robot.nominal {
        Some(nominal) if nominal.torque_noise.len() == robot.joints() => nominal.torque_noise.to_vec(),
        _ => vec![1.0; robot.joints()],
    }
}

/// How large laws are taken to be.
fn size_of(model: &dyn Model, (chi, noise): (&[f64], &[f64]), joint: usize) -> f64 {
    (SHARE * coulomb(model, chi, joint)).max(NOISES * noise[joint])
}

/// A motion that nobody would choose for a law.
fn ordinary(
    model: &dyn Model,
    chi: Option<&[f64]>,
    (share, reach): (f64, f64),
    seed: u64,
) -> Result<ExcitingMotion, SimulationError> {
    let search = ExcitationSettings { share, reach, seed, starts: 1, evaluations: 200, ..Default::default() };
    Ok(excite(model, chi, &search, &|_| {})?.motions.swap_remove(0))
}

/// Coulomb friction of a joint, N.m or N.
fn coulomb(model: &dyn Model, chi: &[f64], joint: usize) -> f64 {
    use crate::model::ParameterKind::Fc;
    let robot = model.robot();
    let frames = robot.joint_of_frame();
    let is_own = |k: usize| {
        let standard = &robot.standard[robot.base[k].standard];
        standard.kind == Fc && frames.get(standard.frame).copied().flatten() == Some(joint)
    };
    (0..chi.len()).filter(|&k| is_own(k)).map(|k| chi[k].abs()).sum()
}

/// A motion as a recording of it would be, without its ends, where it stands.
fn looked_at(motion: &ExcitingMotion) -> Motion {
    let n = motion.joints();
    let samples = (motion.duration() * RATE) as usize;
    let zero = || vec![vec![0.0; samples]; n];
    let mut out = Motion {
        name: String::new(),
        rate: RATE,
        start: 0.0,
        q: zero(),
        dq: zero(),
        ddq: zero(),
        torque: zero(),
        fixed: motion.fixed(),
        edge_samples: 0,
    };
    let (mut q, mut dq, mut ddq) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    for t in 0..samples {
        motion.at(t as f64 / RATE, &mut q, &mut dq, &mut ddq);
        for j in 0..n {
            (out.q[j][t], out.dq[j][t], out.ddq[j][t]) = (q[j], dq[j], ddq[j]);
        }
    }
    out
}
