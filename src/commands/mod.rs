//! The command line: one file a command.

mod diagnose;
mod excite;
mod identify;
mod robots;
mod show;
mod simulate;
mod validate;

pub(crate) use identify::cells as parameter_cells;

use clap::{Parser, Subcommand};
use std::process::ExitCode;

/// From a modified-DH table and a recording to a dynamic model you can trust.
#[derive(Debug, Parser)]
#[command(name = "dynid", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// List the robots that have generated models
    Robots,
    /// Search motions that make a robot's parameters observable
    Excite(excite::Arguments),
    /// Identify a robot's parameters from a recording
    Identify(identify::Arguments),
    /// Predict the torques of a recording with an identified model
    Validate(validate::Arguments),
    /// Find out which physics is missing, where, and whether adding it helps on motion that was held back
    Diagnose(diagnose::Arguments),
    /// Simulate a robot in closed loop and write a recording
    Simulate(simulate::Arguments),
    /// Show a robot: its table, its base parameters, its operation counts
    Show(show::Arguments),
}

/// Runs the command line of this process and says how it went.
pub fn run() -> ExitCode {
    let outcome = match Cli::parse().command {
        Command::Robots => robots::run(),
        Command::Excite(arguments) => excite::run(&arguments),
        Command::Identify(arguments) => identify::run(&arguments),
        Command::Validate(arguments) => validate::run(&arguments),
        Command::Diagnose(arguments) => diagnose::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Show(arguments) => show::run(&arguments),
    };
    match outcome {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{failure}");
            failure.exit_code()
        }
    }
}
