//! A fleet from its recordings to its tables.
//!
//! ```text
//! recordings -> pending/<key>.parquet     a recording was reduced                    reducing
//! pending    -> factors/<day>.parquet     all of a day were                          day
//!            -> parameters, findings      merged, solved, compared, diagnosed        finishing, findings
//!            -> screening/<day>.parquet   the day is done
//! parameters -> trends, alarms, fleet.html
//! ```
//!
//! Each file is written whole or not at all, and what is there is not done again, so that a run that was interrupted goes on
//! where it was.

mod day;
mod findings;
mod finishing;
mod folder;
mod history;
mod reducing;
mod references;
pub mod rows;
pub mod tables;
mod watching;

use std::collections::BTreeMap;
use std::path::Path;

use crate::day::Day;
use crate::engine::Engine;
use crate::error::{FleetError, Result};
use crate::fleet_file::FleetFile;
use crate::work::{Item, work};
use folder::OutFolder;
use history::History;
use references::References;

/// What a run did.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Summary {
    /// Recordings of the fleet, from the day on that was asked for.
    pub recordings: usize,
    /// Of these, those that were reduced now.
    pub reduced: usize,
    /// Days that were worked out now.
    pub days: usize,
}

/// Brings the results of a fleet up to date.
///
/// # Errors
/// What is wrong in the fleet file or a table, a folder that cannot be written, an engine that fails. What was done before is
/// kept, and the next run goes on from there. A recording that cannot be used is no error but a row of `screening`.
pub async fn run(fleet: &FleetFile, path: &Path, engine: &Engine, since: Option<Day>) -> Result<Summary> {
    let out = OutFolder::open(path)?;
    let items = work(fleet, since).await?;
    if items.is_empty() {
        return Err(FleetError::file(
            &fleet.path,
            "it has no recordings: look at `recordings`, and at --since where it was given",
        ));
    }
    let mut by_day: BTreeMap<Day, Vec<&Item>> = BTreeMap::new();
    for item in &items {
        by_day.entry(item.day).or_default().push(item);
    }
    let mut missing = Vec::new();
    let mut unfinished = Vec::new();
    for (&one, own) in &by_day {
        let done = day::done(&out, one)?;
        if own.iter().all(|item| done.contains(&item.key())) {
            continue;
        }
        let reduced = day::reduced(&out, one)?;
        let is_missing = |item: &&&Item| !reduced.contains(&item.key()) && !out.pending(&item.key()).exists();
        missing.extend(own.iter().filter(is_missing).copied());
        unfinished.push(one);
    }
    reducing::reduce_missing(engine, &out, &missing).await?;
    let mut references = References::read(fleet, &out)?;
    let mut history = History::read(&out)?;
    for &one in &unfinished {
        finishing::finish((engine, fleet, &out), &mut references, &mut history, one, &by_day[&one]).await?;
    }
    if !unfinished.is_empty() || !out.file("alarms.parquet").exists() {
        watching::watch_all(&out)?;
    }
    Ok(Summary { recordings: items.len(), reduced: missing.len(), days: unfinished.len() })
}
