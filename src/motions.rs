//! Planned motions on the command line: what family, and files of them.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use clap::{Args, ValueEnum};
use dynid_runtime::model::{JointKind, Robot};
use dynid_runtime::report::{Panel, Sheet};
use dynid_runtime::simulation::excitation::{MotionKind, Profile};
use dynid_runtime::simulation::{Reference, SampledReference};

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

/// A motion sampled at `rate`, as `[q, dq, ddq]` with `signal[joint][sample]`.
fn sampled(motion: &dyn Reference, rate: f64) -> [Vec<Vec<f64>>; 3] {
    let n = motion.joints();
    let samples = (motion.duration() * rate + 1e-6).floor() as usize + 1;
    let mut signals: [Vec<Vec<f64>>; 3] = std::array::from_fn(|_| vec![Vec::with_capacity(samples); n]);
    let (mut q, mut dq, mut ddq) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    for k in 0..samples {
        motion.at(k as f64 / rate, &mut q, &mut dq, &mut ddq);
        for (signal, values) in signals.iter_mut().zip([&q, &dq, &ddq]) {
            for (channel, &value) in signal.iter_mut().zip(values) {
                channel.push(value);
            }
        }
    }
    signals
}

/// A motion as CSV: t, then positions, velocities and accelerations of all joints, SI.
pub fn to_csv(motion: &dyn Reference, rate: f64) -> String {
    let signals = sampled(motion, rate);
    let n = motion.joints();
    let mut text = String::from("t");
    for letter in ["q", "dq", "ddq"] {
        for j in 1..=n {
            // Writing to a String cannot fail.
            let _ = write!(text, ",{letter}{j}");
        }
    }
    text.push('\n');
    for k in 0..signals[0].first().map_or(0, Vec::len) {
        let _ = write!(text, "{}", k as f64 / rate);
        for channel in signals.iter().flatten() {
            let _ = write!(text, ",{}", channel[k]);
        }
        text.push('\n');
    }
    text
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
                    (format!("joint {}", j + 1), points)
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
    let wrong = |line: usize, what: String| Failure::Input(format!("{}:{line}: {what}", path.display()));
    let columns = 1 + 3 * joints;
    let mut time = Vec::new();
    let mut signals: Vec<Vec<f64>> = vec![Vec::new(); 3 * joints];
    for (k, row) in text.lines().enumerate().skip(1).filter(|(_, row)| !row.trim().is_empty()) {
        let fields: Vec<&str> = row.split(',').collect();
        if fields.len() != columns {
            let found = fields.len();
            return Err(wrong(
                k + 1,
                format!("{found} columns: t, q, dq and ddq of {joints} joints are {columns}"),
            ));
        }
        for (place, field) in fields.iter().enumerate() {
            let value: f64 = field
                .trim()
                .parse()
                .ok()
                .filter(|x: &f64| x.is_finite())
                .ok_or_else(|| wrong(k + 1, format!("'{field}' is not a finite number")))?;
            if place == 0 { time.push(value) } else { signals[place - 1].push(value) }
        }
    }
    if time.len() < 2 {
        return Err(wrong(1, "a motion needs two rows at least".to_owned()));
    }
    let step = (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64;
    for (k, pair) in time.windows(2).enumerate() {
        if (pair[1] - pair[0] - step).abs() > 1e-3 * step || step <= 0.0 {
            return Err(wrong(k + 3, format!("the rows must be equally spaced in time, every {step:.6} s")));
        }
    }
    let ddq = signals.split_off(2 * joints);
    let dq = signals.split_off(joints);
    let still = |j: usize| signals[j].iter().all(|&x| x == signals[j][0]);
    let fixed = (0..joints).filter(|&j| still(j)).collect();
    Ok(SampledReference { step, q: signals, dq, ddq, fixed })
}
