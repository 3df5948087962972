//! Saved models: reading one, and which robot it is evaluated as.

use std::path::Path;

use dynid_runtime::model::{Model, Robot};
use dynid_runtime::model_file::{self, Identified, difference, fingerprint};
use dynid_runtime::regular_file;

use crate::failure::{Failure, file_failure};
use crate::models;
use crate::robots::{Dynamics, recursive, resolve};

/// Longest saved model that is read, bytes.
const LONGEST: u64 = 1 << 26;

/// Whether a path is that of a saved model.
pub fn is_model(path: &Path) -> bool {
    path.extension().is_some_and(|extension| extension == "json")
}

/// Reads a saved model, every field of it checked.
///
/// # Errors
/// [`Failure::Input`] with the file and the place in it: line and column, or the path of the field.
pub fn read_model(path: &Path) -> Result<Identified, Failure> {
    let text = regular_file::read_text(path, LONGEST)
        .map_err(|error| file_failure("read the model", path, &error))?;
    model_file::read(&text).map_err(|error| Failure::Input(format!("{}:{error}", path.display())))
}

/// The dynamics of the robot that a model was identified for: the generated one where it is the same robot, else the
/// recursive engine over the table of the file. A file from before there were tables names its robot.
///
/// # Errors
/// [`Failure::Input`] where an older file names a robot that is not there, or that it does not fit.
pub fn own_dynamics(identified: &Identified, path: &Path) -> Result<Dynamics, Failure> {
    let Some(table) = &identified.table else {
        let dynamics = resolve(&identified.robot, path.parent()).map_err(|error| {
            Failure::Input(format!(
                "{}: it was saved by an older dynid, without its robot's table, and its robot is not found: {error}",
                path.display()
            ))
        })?;
        check_effects(identified, dynamics.model().robot(), path)?;
        return Ok(dynamics);
    };
    match same_generated(table) {
        Some(model) => Ok(Dynamics::Generated(model)),
        None => recursive(table.clone(), &path.display().to_string()),
    }
}

/// The generated model of the same robot.
fn same_generated(table: &Robot) -> Option<&'static dyn Model> {
    models::find(&table.name).filter(|model| fingerprint(model.robot()) == fingerprint(table))
}

/// A robot that a recording is read as, and what a person should know about the choice.
pub struct Chosen {
    /// Its dynamics.
    pub dynamics: Dynamics,
    /// A warning.
    pub warning: Option<String>,
}

/// Which robot a model predicts a recording as.
///
/// With `--robot` it is that one. Otherwise it is the model's own: parameters mean something with their own table only.
/// Where the recording names a robot of the same name whose table has changed since, that is warned of; where it names
/// another robot, that is refused. A recording whose robot is not found is taken to be of the model's.
///
/// # Errors
/// [`Failure::Input`] where the recording is of another robot, or the robot is not found.
pub fn robot_for(
    identified: &Identified,
    path: &Path,
    asked: Option<&str>,
    named: (&str, &Path),
) -> Result<Chosen, Failure> {
    let file = path.display();
    let Some(table) = &identified.table else {
        let dynamics = match asked {
            Some(name) => resolve(name, None)?,
            None if models::find(&identified.robot).is_some() => resolve(&identified.robot, None)?,
            None => resolve(named.0, Some(named.1))?,
        };
        check_effects(identified, dynamics.model().robot(), path)?;
        let warning =
            format!("{file}: saved by an older dynid, without its robot's table: it cannot be checked");
        return Ok(Chosen { dynamics, warning: Some(warning) });
    };
    if let Some(name) = asked {
        let dynamics = resolve(name, None)?;
        check_effects(identified, dynamics.model().robot(), path)?;
        let warning = difference(table, dynamics.model().robot())
            .map(|what| format!("{file} was identified with another table than that of {name}: {what}"));
        return Ok(Chosen { dynamics, warning });
    }
    let own = own_dynamics(identified, path)?;
    let Ok(recorded) = resolve(named.0, Some(named.1)) else {
        return Ok(Chosen { dynamics: own, warning: None });
    };
    let robot = recorded.model().robot();
    let Some(what) = difference(table, robot) else {
        return Ok(Chosen { dynamics: recorded, warning: None });
    };
    if robot.name != table.name {
        return Err(Failure::Input(format!(
            "{file} is a model of {}, and the recording is of {}: --robot {} predicts it all the same",
            table.name, robot.name, named.0
        )));
    }
    let warning = format!(
        "the table of {} has changed since {file} was identified: {what}. The model's own table is used; identify again, \
         or take today's with --robot",
        table.name
    );
    Ok(Chosen { dynamics: own, warning: Some(warning) })
}

/// The effects of a model on a robot that is not the one of its file.
fn check_effects(identified: &Identified, robot: &Robot, path: &Path) -> Result<(), Failure> {
    for (k, term) in identified.effects.iter().enumerate() {
        term.check(robot)
            .map_err(|error| Failure::Input(format!("{}:effects[{k}].{error}", path.display())))?;
    }
    Ok(())
}

/// chi of a saved model for a robot.
///
/// # Errors
/// [`Failure::Input`] with the parameter that the model does not have.
pub fn known_parameters(identified: &Identified, robot: &Robot, path: &Path) -> Result<Vec<f64>, Failure> {
    identified.chi(robot).map_err(|missing| {
        Failure::Input(format!(
            "{}: it has no {missing}, which {} needs: it was identified for another robot",
            path.display(),
            robot.name
        ))
    })
}
