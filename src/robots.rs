//! Which robot is meant: one that was generated at build time, or a YAML or URDF given by path.

use std::path::{Path, PathBuf};

use dynid_codegen::base::base_set;
use dynid_codegen::numeric_robot;
use dynid_codegen::robot::parse_with_warnings;
use dynid_runtime::model::{Model, RecursiveModel, Robot};
use dynid_runtime::recording::meant;
use dynid_runtime::regular_file;
use dynid_urdf::ImportOptions;

use crate::failure::{Failure, file_failure};
use crate::models;
use crate::output::warn;
use crate::urdf_files::{imported, is_urdf};

/// Longest robot YAML that is read, bytes.
const LONGEST: u64 = 1 << 20;

/// A robot's dynamics.
pub enum Dynamics {
    /// Closed-form code from `robots/`.
    Generated(&'static dyn Model),
    /// The recursive engine over a YAML read at run time: the same numbers, slower.
    Recursive(Box<RecursiveModel>),
}

impl Dynamics {
    /// The model, whichever it is.
    pub fn model(&self) -> &dyn Model {
        match self {
            Dynamics::Generated(model) => *model,
            Dynamics::Recursive(model) => model.as_ref(),
        }
    }
}

/// Finds a robot by the name of a generated model or by the path of a YAML.
///
/// `beside` is the folder of the recording that names the robot: a relative path is looked for there and nowhere else,
/// so that a recording means the same robot from every working directory. Without it the path comes from the command
/// line and is relative to the working directory.
///
/// # Errors
/// [`Failure::Input`] with every mistake of the YAML as `file:line:col: message`, or with the known names.
pub fn resolve(name: &str, beside: Option<&Path>) -> Result<Dynamics, Failure> {
    if let Some(model) = models::find(name) {
        return Ok(Dynamics::Generated(model));
    }
    let looks_like_a_path =
        [".yaml", ".yml", ".urdf"].iter().any(|end| name.ends_with(end)) || name.contains('/');
    if !looks_like_a_path {
        return Err(unknown(name));
    }
    let path = path_of(name, beside);
    if beside.is_some() && !path.is_file() && Path::new(name).is_file() {
        return Err(Failure::Input(format!(
            "{}: there is no such file: a robot is looked for beside the recording that names it. There is a {name} in the \
             working directory: --robot {name} takes it",
            path.display()
        )));
    }
    recursive(read(&path)?, &path.display().to_string())
}

/// The recursive engine for a robot; `named` is what a person knows it by.
///
/// # Errors
/// [`Failure::Input`] where the engine does not take it.
pub fn recursive(robot: Robot, named: &str) -> Result<Dynamics, Failure> {
    let model = RecursiveModel::new(robot).map_err(|error| Failure::Input(format!("{named}: {error}")))?;
    Ok(Dynamics::Recursive(Box::new(model)))
}

/// The path that is meant: a relative one is looked for in the folder of the recording, where there is one.
pub fn path_of(name: &str, beside: Option<&Path>) -> PathBuf {
    beside.map_or_else(|| PathBuf::from(name), |folder| folder.join(name))
}

/// How a robot that was found is found again: its name, or the path of its YAML.
pub fn found_again(dynamics: &Dynamics, name: &str, beside: Option<&Path>) -> String {
    match dynamics {
        Dynamics::Generated(model) => model.robot().name.to_string(),
        Dynamics::Recursive(_) => path_of(name, beside).display().to_string(),
    }
}

/// The bytes of a robot YAML, those of its table for a URDF. That they are too many, or no text, is told with the other
/// mistakes.
///
/// # Errors
/// [`Failure::Input`] naming the file.
pub fn read_yaml(path: &Path) -> Result<Vec<u8>, Failure> {
    if is_urdf(path) {
        return Ok(imported(path, &ImportOptions::default())?.0.yaml.into_bytes());
    }
    regular_file::read(path, LONGEST).map_err(|error| file_failure("read the robot", path, &error))
}

/// Reads a robot YAML, or a URDF, into the numbers that the runtime works with. What is allowed in it but probably not meant is
/// told on standard error.
///
/// # Errors
/// [`Failure::Input`] with every mistake, one a line.
pub fn read(path: &Path) -> Result<Robot, Failure> {
    if is_urdf(path) {
        let (_, table) = imported(path, &ImportOptions::default())?;
        return Ok(numeric_robot(&table, &base_set(&table)));
    }
    let text = read_yaml(path)?;
    let (table, warnings) = parse_with_warnings(&path.display().to_string(), &text).map_err(|mistakes| {
        Failure::Input(mistakes.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))
    })?;
    warnings.iter().for_each(|warning| warn(&warning.to_string()));
    Ok(numeric_robot(&table, &base_set(&table)))
}

fn unknown(name: &str) -> Failure {
    let known: Vec<String> = models::all().iter().map(|m| m.robot().name.to_string()).collect();
    let meant = meant(name, known.iter().map(String::as_str));
    Failure::Input(format!(
        "there is no robot '{name}'{meant}: known are {}; or give the path of a robot YAML or a URDF",
        known.join(", ")
    ))
}
