//! What a diagnosis may be told beforehand: a model from before a change, and laws of the user.

use std::path::{Path, PathBuf};
use std::sync::Arc;

use dynid::arguments::Source;
use dynid::commands::diagnose::reference;
use dynid::origin::{Origin, find};
use dynid::pages::Prior;
use dynid::recorded::Measured;
use dynid::saved::read_model;
use dynid_runtime::diagnosis::Reference;
use dynid_runtime::effects::UserLaw;
use dynid_runtime::law_file;
use dynid_runtime::model::Robot;
use dynid_runtime::model_file::Identified;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::error::{error, of_failure};
use crate::fit::PyFit;

/// A model of a robot before something changed.
pub(crate) struct Before {
    /// Its parameters and laws with their uncertainty.
    pub reference: Arc<Reference>,
    /// The parameters, for the page.
    pub prior: Prior,
    /// The motions that it is from, where its file names them and they are as they were; else why they are not used.
    pub origin: Origin,
}

/// A [`PyFit`], or the path of a saved one, as a model from before of the robot whose recording is diagnosed.
///
/// # Errors
/// A file that is no model, or a model of another robot.
pub(crate) fn before(given: &Bound<'_, PyAny>, diagnosed: (&Source, &Measured)) -> PyResult<Before> {
    let robot = diagnosed.1.dynamics.model().robot();
    let of = |saved: &Identified, its: &Robot, path: &Path, origin| -> PyResult<Before> {
        let reference = reference::of(saved, its, path, robot).map_err(of_failure)?;
        let prior = Prior::saved("reference", saved, robot);
        Ok(Before { reference: Arc::new(reference), prior, origin })
    };
    if let Ok(fit) = given.cast::<PyFit>() {
        let fit = fit.get();
        return of(&fit.identified, fit.dynamics.model().robot(), Path::new("reference"), Origin::default());
    }
    let path: PathBuf =
        given.extract().map_err(|_| error("reference: expected a dynid.Fit or the path of a saved model"))?;
    let saved = read_model(&path).map_err(of_failure)?;
    let own = dynid::saved::own_dynamics(&saved, &path).map_err(of_failure)?;
    of(&saved, own.model().robot(), &path, find(&saved, &path, diagnosed))
}

/// The path of a list of laws, or the list: dictionaries with id, joint, law, and where needed unit and shapes.
///
/// # Errors
/// What is no law of this robot, with its place.
pub(crate) fn laws(py: Python<'_>, given: &Bound<'_, PyAny>, robot: &Robot) -> PyResult<Vec<UserLaw>> {
    if let Ok(path) = given.extract::<PathBuf>() {
        return law_file::read(&path, robot).map_err(|why| error(why.to_string()));
    }
    // JSON is YAML, with the same keys; a law a line, so that a mistake is told by its law.
    let json = py.import("json")?;
    // Numbers of numpy are told as the numbers that they are.
    let options = PyDict::new(py);
    options.set_item("default", py.import("operator")?.call_method1("methodcaller", ("item",))?)?;
    let mut text = String::from("[");
    for law in given.try_iter().map_err(|_| error("laws: expected a path, or a list of dictionaries"))? {
        let separator = if text.len() > 1 { ",\n" } else { "" };
        let law: String = json.call_method("dumps", (law?,), Some(&options))?.extract()?;
        text.push_str(separator);
        text.push_str(&law);
    }
    text.push(']');
    law_file::parse("laws", text.as_bytes(), robot).map_err(|why| error(why.to_string()))
}
