//! Arguments that several commands share: which recording, and how its signals become equations.

use std::path::{Path, PathBuf};

use clap::Args;
use dynid_runtime::estimation::observe::{ObserveSettings, Standstill};
use dynid_runtime::prediction::Comparison;

use crate::failure::Failure;
use crate::ranges;

/// Which recording is read.
#[derive(Debug, Clone, Args)]
pub struct Source {
    /// The recording: a YAML that names the robot, the files and the columns
    pub recording: PathBuf,
    /// Another robot than the one the recording names: a name, or the path of a robot YAML or a URDF
    #[arg(long)]
    pub robot: Option<String>,
    /// Use only what comes after this time, s
    #[arg(long, allow_negative_numbers = true, value_parser = ranges::instant, value_name = ranges::INSTANT)]
    pub from: Option<f64>,
    /// Use only what comes before this time, s
    #[arg(long, allow_negative_numbers = true, value_parser = ranges::instant, value_name = ranges::INSTANT)]
    pub to: Option<f64>,
}

impl Source {
    /// All of a recording, of the robot that it names.
    pub fn whole(recording: PathBuf) -> Self {
        Self { recording, robot: None, from: None, to: None }
    }

    /// Another recording of the same robot, over all of its time.
    pub fn other(&self, recording: &Path) -> Self {
        Self { robot: self.robot.clone(), ..Self::whole(recording.to_path_buf()) }
    }
}

/// How signals become equations that parameters are identified from. The defaults are the same for every robot and
/// recording.
#[derive(Debug, Clone, Default, Args)]
pub struct Sampling {
    /// Band of the equations, Hz: what is faster is filtered out of torques and model alike [default: the widest, up
    /// to 50 Hz, in which the encoders' noise hardly shows in the accelerations]
    #[arg(long, allow_negative_numbers = true, value_parser = ranges::band, value_name = ranges::BAND)]
    pub band: Option<f64>,
    #[command(flatten)]
    /// Which rows.
    pub rows: RowOptions,
}

/// How a recording is sampled to judge a model on it.
#[derive(Debug, Clone, Default, Args)]
pub struct ComparisonOptions {
    /// Widest band of the comparison, Hz: what is faster is filtered out of torques and model alike [default: 25]. A
    /// recording that carries less is compared in what it carries
    #[arg(long, allow_negative_numbers = true, value_parser = ranges::band, value_name = ranges::BAND)]
    pub band: Option<f64>,
    #[command(flatten)]
    /// Which rows.
    pub rows: RowOptions,
}

/// Which rows are taken.
#[derive(Debug, Clone, Default, Args)]
pub struct RowOptions {
    /// Equations a second, Hz [default: twice the band]
    #[arg(
        long,
        allow_negative_numbers = true,
        value_parser = ranges::rows_rate,
        value_name = ranges::ROWS_RATE,
    )]
    pub rate: Option<f64>,
    /// Cut-off of the position filter, Hz [default: twice the band, at most a fifth of the recording's rate]
    #[arg(long, allow_negative_numbers = true, value_parser = ranges::cutoff, value_name = ranges::CUTOFF)]
    pub cutoff: Option<f64>,
    /// Leave out rows where the joint is slower than this, rad/s or m/s: one value, or one per joint [default: 2 %
    /// of the joint's fastest speed]
    #[arg(
        long,
        value_delimiter = ',',
        conflicts_with = "all_rows",
        allow_negative_numbers = true,
        value_parser = ranges::standstill,
        value_name = ranges::STANDSTILL,
    )]
    pub standstill: Vec<f64>,
    /// Keep the rows where joints stand still
    #[arg(long)]
    pub all_rows: bool,
    /// Threads; the result is the same for every number [default: all cores]
    #[arg(
        long,
        default_value_t = 0,
        allow_negative_numbers = true,
        value_parser = ranges::threads,
        value_name = ranges::THREADS,
    )]
    pub threads: usize,
}

/// How a diagnosis samples the recording, the baseline and the test recording.
#[derive(Debug, Clone, Default, Args)]
pub struct DiagnosisOptions {
    /// Highest frequency of the rows, Hz, and widest band of the errors that are told [default: by the recording's
    /// noise, and 25]
    #[arg(long, allow_negative_numbers = true, value_parser = ranges::band, value_name = ranges::BAND)]
    pub band: Option<f64>,
    /// Cut-off of the filters of positions and torques, Hz [default: by the band, at most 60]
    #[arg(long, allow_negative_numbers = true, value_parser = ranges::cutoff, value_name = ranges::CUTOFF)]
    pub cutoff: Option<f64>,
    /// Leave out rows where the joint is slower than this, rad/s or m/s: one value, or one per joint [default: 1.5 %
    /// of the joint's fastest speed]
    #[arg(
        long,
        value_delimiter = ',',
        allow_negative_numbers = true,
        value_parser = ranges::standstill,
        value_name = ranges::STANDSTILL,
    )]
    pub standstill: Vec<f64>,
    /// Do not look for pushes that a single joint sees while it moves
    #[arg(long)]
    pub no_single_joint_contacts: bool,
    /// It is done anyway
    #[arg(long, hide = true, conflicts_with = "no_single_joint_contacts")]
    pub single_joint_contacts: bool,
    /// Threads; the result is the same for every number [default: all cores]
    #[arg(
        long,
        default_value_t = 0,
        allow_negative_numbers = true,
        value_parser = ranges::threads,
        value_name = ranges::THREADS,
    )]
    pub threads: usize,
}

/// Which part of a URDF is a robot's table, and how it is read.
#[derive(Debug, Clone, Args)]
pub struct UrdfOptions {
    /// The link that does not move [default: the root]
    #[arg(long)]
    pub base: Option<String>,
    /// The last link of a chain; other joints are held at 0 [default: every joint beyond the base moves]
    #[arg(long)]
    pub tip: Option<String>,
    /// Angles of the URDF this close to a multiple of pi/4 are taken for it, rad: 0.0001 for a file that writes 1.5708
    #[arg(
        long,
        default_value_t = dynid_urdf::ImportOptions::default().snap,
        allow_negative_numbers = true,
        value_parser = ranges::snap,
        value_name = ranges::SNAP,
    )]
    pub snap: f64,
    /// Gravity in the frame of the URDF's root link, m/s2, as three numbers with commas [default: 0,0,-9.81]
    #[arg(long, allow_negative_numbers = true, value_delimiter = ',', value_parser = ranges::gravity, value_name = ranges::GRAVITY)]
    pub gravity: Vec<f64>,
}

impl UrdfOptions {
    /// As the import takes them.
    ///
    /// # Errors
    /// Another number of entries of gravity than three.
    pub fn import(&self) -> Result<dynid_urdf::ImportOptions, Failure> {
        let known = dynid_urdf::ImportOptions::default();
        let gravity = match self.gravity[..] {
            [] => known.gravity,
            [x, y, z] => [x, y, z],
            _ => {
                return Err(Failure::Input(format!(
                    "--gravity has {} numbers, expected 3",
                    self.gravity.len()
                )));
            }
        };
        Ok(dynid_urdf::ImportOptions {
            base: self.base.clone(),
            tip: self.tip.clone(),
            snap: self.snap,
            gravity,
        })
    }
}

impl RowOptions {
    /// What is done with rows where a joint hardly moves.
    pub fn standstill(&self, joints: usize) -> Standstill {
        if self.all_rows { Standstill::Keep } else { standstill(&self.standstill, joints) }
    }
}

/// One speed for all joints, one for each, or the rule.
fn standstill(speeds: &[f64], joints: usize) -> Standstill {
    match speeds {
        [] => Standstill::default(),
        [one] => Standstill::Below(vec![*one; joints]),
        several => Standstill::Below(several.to_vec()),
    }
}

impl Sampling {
    /// As settings of the observation; the band is chosen with the recording.
    pub fn settings(&self, joints: usize) -> ObserveSettings {
        ObserveSettings {
            rate: self.rows.rate,
            standstill: self.rows.standstill(joints),
            threads: self.rows.threads,
            ..ObserveSettings::default()
        }
    }
}

impl ComparisonOptions {
    /// As the evaluator takes it.
    pub fn comparison(&self, joints: usize) -> Comparison {
        Comparison {
            band: self.band,
            rate: self.rows.rate,
            cutoff: self.rows.cutoff,
            standstill: self.rows.standstill(joints),
            threads: self.rows.threads,
        }
    }
}

impl DiagnosisOptions {
    /// The comparison of the models before and after.
    pub fn comparison(&self, joints: usize) -> Comparison {
        Comparison {
            band: self.band,
            rate: None,
            cutoff: self.cutoff,
            standstill: standstill(&self.standstill, joints),
            threads: self.threads,
        }
    }

    /// The speeds of standstill that were given, one per joint.
    pub fn speeds(&self, joints: usize) -> Option<Vec<f64>> {
        match self.standstill.as_slice() {
            [] => None,
            [one] => Some(vec![*one; joints]),
            several => Some(several.to_vec()),
        }
    }
}
