//! Which MCAP files a path means: one, or those of a rosbag2 folder.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use crate::recording::RecordingError;
use crate::regular_file;

/// Longest `metadata.yaml` that is read, bytes.
const LONGEST: u64 = 1 << 24;

#[derive(Deserialize)]
struct Metadata {
    rosbag2_bagfile_information: Information,
}

#[derive(Deserialize)]
struct Information {
    #[serde(default)]
    storage_identifier: String,
    #[serde(default)]
    relative_file_paths: Vec<PathBuf>,
    #[serde(default)]
    compression_mode: String,
}

/// The files of a log in the order of time.
///
/// # Errors
/// A folder without MCAP files; a format that only can be converted, with how.
pub(in crate::recording) fn files_of(path: &Path, file: &str) -> Result<Vec<PathBuf>, RecordingError> {
    let error = |message: String| RecordingError::File { file: file.into(), message };
    if !path.is_dir() {
        return match path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase).as_deref() {
            Some("db3") => Err(error(sqlite(file))),
            Some("bag") => Err(error(format!(
                "this is a bag of ROS 1, which is not read. Convert it: `pip install rosbags`, then `rosbags-convert \
                 --src {file} --dst converted --dst-storage mcap`, and name the folder `converted` instead"
            ))),
            _ => Ok(vec![path.to_path_buf()]),
        };
    }
    let files = match regular_file::read(&path.join("metadata.yaml"), LONGEST) {
        Ok(bytes) => {
            let metadata: Metadata =
                serde_yaml::from_slice(&bytes).map_err(|e| error(format!("metadata.yaml: {e}")))?;
            let Information { storage_identifier, relative_file_paths, compression_mode } =
                metadata.rosbag2_bagfile_information;
            if storage_identifier == "sqlite3" {
                return Err(error(sqlite(file)));
            }
            if !matches!(compression_mode.to_ascii_lowercase().as_str(), "" | "none") {
                return Err(error(format!(
                    "its files or messages are packed by rosbag2 (compression_mode {compression_mode}); chunks that MCAP \
                     packs are read. {}",
                    convert(file)
                )));
            }
            relative_file_paths.iter().map(|name| path.join(name)).collect()
        }
        Err(_) => in_folder(path, file)?,
    };
    if files.is_empty() {
        return Err(error("this folder has no metadata.yaml and no .mcap file in it".into()));
    }
    Ok(files)
}

/// The MCAP files of a folder that says nothing of them, by number.
fn in_folder(path: &Path, file: &str) -> Result<Vec<PathBuf>, RecordingError> {
    let entries = std::fs::read_dir(path).map_err(|e| RecordingError::io(path, &e))?;
    let all: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    let is = |path: &PathBuf, wanted: &str| path.extension().is_some_and(|e| e.eq_ignore_ascii_case(wanted));
    let mut found: Vec<PathBuf> = all.iter().filter(|p| is(p, "mcap")).cloned().collect();
    if found.is_empty() && all.iter().any(|p| is(p, "db3")) {
        return Err(RecordingError::File { file: file.into(), message: sqlite(file) });
    }
    // run_2.mcap comes before run_10.mcap.
    found.sort_by_key(|path| (path.as_os_str().len(), path.clone()));
    Ok(found)
}

fn sqlite(file: &str) -> String {
    format!("this is a bag in SQLite, which is not read. {}", convert(file))
}

fn convert(file: &str) -> String {
    format!(
        "Convert it: write `output_bags: [{{uri: converted, storage_id: mcap, all: true}}]` to out.yaml, run `ros2 bag \
         convert -i {file} -o out.yaml`, and name the folder `converted` instead"
    )
}
