//! What can be wrong with a recording.

use thiserror::Error;

/// A recording that cannot be read, with the place and what to do.
#[derive(Debug, Clone, PartialEq, Error)]
#[non_exhaustive]
pub enum RecordingError {
    /// A file that cannot be opened or read.
    #[error("{file}: {message}")]
    File {
        /// The file.
        file: String,
        /// What the system said.
        message: String,
    },
    /// A manifest that does not keep to the contract.
    #[error("{file}:{line}:{column}: {message}")]
    Manifest {
        /// The manifest.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What was found and what was expected.
        message: String,
    },
    /// A data file that does not have what the manifest says.
    #[error("{file}:{line}: {message}")]
    Table {
        /// The data file.
        file: String,
        /// Line, from 1.
        line: u64,
        /// What was found and what was expected.
        message: String,
    },
    /// Position and torque files, or time and position, that do not have the same number of rows.
    #[error(
        "{first} has {first_rows} rows and {second} has {second_rows}: row k of both must be the same instant; \
         record them together, or name the file that belongs to it"
    )]
    UnequalRows {
        /// A file of the trajectory.
        first: String,
        /// Its rows.
        first_rows: u64,
        /// Another file of the trajectory.
        second: String,
        /// Its rows.
        second_rows: u64,
    },
    /// A window or a file in which no row is left.
    #[error("{name}: no rows {why}")]
    Empty {
        /// The trajectory.
        name: String,
        /// Why.
        why: String,
    },
    /// More rows that cannot be right than a recording may have.
    #[error(
        "{name}: {left_out} of {rows} rows cannot be right, more than {limit} %; most of them: {reason}, as in \
         {example}. {advice}"
    )]
    TooManyLeftOut {
        /// The trajectory.
        name: String,
        /// Rows left out.
        left_out: u64,
        /// Rows in its window.
        rows: u64,
        /// The share allowed, %.
        limit: f64,
        /// The most frequent reason.
        reason: String,
        /// `file:line: what`.
        example: String,
        /// What to look at.
        advice: String,
    },
}

impl RecordingError {
    /// Whether the data are at fault rather than what was asked for (exit status 1 rather than 2).
    pub fn is_about_data(&self) -> bool {
        matches!(self, Self::TooManyLeftOut { .. } | Self::Empty { .. })
    }

    pub(super) fn io(file: &std::path::Path, error: &std::io::Error) -> Self {
        let message = match error.kind() {
            std::io::ErrorKind::NotFound => format!("there is no such file{}", beside(file)),
            std::io::ErrorKind::PermissionDenied => "it may not be read".into(),
            std::io::ErrorKind::IsADirectory => "it is a folder, a file was expected".into(),
            _ => error.get_ref().map_or_else(|| error.to_string(), ToString::to_string),
        };
        Self::File { file: file.display().to_string(), message }
    }
}

/// " (did you mean `...`?)" with the file of the same folder whose name is nearest.
fn beside(file: &std::path::Path) -> String {
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    let entries = std::fs::read_dir(folder.unwrap_or(std::path::Path::new(".")));
    let names = entries.into_iter().flatten().flatten().take(MOST_BESIDE);
    let mut names: Vec<String> = names.filter_map(|entry| entry.file_name().into_string().ok()).collect();
    names.sort_unstable();
    // Endings are alike anyway.
    let stem = |name: &str| name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_owned();
    let stems: Vec<String> = names.iter().map(|name| stem(name)).collect();
    let name = file.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    let meant = super::nearest(&stem(&name), stems.iter().map(String::as_str));
    let place = stems.iter().position(|stem| Some(stem.as_str()) == meant);
    place.map_or_else(String::new, |k| super::names::offered(&names[k]))
}

/// Files of a folder that are looked at for a name that was meant.
const MOST_BESIDE: usize = 1000;
