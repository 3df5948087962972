//! `dynid export`: a model in the formats of other tools.

mod bodies;
mod left_out;
mod mjcf;
mod urdf;

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::arguments::UrdfOptions;
use crate::failure::Failure;

/// What to export, as what and where to.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A model saved by `identify --out` or `diagnose --out`; or a robot, by name or path, with its nominal parameters
    what: String,
    /// The format
    #[arg(long)]
    to: Target,
    /// Where it is written; what the format cannot hold goes into a JSON beside it
    #[arg(long)]
    out: PathBuf,
    /// URDF of the same robot: its inertials are the prior of what the data do not determine, its names and frames are kept;
    /// `--to urdf` writes into a copy of it
    #[arg(long)]
    template: Option<PathBuf>,
    #[command(flatten)]
    options: UrdfOptions,
}

/// A format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Target {
    /// Unified Robot Description Format
    Urdf,
    /// MuJoCo's XML
    Mjcf,
}

/// Exports.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match arguments.to {
        Target::Urdf => urdf::run(arguments),
        Target::Mjcf => mjcf::run(arguments),
    }
}
