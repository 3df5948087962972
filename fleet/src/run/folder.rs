//! The folder of a fleet's results.

use std::collections::BTreeSet;
use std::fs::File;
use std::path::{Path, PathBuf};

use dynid::output::make_folder;

use crate::day::{self, Day};
use crate::error::{FleetError, Result};

/// Tables with a file for each day.
const TABLES: [&str; 4] = ["factors", "parameters", "findings", "screening"];

/// The folder of results. While it is held, no other run writes to it.
pub struct OutFolder {
    path: PathBuf,
    _lock: File,
}

impl OutFolder {
    /// Opens a folder, or makes it.
    ///
    /// # Errors
    /// What the file system says; another run that holds it.
    pub fn open(path: &Path) -> Result<Self> {
        for folder in TABLES.into_iter().chain(["pending"]) {
            make_folder(&path.join(folder))?;
        }
        let name = path.join(".lock");
        let lock = File::create(&name).map_err(|error| FleetError::io(&name, "make it", &error))?;
        match lock.try_lock() {
            Ok(()) => Ok(Self { path: path.to_path_buf(), _lock: lock }),
            Err(_) => {
                Err(FleetError::file(path, "another run writes to it; wait for it, or choose another --out"))
            }
        }
    }

    /// A file of it.
    pub fn file(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// The file of a table and a day.
    pub fn of_day(&self, table: &str, day: Day) -> PathBuf {
        self.path.join(table).join(format!("{}.parquet", day::written(day)))
    }

    /// The file of a recording that was reduced, until its day is done.
    pub fn pending(&self, key: &str) -> PathBuf {
        self.path.join("pending").join(format!("{key}.parquet"))
    }

    /// Keys of the recordings that were reduced and whose days are not done since.
    pub fn all_pending(&self) -> BTreeSet<String> {
        let files = std::fs::read_dir(self.path.join("pending")).into_iter().flatten().flatten();
        files
            .filter_map(|entry| Some(entry.file_name().to_str()?.strip_suffix(".parquet")?.to_owned()))
            .collect()
    }

    /// Days of a table that are there, ascending.
    pub fn days(&self, table: &str) -> Vec<Day> {
        let files = std::fs::read_dir(self.path.join(table)).into_iter().flatten().flatten();
        let mut days: Vec<Day> = files
            .filter_map(|entry| day::parse(entry.file_name().to_str()?.strip_suffix(".parquet")?))
            .collect();
        days.sort_unstable();
        days
    }
}
