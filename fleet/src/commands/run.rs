//! `dynid-fleet run fleet.yaml`

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use clap::builder::TypedValueParser;
use dynid::output::{finished, print};

use super::out_of;
use super::told::told;
use crate::day::{self, Day};
use crate::engine::Engine;
use crate::error::Result;
use crate::fleet_file::FleetFile;

/// What to bring up to date, and where.
#[derive(Debug, Args)]
pub(super) struct Options {
    /// The fleet
    fleet: PathBuf,
    /// Folder of the results [default: what the fleet says, or fleet-results beside it]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Run on the cluster of this scheduler
    #[arg(long, value_name = "HOST:PORT")]
    cluster: Option<String>,
    /// Only recordings of this day and later
    #[arg(long, value_parser = a_day, value_name = "DAY")]
    since: Option<Day>,
    /// Recordings at a time in this process [default: one for each processor]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024).map(usize::from))]
    pub(super) threads: Option<usize>,
    /// After how many seconds without a result a job is submitted to the cluster again
    #[arg(long, default_value_t = 3600, value_parser = clap::value_parser!(u64).range(1..))]
    timeout: u64,
}

fn a_day(text: &str) -> std::result::Result<Day, String> {
    day::parse(text).ok_or_else(|| "expected a day such as 2026-03-01".to_owned())
}

/// Brings a fleet up to date.
pub(super) async fn run(options: &Options) -> Result<()> {
    let fleet = FleetFile::read(&options.fleet)?;
    let out = out_of(&fleet, options.out.as_deref());
    let engine = Engine::at(options.cluster.as_deref(), Duration::from_secs(options.timeout));
    let did = crate::run::run(&fleet, &out, &engine, options.since).await?;
    print(&told(&did, &out));
    Ok(finished()?)
}
