//! Recordings that were not reduced yet are; each is kept as soon as it is here.

use std::collections::{BTreeMap, BTreeSet};

use datafusion::arrow::array::{Array, ArrayRef, AsArray, RecordBatch, UInt32Array};
use datafusion::arrow::compute::take;

use super::folder::OutFolder;
use super::rows::{batch, factors_schema, text};
use super::tables;
use crate::engine::Engine;
use crate::error::{FleetError, Result};
use crate::functions::work_batch;
use crate::work::Item;

/// Recordings of a job: what a cluster that fails does again at most.
const JOB: usize = 64;

const QUERY: &str = "SELECT key, dynid_reduce(recording, robot_table, asked_band) AS motions FROM work";

/// Reduces recordings and keeps what comes of them beside the tables.
///
/// # Errors
/// What the engine or the file system says. What was reduced before is kept.
pub async fn reduce_missing(engine: &Engine, out: &OutFolder, missing: &[&Item]) -> Result<()> {
    for (k, job) in missing.chunks(JOB).enumerate() {
        let items: Vec<Item> = job.iter().map(|item| (*item).clone()).collect();
        let rows = work_batch(&items)?;
        let keep = |answer: &RecordBatch| keep(out, &rows, answer);
        let complete = |answer: &[RecordBatch]| complete(&rows, answer);
        engine.over(&rows, QUERY, &keep, &complete).await?;
        eprintln!("dynid-fleet: {} of {} recordings reduced", k * JOB + items.len(), missing.len());
    }
    Ok(())
}

/// Whether the answer has each recording once.
fn complete(rows: &RecordBatch, answer: &[RecordBatch]) -> std::result::Result<(), String> {
    let mut left: BTreeSet<&str> = (0..rows.num_rows()).filter_map(|k| text(rows, "key", k)).collect();
    let asked = left.len();
    for batch in answer {
        for k in 0..batch.num_rows() {
            let key = text(batch, "key", k).ok_or("a recording without a key")?;
            if !left.remove(key) {
                return Err(format!("recording {key} came twice, or was not asked for"));
            }
        }
    }
    match left.len() {
        0 => Ok(()),
        missing => Err(format!("{missing} of {asked} recordings are missing")),
    }
}

/// Keeps each recording of an answer in a file of its own.
fn keep(out: &OutFolder, rows: &RecordBatch, answer: &RecordBatch) -> Result<()> {
    let wrong = || FleetError::Engine("the engine returned other columns than were asked for".to_owned());
    let places: BTreeMap<&str, usize> =
        (0..rows.num_rows()).filter_map(|k| Some((text(rows, "key", k)?, k))).collect();
    let motions = answer.column_by_name("motions").and_then(|column| column.as_list_opt::<i32>());
    let motions = motions.ok_or_else(wrong)?;
    for k in 0..answer.num_rows() {
        let key = text(answer, "key", k).ok_or_else(wrong)?;
        let place = *places.get(key).ok_or_else(wrong)?;
        let own = motions.value(k);
        let own = own.as_struct_opt().ok_or_else(wrong)?;
        let again = UInt32Array::from(vec![u32::try_from(place).unwrap_or(u32::MAX); own.len()]);
        let of_recording = rows.columns().iter().map(|column| take(column, &again, None));
        let mut columns: Vec<ArrayRef> = of_recording
            .collect::<std::result::Result<_, _>>()
            .map_err(|error| FleetError::Engine(error.to_string()))?;
        columns.extend(own.columns().iter().cloned());
        tables::write(&out.pending(key), &batch(&factors_schema(), columns)?)?;
    }
    Ok(())
}
