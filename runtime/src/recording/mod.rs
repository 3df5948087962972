//! Recordings: manifests, files, units, trajectories.
//!
//! A [`Manifest`] says which files and columns hold what; [`load()`] reads them for a robot, on the joint side and in SI,
//! and [`Loader`] does so piece by piece. Every mistake is told with its file, line and column, and what was expected.
//!
//! ```
//! use dynid_runtime::recording::Manifest;
//! use std::path::Path;
//!
//! let manifest = Manifest::parse(
//!     Path::new("log.yaml"),
//!     b"robot: tx40
//! time: {column: t, unit: ms}
//! position: {columns: [q1, q2], unit: deg}
//! torque: {columns: [i1, i2], unit: A, gain: [14.9, 13.3]}
//! trajectories:
//!   - {file: run.csv, from: 0.5, to: 7}
//! ",
//! )?;
//! assert_eq!(manifest.trajectories[0].to, Some(7.0));
//!
//! let mistake = Manifest::parse(Path::new("log.yaml"), b"robot: tx40\nposition: {columns: [q1]}\n");
//! assert_eq!(mistake.unwrap_err().to_string(), "log.yaml:1:1: a recording has no 'time'");
//! # Ok::<(), dynid_runtime::recording::RecordingError>(())
//! ```

mod channel;
mod column;
mod condition;
mod conditions;
mod error;
mod fields;
mod files;
#[cfg(test)]
mod folder;
mod format;
mod formats;
mod layout_guess;
mod load;
mod look;
mod manifest;
mod manifest_reader;
mod manifest_values;
mod names;
mod npy;
mod number;
mod provenance;
mod reach;
mod regear;
mod report;
mod rows;
mod screen;
mod table;
mod topic;
mod trajectory;
mod unit;
mod window;
mod write;
pub mod yaml;

pub use column::Column;
pub use condition::Condition;
pub use conditions::{Conditions, conditions};
pub use error::RecordingError;
pub use formats::is_log;
pub use load::{Loader, Recording, load};
pub use look::{Channels, Contents, Role, Series, channels, look};
pub use manifest::{Channel, Layout, Manifest, MessageFields, Side, Time, Window};
pub use names::{meant, nearest};
pub use reach::Reach;
pub use regear::regear;
pub use report::{Cut, LeftOutRow, MOST_LEFT_OUT, Reason, RowReport};
pub use rows::Rows;
pub use table::TableReader;
pub use topic::Topic;
pub use trajectory::Trajectory;
pub use unit::{Quantity, Unit};
pub use write::{Columns, DataFormat, JointFields, JointLog, manifest_text, manifest_text_as, write_rows};
