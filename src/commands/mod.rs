//! The command line: one file a command.

mod challenge;
mod demo;
mod diagnose;
mod excite;
mod identify;
mod paper;
mod robots;
mod show;
mod simulate;
mod validate;

pub(crate) use identify::cells as parameter_cells;

use clap::{Parser, Subcommand};

use crate::failure::Failure;
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
    /// Simulate a TX-40 that hides an effect, identify it, find the effect, and write a report
    Demo(demo::Arguments),
    /// List the robots that have generated models
    Robots,
    /// Search motions that make a robot's parameters observable
    Excite(excite::Arguments),
    /// Identify a robot's parameters from a recording
    Identify(identify::Arguments),
    /// Predict the torques of a recording with an identified model
    Validate(validate::Arguments),
    /// Find out which physics is missing, where, and whether adding it helps on held-out motion
    Diagnose(diagnose::Arguments),
    /// Diagnose recordings with hidden effects, then read what was hidden and keep score
    Challenge(challenge::Arguments),
    /// Tables II, III and IV of the power-model paper, ours beside theirs
    Paper(paper::Arguments),
    /// Simulate a robot in closed loop and write a recording
    Simulate(simulate::Arguments),
    /// Show a robot: its table, its base parameters, its operation counts
    Show(show::Arguments),
}

/// Runs the command line of this process and says how it went.
pub fn run() -> ExitCode {
    match execute(Cli::parse().command) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("{failure}");
            failure.exit_code()
        }
    }
}

fn execute(command: Command) -> Result<(), Failure> {
    match command {
        Command::Demo(arguments) => demo::run(&arguments),
        Command::Robots => robots::run(),
        Command::Excite(arguments) => excite::run(&arguments),
        Command::Paper(arguments) => paper::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Challenge(arguments) => challenge::run(&arguments),
        Command::Diagnose(arguments) => diagnose::run(&arguments),
        Command::Identify(arguments) => identify::run(&arguments),
        Command::Show(arguments) => show::run(&arguments),
        Command::Validate(arguments) => validate::run(&arguments),
    }
}

/// Runs a command given as words, without the name of the program.
fn execute_words(words: &[&str]) -> Result<(), Failure> {
    let line = std::iter::once("dynid").chain(words.iter().copied());
    let cli = Cli::try_parse_from(line).map_err(|error| Failure::Input(error.to_string()))?;
    execute(cli.command)
}
