//! Planned motions on the command line: what family, and files of them.

use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use dynid_runtime::model::{JointIndex, JointKind, Robot};
use dynid_runtime::report::{Panel, Sheet};
use dynid_runtime::simulation::excitation::{MotionKind, Profile};
use dynid_runtime::simulation::{Reference, SampledReference, from_csv, sampled};

use crate::failure::{Failure, file_failure};

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
    #[arg(long, default_value_t = 8.0, allow_negative_numbers = true)]
    pub period: f64,
    /// Harmonics of a Fourier motion
    #[arg(long, default_value_t = 5)]
    pub harmonics: usize,
    /// Points of a point-to-point motion
    #[arg(long, default_value_t = 8)]
    pub points: usize,
    /// Stop at each point, s
    #[arg(long, default_value_t = 0.1, allow_negative_numbers = true)]
    pub pause: f64,
    /// Share of every limit of the robot that may be used
    #[arg(long, default_value_t = 0.9, allow_negative_numbers = true)]
    pub share: f64,
    /// Share of the position range that is used, about its middle
    #[arg(long, default_value_t = 1.0, allow_negative_numbers = true)]
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

/// Refuses a size that is negative or no number.
///
/// # Errors
/// [`Failure::Input`] naming the option.
pub fn check_size(option: &str, size: f64) -> Result<(), Failure> {
    if size >= 0.0 && size.is_finite() {
        return Ok(());
    }
    Err(Failure::Input(format!("{option} {size}: it must be zero or positive")))
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

/// The motions that `dynid excite` wrote to a folder (`motion1.csv`, ...), or the one CSV that is named.
///
/// # Errors
/// [`Failure::Input`] with file and line.
pub fn read(path: &Path, joints: usize) -> Result<Vec<SampledReference>, Failure> {
    if path.is_file() {
        return Ok(vec![read_one(path, joints)?]);
    }
    let files: Vec<PathBuf> =
        (1..).map(|k| path.join(format!("motion{k}.csv"))).take_while(|file| file.is_file()).collect();
    if files.is_empty() {
        return Err(Failure::Input(format!(
            "{}: there is no motion1.csv: give a CSV of a motion or a folder written by `dynid excite`",
            path.display()
        )));
    }
    files.iter().map(|file| read_one(file, joints)).collect()
}

fn read_one(path: &Path, joints: usize) -> Result<SampledReference, Failure> {
    let text =
        std::fs::read_to_string(path).map_err(|error| file_failure("read the motion", path, &error))?;
    from_csv(&text, joints).map_err(|error| Failure::Input(format!("{}:{error}", path.display())))
}
