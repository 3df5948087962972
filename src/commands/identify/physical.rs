//! `identify --physical`: standard parameters that bodies can have, and the base parameters of these bodies.

use std::path::Path;

use dynid_runtime::estimation::observe::Observation;
use dynid_runtime::model::Robot;
use dynid_runtime::model_file::{Identified, difference};
use dynid_runtime::prediction::observed_errors;
use dynid_runtime::report::percent;
use dynid_urdf::ImportOptions;

use crate::body_report::{report, words};
use crate::failure::Failure;
use crate::near_bodies::{NearBodies, Table};
use crate::robots::resolve;
use crate::saved::{is_model, read_model};
use crate::urdf_files::{self, is_urdf};

/// Makes a model one of bodies: its base parameters become theirs, its table's nominal values their standard parameters.
/// Returns what to say of it. `prior` is a URDF, a robot YAML or a model; the robot's nominal values and ellipsoids where it is
/// not given.
///
/// # Errors
/// [`Failure::Input`] for a prior of another robot, [`Failure::Data`] where nothing says how near the parameters must be.
pub(super) fn make_physical(
    identified: &mut Identified,
    robot: &Robot,
    torques: &Observation,
    prior: Option<&Path>,
) -> Result<String, Failure> {
    let bodies = match prior {
        Some(path) if is_urdf(path) => {
            let options = ImportOptions::default();
            let urdf = urdf_files::parsed(path, &urdf_files::bytes(path)?, options.snap)?;
            let template = urdf_files::template(path, &urdf, robot, &options)?;
            NearBodies::new(identified, robot, Table::of(robot), Some((&template, path)))
        }
        Some(path) => NearBodies::new(identified, robot, Table::of(&table_of(path, robot)?), None),
        None => NearBodies::new(identified, robot, Table::of(robot), None),
    };
    let bodies = bodies.map_err(|error| Failure::Data(error.to_string()))?;
    let told = report(&bodies, robot, Some(torques), identified.relative_error);
    let mut text = bodies.words(identified, robot);
    let errors = observed_errors(torques, &bodies.near.chi);
    let least = told.relative_errors.and_then(|[_, least]| least);
    text.push_str(&format!(
        "\nrelative error of the torques {} -> {} with bodies; {} with those nearest to the data, whatever the prior\n\n{}",
        percent(identified.relative_error),
        percent(errors.relative_error),
        percent(least),
        words(&told)
    ));
    identified.bodies = Some(told);
    identified.relative_error = errors.relative_error;
    identified.per_joint = errors.per_joint;
    for (parameter, base) in identified.base_parameters.iter_mut().zip(&bodies.near.chi) {
        parameter.value = *base;
    }
    if let Some(table) = &mut identified.table {
        let mut values = table.nominal.clone().unwrap_or_else(|| dynid_runtime::model::Nominal {
            standard: Vec::new().into(),
            kp: Vec::new().into(),
            kd: Vec::new().into(),
            ki: Vec::new().into(),
            position_noise: Vec::new().into(),
            torque_noise: Vec::new().into(),
        });
        values.standard = bodies.near.standard.into();
        table.nominal = Some(values);
    }
    Ok(text.trim_end().to_owned())
}

/// The standard parameters of a prior, where it has those of the robot's own frames; `None` for a URDF, whose bodies are
/// taken in its own.
///
/// # Errors
/// [`Failure::Input`] for a prior of another robot.
pub(super) fn standard_of(path: &Path, robot: &Robot) -> Result<Option<Vec<f64>>, Failure> {
    if is_urdf(path) {
        return Ok(None);
    }
    Ok(table_of(path, robot)?.nominal.map(|nominal| nominal.standard.into_owned()))
}

/// The table of a robot YAML or of a model, with nominal standard parameters.
fn table_of(path: &Path, robot: &Robot) -> Result<Robot, Failure> {
    let wrong = |what: String| Failure::Input(format!("{}: {what}", path.display()));
    let other = if is_model(path) {
        read_model(path)?.table.ok_or_else(|| wrong("a model without its table is no prior".to_owned()))?
    } else {
        resolve(&path.display().to_string(), None)?.model().robot().clone()
    };
    if let Some(what) = difference(&other, robot) {
        return Err(wrong(format!("its table is not that of the recording's robot: {what}")));
    }
    if other.nominal.is_none() {
        return Err(wrong("it has no nominal parameters".to_owned()));
    }
    Ok(other)
}
