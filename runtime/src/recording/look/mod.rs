//! What is in a data file: its topics, its signals with their rates, gaps and ranges, and what is wrong with it.
//!
//! Everything is read once, in bounded memory. Which signal is what is guessed by its name, see [`Role`].

mod roles;
mod series;

use std::path::Path;

use serde::Serialize;

use super::formats::{self, Wanted};
use super::layout_guess::{self, Guess};
use super::npy::NpyReader;
use super::topic::Topic;
use super::{Column, Layout, RecordingError, Rows};
pub use roles::{Channels, Role, channels};
pub use series::Series;
use series::Watched;

/// Rows read at a time.
const AT_ONCE: usize = 4096;

/// What is in a data file.
#[derive(Debug, Clone, Serialize)]
pub struct Contents {
    /// The file as it was named.
    pub file: String,
    /// Its format, in words.
    pub format: &'static str,
    /// Rows or messages that were read.
    pub rows: u64,
    /// Topics of a log.
    pub topics: Vec<Topic>,
    /// The topic whose signals these are.
    pub topic: Option<String>,
    /// The column of time, where one is found.
    pub time: Option<String>,
    /// Seconds per unit of it, as far as its type, its name or its steps say.
    pub time_unit: f64,
    /// The signals, time among them, in the order of the file.
    pub signals: Vec<Series>,
    /// The layout of a text file, where it is not the usual one.
    #[serde(skip)]
    pub layout: Option<Layout>,
    /// What is wrong with it.
    pub wrong: Vec<String>,
}

/// What is to be scanned: columns, what they are called, the layout of a text, topics.
struct Plan {
    format: &'static str,
    columns: Vec<Column>,
    names: Vec<String>,
    layout: Layout,
    unusual: bool,
    topics: Vec<Topic>,
    topic: Option<String>,
    unit: Option<f64>,
    notes: Vec<String>,
}

impl Plan {
    fn of_columns(format: &'static str, columns: Vec<Column>) -> Self {
        let name = |column: &Column| match column {
            Column::Name(name) => name.clone(),
            Column::Index(index) => index.to_string(),
        };
        let names = columns.iter().map(name).collect();
        let (layout, topics, notes) = (Layout::default(), Vec::new(), Vec::new());
        Self { format, columns, names, layout, unusual: false, topics, topic: None, unit: None, notes }
    }
}

/// Looks at a data file: text, `.npy`, Parquet, MCAP or a rosbag2 folder. `topic` is that of a log with several.
///
/// # Errors
/// A file that cannot be read, or has nothing in it that could be looked at.
pub fn look(path: &Path, file: &str, topic: Option<&str>) -> Result<Contents, RecordingError> {
    let plan = plan(path, file, topic)?;
    let (columns, layout, topic) = (&plan.columns, &plan.layout, plan.topic.as_deref());
    let wanted = Wanted { columns, layout, topic, names: None, partial: true };
    let mut contents = Contents {
        file: file.into(),
        format: plan.format,
        rows: 0,
        topics: plan.topics,
        topic: plan.topic.clone(),
        time: None,
        time_unit: 1.0,
        signals: Vec::new(),
        layout: plan.unusual.then(|| plan.layout.clone()),
        wrong: plan.notes,
    };
    if plan.columns.is_empty() {
        return Ok(contents);
    }
    let mut source = formats::open(path, file, &wanted)?;
    let mut rows = Rows::new(plan.columns.len());
    source.read(&mut rows, AT_ONCE)?;
    let time = roles::time_of(&plan.names, &rows);
    contents.time_unit =
        plan.unit.or_else(|| time.map(|k| roles::time_unit(&plan.names[k], &rows.columns[k]))).unwrap_or(1.0);
    let mut watched: Vec<Watched> = plan.names.iter().map(|name| Watched::new(name)).collect();
    while !rows.is_empty() {
        for k in 0..rows.len() {
            let now = match time {
                Some(column) => rows.columns[column][k] * contents.time_unit,
                None => (contents.rows + k as u64) as f64,
            };
            watched.iter_mut().zip(&rows.columns).for_each(|(signal, column)| signal.take(now, column[k]));
        }
        contents.rows += rows.len() as u64;
        rows.clear();
        source.read(&mut rows, AT_ONCE)?;
    }
    contents.wrong.extend(source.notes());
    contents.time = time.map(|k| plan.names[k].clone());
    let finish = |(signal, name): (Watched, &String)| signal.finish(time.is_some(), roles::role_of(name));
    contents.signals = watched.into_iter().zip(&plan.names).map(finish).collect();
    roles::doubts(&mut contents);
    Ok(contents)
}

fn plan(path: &Path, file: &str, topic: Option<&str>) -> Result<Plan, RecordingError> {
    if formats::is_log(path) {
        return log(path, file, topic);
    }
    let named = |names: Vec<String>| names.into_iter().map(Column::Name).collect::<Vec<_>>();
    match formats::extension(path).as_str() {
        "npy" => {
            let count = NpyReader::open(path, file, &[])?.columns();
            Ok(Plan::of_columns("NumPy array", (0..count).map(Column::Index).collect()))
        }
        "parquet" => {
            let (names, unit) = formats::parquet_columns(path, file)?;
            Ok(Plan { unit, ..Plan::of_columns("Parquet", named(names)) })
        }
        _ => {
            let Guess { layout, names, unusual } = layout_guess::of_file(path, file)?;
            let columns = match names {
                Some(names) => named(names),
                None => (0..layout_guess::fields(path, &layout)).map(Column::Index).collect(),
            };
            Ok(Plan { layout, unusual, ..Plan::of_columns("text", columns) })
        }
    }
}

fn log(path: &Path, file: &str, topic: Option<&str>) -> Result<Plan, RecordingError> {
    let survey = formats::survey(path, file, topic)?;
    let mut columns = Vec::new();
    if !survey.signals.is_empty() {
        let stamp = if survey.stamped { "header.stamp" } else { "log_time" };
        columns.push(Column::Name(stamp.into()));
        columns.extend(survey.signals.into_iter().map(Column::Name));
    }
    let mut plan = Plan::of_columns("MCAP", columns);
    (plan.topics, plan.topic, plan.notes) = (survey.topics, survey.topic, survey.notes);
    if !survey.stamped && !plan.columns.is_empty() {
        plan.notes.push("the header stamps are 0: the time of the log is taken instead".into());
    }
    Ok(plan)
}
