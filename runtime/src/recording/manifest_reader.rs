//! A manifest from its YAML.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::RecordingError;
use super::column::Column;
use super::condition::Condition;
use super::manifest::{Channel, Layout, Manifest, MessageFields, STAMP, Side, Time, Window};
use super::manifest_values::number;
use super::unit::{Quantity, Unit};
use crate::regular_file;

use super::yaml::{MAX_BYTES, Mistake, Node, Place, read_positions};

/// Keys without which there is no recording.
const NEEDED: [&str; 4] = ["robot", "time", "position", "torque"];

/// Where a log does not say what its torques are.
const SAY_THE_UNIT: &str = "`effort` is N.m with some drivers and the motor's current with others, so it must be said \
    which: `torque: {unit: N.m}`, or `torque: {unit: A, gain: [...]}` with N.m per ampere";

/// Most trajectories of a recording: each of them reads its file from the beginning.
const MOST_TRAJECTORIES: usize = 2000;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    robot: String,
    #[serde(default)]
    title: String,
    #[serde(default)]
    side: Side,
    #[serde(default)]
    joints: Vec<String>,
    fields: Option<MessageFields>,
    #[serde(default)]
    layout: Layout,
    time: Option<RawTime>,
    position: Option<Channel>,
    #[serde(default)]
    velocity: Option<Channel>,
    torque: Option<Channel>,
    temperature: Option<Condition>,
    load: Option<Condition>,
    #[serde(default)]
    trajectories: Vec<Window>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawTime {
    column: Option<Column>,
    unit: Option<Unit>,
    from_first_row: Option<bool>,
    file: Option<String>,
    #[serde(default, deserialize_with = "number")]
    rate: Option<f64>,
}

impl Manifest {
    /// Reads a manifest file.
    ///
    /// # Errors
    /// A file that cannot be read; otherwise as [`Manifest::parse`].
    pub fn read(path: &Path) -> Result<Self, RecordingError> {
        let bytes = regular_file::read(path, MAX_BYTES as u64).map_err(|e| RecordingError::io(path, &e))?;
        Self::parse(path, &bytes)
    }

    /// Parses the text of a manifest; `path` is where it stands, for messages and for the files it names.
    ///
    /// # Errors
    /// [`RecordingError::Manifest`] with line and column: text of more than 1 MiB, not UTF-8, not YAML, or nested
    /// deeper than 16 levels; a key that is unknown, missing or there twice; a value that does not fit the contract.
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, RecordingError> {
        let file = path.display().to_string();
        let fail = |Mistake { place, message }| RecordingError::Manifest {
            file: file.clone(),
            line: place.line,
            column: place.column,
            message,
        };
        let places = read_positions(bytes).and_then(mapping).map_err(fail)?;
        let raw: Raw =
            serde_yaml::from_slice(without_mark(bytes)).map_err(|e| fail(mistake_of(&e, &places)))?;
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        Self::build(file, folder, places, raw)
    }

    fn build(path: String, folder: PathBuf, places: Node, raw: Raw) -> Result<Self, RecordingError> {
        let named = !raw.joints.is_empty();
        let missing = |key: &&str| !places.has(key) && (!named || *key == "torque");
        if let Some(key) = NEEDED.into_iter().find(missing) {
            let why = if named { format!(": {SAY_THE_UNIT}") } else { String::new() };
            let Place { line, column } = places.place;
            let message = format!("a recording has no '{key}'{why}");
            return Err(RecordingError::Manifest { file: path, line, column, message });
        }
        let mut manifest = Self {
            path,
            folder,
            robot: raw.robot,
            title: raw.title,
            side: raw.side,
            joints: raw.joints,
            fields: raw.fields,
            layout: raw.layout,
            time: Time::Rate(0.0),
            position: raw.position.unwrap_or_default(),
            velocity: raw.velocity,
            torque: raw.torque.unwrap_or_default(),
            temperature: raw.temperature,
            load: raw.load,
            trajectories: raw.trajectories,
            places,
        };
        manifest.time = match raw.time {
            Some(time) => manifest.check_time(time)?,
            None => Time::Column {
                column: Column::Name(STAMP.into()),
                unit: Some(Unit::second()),
                from_first_row: false,
                file: None,
            },
        };
        manifest.check_channels()?;
        manifest.check_conditions()?;
        manifest.check()?;
        Ok(manifest)
    }

    fn check_time(&self, raw: RawTime) -> Result<Time, RecordingError> {
        match (raw.column, raw.rate) {
            (Some(_), Some(_)) => {
                Err(self.error(&["time"], "`column` and `rate` exclude each other; keep one"))
            }
            (None, None) => {
                Err(self.error(&["time"], "a `column` of time stamps or a `rate` in Hz is needed"))
            }
            (None, Some(rate)) => {
                if rate <= 0.0 {
                    return Err(
                        self.error(&["time", "rate"], &format!("a rate of {rate} Hz; it must be positive"))
                    );
                }
                if raw.unit.is_some() || raw.from_first_row.is_some() || raw.file.is_some() {
                    return Err(
                        self.error(&["time"], "with a `rate` there is no unit, file or from_first_row")
                    );
                }
                Ok(Time::Rate(rate))
            }
            (Some(column), None) => {
                let unit = match raw.unit {
                    Some(unit) if unit.quantity != Quantity::Time => {
                        let wanted = Unit::names_of(&[Quantity::Time]);
                        let message = format!("`{}` is no unit of time, expected one of {wanted}", unit.name);
                        return Err(self.error(&["time", "unit"], &message));
                    }
                    unit => unit,
                };
                let from_first_row = raw.from_first_row.unwrap_or(false);
                Ok(Time::Column { column, unit, from_first_row, file: raw.file })
            }
        }
    }

    /// Columns where no joints are named, and joints as they must be.
    fn check_channels(&self) -> Result<(), RecordingError> {
        if self.fields.is_some() && self.joints.is_empty() {
            let message =
                "`fields` say where the signals of `joints` are: name the joints as the messages do";
            return Err(self.error(&["fields"], message));
        }
        if self.joints.is_empty() {
            let channels = ["position", "velocity", "torque"];
            let without =
                |key: &&str| self.places.value_of(key).is_some_and(|channel| !channel.has("columns"));
            return match channels.into_iter().find(without) {
                Some(key) => Err(self.error(&[key], "missing field `columns`")),
                None => Ok(()),
            };
        }
        for (k, joint) in self.joints.iter().enumerate() {
            if joint.trim().is_empty() || self.joints[..k].contains(joint) {
                let message = format!("`{joint}`: every joint has a name of its own");
                return Err(self.error(&["joints", &k.to_string()], &message));
            }
        }
        if self.torque.unit.is_empty() {
            return Err(self.error(&["torque"], SAY_THE_UNIT));
        }
        Ok(())
    }

    fn check(&mut self) -> Result<(), RecordingError> {
        if self.robot.trim().is_empty() {
            return Err(self.error(&["robot"], "a robot's name or the path of its YAML is needed"));
        }
        if self.layout.delimiter == self.layout.decimal {
            return Err(self.error(&["layout"], "delimiter and decimal point are the same byte"));
        }
        if self.trajectories.len() > MOST_TRAJECTORIES {
            let message =
                format!("{} given; a recording has at most {MOST_TRAJECTORIES}", self.trajectories.len());
            return Err(self.error(&["trajectories", &MOST_TRAJECTORIES.to_string()], &message));
        }
        let listed = !self.trajectories.is_empty();
        if !listed {
            self.trajectories.push(Window::default());
        }
        for (k, window) in self.trajectories.iter().enumerate() {
            let from = window.from.unwrap_or(f64::NEG_INFINITY);
            if window.to.is_some_and(|to| to <= from) {
                let message = format!("trajectory {}: `to` must be later than `from`", k + 1);
                return Err(self.error(&["trajectories", &k.to_string(), "to"], &message));
            }
            let time_file = match &self.time {
                Time::Column { file, .. } => file.is_some(),
                Time::Rate(_) => true,
            };
            let velocity_file = self.velocity.as_ref().is_none_or(|v| v.file.is_some());
            let named = self.position.file.is_some() && self.torque.file.is_some() && velocity_file;
            // Stamps without a file of their own are those of the positions.
            let time_has_one = time_file || self.position.file.is_some();
            if window.file.is_none() && !(named && time_has_one) {
                let message = match listed {
                    true => format!("trajectory {} names no `file`, and not every channel names one", k + 1),
                    false => "a recording has no 'trajectories', and not every channel names a `file`".into(),
                };
                return Err(self.error(&["trajectories", &k.to_string()], &message));
            }
        }
        Ok(())
    }
}

/// The file without a byte-order mark.
fn without_mark(bytes: &[u8]) -> &[u8] {
    bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes)
}

/// The places of a file that has keys.
fn mapping(root: Option<Node>) -> Result<Node, Mistake> {
    let (place, message) = match root {
        Some(root) if root.is_mapping() => return Ok(root),
        Some(root) => (
            root.place,
            "this is not a recording YAML: it needs the keys robot, time, position, torque and trajectories",
        ),
        None => (Place::START, "the file is empty; a recording needs robot, time, position and torque"),
    };
    Err(Mistake { place, message: message.into() })
}

/// What serde found wrong, with the place told once, in front.
fn mistake_of(error: &serde_yaml::Error, root: &Node) -> Mistake {
    let message = error.to_string();
    let missing = NEEDED.into_iter().find(|key| !root.has(key));
    if let Some(key) = missing.filter(|_| message.starts_with("missing field")) {
        return Mistake { place: root.place, message: format!("a recording has no '{key}'") };
    }
    let place = error.location().map_or(Place::START, |l| Place { line: l.line(), column: l.column() });
    Mistake { place, message: shortened(message.split(" at line ").next().unwrap_or_default()) }
}

/// A message without the length of what it quotes.
fn shortened(message: &str) -> String {
    const MOST: usize = 300;
    match message.char_indices().nth(MOST) {
        Some((end, _)) => format!("{} ...", &message[..end]),
        None => message.to_owned(),
    }
}

#[cfg(test)]
#[path = "manifest_tests.rs"]
mod tests;
