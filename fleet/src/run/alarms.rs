//! The alarms of a fleet as they stand in their table.

use std::collections::BTreeSet;

use datafusion::arrow::array::RecordBatch;
use datafusion::arrow::datatypes::{DataType, Field, Schema, SchemaRef};
use dynid_fleet_watch::{Alarm, Kind};

use super::folder::OutFolder;
use super::rows::{batch, count, counts, date, day_of, days, number, numbers, text, texts};
use super::tables;
use crate::day::Day;
use crate::error::Result;

/// An alarm.
#[derive(Debug, Clone, PartialEq)]
pub struct AlarmRow {
    /// Name of the robot.
    pub robot: String,
    /// Fingerprint of the robot's table.
    pub table: String,
    /// Name of the parameter.
    pub parameter: String,
    /// Unit of the parameter.
    pub unit: String,
    /// Day on which it was raised.
    pub day: Day,
    /// Day on which the change began, most likely.
    pub began: Day,
    /// `drift`, `step`, `unlike_siblings`.
    pub kind: String,
    /// How much it changed, and the standard deviation of that, in `unit`.
    pub change: f64,
    /// Standard deviation of `change`.
    pub change_sigma: f64,
    /// Level before the change, or the siblings'.
    pub before: f64,
    /// Evidence against "nothing has changed".
    pub e_value: f64,
    /// Robots with the same table that it was compared with.
    pub siblings: usize,
    /// Median of their changes meanwhile.
    pub siblings_change: Option<f64>,
    /// Whether it was not there before this run.
    pub new: bool,
}

/// What an alarm is of: a series is alarmed once.
type Name = (String, String, String);

/// What alarms there are of before a run.
pub struct Before(BTreeSet<Name>);

impl Before {
    /// Those of the table.
    ///
    /// # Errors
    /// A table that is none.
    pub fn read(out: &OutFolder) -> Result<Self> {
        let rows = tables::read(&out.file("alarms.parquet"), &schema())?;
        let all = rows.iter().flat_map(|rows| (0..rows.num_rows()).map(|k| name(rows, k)));
        Ok(Self(all.collect()))
    }
}

fn name(rows: &RecordBatch, k: usize) -> Name {
    let [robot, table, parameter] = ["robot", "robot_table", "parameter"]
        .map(|column| text(rows, column, k).unwrap_or_default().to_owned());
    (robot, table, parameter)
}

/// The alarms of the table, the worst first: the rarest without a change, then the largest beside its standard deviation.
///
/// # Errors
/// A table that is none.
pub fn read(out: &OutFolder, before: &Before) -> Result<Vec<AlarmRow>> {
    let Some(rows) = tables::read(&out.file("alarms.parquet"), &schema())? else { return Ok(Vec::new()) };
    let mut alarms: Vec<AlarmRow> = (0..rows.num_rows()).map(|k| row(&rows, k, before)).collect();
    let ratio = |a: &AlarmRow| (a.change / a.change_sigma).abs();
    alarms.sort_by(|a, b| {
        let worse = b.e_value.total_cmp(&a.e_value).then_with(|| ratio(b).total_cmp(&ratio(a)));
        worse.then_with(|| (&a.robot, &a.parameter).cmp(&(&b.robot, &b.parameter)))
    });
    Ok(alarms)
}

fn row(rows: &RecordBatch, k: usize, before: &Before) -> AlarmRow {
    let name = name(rows, k);
    let words = |column: &str| text(rows, column, k).unwrap_or_default().to_owned();
    let value = |column: &str| number(rows, column, k).unwrap_or(f64::NAN);
    let new = !before.0.contains(&name);
    let (robot, table, parameter) = name;
    AlarmRow {
        robot,
        table,
        parameter,
        new,
        unit: words("unit"),
        day: day_of(rows, k).unwrap_or_default(),
        began: date(rows, "began", k).unwrap_or_default(),
        kind: words("kind"),
        change: value("change"),
        change_sigma: value("change_sigma"),
        before: value("before"),
        e_value: value("e_value"),
        siblings: count(rows, "siblings", k).and_then(|n| usize::try_from(n).ok()).unwrap_or(0),
        siblings_change: number(rows, "siblings_change", k),
    }
}

/// Columns of `alarms`.
fn schema() -> SchemaRef {
    use DataType::{Date32, Float64, Int64, Utf8};
    let named = ["robot", "robot_table", "parameter", "unit"].map(|name| Field::new(name, Utf8, false));
    let own = [
        ("day", Date32),
        ("began", Date32),
        ("began_from", Date32),
        ("began_to", Date32),
        ("kind", Utf8),
        ("change", Float64),
        ("change_sigma", Float64),
        ("before", Float64),
        ("e_value", Float64),
        ("siblings", Int64),
        ("siblings_change", Float64),
        ("sentence", Utf8),
    ];
    let own = own.map(|(name, kind)| Field::new(name, kind, true));
    Schema::new(named.into_iter().chain(own).collect::<Vec<_>>()).into()
}

fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Drift => "drift",
        Kind::Step => "step",
        Kind::UnlikeSiblings => "unlike_siblings",
        _ => "change",
    }
}

/// Writes the table.
///
/// # Errors
/// What the file system says.
pub fn write(out: &OutFolder, alarms: &[Alarm]) -> Result<()> {
    let text = |of: fn(&Alarm) -> &str| texts(alarms.iter().map(|a| Some(of(a))));
    let day = |of: fn(&Alarm) -> i64| days(alarms.iter().map(|a| Day::try_from(of(a)).unwrap_or(Day::MAX)));
    let number = |of: fn(&Alarm) -> f64| numbers(alarms.iter().map(|a| Some(of(a))));
    let columns = vec![
        text(|a| &a.robot),
        text(|a| &a.table),
        text(|a| &a.parameter),
        text(|a| &a.unit),
        day(|a| a.day),
        day(|a| a.began),
        day(|a| a.began_between.0),
        day(|a| a.began_between.1),
        text(|a| kind(a.kind)),
        number(|a| a.change),
        number(|a| a.change_sigma),
        number(|a| a.before),
        number(|a| a.e_value),
        counts(alarms.iter().map(|a| a.siblings as i64)),
        numbers(alarms.iter().map(|a| a.siblings_change)),
        text(|a| &a.sentence),
    ];
    tables::write(&out.file("alarms.parquet"), &batch(&schema(), columns)?)
}
