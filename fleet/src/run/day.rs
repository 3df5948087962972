//! A day of a fleet: the factors of its recordings, robot by robot.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use datafusion::arrow::array::{BooleanArray, RecordBatch};
use datafusion::arrow::compute::{concat_batches, filter_record_batch};
use datafusion::arrow::datatypes::SchemaRef;
use dynid_runtime::estimation::Reduced;

use super::folder::OutFolder;
use super::rows::{bytes, factors_schema, number, screening_schema, text};
use super::tables;
use crate::day::Day;
use crate::error::{FleetError, Result};
use crate::work::Item;

/// A robot on a day.
pub struct RobotDay {
    /// All of its recordings that are used.
    pub all: Reduced,
    /// Each of them, by its path or address.
    pub recordings: BTreeMap<String, Reduced>,
    /// Mean temperature of these recordings, °C, where they say one.
    pub temperature: Option<f64>,
    /// Mean of their loads, where they say one.
    pub load: Option<f64>,
    /// The name that the robot's table has.
    pub table_name: Option<String>,
}

/// Keys of recordings, and the stamps of their files where they are known.
pub type Known = BTreeMap<String, Option<String>>;

/// The recordings that a day was done with; none where it was not done.
///
/// # Errors
/// A table that is none.
pub fn done(out: &OutFolder, day: Day) -> Result<Known> {
    known(&out.of_day("screening", day), &screening_schema())
}

/// The recordings of a day that were reduced, whether the day is done or not.
///
/// # Errors
/// A table that is none.
pub fn reduced(out: &OutFolder, day: Day) -> Result<Known> {
    known(&out.of_day("factors", day), &factors_schema())
}

/// A recording that was reduced and whose day is not done since.
///
/// # Errors
/// A table that is none.
pub fn pending(out: &OutFolder, key: &str) -> Result<Known> {
    known(&out.pending(key), &factors_schema())
}

fn known(path: &Path, schema: &SchemaRef) -> Result<Known> {
    let table = tables::read(path, schema)?;
    let row = |table: &RecordBatch, k: usize| {
        Some((text(table, "key", k)?.to_owned(), text(table, "files", k).map(str::to_owned)))
    };
    Ok(table.iter().flat_map(|table| (0..table.num_rows()).filter_map(|k| row(table, k))).collect())
}

/// Brings the motions of a day together, from what was reduced since its table was written and from it, and writes the table.
///
/// # Errors
/// A table that is none, or what the file system says.
pub fn gather(out: &OutFolder, day: Day, items: &[&Item]) -> Result<RecordBatch> {
    let schema = factors_schema();
    let failed = |error: datafusion::arrow::error::ArrowError| FleetError::Engine(error.to_string());
    let path = out.of_day("factors", day);
    let wanted: BTreeSet<String> = items.iter().map(|item| item.key()).collect();
    let mut parts = Vec::new();
    let mut fresh = BTreeSet::new();
    for item in items {
        let key = item.key();
        if let Some(part) = tables::read(&out.pending(&key), &schema)? {
            parts.push(part);
            fresh.insert(key);
        }
    }
    if let Some(before) = tables::read(&path, &schema)? {
        let still: BooleanArray = (0..before.num_rows())
            .map(|k| {
                Some(text(&before, "key", k).is_some_and(|key| wanted.contains(key) && !fresh.contains(key)))
            })
            .collect();
        parts.push(filter_record_batch(&before, &still).map_err(failed)?);
    }
    let all = concat_batches(&schema, &parts).map_err(failed)?;
    // The same recordings give the same table, whenever each of them was reduced.
    let mut order: Vec<u32> = (0..all.num_rows() as u32).collect();
    order.sort_by_key(|&k| (text(&all, "robot", k as usize), text(&all, "recording", k as usize)));
    let order = datafusion::arrow::array::UInt32Array::from(order);
    let columns = all.columns().iter().map(|column| datafusion::arrow::compute::take(column, &order, None));
    let columns = columns.collect::<std::result::Result<Vec<_>, _>>().map_err(failed)?;
    let sorted = RecordBatch::try_new(schema, columns).map_err(failed)?;
    tables::write(&path, &sorted)?;
    Ok(sorted)
}

/// Removes what was kept of recordings beside the table of their day.
pub fn clear_pending(out: &OutFolder, items: &[&Item]) {
    for item in items {
        // What stays is what the table has.
        let _ = std::fs::remove_file(out.pending(&item.key()));
    }
}

/// The robots of a day with their factors. A recording that was reduced with another robot table than those before it on its
/// day is left out and named.
///
/// # Errors
/// Bytes that are no factors.
pub fn robots(factors: &RecordBatch) -> Result<(BTreeMap<String, RobotDay>, BTreeMap<String, String>)> {
    let mut recordings: BTreeMap<(String, String), Reduced> = BTreeMap::new();
    for k in 0..factors.num_rows() {
        let (Some(robot), Some(recording), Some(bytes)) =
            (text(factors, "robot", k), text(factors, "recording", k), bytes(factors, "factor", k))
        else {
            continue;
        };
        let failed = |error| FleetError::Engine(format!("{recording}: {error}"));
        let factor = Reduced::from_bytes(bytes).map_err(failed)?;
        match recordings.get_mut(&(robot.to_owned(), recording.to_owned())) {
            Some(own) => own.merge(&factor).map_err(failed)?,
            None => {
                recordings.insert((robot.to_owned(), recording.to_owned()), factor);
            }
        }
    }
    let mut robots: BTreeMap<String, RobotDay> = BTreeMap::new();
    let mut left_out = BTreeMap::new();
    for ((robot, recording), factor) in recordings {
        match robots.get_mut(&robot) {
            Some(day) => match day.all.merge(&factor) {
                Ok(()) => {
                    day.recordings.insert(recording, factor);
                }
                Err(error) => {
                    left_out.insert(recording, error.to_string());
                }
            },
            None => {
                let recordings = BTreeMap::from([(recording, factor.clone())]);
                let own =
                    RobotDay { all: factor, recordings, temperature: None, load: None, table_name: None };
                robots.insert(robot, own);
            }
        }
    }
    for (robot, day) in &mut robots {
        day.temperature = mean(factors, robot, ["temperature", "own_temperature"]);
        day.load = mean(factors, robot, ["load", "own_load"]);
        let mut own = used(factors, robot);
        day.table_name = own.find_map(|k| text(factors, "table_name", k).map(str::to_owned));
    }
    Ok((robots, left_out))
}

/// Mean over the motions of a robot that are used: of what the table of recordings says, else of what the recording does.
fn mean(factors: &RecordBatch, robot: &str, [said, own]: [&str; 2]) -> Option<f64> {
    let value = |k: usize| number(factors, said, k).or_else(|| number(factors, own, k));
    let values: Vec<f64> = used(factors, robot).filter_map(value).collect();
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

/// Rows of the motions of a robot that are used.
fn used<'a>(factors: &'a RecordBatch, robot: &'a str) -> impl Iterator<Item = usize> + 'a {
    (0..factors.num_rows())
        .filter(move |&k| text(factors, "robot", k) == Some(robot) && bytes(factors, "factor", k).is_some())
}
