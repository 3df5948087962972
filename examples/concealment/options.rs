//! What a run is asked for.

use std::path::PathBuf;

use clap::{Parser, ValueEnum};

use crate::case::Before;
use crate::recorder::Recorder;

/// What a contact pushes.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, ValueEnum)]
pub enum Pushed {
    /// The last link, with a force.
    #[default]
    Link,
    /// One joint, with a torque.
    Joint,
}

/// What to hide, and where the table goes.
#[derive(Debug, Parser)]
pub struct Options {
    /// Robots
    #[arg(long, value_delimiter = ',', default_value = "tx40,cobot6,scara4")]
    pub robots: Vec<String>,
    /// Effects; `none` is a run without any [default: all of the catalogue, and none]
    #[arg(long, value_delimiter = ',')]
    pub effects: Vec<String>,
    /// Sizes
    #[arg(long, value_delimiter = ',', default_value = "small,medium,large")]
    pub sizes: Vec<String>,
    /// How many seeds; each has its own motions, joint, shape and noise
    #[arg(long, default_value_t = 5)]
    pub seeds: u64,
    /// The first seed
    #[arg(long, default_value_t = 1)]
    pub first_seed: u64,
    /// Hide so many effects at once: each effect with others of the list
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..=4))]
    pub together: u8,
    /// How torques and positions are recorded; each seed takes the next one of the list
    #[arg(long, value_enum, value_delimiter = ',', default_value = "white")]
    pub recorders: Vec<Recorder>,
    /// Record every robot before anything was hidden in it, too, and look for what changed
    #[arg(long)]
    pub baseline: bool,
    /// Let every robot have load friction and a spring before anything was hidden in it, too; diagnose it then, and judge
    /// the recording against the model that this gives, or against it and its motions
    #[arg(
        long,
        value_enum,
        num_args = 0..=1,
        default_missing_value = "model",
        conflicts_with_all = ["baseline", "dump", "visible"],
    )]
    pub reference: Option<Before>,
    /// One motion of this duration, s, instead of one to three of 16 to 24 s together
    #[arg(long)]
    pub seconds: Option<f64>,
    /// What contacts push: a link, by a force, or one joint, by a torque
    #[arg(long, value_enum, default_value_t)]
    pub push: Pushed,
    /// How long contacts last, s: least and most
    #[arg(long, value_delimiter = ',', num_args = 2, default_values_t = crate::case::USUAL_PUSH)]
    pub push_seconds: Vec<f64>,
    /// Threads; the result does not depend on them
    #[arg(long, default_value_t = 2)]
    pub threads: usize,
    /// Markdown file for the tables [default: standard output]
    #[arg(long)]
    pub out: Option<PathBuf>,
    /// Write down every finished run here, and take those that are there as done: a stopped test goes on
    #[arg(long, conflicts_with_all = ["visible", "dump"])]
    pub journal: Option<PathBuf>,
    /// Simulate only, and write what can be seen of every effect
    #[arg(long, conflicts_with = "dump")]
    pub visible: bool,
    /// Write the cases to this folder as a challenge, instead of diagnosing them
    #[arg(long, conflicts_with = "out")]
    pub dump: Option<PathBuf>,
}
