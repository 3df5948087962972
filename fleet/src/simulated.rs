//! A small simulated fleet: alike but not the same, noisy, and one of them with a gear that wears.

use std::path::{Path, PathBuf};

use dynid::models;
use dynid::output::{make_folder, write};
use dynid::recording_files::{RobotReference, write_recording};
use dynid_runtime::model::{Model, States, torques};
use dynid_runtime::recording::{DataFormat, Trajectory};
use dynid_runtime::simulation::excitation::{ExcitationSettings, MotionKind, excite};
use dynid_runtime::simulation::sampled;
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use crate::day::{self, Day};
use crate::error::{FleetError, Result};

/// Robot of the fleet, and its joint whose gear wears in the last one.
const ROBOT: &str = "tx40";
const WORN: &str = "Fc2";

/// First day: 2026-03-01.
const FIRST: Day = 20_513;

/// Standard deviation of what distinguishes the friction of siblings.
const BETWEEN_ROBOTS: f64 = 0.03;

/// By how much the friction of the worn gear has grown on the last day.
const WEAR: f64 = 0.6;

/// What is simulated.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Plan {
    /// Robots.
    pub robots: usize,
    /// Days, each with a recording of each robot.
    pub days: usize,
    /// Motions of 8 s in a recording.
    pub motions: usize,
    /// Rows a second, Hz.
    pub rate: f64,
    /// Standard deviation of a robot's friction from day to day, as a part of it. Real friction varies by some hundredths, with
    /// temperature.
    pub day_to_day: f64,
    /// The same seed gives the same fleet.
    pub seed: u64,
}

/// Writes the recordings of a fleet and its `fleet.yaml`; returns the path of it.
///
/// Torques are those of the inverse dynamics along planned motions, with the noise of the robot's sensors.
///
/// # Errors
/// What the file system says.
pub fn simulate(folder: &Path, plan: &Plan) -> Result<PathBuf> {
    let missing = || FleetError::Engine(format!("this dynid has no robot {ROBOT} with nominal values"));
    let model = models::find(ROBOT).ok_or_else(missing)?;
    let nominal = model.robot().nominal.as_ref().ok_or_else(missing)?;
    let chi = model.robot().base_from_standard(&nominal.standard);
    let signals = motions(model, &chi, plan)?;
    for robot in 0..plan.robots {
        let name = format!("r{:03}", robot + 1);
        let own = own_parameters(model, &chi, random(plan, [1, robot as u64, 0]));
        for past in 0..plan.days {
            let day = FIRST + past as Day;
            let wears = robot + 1 == plan.robots;
            let since = past as f64 / (plan.days.max(2) - 1) as f64;
            let wear = if wears { WEAR * since } else { 0.0 };
            let of_day = random(plan, [2, robot as u64, past as u64]);
            let today = today(model, &own, of_day, (wear, plan.day_to_day));
            let mut noise = random(plan, [3, robot as u64, past as u64]);
            let recorded: Vec<Trajectory> = signals
                .iter()
                .enumerate()
                .map(|(k, s)| recorded(model, &today, s, (k, plan.rate), &mut noise))
                .collect();
            let place = folder.join("logs").join(&name).join(day::written(day));
            let form = (DataFormat::Csv, &[][..]);
            let title = format!("{name}, simulated");
            write_recording(
                (&place, "recording.yaml", "motion"),
                model.robot(),
                RobotReference::Name(ROBOT),
                (&title, form),
                &recorded,
            )?;
        }
    }
    make_folder(folder)?;
    let path = folder.join("fleet.yaml");
    write(&path, "recordings: logs/{robot}/{day}/recording.yaml\nout: results\n")?;
    Ok(path)
}

/// A generator of its own for each thing that is drawn, so that a longer fleet begins like a shorter one.
fn random(plan: &Plan, place: [u64; 3]) -> Pcg64 {
    let mixed =
        place.iter().fold(plan.seed, |all, x| all.wrapping_mul(0x9e37_79b9_7f4a_7c15).wrapping_add(x + 1));
    Pcg64::seed_from_u64(mixed)
}

fn draw(random: &mut Pcg64) -> f64 {
    StandardNormal.sample(random)
}

type Signals = [Vec<Vec<f64>>; 3];

/// Fourier motions within the robot's limits, sampled.
fn motions(model: &dyn Model, chi: &[f64], plan: &Plan) -> Result<Vec<Signals>> {
    let one = |k: usize| {
        let settings = ExcitationSettings {
            kind: MotionKind::Fourier { harmonics: 5, period: 8.0, periods: 1 },
            share: 0.8,
            seed: plan.seed.wrapping_mul(1000).wrapping_add(k as u64),
            ..ExcitationSettings::default()
        };
        let planned = excite(model, Some(chi), &settings, &|_| {});
        let planned = planned.map_err(|error| FleetError::Engine(error.to_string()))?;
        planned
            .motions
            .first()
            .map(|motion| sampled(motion, plan.rate))
            .ok_or_else(|| FleetError::Engine("no motion could be planned".to_owned()))
    };
    (0..plan.motions).map(one).collect()
}

fn is_friction(name: &str) -> bool {
    name.starts_with('F')
}

/// The parameters of a sibling: friction differs, bodies do not.
fn own_parameters(model: &dyn Model, chi: &[f64], mut random: Pcg64) -> Vec<f64> {
    let base = model.robot().base.iter().zip(chi);
    base.map(|(b, &x)| if is_friction(&b.name) { x * (1.0 + BETWEEN_ROBOTS * draw(&mut random)) } else { x })
        .collect()
}

/// The parameters of a robot on a day, with what its gear has worn and its friction varies.
fn today(model: &dyn Model, own: &[f64], mut random: Pcg64, (wear, varies): (f64, f64)) -> Vec<f64> {
    let base = model.robot().base.iter().zip(own);
    base.map(|(b, &x)| {
        let worn = if b.name == WORN { 1.0 + wear } else { 1.0 };
        if is_friction(&b.name) { x * worn * (1.0 + varies * draw(&mut random)) } else { x }
    })
    .collect()
}

/// What the sensors say of a motion.
fn recorded(
    model: &dyn Model,
    chi: &[f64],
    [q, dq, ddq]: &Signals,
    (k, rate): (usize, f64),
    random: &mut Pcg64,
) -> Trajectory {
    let states = dynid_runtime::model::StateSlices::new(q, dq, ddq);
    let states: States<'_> = states.states();
    let exact = torques(model, chi, states);
    let nominal = model.robot().nominal.as_ref();
    let noise = |of: fn(&dynid_runtime::model::Nominal) -> &[f64], joint: usize| {
        nominal.and_then(|nominal| of(nominal).get(joint).copied()).unwrap_or(0.0)
    };
    let mut noisy = |signal: &[f64], sigma: f64| -> Vec<f64> {
        signal.iter().map(|x| x + sigma * draw(random)).collect()
    };
    let position = q.iter().enumerate().map(|(j, q)| noisy(q, noise(|n| &n.position_noise, j))).collect();
    let torque = exact.iter().enumerate().map(|(j, t)| noisy(t, noise(|n| &n.torque_noise, j))).collect();
    let samples = q.first().map_or(0, Vec::len);
    Trajectory {
        name: format!("motion {}", k + 1),
        time: (0..samples).map(|t| t as f64 / rate).collect(),
        position,
        velocity: None,
        torque,
        fixed: Vec::new(),
    }
}
