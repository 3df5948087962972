//! A fleet from its recordings to its tables.
//!
//! ```text
//! recordings -> pending/<key>.parquet     a recording was reduced                    reducing
//! pending    -> factors/<day>.parquet     all of a day were                          day
//!            -> parameters, findings      merged, solved, compared, diagnosed        finishing, findings
//!            -> screening/<day>.parquet   the day is done
//! parameters -> trends, alarms            all days anew                              watching, alarms
//!            -> fleet.html, robots/*.html                                            pages
//! ```
//!
//! Each file is written whole or not at all, and what is there is not done again, so that a run that was interrupted goes on
//! where it was.

pub mod alarms;
mod day;
mod findings;
mod finishing;
mod folder;
mod history;
mod outcomes;
mod pages;
mod reducing;
mod references;
pub mod rows;
pub mod tables;
mod todo;
mod watching;

use std::collections::BTreeMap;
use std::path::Path;

use crate::day::Day;
use crate::engine::Engine;
use crate::error::{FleetError, Result};
use crate::fleet_file::FleetFile;
use crate::work::{Item, work};
use alarms::{AlarmRow, Before};
use folder::OutFolder;
use history::History;
pub use outcomes::Outcomes;
use references::References;

/// What a run did.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Summary {
    /// Recordings of the fleet, from the day on that was asked for.
    pub recordings: usize,
    /// Of these, those that were reduced now.
    pub reduced: usize,
    /// Of these, those that had been reduced before and were replaced under the same name.
    pub replaced: usize,
    /// Days of these recordings.
    pub all_days: usize,
    /// Of these, those that were worked out now.
    pub days: usize,
    /// What became of the recordings, those of earlier runs too.
    pub outcomes: Outcomes,
    /// All alarms of the fleet, the worst first.
    pub alarms: Vec<AlarmRow>,
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
    let todo = todo::of(&out, &by_day).await?;
    reducing::reduce_missing(engine, &out, &todo.missing).await?;
    let mut references = References::read(fleet, &out)?;
    todo.replaced.iter().for_each(|item| references.forget(&item.robot, item.day));
    let mut history = History::read(&out)?;
    for &one in &todo.days {
        finishing::finish((engine, fleet, &out), &mut references, &mut history, one, &by_day[&one]).await?;
    }
    let before = Before::read(&out)?;
    if !todo.days.is_empty() || !pages::are_there(&out) {
        watching::watch_all(&out)?;
    }
    Ok(Summary {
        recordings: items.len(),
        reduced: todo.missing.len(),
        replaced: todo.replaced.len(),
        all_days: by_day.len(),
        days: todo.days.len(),
        outcomes: Outcomes::of(&out, by_day.keys().copied())?,
        alarms: alarms::read(&out, &before)?,
    })
}
