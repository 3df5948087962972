//! The way from robots to their modules.

use crate::base::BaseSet;
use crate::emit;
use crate::mechanics::{Equations, ModelCounts, ModelError};
use crate::robot::{Diagnostic, Robot, parse_with_doubts};

/// Why no module came out.
#[derive(Debug, thiserror::Error)]
pub enum GenerateError {
    /// The robot has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The text that was written is not Rust; a bug of the generator.
    #[error("the generated code does not parse: {0}")]
    Syntax(#[from] syn::Error),
}

/// The module of a robot: its data, its equations and its `Model`, as formatted Rust.
///
/// # Errors
/// A drive without a model. A robot from [`crate::robot::parse`] always has one.
pub fn generate(robot: &Robot) -> Result<String, GenerateError> {
    generate_with(robot, &crate::base::base_set(robot))
}

/// [`generate`] for base parameters that are known already.
///
/// # Errors
/// As [`generate`].
pub fn generate_with(robot: &Robot, set: &BaseSet) -> Result<String, GenerateError> {
    let equations = Equations::derive(robot, set)?;
    Ok(emit::module(robot, set, &equations)?)
}

/// What evaluating the functions of a robot's module costs.
///
/// # Errors
/// As [`generate`].
pub fn operation_counts(robot: &Robot) -> Result<ModelCounts, ModelError> {
    Ok(Equations::derive(robot, &crate::base::base_set(robot))?.counts())
}

/// The robots of several YAMLs, and what is doubtful about them.
#[derive(Debug, Clone, PartialEq)]
pub struct Collection {
    /// In the order of the files.
    pub robots: Vec<Robot>,
    /// What is allowed in the files but probably not meant.
    pub doubts: Vec<Diagnostic>,
}

/// Reads several robot YAMLs, given as path and bytes, that go into one registry.
///
/// # Errors
/// Every mistake of every file, and every name that is taken already.
pub fn read_all(files: &[(String, Vec<u8>)]) -> Result<Collection, Vec<Diagnostic>> {
    let mut mistakes = Vec::new();
    let mut collection = Collection { robots: Vec::new(), doubts: Vec::new() };
    let mut paths: Vec<&str> = Vec::new();
    for (path, bytes) in files {
        match parse_with_doubts(path, bytes) {
            Err(found) => mistakes.extend(found),
            Ok((robot, doubts)) => {
                match collection.robots.iter().position(|known| known.name == robot.name) {
                    Some(first) => {
                        let message = format!("the name {} is already that of {}", robot.name, paths[first]);
                        mistakes.push(at_key(path, bytes, "name", message));
                    }
                    None => {
                        collection.robots.push(robot);
                        collection.doubts.extend(doubts);
                        paths.push(path);
                    }
                }
            }
        }
    }
    if mistakes.is_empty() { Ok(collection) } else { Err(mistakes) }
}

/// A mistake at a top-level key of a file, or at its start where the key cannot be found.
fn at_key(path: &str, bytes: &[u8], key: &str, message: String) -> Diagnostic {
    let text = String::from_utf8_lossy(bytes);
    let line = text.lines().position(|line| line.trim_start().starts_with(key)).unwrap_or(0) + 1;
    Diagnostic { path: path.to_owned(), line, column: 1, message }
}
