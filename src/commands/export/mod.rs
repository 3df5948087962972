//! `dynid export`: a robot or an identified model as something that other programs take.

mod bodies;
mod c;
mod known;
mod left_out;
mod mjcf;
mod rust;
mod urdf;

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::arguments::UrdfOptions;
use crate::failure::Failure;

/// What to export, as what and where to.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A model saved by `identify --out` or `diagnose --out`; or a robot, by name or path, with its nominal parameters where
    /// the format needs values
    what: String,
    /// The language or the format
    #[arg(long, value_enum)]
    to: Target,
    /// Where it is written: of a language a folder, which is made where it is missing; of a format a file, with what it cannot
    /// hold in a JSON beside it
    #[arg(long)]
    out: PathBuf,
    /// The floating-point type of C; Rust is generic over it
    #[arg(long, value_enum)]
    real: Option<Real>,
    /// Beside the C, a source by which CasADi loads its functions from a library
    #[arg(long)]
    casadi: bool,
    /// URDF of the same robot: its inertials are the prior of what the data do not determine, its names and frames are kept;
    /// `--to urdf` writes into a copy of it
    #[arg(long)]
    template: Option<PathBuf>,
    #[command(flatten)]
    options: UrdfOptions,
}

/// A language or a format.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Target {
    /// A header and a C99 source that need the C library's mathematics alone
    C,
    /// A Rust module that needs `core` alone
    Rust,
    /// Unified Robot Description Format
    Urdf,
    /// MuJoCo's XML
    Mjcf,
}

/// A floating-point type.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Real {
    /// `float`
    F32,
    /// `double`
    F64,
}

/// Writes it, and says what it wrote and what could not go in.
///
/// # Errors
/// [`Failure::Input`] for an option that the target has no use for, and what the target itself refuses.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let of_code = matches!(arguments.to, Target::C | Target::Rust);
    if of_code && arguments.template.is_some() {
        return Err(Failure::Input("--template is for --to urdf and --to mjcf".to_owned()));
    }
    if arguments.real.is_some() && arguments.to != Target::C {
        return Err(Failure::Input("--real is for --to c; the Rust module takes any number type".to_owned()));
    }
    if arguments.casadi && arguments.to != Target::C {
        return Err(Failure::Input("--casadi is for --to c".to_owned()));
    }
    match arguments.to {
        Target::C => c::run(arguments),
        Target::Rust => rust::run(arguments),
        Target::Urdf => urdf::run(arguments),
        Target::Mjcf => mjcf::run(arguments),
    }
}
