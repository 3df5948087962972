//! The recording YAML: which files hold what.

use std::path::PathBuf;

use serde::Deserialize;

use super::RecordingError;
use super::column::Column;
use super::condition::Condition;
use super::manifest_values::{number, numbers, one_byte, one_or_many};
use super::unit::Unit;
use super::yaml::Node;

/// The column of a log that holds the stamps of its messages, in s since the first.
pub(super) const STAMP: &str = "header.stamp";

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
    /// Names that the joints have in logs that name them (MCAP), in the order of the robot's table; may be empty.
    pub joints: Vec<String>,
    /// Where the signals of these joints are in messages of other types than those that tell of joints.
    pub fields: Option<MessageFields>,
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
    /// Temperature of the robot, where it was recorded.
    pub temperature: Option<Condition>,
    /// A measure of the load that the robot carried, where it was recorded.
    pub load: Option<Condition>,
    /// The motions.
    pub trajectories: Vec<Window>,
    /// Where its values stand.
    pub(super) places: Node,
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
        /// Its unit; `None` where it is not said: s, or what the type of the column says.
        unit: Option<Unit>,
        /// Whether the first row is t = 0.
        from_first_row: bool,
        /// The file, where it is not the trajectory's.
        file: Option<String>,
    },
    /// Rows are equally spaced, the first at t = 0; Hz.
    Rate(f64),
}

/// Paths to lists of numbers in the messages of a log, `actual.positions`, whose elements have names.
#[derive(Debug, Clone, PartialEq, Eq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct MessageFields {
    /// Of the positions.
    pub position: String,
    /// Of the velocities, where they are wanted.
    #[serde(default)]
    pub velocity: Option<String>,
    /// Of the torques.
    pub torque: String,
    /// Of the names of the elements, where it is none of the usual ones.
    #[serde(default)]
    pub names: Option<String>,
}

impl MessageFields {
    /// The path of a channel, by its key.
    pub(super) fn path(&self, quantity: &str) -> Option<&str> {
        match quantity {
            "position" => Some(&self.position),
            "velocity" => self.velocity.as_deref(),
            _ => Some(&self.torque),
        }
    }
}

/// Columns of one quantity, one per joint.
#[derive(Debug, Clone, PartialEq, Default, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Channel {
    /// The file, where it is not the trajectory's.
    #[serde(default)]
    pub file: Option<String>,
    /// One per joint; empty where only logs that name their joints are read.
    #[serde(default)]
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
    /// The topic of a log with several.
    #[serde(default)]
    pub topic: Option<String>,
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

impl Manifest {
    /// An error at the place of a key, by the keys that lead to it. A number is an item of a list, from 0.
    pub(super) fn error(&self, keys: &[&str], message: &str) -> RecordingError {
        let place = self.places.place_of(keys);
        let named: Vec<&str> = keys.iter().filter(|k| k.parse::<usize>().is_err()).copied().collect();
        let (file, message) = (self.path.clone(), format!("{}: {message}", named.join(".")));
        RecordingError::Manifest { file, line: place.line, column: place.column, message }
    }
}
