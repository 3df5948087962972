//! The way from robots to their modules.

use crate::base::BaseSet;
use crate::emit;
use crate::mechanics::{Equations, ModelCounts, ModelError};
use crate::robot::{Diagnostic, Robot, parse};

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
/// A drive without a model. A robot from [`parse`] always has one.
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

/// The module of one robot of a collection.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Module {
    /// Name of the robot and of the module.
    pub name: String,
    /// Its source.
    pub source: String,
}

/// The modules of several robot YAMLs, given as path and bytes, in their order.
///
/// # Errors
/// Every mistake of every file, and every name that is taken already.
pub fn generate_all(files: &[(String, Vec<u8>)]) -> Result<Vec<Module>, Vec<Diagnostic>> {
    let mut mistakes = Vec::new();
    let mut robots: Vec<(&str, Robot)> = Vec::new();
    for (path, bytes) in files {
        let robot = match parse(path, bytes) {
            Ok(robot) => robot,
            Err(found) => {
                mistakes.extend(found);
                continue;
            }
        };
        if let Some((first, _)) = robots.iter().find(|(_, known)| known.name == robot.name) {
            let message = format!("the name {} is already that of {first}", robot.name);
            mistakes.push(at_key(path, bytes, "name", message));
        } else {
            robots.push((path, robot));
        }
    }
    let mut modules = Vec::new();
    for (path, robot) in &robots {
        match generate(robot) {
            Ok(source) => modules.push(Module { name: robot.name.clone(), source }),
            Err(error) => mistakes.push(at_key(path, &[], "name", error.to_string())),
        }
    }
    if mistakes.is_empty() { Ok(modules) } else { Err(mistakes) }
}

/// A mistake at a top-level key of a file, or at its start where the key cannot be found.
fn at_key(path: &str, bytes: &[u8], key: &str, message: String) -> Diagnostic {
    let text = String::from_utf8_lossy(bytes);
    let line = text.lines().position(|line| line.trim_start().starts_with(key)).unwrap_or(0) + 1;
    Diagnostic { path: path.to_owned(), line, column: 1, message }
}
