//! Which robot is meant: one that was generated at build time, or a YAML given by path.

use std::path::{Path, PathBuf};

use dynid_codegen::base::base_set;
use dynid_codegen::numeric_robot;
use dynid_codegen::robot::parse_with_doubts;
use dynid_runtime::model::{Model, RecursiveModel, Robot};

use crate::failure::{Failure, file_failure};
use crate::models;

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
/// A relative path is looked for from the working directory and from `beside`, the folder of the recording.
///
/// # Errors
/// [`Failure::Input`] with every mistake of the YAML as `file:line:col: message`, or with the known names.
pub fn resolve(name: &str, beside: Option<&Path>) -> Result<Dynamics, Failure> {
    if let Some(model) = models::find(name) {
        return Ok(Dynamics::Generated(model));
    }
    let looks_like_a_path = name.ends_with(".yaml") || name.ends_with(".yml") || name.contains('/');
    if !looks_like_a_path {
        return Err(unknown(name));
    }
    let path = path_of(name, beside);
    let robot = read(&path)?;
    let model =
        RecursiveModel::new(robot).map_err(|error| Failure::Input(format!("{}: {error}", path.display())))?;
    Ok(Dynamics::Recursive(Box::new(model)))
}

/// The path that is meant by a relative one: from the working directory where such a file is there, else from `beside`.
pub fn path_of(name: &str, beside: Option<&Path>) -> PathBuf {
    let direct = PathBuf::from(name);
    match beside.map(|folder| folder.join(name)) {
        Some(joined) if !direct.is_file() => joined,
        _ => direct,
    }
}

/// Reads a robot YAML into the numbers that the runtime works with. What is allowed in it but probably not meant is
/// told on standard error.
///
/// # Errors
/// [`Failure::Input`] with every mistake, one a line.
pub fn read(path: &Path) -> Result<Robot, Failure> {
    let text = std::fs::read(path).map_err(|error| file_failure("read the robot", path, &error))?;
    let (table, doubts) = parse_with_doubts(&path.display().to_string(), &text).map_err(|mistakes| {
        Failure::Input(mistakes.iter().map(ToString::to_string).collect::<Vec<_>>().join("\n"))
    })?;
    doubts.iter().for_each(|doubt| eprintln!("warning: {doubt}"));
    Ok(numeric_robot(&table, &base_set(&table)))
}

fn unknown(name: &str) -> Failure {
    let known: Vec<String> = models::all().iter().map(|m| m.robot().name.to_string()).collect();
    Failure::Input(format!(
        "there is no robot '{name}': known are {}; or give the path of a robot YAML",
        known.join(", ")
    ))
}
