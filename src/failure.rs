//! How a command ends when it cannot do what was asked.

use std::fmt;
use std::process::ExitCode;

/// Why a command stopped.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Failure {
    /// The input is wrong: exit status 2. The text says what, where, and what to do.
    Input(String),
    /// The input is right, but the data cannot support the answer: exit status 1. The text says why.
    Data(String),
}

impl Failure {
    /// The exit status of the contract.
    pub fn exit_code(&self) -> ExitCode {
        match self {
            Failure::Input(_) => ExitCode::from(2),
            Failure::Data(_) => ExitCode::from(1),
        }
    }
}

impl fmt::Display for Failure {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Failure::Input(text) | Failure::Data(text) => f.write_str(text),
        }
    }
}

impl std::error::Error for Failure {}

/// Wraps what the file system said with the file and what was wanted of it.
pub fn file_failure(doing: &str, path: &std::path::Path, error: &std::io::Error) -> Failure {
    use std::io::ErrorKind::{IsADirectory, NotADirectory, NotFound, PermissionDenied};
    let why = match error.kind() {
        NotFound => "there is no such file or folder".to_owned(),
        IsADirectory => "it is a folder, a file was expected".to_owned(),
        NotADirectory => "a part of the path is a file, not a folder".to_owned(),
        PermissionDenied => "it is not permitted".to_owned(),
        // What has its own words needs no kind and no number of the system.
        _ => error.get_ref().map_or_else(|| error.to_string(), ToString::to_string),
    };
    Failure::Input(format!("{}: cannot {doing}: {why}", path.display()))
}
