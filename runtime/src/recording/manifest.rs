//! The recording YAML: which files hold what.

use std::fmt;
use std::path::{Path, PathBuf};

use serde::de::{self, IntoDeserializer, SeqAccess, Visitor};
use serde::{Deserialize, Deserializer};

use super::RecordingError;
use super::duplicate_key::duplicate_key;
use super::unit::{Quantity, Unit};

/// A recording as its manifest describes it. Files are named relative to the manifest.
///
/// A recorded value x of channel k becomes (x + offset\[k\]) * gain\[k\] in SI, `offset` in the unit of the column
/// as it stands in the file, `gain` per unit of it (N.m per A for a current in amperes; a pure factor where the
/// unit is one of position, velocity or torque already). Only then, with `side: motor`, motor values go through
/// the gear to the joints.
#[derive(Debug, Clone, PartialEq)]
pub struct Manifest {
    /// The manifest's own path, for messages.
    pub path: String,
    /// Its folder.
    pub folder: PathBuf,
    /// A robot's name, or the path of a robot YAML (relative to the manifest).
    pub robot: String,
    /// Free text.
    pub title: String,
    /// Side of the gear that was recorded.
    pub side: Side,
    /// How the text files are laid out.
    pub layout: Layout,
    /// Where time comes from.
    pub time: Time,
    /// Positions.
    pub position: Channel,
    /// Velocities, where they were recorded.
    pub velocity: Option<Channel>,
    /// Torques.
    pub torque: Channel,
    /// The motions.
    pub trajectories: Vec<Window>,
    text: String,
}

/// Side of the gear.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// Joint angles and joint torques.
    #[default]
    Joint,
    /// Motor angles and motor torques: q = gear^-1 motor, tau = gearT motor.
    Motor,
}

/// How the text files are laid out.
#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Layout {
    /// The first line names the columns.
    pub header: bool,
    /// One byte between the fields; a space stands for any run of blanks.
    #[serde(deserialize_with = "one_byte")]
    pub delimiter: u8,
    /// The decimal point.
    #[serde(deserialize_with = "one_byte")]
    pub decimal: u8,
    /// Lines before the header or the first row.
    pub skip: u64,
}

impl Default for Layout {
    fn default() -> Self {
        Self { header: true, delimiter: b',', decimal: b'.', skip: 0 }
    }
}

/// Where time comes from.
#[derive(Debug, Clone, PartialEq)]
pub enum Time {
    /// A column of stamps.
    Column {
        /// The column.
        column: Column,
        /// Its unit.
        unit: Unit,
        /// Whether the first row is t = 0.
        from_first_row: bool,
        /// The file, where it is not the trajectory's.
        file: Option<String>,
    },
    /// Rows are equally spaced, the first at t = 0; Hz.
    Rate(f64),
}

/// A column by name or 0-based index.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Column {
    /// Name in the header.
    Name(String),
    /// 0-based.
    Index(usize),
}

/// Columns of one quantity, one per joint.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Channel {
    /// The file, where it is not the trajectory's.
    #[serde(default)]
    pub file: Option<String>,
    /// One per joint.
    pub columns: Vec<Column>,
    /// One for all or one per joint; empty: SI.
    #[serde(default, deserialize_with = "one_or_many")]
    pub unit: Vec<Unit>,
    /// Added to the recorded value, in its unit; one per joint or empty.
    #[serde(default, deserialize_with = "numbers")]
    pub offset: Vec<f64>,
    /// SI value per recorded unit; one per joint or empty.
    #[serde(default, deserialize_with = "numbers")]
    pub gain: Vec<f64>,
}

/// One motion: a file, or a window of it.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Window {
    /// The file of the channels that name none.
    #[serde(default)]
    pub file: Option<String>,
    /// First time, s.
    #[serde(default, deserialize_with = "number")]
    pub from: Option<f64>,
    /// Last time, s.
    #[serde(default, deserialize_with = "number")]
    pub to: Option<f64>,
    /// Joints that stand still, by their number in the robot's table.
    #[serde(default)]
    pub fixed: Vec<usize>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    robot: String,
    #[serde(default)]
    title: String,
    #[serde(default)]
    side: Side,
    #[serde(default)]
    layout: Layout,
    time: RawTime,
    position: Channel,
    #[serde(default)]
    velocity: Option<Channel>,
    torque: Channel,
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

/// A message without the length of what it quotes.
fn shortened(message: &str) -> String {
    const MOST: usize = 300;
    match message.char_indices().nth(MOST) {
        Some((end, _)) => format!("{} ...", &message[..end]),
        None => message.to_owned(),
    }
}

impl Manifest {
    /// Reads a manifest file.
    pub fn read(path: &Path) -> Result<Self, RecordingError> {
        let bytes = std::fs::read(path).map_err(|e| RecordingError::io(path, &e))?;
        Self::parse(path, &bytes)
    }

    /// Parses the text of a manifest; `path` is where it stands, for messages and for the files it names.
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self, RecordingError> {
        let file = path.display().to_string();
        let text = std::str::from_utf8(bytes).map_err(|e| {
            let line = 1 + bytes[..e.valid_up_to()].iter().filter(|b| **b == b'\n').count();
            let message = "this byte is not UTF-8; a recording YAML is text".into();
            RecordingError::Manifest { file: file.clone(), line, column: 1, message }
        })?;
        if text.lines().all(|l| l.trim().is_empty() || l.trim_start().starts_with('#')) {
            let message = "the file is empty; a recording needs robot, time, position and torque".into();
            return Err(RecordingError::Manifest { file, line: 1, column: 1, message });
        }
        if let Some(twice) = duplicate_key(text) {
            let message = format!("the key `{}` is there twice; first at line {}", twice.key, twice.first);
            return Err(RecordingError::Manifest { file, line: twice.line, column: twice.column, message });
        }
        let raw: Raw = serde_yaml::from_str(text).map_err(|e| {
            let (line, column) = e.location().map_or((1, 1), |l| (l.line(), l.column()));
            let message = e.to_string();
            // The place is told once, in front.
            let message = message.split(" at line ").next().unwrap_or_default();
            // A file that is not a mapping at all is quoted whole by the parser.
            let message = if message.ends_with("expected struct Raw") {
                "this is not a recording YAML: it needs the keys robot, time, position, torque and trajectories"
                    .to_owned()
            } else {
                shortened(message)
            };
            RecordingError::Manifest { file: file.clone(), line, column, message }
        })?;
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        let mut manifest = Self {
            path: file,
            folder,
            robot: raw.robot,
            title: raw.title,
            side: raw.side,
            layout: raw.layout,
            time: Time::Rate(0.0),
            position: raw.position,
            velocity: raw.velocity,
            torque: raw.torque,
            trajectories: raw.trajectories,
            text: text.to_string(),
        };
        manifest.time = manifest.check_time(raw.time)?;
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
                    Some(unit) => unit,
                    None => Unit { name: "s".into(), quantity: Quantity::Time, factor: 1.0 },
                };
                let from_first_row = raw.from_first_row.unwrap_or(false);
                Ok(Time::Column { column, unit, from_first_row, file: raw.file })
            }
        }
    }

    fn check(&mut self) -> Result<(), RecordingError> {
        if self.robot.trim().is_empty() {
            return Err(self.error(&["robot"], "a robot's name or the path of its YAML is needed"));
        }
        if self.layout.delimiter == self.layout.decimal {
            return Err(self.error(&["layout"], "delimiter and decimal point are the same byte"));
        }
        if self.trajectories.is_empty() {
            self.trajectories.push(Window::default());
        }
        for (k, window) in self.trajectories.iter().enumerate() {
            let from = window.from.unwrap_or(f64::NEG_INFINITY);
            if window.to.is_some_and(|to| to <= from) {
                let message = format!("trajectory {}: `to` must be later than `from`", k + 1);
                return Err(self.error(&["trajectories"], &message));
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
                let message =
                    format!("trajectory {} names no `file`, and not every channel names one", k + 1);
                return Err(self.error(&["trajectories"], &message));
            }
        }
        Ok(())
    }

    /// An error at the line of a key, found by its name and those above it.
    pub(super) fn error(&self, keys: &[&str], message: &str) -> RecordingError {
        let (line, column) = place(&self.text, keys);
        let (file, message) = (self.path.clone(), format!("{}: {message}", keys.join(".")));
        RecordingError::Manifest { file, line, column, message }
    }
}

/// Line and column (from 1) of `keys.0`, then of `keys.1` at or after it, and so on, as far as they are found.
fn place(text: &str, keys: &[&str]) -> (usize, usize) {
    let mut at = 0;
    for key in keys {
        let wanted = format!("{key}:");
        let starts = text[at..].match_indices(&wanted).map(|(i, _)| at + i);
        let found =
            starts.into_iter().find(|&i| !text[..i].ends_with(|c: char| c.is_alphanumeric() || c == '_'));
        match found {
            Some(i) => at = i,
            None => break,
        }
    }
    let line_start = text[..at].rfind('\n').map_or(0, |i| i + 1);
    (text[..at].matches('\n').count() + 1, text[line_start..at].chars().count() + 1)
}

fn finite<E: de::Error>(value: f64) -> Result<f64, E> {
    if value.is_finite() { Ok(value) } else { Err(E::custom(format!("{value} is not a finite number"))) }
}

fn number<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Option<f64>, D::Error> {
    Option::<f64>::deserialize(deserializer)?.map(finite).transpose()
}

fn numbers<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<f64>, D::Error> {
    Vec::<f64>::deserialize(deserializer)?.into_iter().map(finite).collect()
}

fn one_byte<'de, D: Deserializer<'de>>(deserializer: D) -> Result<u8, D::Error> {
    let text = String::deserialize(deserializer)?;
    match (text.as_bytes(), text.as_str()) {
        ([b'\n' | b'\r' | b'"' | b'0'..=b'9' | b'-' | b'+'], _) => {}
        ([byte], _) if byte.is_ascii() => return Ok(*byte),
        (_, "tab" | "\\t") => return Ok(b'\t'),
        _ => {}
    }
    Err(de::Error::custom(format!(
        "`{text}`: one ASCII character is expected, as \",\" \";\" \"\\t\" or \" \""
    )))
}

fn one_or_many<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Unit>, D::Error> {
    struct Units;
    impl<'de> Visitor<'de> for Units {
        type Value = Vec<Unit>;

        fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
            f.write_str("a unit, or a list of units, one per joint")
        }

        fn visit_str<E: de::Error>(self, name: &str) -> Result<Self::Value, E> {
            Unit::deserialize(name.into_deserializer()).map(|u| vec![u])
        }

        fn visit_u64<E: de::Error>(self, value: u64) -> Result<Self::Value, E> {
            self.visit_str(&value.to_string())
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
            let mut units = Vec::new();
            while let Some(unit) = seq.next_element()? {
                units.push(unit);
            }
            Ok(units)
        }
    }
    deserializer.deserialize_any(Units)
}

impl<'de> Deserialize<'de> for Column {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct NameOrIndex;
        impl Visitor<'_> for NameOrIndex {
            type Value = Column;

            fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str("a column's name, or its index from 0")
            }

            fn visit_str<E: de::Error>(self, name: &str) -> Result<Column, E> {
                Ok(Column::Name(name.into()))
            }

            fn visit_u64<E: de::Error>(self, index: u64) -> Result<Column, E> {
                if index > 100_000 {
                    return Err(E::custom(format!("column {index}: no table is as wide as that")));
                }
                Ok(Column::Index(index as usize))
            }
        }
        deserializer.deserialize_any(NameOrIndex)
    }
}

impl fmt::Display for Column {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Name(name) => write!(f, "`{name}`"),
            Self::Index(index) => write!(f, "{index}"),
        }
    }
}

#[cfg(test)]
#[path = "manifest_tests.rs"]
mod tests;
