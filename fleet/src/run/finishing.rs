//! From the factors of a day to its tables.

use std::collections::BTreeMap;

use datafusion::arrow::array::RecordBatch;
use dynid_runtime::estimation::ReducedEstimate;

use super::day::{RobotDay, clear_pending, gather, robots};
use super::findings::{Risen, findings};
use super::folder::OutFolder;
use super::history::History;
use super::references::References;
use super::rows::{
    batch, count, counts, days, flags, number, numbers, parameters_schema, screening_schema, text, texts,
};
use super::tables;
use crate::day::Day;
use crate::engine::Engine;
use crate::error::Result;
use crate::fleet_file::FleetFile;
use crate::rise::{Rise, rise};
use crate::work::Item;

/// Works out a day whose recordings were all reduced. Its table `screening` comes last: a day that has it is done.
///
/// # Errors
/// What the engine, a model or the file system says. The day is not done then.
pub async fn finish(
    (engine, fleet, out): (&Engine, &FleetFile, &OutFolder),
    references: &mut References<'_>,
    history: &mut History,
    day: Day,
    items: &[&Item],
) -> Result<()> {
    let factors = gather(out, day, items)?;
    let (robots, left_out) = robots(&factors)?;
    let mut parameters = Parameters::default();
    let mut rises = BTreeMap::new();
    let mut risen = Vec::new();
    for (robot, own) in &robots {
        let reference = references.of(robot, day, &own.all.to_bytes())?;
        let found = own.all.solve();
        parameters.add(robot, &found, own, &reference.values);
        let chi: Vec<f64> = found
            .parameters
            .iter()
            .map(|p| reference.values.get(&p.name).copied().unwrap_or(p.value))
            .collect();
        for (recording, factor) in &own.recordings {
            let Some(rise) = rise(factor, &chi) else { continue };
            rises.insert(recording.as_str(), rise);
            let news = rise.ratio > fleet.diagnosis.error_rises * history.before(robot, day)
                && history.predicted(robot, day).is_some_and(|limit| rise.ratio > limit);
            if fleet.diagnosis.enabled && rise.certain && news {
                let table = items.iter().find(|i| &i.recording == recording).and_then(|i| i.table.clone());
                let reference = reference.clone();
                risen.push(Risen { robot: robot.clone(), recording: recording.clone(), table, reference });
            }
        }
    }
    references.keep()?;
    tables::write(&out.of_day("parameters", day), &parameters.batch(day)?)?;
    tables::write(&out.of_day("findings", day), &findings(engine, day, &risen, fleet.diagnosis.rows).await?)?;
    let screening = screening(&factors, day, &rises, &left_out)?;
    tables::write(&out.of_day("screening", day), &screening)?;
    history.add(day, &screening);
    clear_pending(out, items);
    Ok(())
}

#[derive(Default)]
struct Parameters {
    robots: Vec<String>,
    names: Vec<String>,
    values: Vec<Option<f64>>,
    sigmas: Vec<Option<f64>>,
    references: Vec<Option<f64>>,
    units: Vec<String>,
    tables: Vec<String>,
    temperatures: Vec<Option<f64>>,
    loads: Vec<Option<f64>>,
    table_names: Vec<Option<String>>,
}

impl Parameters {
    fn add(
        &mut self,
        robot: &str,
        found: &ReducedEstimate,
        day: &RobotDay,
        reference: &BTreeMap<String, f64>,
    ) {
        let count = found.parameters.len();
        self.tables.extend(std::iter::repeat_n(day.all.fingerprint().to_owned(), count));
        self.temperatures.extend(std::iter::repeat_n(day.temperature, count));
        self.loads.extend(std::iter::repeat_n(day.load, count));
        self.table_names.extend(std::iter::repeat_n(day.table_name.clone(), count));
        for (parameter, (_, unit)) in found.parameters.iter().zip(day.all.parameters()) {
            self.robots.push(robot.to_owned());
            self.names.push(parameter.name.clone());
            self.values.push(parameter.sigma.map(|_| parameter.value));
            self.sigmas.push(parameter.sigma);
            self.references.push(reference.get(&parameter.name).copied());
            self.units.push(unit.clone());
        }
    }

    fn batch(self, day: Day) -> Result<RecordBatch> {
        let columns = vec![
            texts(self.robots.iter().map(|t| Some(t.as_str()))),
            days(self.robots.iter().map(|_| day)),
            texts(self.names.iter().map(|t| Some(t.as_str()))),
            numbers(self.values),
            numbers(self.sigmas),
            numbers(self.references),
            texts(self.units.iter().map(|t| Some(t.as_str()))),
            texts(self.tables.iter().map(|t| Some(t.as_str()))),
            numbers(self.temperatures),
            numbers(self.loads),
            texts(self.table_names.iter().map(Option::as_deref)),
        ];
        batch(&parameters_schema(), columns)
    }
}

/// A row for each recording of a day: what became of it.
fn screening(
    factors: &RecordBatch,
    day: Day,
    rises: &BTreeMap<&str, Rise>,
    left_out: &BTreeMap<String, String>,
) -> Result<RecordBatch> {
    // Rows of a recording stand together.
    let mut first: Vec<(usize, i64, i64)> = Vec::new();
    for k in 0..factors.num_rows() {
        let (motion, rows) =
            (i64::from(text(factors, "motion", k).is_some()), count(factors, "rows", k).unwrap_or(0));
        match first.last_mut() {
            Some((before, motions, all)) if text(factors, "key", *before) == text(factors, "key", k) => {
                *motions += motion;
                *all += rows;
            }
            _ => first.push((k, motion, rows)),
        }
    }
    let column = |name: &str| texts(first.iter().map(|(k, ..)| text(factors, name, *k)));
    let recording = |k: usize| text(factors, "recording", k).unwrap_or_default();
    let outcome = |k: usize| {
        if left_out.contains_key(recording(k)) { Some("refused") } else { text(factors, "outcome", k) }
    };
    let message = |k: usize| left_out.get(recording(k)).map(String::as_str).or(text(factors, "message", k));
    let rise = |k: usize| rises.get(recording(k));
    let columns = vec![
        column("robot"),
        days(first.iter().map(|_| day)),
        column("recording"),
        column("key"),
        texts(first.iter().map(|(k, ..)| outcome(*k))),
        texts(first.iter().map(|(k, ..)| message(*k))),
        counts(first.iter().map(|(_, motions, _)| *motions)),
        counts(first.iter().map(|(_, _, rows)| *rows)),
        counts(first.iter().map(|(k, ..)| count(factors, "samples", *k).unwrap_or(0))),
        counts(first.iter().map(|(k, ..)| count(factors, "left_out", *k).unwrap_or(0))),
        numbers(first.iter().map(|(k, ..)| number(factors, "band", *k))),
        numbers(first.iter().map(|(k, ..)| number(factors, "relative_error", *k))),
        numbers(first.iter().map(|(k, ..)| rise(*k).map(|rise| rise.ratio))),
        flags(first.iter().map(|(k, ..)| rise(*k).map(|rise| rise.certain))),
        column("files"),
    ];
    batch(&screening_schema(), columns)
}
