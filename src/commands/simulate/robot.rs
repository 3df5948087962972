//! Which robot is simulated, and what it needs for that.

use std::path::Path;

use dynid_runtime::effects::EffectTerm;
use dynid_runtime::model::{Model, Robot};
use dynid_runtime::model_file::Identified;
use dynid_runtime::simulation::{Plant, Residue, SimulationError, World, check_standard};

use super::Arguments;
use super::elastic::elastic_joint;
use crate::failure::Failure;
use crate::saved::{is_model, known_parameters, read_model};

/// The robot that is simulated.
pub(super) enum Parameters {
    /// Standard parameters.
    Standard(Vec<f64>),
    /// Base parameters of an identified model, and the effects that were found with them.
    Base(Vec<f64>, Vec<EffectTerm>),
}

/// Everything that a robot's YAML lacks for a simulation, at once.
pub(super) fn missing(robot: &Robot, saved: bool, followed: bool) -> Option<String> {
    let mut needed = Vec::new();
    if robot.nominal.is_none() && !saved {
        needed.push(
            "`nominal:` with the standard parameters (a model saved by `identify` needs none)".to_owned(),
        );
    }
    if !followed {
        let limits = &robot.limits;
        let empty = [
            ("position", limits.position.is_empty()),
            ("velocity", limits.velocity.is_empty()),
            ("acceleration", limits.acceleration.is_empty()),
        ];
        let names: Vec<&str> = empty.iter().filter(|(_, empty)| *empty).map(|(name, _)| *name).collect();
        if !names.is_empty() {
            needed.push(format!("`limits:` with {} (--follow needs none)", names.join(", ")));
        }
    }
    (!needed.is_empty())
        .then(|| format!("{} cannot be simulated: its YAML lacks {}", robot.name, needed.join(" and ")))
}

/// The model that a name is the file of; `None` where it is none.
pub(super) fn saved_model(name: &str) -> Result<Option<Identified>, Failure> {
    let path = Path::new(name);
    if !is_model(path) {
        return Ok(None);
    }
    read_model(path).map(Some)
}

/// Parameters of a saved model, or the nominal ones of the robot.
pub(super) fn parameters(
    robot: &Robot,
    saved: Option<&Identified>,
    name: &str,
) -> Result<Parameters, Failure> {
    if let Some(identified) = saved {
        let chi = known_parameters(identified, robot, Path::new(name))?;
        return Ok(Parameters::Base(chi, identified.effects.clone()));
    }
    let Some(nominal) = &robot.nominal else {
        return Err(Failure::Input(SimulationError::NoNominal { robot: robot.name.to_string() }.to_string()));
    };
    check_standard(robot, &nominal.standard)
        .map_err(|error| Failure::Input(format!("{}: nominal parameters: {error}", robot.name)))?;
    Ok(Parameters::Standard(nominal.standard.to_vec()))
}

/// The robot; `world` is what base parameters and effects make of it.
pub(super) fn plant<'m>(
    world: &'m World<'_>,
    model: &'m dyn Model,
    parameters: &Parameters,
    arguments: &Arguments,
) -> Result<Plant<'m>, Failure> {
    let robot = model.robot();
    let failed = |error: SimulationError| Failure::Input(error.to_string());
    let elastic =
        arguments.elastic.iter().map(|text| elastic_joint(robot, text)).collect::<Result<Vec<_>, _>>()?;
    let more = arguments.residue != 0.0 || arguments.ripple != 0.0 || !elastic.is_empty();
    match parameters {
        Parameters::Base(..) if !more => world.plant("").map_err(failed),
        Parameters::Base(..) => Err(Failure::Input(
            "--residue, --ripple and --elastic need standard parameters: simulate a robot with nominal values".to_owned(),
        )),
        Parameters::Standard(_) if !arguments.effect.is_empty() && more => Err(Failure::Input(
            "--effect goes without --residue, --ripple and --elastic; torque_ripple is an --effect too".to_owned(),
        )),
        Parameters::Standard(_) if !arguments.effect.is_empty() => world.plant("").map_err(failed),
        Parameters::Standard(standard) => {
            let mut residue = Residue::typical(robot, standard, arguments.residue);
            let whole = Residue::typical(robot, standard, 1.0);
            for (ripple, full) in residue.ripple.iter_mut().zip(&whole.ripple) {
                *ripple += arguments.ripple * full / Residue::TYPICAL_RIPPLE;
            }
            let beyond = arguments.residue != 0.0 || arguments.ripple != 0.0;
            let effects = if beyond { vec![residue.boxed()] } else { Vec::new() };
            Plant::with_effects(model, standard, &elastic, effects).map_err(failed)
        }
    }
}
