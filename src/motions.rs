//! Planned motions on the command line: what family, and files of them.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use dynid_runtime::model::{JointIndex, JointKind, Robot};
use dynid_runtime::regular_file;
use dynid_runtime::report::{Panel, Sheet};
use dynid_runtime::simulation::excitation::{MotionKind, Profile};
use dynid_runtime::simulation::{Reference, SampledReference, from_csv, sampled};

use crate::failure::{Failure, file_failure};
use crate::ranges;

/// Longest motion and longest list of motions that are read, bytes.
const LONGEST: u64 = 1 << 30;
const LONGEST_PLAN: u64 = 1 << 20;

/// Families of motions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum Family {
    /// Periodic Fourier series
    Fourier,
    /// Point to point, fifth-order polynomials
    Quintic,
    /// Point to point, trapezoidal acceleration
    Trapezoidal,
}

/// Which motions are planned.
#[derive(Debug, Clone, Args)]
pub struct MotionOptions {
    /// Family of the motions
    #[arg(long, value_enum, default_value = "fourier")]
    pub kind: Family,
    /// Length of a Fourier motion, s
    #[arg(
        long,
        default_value_t = 8.0,
        allow_negative_numbers = true,
        value_parser = ranges::period,
        value_name = ranges::PERIOD,
    )]
    pub period: f64,
    /// Harmonics of a Fourier motion
    #[arg(
        long,
        default_value_t = 5,
        allow_negative_numbers = true,
        value_parser = ranges::harmonics,
        value_name = ranges::HARMONICS,
    )]
    pub harmonics: usize,
    /// Points of a point-to-point motion
    #[arg(
        long,
        default_value_t = 8,
        allow_negative_numbers = true,
        value_parser = ranges::points,
        value_name = ranges::POINTS,
    )]
    pub points: usize,
    /// Stop at each point, s
    #[arg(
        long,
        default_value_t = 0.1,
        allow_negative_numbers = true,
        value_parser = ranges::pause,
        value_name = ranges::PAUSE,
    )]
    pub pause: f64,
    /// Share of every limit of the robot that may be used
    #[arg(
        long,
        default_value_t = 0.9,
        allow_negative_numbers = true,
        value_parser = ranges::share,
        value_name = ranges::SHARE,
    )]
    pub share: f64,
    /// Share of the position range that is used, about its middle
    #[arg(
        long,
        default_value_t = 1.0,
        allow_negative_numbers = true,
        value_parser = ranges::share,
        value_name = ranges::SHARE,
    )]
    pub reach: f64,
}

impl MotionOptions {
    /// As the search takes it.
    pub fn kind(&self) -> MotionKind {
        let points = |profile| MotionKind::PointToPoint { points: self.points, profile, pause: self.pause };
        match self.kind {
            Family::Fourier => {
                MotionKind::Fourier { harmonics: self.harmonics, period: self.period, periods: 1 }
            }
            Family::Quintic => points(Profile::Quintic),
            Family::Trapezoidal => points(Profile::TrapezoidalAcceleration),
        }
    }
}

/// A motion as a sheet of q, dq and ddq over time.
pub fn to_svg(motion: &dyn Reference, robot: &Robot, title: &str) -> String {
    let rate = 400.0 / motion.duration().max(1e-3);
    let signals = sampled(motion, rate);
    let prismatic = robot.frames.iter().any(|f| f.kind == JointKind::Prismatic);
    let units = if prismatic {
        ["rad or m", "rad/s or m/s", "rad/s² or m/s²"]
    } else {
        ["rad", "rad/s", "rad/s²"]
    };
    let panels = ["q", "dq", "ddq"]
        .iter()
        .zip(units)
        .zip(&signals)
        .map(|((name, unit), signal)| Panel {
            title: format!("{name}, {unit}"),
            lines: signal
                .iter()
                .enumerate()
                .map(|(j, values)| {
                    let points = values.iter().enumerate().map(|(k, &v)| (k as f64 / rate, v)).collect();
                    (format!("joint {}", robot.joint_number(JointIndex(j))), points)
                })
                .collect(),
        })
        .collect();
    Sheet { title: title.to_owned(), x: "time, s".to_owned(), columns: 1, panel: [760.0, 230.0], panels }
        .to_svg()
}

/// What `dynid excite` calls the list of its motions.
pub const PLAN: &str = "motions.yaml";

/// The files of a planned motion, beside the list.
#[derive(Debug, Clone, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
pub struct PlannedMotion {
    /// Its rows.
    pub file: String,
    /// Its signals over time.
    pub figure: String,
}

#[derive(serde::Deserialize)]
struct Plan {
    motions: Vec<PlannedMotion>,
}

/// The list of planned motions of a robot.
pub fn plan_text(robot: &str, motions: &[PlannedMotion]) -> String {
    let mut text = format!("robot: {robot}\nmotions:\n");
    for PlannedMotion { file, figure } in motions {
        text.push_str(&format!("  - {{file: {file}, figure: {figure}}}\n"));
    }
    text
}

/// The motions of a folder that `dynid excite` wrote, in the order of its `motions.yaml`; of a folder without one those
/// that are called `motion1.csv`, `motion2.csv`, ...; or the one CSV that is named.
///
/// # Errors
/// [`Failure::Input`] with file and line.
pub fn read(path: &Path, joints: usize) -> Result<Vec<SampledReference>, Failure> {
    if path.is_file() {
        return Ok(vec![read_one(path, joints)?]);
    }
    let plan = path.join(PLAN);
    let files: Vec<PathBuf> = if plan.is_file() {
        let text = regular_file::read_text(&plan, LONGEST_PLAN)
            .map_err(|error| file_failure("read the list of motions", &plan, &error))?;
        let listed: Plan = serde_yaml::from_str(&text)
            .map_err(|error| Failure::Input(format!("{}: {error}", plan.display())))?;
        listed.motions.iter().map(|motion| path.join(&motion.file)).collect()
    } else {
        (1..).map(|k| path.join(format!("motion{k}.csv"))).take_while(|file| file.is_file()).collect()
    };
    if files.is_empty() {
        return Err(Failure::Input(format!(
            "{}: there is no {PLAN} and no motion1.csv: give a CSV of a motion or a folder written by `dynid excite`",
            path.display()
        )));
    }
    files.iter().map(|file| read_one(file, joints)).collect()
}

fn read_one(path: &Path, joints: usize) -> Result<SampledReference, Failure> {
    let text = regular_file::read_text(path, LONGEST)
        .map_err(|error| file_failure("read the motion", path, &error))?;
    from_csv(&text, joints).map_err(|error| Failure::Input(format!("{}:{error}", path.display())))
}
