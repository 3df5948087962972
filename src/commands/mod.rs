//! The command line: one file a command.

mod challenge;
mod demo;
pub mod diagnose;
mod effects;
mod excite;
mod export;
pub mod identify;
mod import;
mod init;
mod look;
mod paper;
mod robots;
mod shell;
mod show;
mod simulate;
mod validate;

use clap::{Parser, Subcommand};

use crate::failure::Failure;
use crate::output::{complain, finished};
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
    /// List the effects that a diagnosis looks for, or tell what one of them is
    Effects(effects::Arguments),
    /// Search motions that make a robot's parameters observable
    Excite(excite::Arguments),
    /// Write a robot or an identified model as C, Rust without std, URDF or MJCF
    Export(export::Arguments),
    /// Identify a robot's parameters from a recording
    Identify(identify::Arguments),
    /// Write the table of a URDF as a robot YAML
    Import(import::Arguments),
    /// Write a robot YAML and a recording YAML to fill in
    Init(init::Arguments),
    /// Say what is in a recording, and write a recording YAML to start from
    Look(look::Arguments),
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
    /// Print the completions of a shell: `dynid completions bash > /etc/bash_completion.d/dynid`
    Completions(shell::Arguments),
    /// Print the manual: `dynid man > dynid.1`
    Man,
}

/// Runs the command line of this process and says how it went.
pub fn run() -> ExitCode {
    quiet_about_damaged_pages();
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        Err(said) => return told_by_the_parser(&said),
    };
    // What was printed may have been lost even where the command did what it was asked for.
    let words: Vec<String> =
        std::env::args_os().skip(1).map(|word| word.to_string_lossy().into_owned()).collect();
    match execute(cli.command, &words).and_then(|()| finished()) {
        Ok(()) => ExitCode::SUCCESS,
        Err(failure) => {
            complain(&failure.to_string());
            failure.exit_code()
        }
    }
}

/// The decoders of the `parquet` crate panic on some pages that are damaged, which the reader tells as a mistake of the
/// file; nobody needs to be told twice.
fn quiet_about_damaged_pages() {
    let usual = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |panic| {
        if !panic.location().is_some_and(|place| place.file().contains("/parquet-")) {
            usual(panic);
        }
    }));
}

/// Help and version go to standard output, what is wrong with the words of a command to standard error.
fn told_by_the_parser(said: &clap::Error) -> ExitCode {
    match said.print() {
        Err(error) if !said.use_stderr() && error.kind() != std::io::ErrorKind::BrokenPipe => {
            complain(&format!("standard output: cannot write it: {error}"));
            ExitCode::from(2)
        }
        _ => ExitCode::from(if said.use_stderr() { 2 } else { 0 }),
    }
}

/// Runs a command; `words` are those that it was given, for the pages.
fn execute(command: Command, words: &[String]) -> Result<(), Failure> {
    match command {
        Command::Demo(arguments) => demo::run(&arguments),
        Command::Robots => robots::run(),
        Command::Effects(arguments) => effects::run(&arguments),
        Command::Excite(arguments) => excite::run(&arguments),
        Command::Paper(arguments) => paper::run(&arguments),
        Command::Simulate(arguments) => simulate::run(&arguments),
        Command::Challenge(arguments) => challenge::run(&arguments),
        Command::Diagnose(arguments) => diagnose::run(&arguments, words),
        Command::Identify(arguments) => identify::run(&arguments, words),
        Command::Export(arguments) => export::run(&arguments),
        Command::Import(arguments) => import::run(&arguments),
        Command::Init(arguments) => init::run(&arguments),
        Command::Look(arguments) => look::run(&arguments),
        Command::Completions(arguments) => shell::completions(&arguments),
        Command::Man => shell::manual(),
        Command::Show(arguments) => show::run(&arguments),
        Command::Validate(arguments) => validate::run(&arguments, words),
    }
}

/// Runs a command given as words, without the name of the program.
fn execute_words(words: &[&str]) -> Result<(), Failure> {
    let line = std::iter::once("dynid").chain(words.iter().copied());
    let cli = Cli::try_parse_from(line).map_err(|error| Failure::Input(error.to_string()))?;
    let words: Vec<String> = words.iter().map(ToString::to_string).collect();
    execute(cli.command, &words)
}
