//! `dynid-fleet sql fleet.yaml "SELECT ..."`

use std::path::PathBuf;
use std::time::Duration;

use clap::Args;
use datafusion::arrow::util::pretty::pretty_format_batches;
use datafusion::prelude::{ParquetReadOptions, SessionContext};

use super::out_of;
use crate::engine::Engine;
use crate::error::{FleetError, Result};
use crate::fleet_file::FleetFile;

/// What to ask.
#[derive(Debug, Args)]
pub(super) struct Options {
    /// The fleet
    fleet: PathBuf,
    /// The query. Tables: parameters, findings, screening, factors, trends, alarms; functions: dynid_reduce, dynid_merge,
    /// dynid_solve, dynid_rise, dynid_diagnose, and the table dynid_factors('fleet.yaml')
    query: String,
    /// Folder of the results [default: what the fleet says, or fleet-results beside it]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Run on the cluster of this scheduler, which must see the folder of the results
    #[arg(long, value_name = "HOST:PORT")]
    cluster: Option<String>,
}

/// Asks, and prints the answer.
pub(super) async fn run(options: &Options) -> Result<()> {
    let fleet = FleetFile::read(&options.fleet)?;
    let out = out_of(&fleet, options.out.as_deref());
    let engine = Engine::at(options.cluster.as_deref(), Duration::from_secs(3600));
    let context = engine.context().await?;
    register_results(&context, &out).await?;
    let batches = context.sql(&options.query).await?.collect().await?;
    let table = pretty_format_batches(&batches).map_err(|error| FleetError::Engine(error.to_string()))?;
    println!("{table}");
    Ok(())
}

/// The results as tables, those that are there.
async fn register_results(context: &SessionContext, out: &std::path::Path) -> Result<()> {
    for name in ["parameters", "findings", "screening", "factors"] {
        let folder = out.join(name);
        let any = std::fs::read_dir(&folder).is_ok_and(|mut files| files.next().is_some());
        if any {
            let path = format!("{}/", folder.display());
            context.register_parquet(name, &path, ParquetReadOptions::default()).await?;
        }
    }
    for name in ["trends", "alarms"] {
        let file = out.join(format!("{name}.parquet"));
        if file.is_file() {
            context.register_parquet(name, file.display().to_string(), ParquetReadOptions::default()).await?;
        }
    }
    Ok(())
}
