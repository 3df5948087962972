//! From the parameters of all days to `trends`, `alarms` and pages.

use std::collections::BTreeMap;

use datafusion::arrow::array::RecordBatch;
use datafusion::arrow::datatypes::{DataType, Field, Schema, SchemaRef};
use dynid_fleet_watch::{Observation, Series, Settings, Trend, watch};

use super::folder::OutFolder;
use super::pages::{self, TableNames};
use super::rows::{batch, counts, days, number, numbers, parameters_schema, text, texts};
use super::{alarms, tables};
use crate::day::Day;
use crate::error::Result;

/// Works out trends and alarms of all days anew: an alarm of a day depends on nothing later, so that those of earlier runs
/// stay as they were.
///
/// # Errors
/// A table that is none, or what the file system says.
pub fn watch_all(out: &OutFolder) -> Result<()> {
    let (series, names) = series(out)?;
    let watched = watch(&series, &Settings::default());
    tables::write(&out.file("trends.parquet"), &trends(&watched.trends)?)?;
    alarms::write(out, &watched.alarms)?;
    pages::write(out, &series, &watched, &names)
}

/// What a series is of: robot, table and parameter.
type Name = (String, String, String);

/// All series, and the names of robot tables by their fingerprints.
fn series(out: &OutFolder) -> Result<(Vec<Series>, TableNames)> {
    let mut all: BTreeMap<Name, Series> = BTreeMap::new();
    let mut names = TableNames::default();
    for day in out.days("parameters") {
        let Some(rows) = tables::read(&out.of_day("parameters", day), &parameters_schema())? else {
            continue;
        };
        for k in 0..rows.num_rows() {
            add(&mut all, &rows, k, day);
            names.add(text(&rows, "robot_table", k), text(&rows, "table_name", k));
        }
    }
    Ok((all.into_values().collect(), names))
}

fn add(all: &mut BTreeMap<Name, Series>, rows: &RecordBatch, k: usize, day: Day) {
    let named = |column: &str| text(rows, column, k).unwrap_or_default().to_owned();
    let (Some(value), Some(sigma)) = (number(rows, "value", k), number(rows, "sigma", k)) else { return };
    // A value that was known beforehand never changes.
    if sigma <= 0.0 {
        return;
    }
    let (robot, table, parameter) = (named("robot"), named("robot_table"), named("parameter"));
    let own = all.entry((robot.clone(), table.clone(), parameter.clone())).or_insert_with(|| Series {
        robot,
        table,
        parameter,
        unit: named("unit"),
        observations: Vec::new(),
    });
    let (temperature, load) = (number(rows, "temperature", k), number(rows, "load", k));
    own.observations.push(Observation { day: day.into(), value, sigma, temperature, load });
}

fn schema(fields: &[(&str, DataType)]) -> SchemaRef {
    let named = ["robot", "robot_table", "parameter", "unit"];
    let mut all: Vec<Field> = named.map(|name| Field::new(name, DataType::Utf8, false)).into();
    all.extend(fields.iter().map(|(name, kind)| Field::new(*name, kind.clone(), true)));
    Schema::new(all).into()
}

/// A day of the watch as one of a table.
fn of_table(day: i64) -> Day {
    Day::try_from(day).unwrap_or(Day::MAX)
}

fn trends(trends: &[Trend]) -> Result<RecordBatch> {
    use DataType::{Date32, Float64, Int64};
    let schema = schema(&[
        ("days", Int64),
        ("slope", Float64),
        ("slope_low", Float64),
        ("slope_high", Float64),
        ("monotone_p_value", Float64),
        ("change_day", Date32),
        ("change", Float64),
        ("change_sigma", Float64),
        ("change_p_value", Float64),
        ("per_degree", Float64),
        ("per_load", Float64),
        ("day_to_day", Float64),
        ("siblings_off", Float64),
        ("e_value", Float64),
    ]);
    let text = |of: fn(&Trend) -> &str| texts(trends.iter().map(|t| Some(of(t))));
    let number = |of: fn(&Trend) -> Option<f64>| numbers(trends.iter().map(of));
    let columns = vec![
        text(|t| &t.robot),
        text(|t| &t.table),
        text(|t| &t.parameter),
        text(|t| &t.unit),
        counts(trends.iter().map(|t| t.days as i64)),
        number(|t| Some(t.slope)),
        number(|t| Some(t.slope_interval.0)),
        number(|t| Some(t.slope_interval.1)),
        number(|t| Some(t.monotone_p_value)),
        days(trends.iter().map(|t| of_table(t.change_day))),
        number(|t| Some(t.change)),
        number(|t| Some(t.change_sigma)),
        number(|t| Some(t.change_p_value)),
        number(|t| t.per_degree.map(|(value, _)| value)),
        number(|t| t.per_load.map(|(value, _)| value)),
        number(|t| Some(t.day_to_day)),
        number(|t| t.siblings.map(|s| s.deviations)),
        number(|t| t.e_value),
    ];
    batch(&schema, columns)
}
