//! The way from robots to their modules.

use crate::base::BaseSet;
use crate::emit;
use crate::mechanics::{Equations, ModelCounts, ModelError};
use crate::robot::{Diagnostic, RobotTable, at_name, parse_with_warnings};
use std::fmt::Write;
use std::path::Path;

/// Why no module came out.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum GenerateError {
    /// The robot has no model.
    #[error(transparent)]
    Model(#[from] ModelError),
    /// The text that was written is not Rust; a bug of the generator.
    #[error("the generated code does not parse: {0}")]
    Syntax(String),
}

/// The module of a robot: its data, its equations and its `Model`, as formatted Rust.
///
/// The text is the same bytes for the same table. It is a file of its own (`mod arm;`), and what compiles it depends on
/// dynid-runtime.
///
/// # Errors
/// [`GenerateError::Model`] for a drive without a model; a robot from [`crate::robot::parse`] always has one.
/// [`GenerateError::Syntax`] is a bug of the generator.
pub fn generate(robot: &RobotTable) -> Result<String, GenerateError> {
    generate_with(robot, &crate::base::base_set(robot))
}

/// [`generate`] for base parameters that are known already.
///
/// # Errors
/// As [`generate`].
pub fn generate_with(robot: &RobotTable, set: &BaseSet) -> Result<String, GenerateError> {
    let equations = Equations::derive(robot, set)?;
    emit::module(robot, set, &equations).map_err(|error| GenerateError::Syntax(error.to_string()))
}

/// What evaluating the functions of a robot's module costs.
///
/// # Errors
/// [`ModelError`] for a drive without a model.
pub fn operation_counts(robot: &RobotTable) -> Result<ModelCounts, ModelError> {
    Ok(Equations::derive(robot, &crate::base::base_set(robot))?.counts())
}

/// The source of a registry of modules that were written to files, each given by the name of its robot and its path.
///
/// It declares a module for each robot and two lists in the same order, `MODELS` (`&dyn Model`) and `OPERATIONS`. It is
/// made for `include!(concat!(env!("OUT_DIR"), "/registry.rs"))`, where a path cannot be known beforehand.
pub fn registry(modules: &[(&str, &Path)]) -> String {
    let mut source = String::new();
    let list = |item: &str| modules.iter().map(|(name, _)| format!("&{name}::{item}")).collect::<Vec<_>>();
    // Writing to a String cannot fail.
    for (name, path) in modules {
        let _ = writeln!(source, "#[path = {path:?}]\npub mod {name};");
    }
    let models = list("Dynamics").join(", ");
    let _ =
        writeln!(source, "pub(crate) static MODELS: &[&dyn ::dynid_runtime::model::Model] = &[{models}];");
    let operations = list("OPERATIONS").join(", ");
    let kind = "&[&[::dynid_runtime::model::Operations]]";
    let _ = writeln!(source, "pub(crate) static OPERATIONS: {kind} = &[{operations}];");
    source
}

/// The robots of several YAMLs, and what is allowed but probably not meant.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Collection {
    /// In the order of the files.
    pub robots: Vec<RobotTable>,
    /// What is allowed in the files but probably not meant.
    pub warnings: Vec<Diagnostic>,
}

/// Names beside which a module cannot stand: of crates, of the file that lists the modules, and of primitive types.
const TAKEN: [&str; 24] = [
    "alloc",
    "bool",
    "char",
    "core",
    "dynid_runtime",
    "f32",
    "f64",
    "i8",
    "i16",
    "i32",
    "i64",
    "i128",
    "isize",
    "proc_macro",
    "registry",
    "std",
    "str",
    "test",
    "u8",
    "u16",
    "u32",
    "u64",
    "u128",
    "usize",
];

/// Whether a robot's name, a Rust identifier, can be that of its module. Small letters keep it apart from types, and from
/// another one on a disk that makes no difference.
fn is_module_name(name: &str) -> bool {
    !name.bytes().any(|b| b.is_ascii_uppercase()) && !TAKEN.contains(&name)
}

/// Reads several robot YAMLs, given as path and bytes, that go into one registry.
///
/// # Errors
/// Every mistake of every file, every name that is taken already, and every name that no module can have.
pub fn read_all(files: &[(String, Vec<u8>)]) -> Result<Collection, Vec<Diagnostic>> {
    let mut mistakes = Vec::new();
    let mut collection = Collection { robots: Vec::new(), warnings: Vec::new() };
    let mut paths: Vec<&str> = Vec::new();
    for (path, bytes) in files {
        match parse_with_warnings(path, bytes) {
            Err(found) => mistakes.extend(found),
            Ok((robot, warnings)) => {
                match collection.robots.iter().position(|known| known.name == robot.name) {
                    Some(first) => {
                        let message = format!("the name {} is already that of {}", robot.name, paths[first]);
                        mistakes.push(at_name(path, bytes, message));
                    }
                    None if !is_module_name(&robot.name) => {
                        let message = format!(
                            "the name {} cannot be that of a generated module: expected small letters, digits and _, and no \
                             name that Rust or the registry uses",
                            robot.name
                        );
                        mistakes.push(at_name(path, bytes, message));
                    }
                    None => {
                        collection.robots.push(robot);
                        collection.warnings.extend(warnings);
                        paths.push(path);
                    }
                }
            }
        }
    }
    if mistakes.is_empty() { Ok(collection) } else { Err(mistakes) }
}
