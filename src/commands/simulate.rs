//! `dynid simulate MODEL|ROBOT`: a closed loop, written as a recording.

mod effect;
mod elastic;
mod robot;

use std::path::{Path, PathBuf};

use clap::Args;
use dynid_runtime::effects::UserLaw;
use dynid_runtime::model::Model;
use dynid_runtime::model_file::to_yaml;
use dynid_runtime::recording::DataFormat;
use dynid_runtime::report::significant;
use dynid_runtime::simulation::excitation::{ExcitationSettings, excite};
use dynid_runtime::simulation::{LoopSettings, Reference, Simulation, SimulationError, World, simulate};

use crate::failure::Failure;
use crate::motions::{MotionOptions, read as read_motions};
use crate::output::{Bar, make_folder, print, table};
use crate::ranges;
use crate::recording_files::{RobotReference, write_recording};
use crate::robots::{Dynamics, read_yaml, resolve};
use crate::saved::own_dynamics;
use crate::start::{joint_names, numbered};
use effect::{hidden_law, words};
use robot::{Parameters, missing, parameters, plant, saved_model};

/// What to simulate, and where to put it.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A robot's name (its nominal parameters are used), the path of a robot YAML or a URDF, or a model saved by `identify`
    robot: String,
    /// Folder for the recording
    #[arg(long)]
    out: PathBuf,
    /// Follow these motions: a CSV or a folder written by `excite` [default: random motions within the limits]
    #[arg(long)]
    follow: Option<PathBuf>,
    /// How many random motions
    #[arg(
        long,
        default_value_t = 3,
        allow_negative_numbers = true,
        value_parser = ranges::motions,
        value_name = ranges::MOTIONS,
    )]
    motions: usize,
    #[command(flatten)]
    family: MotionOptions,
    /// Control rate, Hz
    #[arg(
        long,
        default_value_t = 5000.0,
        allow_negative_numbers = true,
        value_parser = ranges::control_rate,
        value_name = ranges::CONTROL_RATE,
    )]
    rate: f64,
    /// Control samples for each recorded row
    #[arg(
        long,
        default_value_t = 5,
        allow_negative_numbers = true,
        value_parser = ranges::record_every,
        value_name = ranges::RECORD_EVERY,
    )]
    record_every: usize,
    /// The same seed gives the same recording
    #[arg(long, default_value_t = 1)]
    seed: u64,
    /// Factor on the robot's nominal noise of encoders and torques
    #[arg(
        long,
        default_value_t = 1.0,
        allow_negative_numbers = true,
        value_parser = ranges::noise,
        value_name = ranges::NOISE,
    )]
    noise: f64,
    /// Smallest step of the encoders, rad or m at the joint
    #[arg(
        long,
        default_value_t = 0.0,
        allow_negative_numbers = true,
        value_parser = ranges::quantum,
        value_name = ranges::QUANTUM,
    )]
    quantum: f64,
    /// Physics beyond the model of this size: Stribeck, load and uneven friction and ripple; 1 is a real robot's
    #[arg(
        long,
        default_value_t = 0.0,
        allow_negative_numbers = true,
        value_parser = ranges::size,
        value_name = ranges::SIZE,
    )]
    residue: f64,
    /// Torque ripple of this share of each joint's dry friction, once a motor turn
    #[arg(
        long,
        default_value_t = 0.0,
        allow_negative_numbers = true,
        value_parser = ranges::size,
        value_name = ranges::SIZE,
    )]
    ripple: f64,
    /// Law of a joint that is added, ID:JOINT or ID:JOINT:SIZE: an id of `dynid effects`, and its largest torque in an
    /// ordinary motion, N.m or N, 1e-6..1e6 [default: half of the joint's Coulomb friction]; may be repeated
    #[arg(long, value_name = "ID:JOINT[:SIZE]")]
    effect: Vec<String>,
    /// Elastic joint: JOINT:STIFFNESS[:DAMPING[:PLAY]], SI, stiffness 1e-3..1e12, damping 0..1e9, play 0..10; may be
    /// repeated
    #[arg(long)]
    elastic: Vec<String>,
    /// Format of the motions; MCAP is a log of JointState messages
    #[arg(long, value_enum, default_value_t = Format::Csv)]
    format: Format,
    /// Feed nothing forward: the controller works from the errors alone
    #[arg(long)]
    no_feed_forward: bool,
}

/// Formats of motions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
enum Format {
    Csv,
    Parquet,
    Mcap,
}

impl From<Format> for DataFormat {
    fn from(format: Format) -> Self {
        match format {
            Format::Csv => Self::Csv,
            Format::Parquet => Self::Parquet,
            Format::Mcap => Self::Mcap,
        }
    }
}

/// Simulates and writes.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let saved = saved_model(&arguments.robot)?;
    let dynamics = match &saved {
        Some(identified) => own_dynamics(identified, Path::new(&arguments.robot))?,
        None => resolve(&arguments.robot, None)?,
    };
    let model = dynamics.model();
    let robot = model.robot();
    if let Some(words) = missing(robot, saved.is_some(), arguments.follow.is_some()) {
        return Err(Failure::Input(words));
    }
    let parameters = parameters(robot, saved.as_ref(), &arguments.robot)?;
    let chi = match &parameters {
        Parameters::Standard(standard) => robot.base_from_standard(standard),
        Parameters::Base(chi, _) => chi.clone(),
    };
    let failed = |error: SimulationError| Failure::Input(error.to_string());
    let terms = match &parameters {
        Parameters::Base(_, terms) => terms.as_slice(),
        Parameters::Standard(_) => &[],
    };
    if let Some(law) = terms.iter().filter_map(|t| t.place.law()).find(|law| law.is_of_acceleration()) {
        return Err(Failure::Input(of_acceleration(&arguments.robot, law)));
    }
    let hidden =
        arguments.effect.iter().map(|text| hidden_law(model, &chi, text)).collect::<Result<Vec<_>, _>>()?;
    hidden.iter().for_each(|term| print(&format!("Added: {}", words(term))));
    let world = World::from_base(model, &chi).with(terms).with(&hidden);
    for id in world.left_out_ids() {
        print(&format!("{id} is in the model, but is not simulated"));
    }
    let motions = planned(model, &chi, arguments)?;
    make_folder(&arguments.out)?;
    let bar = Bar::new("simulating");
    let mut runs: Vec<Simulation> = Vec::new();
    for (k, motion) in motions.iter().enumerate() {
        let mut plant = plant(&world, model, &parameters, arguments)?;
        let settings = loop_settings(model, &chi, motion.as_ref(), arguments, k);
        let done = |share: f64| bar.at(((k as f64 + share) * 1000.0) as usize, 1000 * motions.len());
        runs.push(simulate(&mut plant, motion.as_ref(), &settings, &mut { done }).map_err(failed)?);
    }
    drop(bar);
    let trajectories: Vec<_> = runs.iter().map(|run| run.recorded.clone()).collect();
    let title = format!("closed-loop simulation of {}, seed {}", robot.name, arguments.seed);
    let own_table = match &dynamics {
        Dynamics::Generated(_) => None,
        Dynamics::Recursive(model) if saved.is_some() => Some(to_yaml(model.robot()).into_bytes()),
        Dynamics::Recursive(_) => Some(read_yaml(Path::new(&arguments.robot))?),
    };
    let reference = own_table.as_deref().map_or(RobotReference::Name(&robot.name), RobotReference::Yaml);
    let place = (arguments.out.as_path(), "recording.yaml", "traj");
    let joints = joint_names(&arguments.robot)?.unwrap_or_else(|| numbered(robot));
    let form = (arguments.format.into(), joints.as_slice());
    let path = write_recording(place, robot, reference, (&title, form), &trajectories)?;
    print(&summary(&path, &runs));
    Ok(())
}

/// Why a law over an acceleration is not simulated.
fn of_acceleration(file: &str, law: UserLaw) -> String {
    format!(
        "{file}: the law {} ({}) depends on an acceleration, which in a simulation follows from the torques; write it without ddq, or take it out of the model's effects",
        law.id(),
        law.text()
    )
}

fn planned(
    model: &dyn Model,
    chi: &[f64],
    arguments: &Arguments,
) -> Result<Vec<Box<dyn Reference>>, Failure> {
    if let Some(path) = &arguments.follow {
        let read = read_motions(path, model.robot().joints())?;
        return Ok(read.into_iter().map(|motion| Box::new(motion) as Box<dyn Reference>).collect());
    }
    let mut motions: Vec<Box<dyn Reference>> = Vec::new();
    for k in 0..arguments.motions {
        let settings = ExcitationSettings {
            kind: arguments.family.kind(),
            share: arguments.family.share,
            reach: arguments.family.reach,
            seed: arguments.seed.wrapping_mul(1009).wrapping_add(k as u64),
            ..ExcitationSettings::default()
        };
        let plan = excite(model, Some(chi), &settings, &|_| {}).map_err(|e| Failure::Input(e.to_string()))?;
        motions.extend(plan.motions.into_iter().map(|motion| Box::new(motion) as Box<dyn Reference>));
    }
    Ok(motions)
}

fn loop_settings(
    model: &dyn Model,
    chi: &[f64],
    motion: &dyn Reference,
    arguments: &Arguments,
    k: usize,
) -> LoopSettings {
    let seed = arguments.seed.wrapping_mul(1000).wrapping_add(k as u64);
    let mut settings = LoopSettings::nominal(model, chi, motion, arguments.rate, seed);
    settings.record_every = arguments.record_every;
    settings.name = format!("motion {}", k + 1);
    let sensors = &mut settings.sensors;
    for sigma in sensors.position_noise.iter_mut().chain(&mut sensors.torque_noise) {
        *sigma *= arguments.noise;
    }
    if arguments.quantum != 0.0 {
        sensors.position_quantum = vec![arguments.quantum; motion.joints()];
    }
    if arguments.no_feed_forward {
        settings.controller.feed_forward = None;
    }
    settings
}

fn summary(path: &Path, runs: &[Simulation]) -> String {
    let rows = runs
        .iter()
        .map(|run| {
            let last = run.recorded.time.last().copied().unwrap_or(0.0);
            let worst = run.tracking_error.iter().fold(0.0_f64, |m, &x| m.max(x));
            vec![
                run.recorded.name.clone(),
                significant(last, 3),
                run.recorded.time.len().to_string(),
                significant(worst, 2),
                run.limited.iter().sum::<usize>().to_string(),
            ]
        })
        .collect();
    let header =
        ["<motion", "s", "rows", "largest tracking error, rad or m", "control samples at a torque limit"];
    format!("{}\n{}", path.display(), table(&header, rows))
}
