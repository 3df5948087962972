//! What a run is asked for.

use std::path::PathBuf;

use clap::Parser;

/// What to add to which recording.
#[derive(Debug, Parser)]
pub struct Options {
    /// The recording: a YAML that names the robot, the files and the columns
    pub recording: PathBuf,
    /// Motions of the same robot before: only what changed is looked for
    #[arg(long)]
    pub baseline: Option<PathBuf>,
    /// Effects; `none` is a window as it was recorded
    #[arg(
        long,
        value_delimiter = ',',
        default_value = "none,spring,stribeck,load_dependent_friction,nonlinear_viscous,asymmetric_friction,\
                         position_dependent_friction,position_dependent_torque,friction_drift,torque_ripple,\
                         torque_constant_error,time_delay"
    )]
    pub effects: Vec<String>,
    /// Sizes: torque of the law that the standard parameters cannot take over, relative to what they leave without it
    #[arg(long, value_delimiter = ',', default_value = "1,2.5")]
    pub sizes: Vec<f64>,
    /// Length of a window, s
    #[arg(long, default_value_t = 12.0)]
    pub seconds: f64,
    /// Part of a motion that windows are not cut from, at its end; the diagnosis tests its findings on it
    #[arg(long, default_value_t = 0.0)]
    pub test: f64,
    /// How many seeds; each has its own window, joint and shape
    #[arg(long, default_value_t = 2)]
    pub seeds: u64,
    /// The first seed
    #[arg(long, default_value_t = 1)]
    pub first_seed: u64,
    /// Threads; the result does not depend on them
    #[arg(long, default_value_t = 2)]
    pub threads: usize,
}
