//! The paper's recordings, simulated: one motion of all joints and the sets of section IV.B, for any seed.

use thiserror::Error;

use super::cases::{CaseResult, PaperSettings, run_cases};
use crate::estimation::observe::ObserveError;
use crate::model::Model;
use crate::recording::Trajectory;
use crate::signal::{Motion, Preparation, SignalError, prepare};
use crate::simulation::excitation::{
    Criterion, ExcitationPlan, ExcitationSettings, ExcitingMotion, Identification, MotionKind, Profile,
    excite,
};
use crate::simulation::{
    LoopSettings, Plant, Residue, Simulation, SimulationError, check_standard, simulate,
};

/// Why a campaign cannot be run.
#[derive(Debug, Error)]
pub enum CampaignError {
    /// The robot cannot be simulated.
    #[error(transparent)]
    Simulation(#[from] SimulationError),
    /// The recordings cannot be prepared.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// The recordings cannot be observed.
    #[error(transparent)]
    Observe(#[from] ObserveError),
}

/// What is simulated.
#[derive(Debug, Clone, PartialEq)]
pub struct Campaign {
    /// Control and recording rate, Hz.
    pub rate: f64,
    /// Family of the single motion.
    pub single: MotionKind,
    /// Family of the sets.
    pub sets: MotionKind,
    /// Share of the position range of the motions. With 13 points and 0.6 they last about as long as the public
    /// recording of a TX-40, which goes through 13 points in 7.4 s.
    pub reach: f64,
    /// Random starts for each motion.
    pub starts: usize,
    /// Candidates tried from each start for the sets of section IV.B.
    pub evaluations: usize,
    /// Candidates tried from each start for the single motion; 0 takes the best of the random starts, as a motion
    /// is that moves all joints about but was not searched for.
    pub single_evaluations: usize,
    /// Size of the unmodelled residue ([`Residue::typical`]); 0 for a robot that is exactly its model.
    pub residue: f64,
    /// Factor on the nominal noise of encoders and torques.
    pub noise: f64,
    /// Seed of the motions; the noise has its own.
    pub seed: u64,
}

impl Default for Campaign {
    fn default() -> Self {
        Self {
            rate: 5000.0,
            single: Self::points(13),
            sets: Self::points(13),
            reach: 0.6,
            starts: 1,
            evaluations: 200,
            single_evaluations: 0,
            residue: 1.0,
            noise: 1.0,
            seed: 1,
        }
    }
}

/// The planned motions of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Motions {
    /// All joints moving.
    pub single: ExcitingMotion,
    /// Joints 1..k fixed, k = 0 .. n - 1.
    pub sets: Vec<ExcitingMotion>,
    /// How the sets were found.
    pub plan: ExcitationPlan,
}

impl Campaign {
    /// Point-to-point motions with trapezoidal acceleration, as industrial controllers make them.
    pub fn points(points: usize) -> MotionKind {
        MotionKind::PointToPoint { points, profile: Profile::TrapezoidalAcceleration, pause: 0.0 }
    }

    /// Searches the motions: the single one for the IDIM, the sets for the PIM.
    ///
    /// # Errors
    /// A robot without limits, settings out of range.
    pub fn plan(
        &self,
        model: &dyn Model,
        chi: &[f64],
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Motions, SimulationError> {
        let n = model.robot().joints();
        let settings = |kind, identification, sets, seed, evaluations| ExcitationSettings {
            kind,
            identification,
            criterion: Criterion::Determinant,
            sets,
            starts: self.starts,
            evaluations,
            share: 0.9,
            reach: self.reach,
            seed,
        };
        let share = 1.0 / (n + 1) as f64;
        let mut single = excite(
            model,
            Some(chi),
            &settings(self.single, Identification::Idim, 1, self.seed, self.single_evaluations),
            &|p| progress(p * share),
        )?;
        let plan = excite(
            model,
            Some(chi),
            &settings(self.sets, Identification::Pim, n, self.seed + 1, self.evaluations),
            &|p| {
                progress(share + p * (1.0 - share));
            },
        )?;
        Ok(Motions { single: single.motions.swap_remove(0), sets: plan.motions.clone(), plan })
    }

    /// Simulates one motion in closed loop, with the residue and with noise of this seed.
    ///
    /// # Errors
    /// A robot that cannot be simulated.
    pub fn simulate(
        &self,
        model: &dyn Model,
        standard: &[f64],
        motion: &ExcitingMotion,
        name: &str,
        seed: u64,
    ) -> Result<Simulation, SimulationError> {
        let robot = model.robot();
        check_standard(robot, standard)?;
        let residue = Residue::typical(robot, standard, self.residue);
        let effects = if self.residue > 0.0 { vec![residue.boxed()] } else { Vec::new() };
        let mut plant = Plant::with_effects(model, standard, &[], effects)?;
        let chi = robot.base_from_standard(standard);
        let mut settings = LoopSettings::nominal(model, &chi, motion, self.rate, seed);
        settings.name = name.to_string();
        for sigma in settings.sensors.position_noise.iter_mut().chain(&mut settings.sensors.torque_noise) {
            *sigma *= self.noise;
        }
        simulate(&mut plant, motion, &settings, &mut |_| {})
    }
}

/// Simulates the single motion and the sets for one seed.
///
/// # Errors
/// As [`Campaign::simulate`].
pub fn record(
    campaign: &Campaign,
    model: &dyn Model,
    standard: &[f64],
    motions: &Motions,
    seed: u64,
) -> Result<(Trajectory, Vec<Trajectory>), SimulationError> {
    let each = seed.wrapping_mul(1000);
    let single = campaign.simulate(model, standard, &motions.single, "all joints", each)?.recorded;
    let sets = (1..)
        .zip(&motions.sets)
        .map(|(k, motion)| {
            let name = format!("set {k}");
            campaign.simulate(model, standard, motion, &name, each + k).map(|run| run.recorded)
        })
        .collect::<Result<Vec<_>, _>>()?;
    Ok((single, sets))
}

/// Mean and standard deviation over seeds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spread {
    /// Mean.
    pub mean: f64,
    /// Standard deviation (n - 1); 0 for one seed.
    pub deviation: f64,
}

/// Mean and standard deviation of some values; `None` where there are none.
pub fn spread(values: impl IntoIterator<Item = f64>) -> Option<Spread> {
    let values: Vec<f64> = values.into_iter().collect();
    if values.is_empty() {
        return None;
    }
    let mean = values.iter().sum::<f64>() / values.len() as f64;
    let squares: f64 = values.iter().map(|x| (x - mean) * (x - mean)).sum();
    let deviation = (squares / (values.len() as f64 - 1.0).max(1.0)).sqrt();
    Some(Spread { mean, deviation })
}

/// Prepared motions of trajectories.
fn prepared(trajectories: &[Trajectory], preparation: &Preparation) -> Result<Vec<Motion>, SignalError> {
    trajectories.iter().map(|t| prepare(t, preparation)).collect()
}

/// One seed of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct SeedResult {
    /// The seed: of the motions and of the noise.
    pub seed: u64,
    /// What was planned.
    pub motions: Motions,
    /// What was recorded with all joints moving.
    pub single: Trajectory,
    /// The five cases.
    pub cases: Vec<CaseResult>,
}

impl Campaign {
    /// Plans, simulates and identifies for one seed.
    ///
    /// # Errors
    /// A robot that cannot be simulated, or recordings that cannot be identified.
    pub fn run(
        &self,
        model: &dyn Model,
        standard: &[f64],
        preparation: &Preparation,
        settings: &PaperSettings,
        seed: u64,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<SeedResult, CampaignError> {
        // A robot that cannot exist is said before motions are searched for it.
        check_standard(model.robot(), standard)?;
        let chi = model.robot().base_from_standard(standard);
        let campaign = Campaign { seed: self.seed.wrapping_add(100 * seed), ..self.clone() };
        let motions = campaign.plan(model, &chi, &|share| progress(0.5 * share))?;
        let (single, sets) = record(&campaign, model, standard, &motions, seed)?;
        progress(0.8);
        let observed = prepared(std::slice::from_ref(&single), preparation)?;
        let cases = run_cases(model, &observed, Some(&prepared(&sets, preparation)?), settings)?;
        progress(1.0);
        Ok(SeedResult { seed, motions, single, cases })
    }
}
