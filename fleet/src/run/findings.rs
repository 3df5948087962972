//! What is diagnosed of the recordings whose errors rose.

use std::collections::BTreeMap;
use std::sync::{Arc, Mutex};

use datafusion::arrow::array::{Array, ArrayRef, AsArray, BinaryArray, RecordBatch};
use datafusion::arrow::compute::concat_batches;
use datafusion::arrow::datatypes::{DataType, Field, Schema};

use super::references::RobotReference;
use super::rows::{batch, counts, days, findings_schema, text, texts};
use crate::day::Day;
use crate::engine::Engine;
use crate::error::{FleetError, Result};

/// A recording whose errors rose.
pub struct Risen {
    /// Its robot.
    pub robot: String,
    /// Its path or address.
    pub recording: String,
    /// The robot's table, where the fleet says one.
    pub table: Option<String>,
    /// What the robot is compared with.
    pub reference: RobotReference,
}

/// Recordings of a job.
const JOB: usize = 16;

const QUERY: &str =
    "SELECT recording, dynid_diagnose(recording, robot_table, factor, model, rows) AS found FROM work";

/// Diagnoses recordings of a day: the rows of `findings`.
///
/// # Errors
/// What the engine says.
pub async fn findings(engine: &Engine, day: Day, risen: &[Risen], rows: usize) -> Result<RecordBatch> {
    let mut parts = vec![RecordBatch::new_empty(findings_schema())];
    for job in risen.chunks(JOB) {
        let work = work(job, rows)?;
        let answers: Mutex<BTreeMap<String, ArrayRef>> = Mutex::new(BTreeMap::new());
        let keep = |part: &RecordBatch| {
            let mut answers = answers.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
            take(part, &mut answers)
        };
        let complete = |parts: &[RecordBatch]| {
            let rows: usize = parts.iter().map(RecordBatch::num_rows).sum();
            if rows == job.len() { Ok(()) } else { Err(format!("{rows} diagnoses of {}", job.len())) }
        };
        engine.over(&work, QUERY, &keep, &complete).await?;
        let answers = answers.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
        for one in job {
            let found = answers.get(&one.recording).and_then(|found| found.as_struct_opt());
            let found = found
                .ok_or_else(|| FleetError::Engine(format!("{}: no diagnosis came back", one.recording)))?;
            let same = |text: &str| texts(std::iter::repeat_n(Some(text), found.len()).collect::<Vec<_>>());
            let mut columns =
                vec![same(&one.robot), days(std::iter::repeat_n(day, found.len())), same(&one.recording)];
            columns.extend(found.columns().iter().cloned());
            parts.push(batch(&findings_schema(), columns)?);
        }
    }
    concat_batches(&findings_schema(), &parts).map_err(|error| FleetError::Engine(error.to_string()))
}

fn work(job: &[Risen], rows: usize) -> Result<RecordBatch> {
    let field = |name: &str, kind| Field::new(name, kind, true);
    let schema = Arc::new(Schema::new(vec![
        field("recording", DataType::Utf8),
        field("robot_table", DataType::Utf8),
        field("factor", DataType::Binary),
        field("model", DataType::Utf8),
        field("rows", DataType::Int64),
    ]));
    let rows = i64::try_from(rows).unwrap_or(i64::MAX);
    let columns: Vec<ArrayRef> = vec![
        texts(job.iter().map(|one| Some(one.recording.as_str()))),
        texts(job.iter().map(|one| one.table.as_deref())),
        Arc::new(BinaryArray::from_iter(job.iter().map(|one| one.reference.factor.as_deref()))),
        texts(job.iter().map(|one| one.reference.model.as_deref())),
        counts(job.iter().map(|_| rows)),
    ];
    batch(&schema, columns)
}

fn take(part: &RecordBatch, answers: &mut BTreeMap<String, ArrayRef>) -> Result<()> {
    let wrong = || FleetError::Engine("the engine returned other columns than were asked for".to_owned());
    let found =
        part.column_by_name("found").and_then(|column| column.as_list_opt::<i32>()).ok_or_else(wrong)?;
    for k in 0..part.num_rows() {
        answers.insert(text(part, "recording", k).ok_or_else(wrong)?.to_owned(), found.value(k));
    }
    Ok(())
}
