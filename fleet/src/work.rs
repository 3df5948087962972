//! Which recordings there are.

use std::collections::BTreeMap;
use std::path::Path;

use datafusion::arrow::array::{Array, AsArray};
use datafusion::arrow::datatypes::{Date32Type, Float64Type};
use datafusion::prelude::{ParquetReadOptions, SessionContext};
use sha2::{Digest, Sha256};

use crate::day::{self, Day};
use crate::error::{FleetError, Result};
use crate::fleet_file::{FleetFile, Recordings};
use crate::pattern::{Found, Pattern};
use crate::place::Folder;

/// A recording of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Item {
    /// The robot's name in the fleet.
    pub robot: String,
    /// The day that it counts for.
    pub day: Day,
    /// Path or address of its manifest.
    pub recording: String,
    /// The robot's table, where the fleet says one.
    pub table: Option<String>,
    /// Band of the equations, Hz, where the fleet says one.
    pub band: Option<f64>,
    /// Mean temperature of the robot while it was recorded, °C, where it is known.
    pub temperature: Option<f64>,
    /// A measure of the load that it carried, in any unit, where it is known.
    pub load: Option<f64>,
}

impl Item {
    /// What its result depends on, as a name: another band, table or dynid gives another result.
    pub fn key(&self) -> String {
        let band = self.band.map_or_else(String::new, |band| band.to_bits().to_string());
        let parts = [
            env!("CARGO_PKG_VERSION"),
            &self.robot,
            &day::written(self.day),
            &self.recording,
            self.table.as_deref().unwrap_or_default(),
            &band,
        ];
        let mut hash = Sha256::new();
        for part in parts {
            hash.update((part.len() as u64).to_le_bytes());
            hash.update(part.as_bytes());
        }
        hash.finalize().iter().take(12).map(|byte| format!("{byte:02x}")).collect()
    }
}

/// All recordings of a fleet from a day on, by day, robot and recording; each once.
///
/// # Errors
/// A table or a folder that cannot be read, or that says no robot, day or recording.
pub async fn work(fleet: &FleetFile, since: Option<Day>) -> Result<Vec<Item>> {
    let folder = match &fleet.store {
        Some(store) => Folder::of(store)?,
        None => Folder::Local(fleet.folder.clone()),
    };
    let mut items = match &fleet.recordings {
        Recordings::Pattern(pattern) => matching(&folder, pattern).await?,
        Recordings::Table(path) => listed(path, &folder).await?,
    };
    items.retain(|item| since.is_none_or(|since| item.day >= since));
    for item in &mut items {
        item.table = fleet.table_of(&item.robot);
        item.band = fleet.band;
    }
    items.sort_by(|a, b| (a.day, &a.robot, &a.recording).cmp(&(b.day, &b.robot, &b.recording)));
    items.dedup_by(|a, b| (a.day, &a.robot, &a.recording) == (b.day, &b.robot, &b.recording));
    Ok(items)
}

/// Recordings whose paths fit.
async fn matching(folder: &Folder, pattern: &Pattern) -> Result<Vec<Item>> {
    let mut paths = vec![(String::new(), Found::default())];
    for part in 0..pattern.parts() {
        let mut next = Vec::new();
        for (path, found) in &paths {
            let below = |name: &str| if path.is_empty() { name.to_owned() } else { format!("{path}/{name}") };
            if let Some(name) = pattern.fixed(part) {
                next.push((below(name), found.clone()));
                continue;
            }
            let here = Folder::of(&folder.at(path))?;
            if matches!(&here, Folder::Local(local) if !local.is_dir()) && part > 0 {
                continue;
            }
            for name in here.names().await? {
                next.extend(pattern.matched(part, &name, found).map(|found| (below(&name), found)));
            }
        }
        paths = next;
    }
    let exists = |path: &String| match folder {
        Folder::Local(local) => local.join(path).is_file(),
        Folder::Remote(..) => true,
    };
    let item = |(path, found): (String, Found)| {
        let (robot, day) = (found.robot?, day::parse(&found.day?)?);
        exists(&path).then(|| item(robot, day, folder.at(&path)))
    };
    Ok(paths.into_iter().filter_map(item).collect())
}

fn item(robot: String, day: Day, recording: String) -> Item {
    Item { robot, day, recording, table: None, band: None, temperature: None, load: None }
}

/// Recordings of a table: robot, time (or day), recording; temperature and load where it has them.
async fn listed(path: &Path, folder: &Folder) -> Result<Vec<Item>> {
    if path.extension().is_some_and(|extension| extension == "csv") {
        return of_csv(path, folder);
    }
    let context = SessionContext::new();
    let shown = path.display().to_string();
    let failed = |error: datafusion::error::DataFusionError| FleetError::file(path, error.strip_backtrace());
    context.register_parquet("listed", &shown, ParquetReadOptions::default()).await.map_err(failed)?;
    let schema = context.table("listed").await.map_err(failed)?.schema().as_arrow().clone();
    let has = |name: &str| schema.field_with_name(name).is_ok();
    let time = if has("day") { "day" } else { "time" };
    if let Some(missing) = ["robot", time, "recording"].into_iter().find(|name| !has(name)) {
        return Err(FleetError::file(path, format!("it has no column {missing}")));
    }
    let number = |name: &str| {
        if has(name) { format!("CAST(\"{name}\" AS DOUBLE)") } else { "CAST(NULL AS DOUBLE)".into() }
    };
    let query = format!(
        "SELECT CAST(robot AS VARCHAR), CAST(\"{time}\" AS DATE), CAST(recording AS VARCHAR), {}, {} FROM listed",
        number("temperature"),
        number("load")
    );
    let batches = context.sql(&query).await.map_err(failed)?.collect().await.map_err(failed)?;
    let mut items = Vec::new();
    for batch in &batches {
        let texts = [0, 2].map(|column| {
            datafusion::arrow::compute::cast(
                batch.column(column),
                &datafusion::arrow::datatypes::DataType::Utf8,
            )
        });
        let [robots, recordings] =
            texts.map(|text| text.map_err(|error| FleetError::file(path, error.to_string())));
        let (robots, recordings) = (robots?, recordings?);
        let (robots, recordings) = (robots.as_string::<i32>(), recordings.as_string::<i32>());
        let days = batch.column(1).as_primitive::<Date32Type>();
        let [temperatures, loads] = [3, 4].map(|column| batch.column(column).as_primitive::<Float64Type>());
        for k in 0..batch.num_rows() {
            if robots.is_null(k) || recordings.is_null(k) || days.is_null(k) {
                return Err(FleetError::file(
                    path,
                    format!("row {}: robot, {time} or recording is empty", k + 1),
                ));
            }
            let known = |column: &datafusion::arrow::array::Float64Array| {
                (!column.is_null(k)).then(|| column.value(k))
            };
            let mut one = item(robots.value(k).into(), days.value(k), place(folder, recordings.value(k)));
            (one.temperature, one.load) = (known(temperatures), known(loads));
            items.push(one);
        }
    }
    Ok(items)
}

/// The recordings of a CSV with a header.
fn of_csv(path: &Path, folder: &Folder) -> Result<Vec<Item>> {
    let file = path.display().to_string();
    let at = |line: usize, column: usize, message: String| FleetError::Place {
        file: file.clone(),
        line,
        column,
        message,
    };
    let mut reader = csv::ReaderBuilder::new().trim(csv::Trim::All).from_path(path).map_err(|error| {
        match error.into_kind() {
            csv::ErrorKind::Io(error) => FleetError::io(path, "read the recordings", &error),
            other => FleetError::file(path, format!("{other:?}")),
        }
    })?;
    let header = reader.headers().map_err(|error| at(1, 1, error.to_string()))?.clone();
    let columns: BTreeMap<&str, usize> = header.iter().enumerate().map(|(k, name)| (name, k)).collect();
    let needed = |names: &[&str]| {
        names.iter().find_map(|name| columns.get(name).copied()).ok_or_else(|| {
            at(
                1,
                1,
                format!(
                    "no column {}; a table of recordings has robot, time and recording",
                    names.join(" or ")
                ),
            )
        })
    };
    let (robot, time, recording) = (needed(&["robot"])?, needed(&["time", "day"])?, needed(&["recording"])?);
    let mut items = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| {
            let line = error.position().map_or(1, |position| position.line() as usize);
            at(line, 1, error.to_string())
        })?;
        let line = record.position().map_or(1, |position| position.line() as usize);
        let field = |k: usize| {
            record
                .get(k)
                .filter(|text| !text.is_empty())
                .ok_or_else(|| at(line, k + 1, format!("field {} ({}) is empty", k + 1, &header[k])))
        };
        let written = field(time)?;
        let day = day::parse(written).ok_or_else(|| {
            at(line, time + 1, format!("`{written}` is no time; expected 2026-03-01 or 2026-03-01T07:30:00"))
        })?;
        let number = |name: &str| match columns.get(name).and_then(|&k| Some((k, record.get(k)?))) {
            None | Some((_, "")) => Ok(None),
            Some((k, text)) => match text.parse::<f64>() {
                Ok(number) if number.is_finite() => Ok(Some(number)),
                _ => Err(at(line, k + 1, format!("{name}: `{text}` is no number"))),
            },
        };
        let mut one = item(field(robot)?.to_owned(), day, place(folder, field(recording)?));
        (one.temperature, one.load) = (number("temperature")?, number("load")?);
        items.push(one);
    }
    Ok(items)
}

/// A recording that a table names: an address or an absolute path as it is, else beneath the store.
fn place(folder: &Folder, recording: &str) -> String {
    if recording.contains("://") || Path::new(recording).is_absolute() {
        recording.to_owned()
    } else {
        folder.at(recording)
    }
}
