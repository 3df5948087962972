//! Conditions under which a recording was made: temperature and load, which nothing but comparisons of days uses.

use super::condition::Condition;
use super::files::{Clock, Files, Source};
use super::manifest::Window;
use super::{Manifest, RecordingError};

/// Rows taken from a file at a time.
const BLOCK: usize = 4096;

/// Units of temperatures with their names, °C a unit and the zero of the unit in °C.
const TEMPERATURES: [(&[&str], f64, f64); 3] = [
    (&["degC", "°C", "C"], 1.0, 0.0),
    (&["K"], 1.0, -273.15),
    (&["degF", "°F", "F"], 5.0 / 9.0, -32.0 * 5.0 / 9.0),
];

impl Manifest {
    /// Whether the conditions are as they must be.
    pub(super) fn check_conditions(&self) -> Result<(), RecordingError> {
        for (key, condition) in [("temperature", &self.temperature), ("load", &self.load)] {
            if condition.as_ref().is_some_and(|condition| condition.columns.is_empty()) {
                return Err(self.error(&[key, "columns"], "no column is named"));
            }
        }
        let unit = self.temperature.as_ref().and_then(|condition| condition.unit.as_deref());
        match unit {
            Some(unit) if of_temperature(Some(unit)).is_none() => {
                let message = format!("`{unit}` is no unit of temperature, expected degC, K or degF");
                Err(self.error(&["temperature", "unit"], &message))
            }
            _ => Ok(()),
        }
    }
}

/// °C a unit, and its zero in °C.
fn of_temperature(unit: Option<&str>) -> Option<(f64, f64)> {
    let unit = unit.unwrap_or("degC");
    let (_, factor, zero) = TEMPERATURES.into_iter().find(|(names, ..)| names.contains(&unit))?;
    Some((factor, zero))
}

/// Means over the rows of a recording's motions.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Conditions {
    /// °C.
    pub temperature: Option<f64>,
    /// In the unit of its columns.
    pub load: Option<f64>,
}

/// Means of the conditions that a manifest names, over the rows of its trajectories; rows without a number are passed over.
/// The files are read for it once more, but only where the manifest names conditions.
///
/// # Errors
/// A file that cannot be read or lacks a column.
pub fn conditions(manifest: &Manifest) -> Result<Conditions, RecordingError> {
    let (factor, zero) = manifest
        .temperature
        .as_ref()
        .and_then(|condition| of_temperature(condition.unit.as_deref()))
        .unwrap_or((1.0, 0.0));
    let temperature = mean(manifest, manifest.temperature.as_ref())?.map(|value| value * factor + zero);
    Ok(Conditions { temperature, load: mean(manifest, manifest.load.as_ref())? })
}

fn mean(manifest: &Manifest, condition: Option<&Condition>) -> Result<Option<f64>, RecordingError> {
    let Some(condition) = condition else { return Ok(None) };
    let mut sum = Sum::default();
    for window in &manifest.trajectories {
        sum.add(manifest, window, condition)?;
    }
    Ok(sum.mean())
}

/// A mean on the way.
#[derive(Debug, Default)]
struct Sum {
    rows: u64,
    total: f64,
}

impl Sum {
    fn mean(&self) -> Option<f64> {
        Some(self.total / self.rows as f64).filter(|mean| self.rows > 0 && mean.is_finite())
    }

    /// Takes in the rows of a window.
    fn add(
        &mut self,
        manifest: &Manifest,
        window: &Window,
        condition: &Condition,
    ) -> Result<(), RecordingError> {
        let mut files = Files::new(manifest, window);
        let places = files.columns(condition.file.as_ref(), &condition.columns)?;
        // Without a window all rows count, whatever their times.
        let whole = window.from.is_none() && window.to.is_none();
        let clock = if whole { None } else { Some(files.clock_in(condition.file.as_ref())?) };
        let mut sources = files.open()?;
        let mut clock = clock.map(|clock| clock.of_types(manifest, &sources, &mut Vec::new())).transpose()?;
        let inside =
            |t: f64| t >= window.from.unwrap_or(f64::NEG_INFINITY) && t <= window.to.unwrap_or(f64::INFINITY);
        let mut read = 0;
        loop {
            let count = next_block(&mut sources)?;
            if count == 0 {
                return Ok(());
            }
            let times = clock.as_mut().map(|clock: &mut Clock| {
                clock.settle(&sources, &mut Vec::new());
                clock.times(&sources, read, count)
            });
            for row in (0..count).filter(|&row| times.as_ref().is_none_or(|times| inside(times[row]))) {
                let values = places.iter().map(|&(source, slot)| sources[source].1.columns[slot][row]);
                let (sum, known) = values
                    .filter(|value| value.is_finite())
                    .fold((0.0, 0.0), |(sum, known), value| (sum + value, known + 1.0));
                if known > 0.0 {
                    self.total += sum / known;
                    self.rows += 1;
                }
            }
            read += count as u64;
        }
    }
}

/// Reads the next rows of all files; how many all of them have.
fn next_block(sources: &mut [Source]) -> Result<usize, RecordingError> {
    let mut count = usize::MAX;
    for (source, rows) in sources {
        rows.clear();
        source.read(rows, BLOCK)?;
        count = count.min(rows.len());
    }
    Ok(if count == usize::MAX { 0 } else { count })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::recording::folder::Folder;

    const MOTION: &str = "t,q,i,temp,hand\n0,1,2,300,1\n1,1,2,,1\n2,1,2,310,4\n3,1,2,400,x\n";

    fn read(keys: &str, trajectory: &str) -> Result<Conditions, String> {
        let slow = "t,celsius,inside\n0,20,30\n2,22,NaN\n9,90,90\n";
        let folder = Folder::with(&[("a.csv", MOTION), ("slow.csv", slow)]);
        let text = format!(
            "robot: r\ntime: {{column: t}}\nposition: {{columns: [q]}}\ntorque: {{columns: [i]}}\n{keys}\ntrajectories:\n  - {trajectory}\n"
        );
        let manifest = Manifest::parse(&folder.path("r.yaml"), text.as_bytes()).map_err(|e| e.to_string())?;
        conditions(&manifest).map_err(|e| e.to_string())
    }

    fn near(found: Option<f64>, expected: f64) -> bool {
        found.is_some_and(|found| (found - expected).abs() < 1e-9)
    }

    #[test]
    fn means_are_those_of_the_rows_of_the_motion_that_have_a_number() {
        let keys = "temperature: {columns: [temp], unit: K}\nload: {columns: [hand]}";
        let within = read(keys, "{file: a.csv, to: 2}").expect("conditions");
        assert!(near(within.temperature, 305.0 - 273.15) && near(within.load, 2.0), "{within:?}");
        let whole = read(keys, "{file: a.csv}").expect("conditions");
        assert!(near(whole.temperature, 1010.0 / 3.0 - 273.15) && near(whole.load, 2.0), "{whole:?}");
        assert_eq!(read("", "{file: a.csv}"), Ok(Conditions::default()));
    }

    #[test]
    fn a_slow_logger_has_a_file_of_its_own() {
        let keys = "temperature: {file: slow.csv, columns: [celsius, inside]}";
        let within = read(keys, "{file: a.csv, to: 3}").expect("conditions");
        assert!(near(within.temperature, 23.5), "{within:?}");
        let fahrenheit = read(
            "temperature: {file: slow.csv, columns: [celsius], unit: degF}",
            "{file: a.csv, from: 1, to: 2}",
        );
        assert!(near(fahrenheit.expect("conditions").temperature, -10.0 / 1.8), "22 °F");
    }

    #[test]
    fn mistakes_are_told_with_their_place() {
        let mistake = |keys: &str| read(keys, "{file: a.csv}").expect_err("a mistake");
        assert!(
            mistake("temperature: {columns: [temp], unit: V}")
                .contains("r.yaml:5:32: temperature.unit: `V` is no unit"),
            "{}",
            mistake("temperature: {columns: [temp], unit: V}")
        );
        assert!(mistake("temperature: {columns: []}").contains("temperature.columns: no column is named"));
        assert!(mistake("load: {columns: [nothing]}").contains("nothing"));
        assert!(mistake("load: {column: hand}").contains("unknown field `column`"));
        assert!(mistake("temperature: {unit: K}").contains("missing field `columns`"));
    }
}
