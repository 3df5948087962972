//! What can go wrong with a fleet, with what to do.

use std::path::Path;

use datafusion::error::DataFusionError;
use dynid::failure::Failure;

/// Why a command stopped.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum FleetError {
    /// Something in a text file is wrong.
    #[error("{file}:{line}:{column}: {message}")]
    Place {
        /// The file.
        file: String,
        /// Line, from 1.
        line: usize,
        /// Column, from 1.
        column: usize,
        /// What was found and what was expected.
        message: String,
    },
    /// A file or a folder cannot be read or written, or is not what it must be.
    #[error("{file}: {message}")]
    File {
        /// The file.
        file: String,
        /// What is wrong and what to do.
        message: String,
    },
    /// An object store refuses.
    #[error("{url}: {message}")]
    Store {
        /// What was asked for.
        url: String,
        /// What it said and what to do.
        message: String,
    },
    /// The query engine refuses.
    #[error("{0}")]
    Engine(String),
    /// The cluster does not answer, or not as it must.
    #[error("{0}")]
    Cluster(String),
}

impl FleetError {
    /// An error of a file, in the words of the system.
    pub fn io(path: &Path, doing: &str, error: &std::io::Error) -> Self {
        let words = dynid::failure::file_failure(doing, path, error).to_string();
        let file = path.display().to_string();
        let message = words.strip_prefix(&format!("{file}: ")).unwrap_or(&words).to_owned();
        Self::File { file, message }
    }

    /// An error of a file.
    pub fn file(path: &Path, message: impl Into<String>) -> Self {
        Self::File { file: path.display().to_string(), message: message.into() }
    }
}

impl From<DataFusionError> for FleetError {
    fn from(error: DataFusionError) -> Self {
        Self::Engine(error.strip_backtrace())
    }
}

impl From<Failure> for FleetError {
    fn from(failure: Failure) -> Self {
        Self::Engine(failure.to_string())
    }
}

/// What a fleet's functions return.
pub type Result<T> = std::result::Result<T, FleetError>;
