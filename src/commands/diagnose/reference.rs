//! A saved model in the place of a recording from before a robot changed.

use std::path::Path;

use dynid_runtime::diagnosis::Reference;
use dynid_runtime::model::Robot;
use dynid_runtime::model_file::{Identified, difference};

use crate::arguments::Source;
use crate::failure::Failure;
use crate::origin::{Origin, find};
use crate::recorded::Measured;
use crate::saved::{own_dynamics, read_model};

/// A saved model, and the motions that it is from where they are still there.
pub(super) struct Before {
    pub reference: Reference,
    pub origin: Origin,
}

/// What a saved model says of the robot that is diagnosed.
///
/// # Errors
/// [`Failure::Input`] where the file is no model, or one of another robot.
pub(super) fn read(path: &Path, diagnosed: (&Source, &Measured)) -> Result<Before, Failure> {
    let saved = read_model(path)?;
    let own = own_dynamics(&saved, path)?;
    let reference = of(&saved, own.model().robot(), path, diagnosed.1.dynamics.model().robot())?;
    Ok(Before { reference, origin: find(&saved, path, diagnosed) })
}

/// What a model of a robot (`its`) says of the robot that is diagnosed; errors call it `path`.
///
/// Parameters mean something with the table that they were identified with, so that a model with another one is refused.
///
/// # Errors
/// [`Failure::Input`] where it is a model of another robot.
pub fn of(saved: &Identified, its: &Robot, path: &Path, robot: &Robot) -> Result<Reference, Failure> {
    if let Some(what) = difference(its, robot) {
        return Err(Failure::Input(format!(
            "{}: a model of {}, not of the {} that is diagnosed ({what}); identify it again with the table that the \
             recording names",
            path.display(),
            its.name,
            robot.name
        )));
    }
    saved.reference(robot).map_err(|error| Failure::Input(format!("{}:{error}", path.display())))
}
