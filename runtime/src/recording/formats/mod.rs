//! Formats of data files: one file a format. `.npy` arrays and text tables are beside this folder.

#[cfg(feature = "mcap")]
mod mcap;
#[cfg(feature = "parquet")]
mod parquet;

#[cfg(not(all(feature = "mcap", feature = "parquet")))]
use std::io::{self, Write};
use std::path::Path;

#[cfg(not(feature = "parquet"))]
use super::Columns;
#[cfg(not(feature = "mcap"))]
use super::JointLog;
use super::format::Format;
use super::npy::NpyReader;
use super::table::TableReader;
use super::topic::Topic;
use super::{Column, Layout, RecordingError};

/// What is wanted of a file.
pub(super) struct Wanted<'a> {
    /// The columns, each of them once.
    pub columns: &'a [Column],
    /// How a text file is laid out.
    pub layout: &'a Layout,
    /// The topic of a log.
    #[cfg_attr(not(feature = "mcap"), allow(dead_code, reason = "logs alone have topics"))]
    pub topic: Option<&'a str>,
    /// Of a log the path of the names that elements of lists have, where it is not the usual one.
    #[cfg_attr(not(feature = "mcap"), allow(dead_code, reason = "logs alone have lists with names"))]
    pub names: Option<&'a str>,
    /// Whether a row that lacks some signals of a log, or some columns of a Parquet file, is handed out with NaN in their
    /// places.
    #[cfg_attr(
        not(any(feature = "mcap", feature = "parquet")),
        allow(dead_code, reason = "texts tell what they lack")
    )]
    pub partial: bool,
}

/// What a log holds, by its first messages.
pub(super) struct Survey {
    pub topics: Vec<Topic>,
    /// The topic that is looked at, where there is one that tells of joints.
    pub topic: Option<String>,
    /// Its signals, `joint.position` and so on.
    pub signals: Vec<String>,
    /// Whether its messages have header stamps.
    pub stamped: bool,
    pub notes: Vec<String>,
}

/// Opens a file; `.npy`, `.parquet`, `.mcap` and folders are read as such, everything else as text.
pub(super) fn open(path: &Path, file: &str, wanted: &Wanted<'_>) -> Result<Box<dyn Format>, RecordingError> {
    if is_log(path) {
        return open_log(path, file, wanted);
    }
    Ok(match extension(path).as_str() {
        "npy" => Box::new(NpyReader::open(path, file, wanted.columns)?),
        "parquet" => open_parquet(path, file, wanted)?,
        _ => Box::new(TableReader::open(path, file, wanted.layout, wanted.columns)?),
    })
}

/// Whether a path is that of a log that names its joints: an MCAP file, a folder of them, or what only can be converted
/// to one.
pub fn is_log(path: &Path) -> bool {
    matches!(extension(path).as_str(), "mcap" | "db3" | "bag") || path.is_dir()
}

pub(super) fn extension(path: &Path) -> String {
    path.extension().map_or_else(String::new, |e| e.to_string_lossy().to_ascii_lowercase())
}

#[cfg(feature = "mcap")]
fn open_log(path: &Path, file: &str, wanted: &Wanted<'_>) -> Result<Box<dyn Format>, RecordingError> {
    Ok(Box::new(mcap::McapReader::open(path, file, wanted)?))
}

#[cfg(feature = "mcap")]
pub(super) use mcap::{begun, files_of, survey, write as write_mcap};

#[cfg(not(feature = "mcap"))]
pub(super) fn begun(_: &Path, _: &str, _: Option<&str>) -> Option<i64> {
    None
}

#[cfg(not(feature = "mcap"))]
pub(super) fn files_of(_: &Path, _: &str) -> Result<Vec<std::path::PathBuf>, RecordingError> {
    Ok(Vec::new())
}

#[cfg(not(feature = "mcap"))]
fn open_log(_: &Path, file: &str, _: &Wanted<'_>) -> Result<Box<dyn Format>, RecordingError> {
    Err(left_out(file, "mcap"))
}

#[cfg(not(feature = "mcap"))]
pub(super) fn write_mcap(_: &[JointLog<'_>], _: &[String], _: &mut dyn Write) -> io::Result<()> {
    Err(io::Error::other(left_out("an MCAP file", "mcap").to_string()))
}

#[cfg(not(feature = "mcap"))]
pub(super) fn survey(_: &Path, file: &str, _: Option<&str>) -> Result<Survey, RecordingError> {
    Err(left_out(file, "mcap"))
}

#[cfg(feature = "parquet")]
fn open_parquet(path: &Path, file: &str, wanted: &Wanted<'_>) -> Result<Box<dyn Format>, RecordingError> {
    Ok(Box::new(parquet::ParquetReader::open(path, file, wanted.columns, wanted.partial)?))
}

#[cfg(feature = "parquet")]
pub(super) use parquet::{parquet_columns, write as write_parquet};

#[cfg(not(feature = "parquet"))]
fn open_parquet(_: &Path, file: &str, _: &Wanted<'_>) -> Result<Box<dyn Format>, RecordingError> {
    Err(left_out(file, "parquet"))
}

#[cfg(not(feature = "parquet"))]
pub(super) fn write_parquet(_: &Columns<'_>, _: &mut dyn Write) -> io::Result<()> {
    Err(io::Error::other(left_out("a Parquet file", "parquet").to_string()))
}

#[cfg(not(feature = "parquet"))]
pub(super) fn parquet_columns(_: &Path, file: &str) -> Result<(Vec<String>, Option<f64>), RecordingError> {
    Err(left_out(file, "parquet"))
}

#[cfg(not(all(feature = "mcap", feature = "parquet")))]
fn left_out(file: &str, feature: &str) -> RecordingError {
    let message =
        format!("this program was built without the feature `{feature}` of dynid-runtime, which reads it");
    RecordingError::File { file: file.into(), message }
}
