//! From the parameters of all days to `trends`, `alarms` and `fleet.html`.

use std::collections::BTreeMap;

use datafusion::arrow::array::RecordBatch;
use datafusion::arrow::datatypes::{DataType, Field, Schema, SchemaRef};
use dynid::output::write;
use dynid_fleet_watch::{Alarm, Kind, Observation, Series, Settings, Trend, page, watch};

use super::folder::OutFolder;
use super::rows::{batch, counts, days, number, numbers, parameters_schema, text, texts};
use super::tables;
use crate::day::Day;
use crate::error::Result;

/// Works out trends and alarms of all days anew: an alarm of a day depends on nothing later, so that those of earlier runs
/// stay as they were.
///
/// # Errors
/// A table that is none, or what the file system says.
pub fn watch_all(out: &OutFolder) -> Result<()> {
    let series = series(out)?;
    let watched = watch(&series, &Settings::default());
    tables::write(&out.file("trends.parquet"), &trends(&watched.trends)?)?;
    tables::write(&out.file("alarms.parquet"), &alarms(&watched.alarms)?)?;
    write(&out.file("fleet.html"), &page(&series, &watched, &|_| None))?;
    Ok(())
}

/// What a series is of: robot, table and parameter.
type Name = (String, String, String);

fn series(out: &OutFolder) -> Result<Vec<Series>> {
    let mut all: BTreeMap<Name, Series> = BTreeMap::new();
    for day in out.days("parameters") {
        let Some(rows) = tables::read(&out.of_day("parameters", day), &parameters_schema())? else {
            continue;
        };
        for k in 0..rows.num_rows() {
            add(&mut all, &rows, k, day);
        }
    }
    Ok(all.into_values().collect())
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

fn named() -> Vec<Field> {
    ["robot", "robot_table", "parameter", "unit"].map(|name| Field::new(name, DataType::Utf8, false)).into()
}

fn schema(fields: &[(&str, DataType)]) -> SchemaRef {
    let mut all = named();
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

fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Drift => "drift",
        Kind::Step => "step",
        Kind::UnlikeSiblings => "unlike_siblings",
        _ => "change",
    }
}

fn alarms(alarms: &[Alarm]) -> Result<RecordBatch> {
    use DataType::{Date32, Float64, Utf8};
    let schema = schema(&[
        ("day", Date32),
        ("began", Date32),
        ("began_from", Date32),
        ("began_to", Date32),
        ("kind", Utf8),
        ("change", Float64),
        ("change_sigma", Float64),
        ("before", Float64),
        ("e_value", Float64),
        ("sentence", Utf8),
    ]);
    let text = |of: fn(&Alarm) -> &str| texts(alarms.iter().map(|a| Some(of(a))));
    let day = |of: fn(&Alarm) -> i64| days(alarms.iter().map(|a| of_table(of(a))));
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
        text(|a| &a.sentence),
    ];
    batch(&schema, columns)
}
