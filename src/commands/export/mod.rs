//! `dynid export`: a robot or an identified model as something that other programs take.

mod c;
mod known;
mod rust;

use std::path::PathBuf;

use clap::{Args, ValueEnum};

use crate::failure::Failure;

/// What to export, and as what.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A robot of `dynid robots`, the path of a robot YAML, or a model saved by `identify --out` or `diagnose --out`
    what: String,
    /// The language
    #[arg(long, value_enum)]
    to: Target,
    /// Where to write: a folder, which is made where it is missing
    #[arg(long)]
    out: PathBuf,
    /// The floating-point type of C; Rust is generic over it
    #[arg(long, value_enum)]
    real: Option<Real>,
}

/// A language or a format.
#[derive(Debug, Clone, Copy, ValueEnum)]
enum Target {
    /// A header and a C99 source that need the C library's mathematics alone
    C,
    /// A Rust module that needs `core` alone
    Rust,
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
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    match arguments.to {
        Target::C => c::run(arguments),
        Target::Rust => rust::run(arguments),
    }
}
