//! The command line.

mod run;
mod simulate;
mod sql;
mod told;

use std::path::{Path, PathBuf};
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use crate::cluster::{ExecutorOptions, SchedulerOptions, serve_executor, serve_scheduler};
use crate::error::{FleetError, Result};
use crate::fleet_file::FleetFile;

/// dynid on the recordings of a fleet of robots
#[derive(Debug, Parser)]
#[command(name = "dynid-fleet", version, arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Debug, Subcommand)]
enum Command {
    /// Bring parameters, findings, screening, trends and alarms of a fleet up to date
    Run(run::Options),
    /// Ask the results, and the recordings, in SQL
    Sql(sql::Options),
    /// Make a small simulated fleet, with a gear that wears
    Simulate(simulate::Options),
    /// Serve the scheduler of a cluster
    ServeScheduler(SchedulerOptions),
    /// Serve an executor of a cluster: it reads and reduces recordings
    ServeExecutor(ExecutorOptions),
}

/// Stack of a thread: plans are trees that are walked recursively.
const STACK: usize = 16 << 20;

/// Runs the command line.
pub fn run() -> ExitCode {
    let arguments = Arguments::parse();
    match with_runtime(arguments) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("dynid-fleet: {error}");
            ExitCode::from(2)
        }
    }
}

fn with_runtime(arguments: Arguments) -> Result<()> {
    // A recording is reduced by the thread that comes to it: as many at a time as there are threads.
    let processors = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = match &arguments.command {
        Command::Run(options) => options.threads.unwrap_or(processors),
        // Signs of life go on while recordings are reduced.
        _ => processors + 2,
    };
    let runtime = tokio::runtime::Builder::new_multi_thread()
        .worker_threads(threads.max(1))
        .thread_stack_size(STACK)
        .enable_all()
        .build()
        .map_err(|error| FleetError::Engine(error.to_string()))?;
    runtime.block_on(async {
        match arguments.command {
            Command::Run(options) => run::run(&options).await,
            Command::Sql(options) => sql::run(&options).await,
            Command::Simulate(options) => simulate::run(&options),
            Command::ServeScheduler(options) => serve_scheduler(&options).await,
            Command::ServeExecutor(options) => serve_executor(&options).await,
        }
    })
}

/// The folder of results: as asked for, as the fleet says, or beside it.
fn out_of(fleet: &FleetFile, asked: Option<&Path>) -> PathBuf {
    let beside = || fleet.folder.join("fleet-results");
    asked.map(Path::to_path_buf).or_else(|| fleet.out.clone()).unwrap_or_else(beside)
}
