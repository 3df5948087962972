//! A saved model in the place of a recording from before a robot changed.

use std::path::Path;

use dynid_runtime::model_file::difference;
use dynid_runtime::prediction::Predictor;
use dynid_runtime::recording::Trajectory;
use dynid_runtime::signal::Motion;

use crate::arguments::{DiagnosisOptions, RowOptions, Sampling, Source};
use crate::errors::prediction_failure;
use crate::failure::Failure;
use crate::output::warn;
use crate::recorded::read;
use crate::saved::{known_parameters, own_dynamics, read_model};

/// The motions of the recording with the torques that a reference model gives them: what the robot would have been
/// recorded with before it changed. The model is evaluated as the robot that it was identified for.
pub(super) fn as_the_reference(
    path: &Path,
    source: &Source,
    options: &DiagnosisOptions,
) -> Result<Vec<Trajectory>, Failure> {
    let reference = read_model(path)?;
    let rows = RowOptions { cutoff: options.cutoff, threads: options.threads, ..RowOptions::default() };
    let recorded = read(source, &Sampling { band: options.band, rows })?;
    let robot = recorded.dynamics.model().robot();
    let own = own_dynamics(&reference, path)?;
    let model = own.model();
    if model.robot().joints() != robot.joints() {
        return Err(Failure::Input(format!(
            "{}: it is a model of {}, the recording is of {}",
            path.display(),
            model.robot().name,
            robot.name
        )));
    }
    if let Some(what) = difference(model.robot(), robot) {
        warn(&format!(
            "{} was identified with another table than that of {}: {what}. Its own is used for what it predicts",
            path.display(),
            robot.name
        ));
    }
    let chi = known_parameters(&reference, model.robot(), path)?;
    let predictor = Predictor { chi: &chi, effects: &reference.effects, delay: reference.delay };
    recorded
        .motions
        .iter()
        .map(|motion| {
            let torque =
                predictor.torques(model, motion).map_err(|error| prediction_failure(path, &error))?;
            Ok(with_torque(motion, torque))
        })
        .collect()
}

fn with_torque(motion: &Motion, torque: Vec<Vec<f64>>) -> Trajectory {
    let samples = motion.q.first().map_or(0, Vec::len);
    Trajectory {
        name: format!("{} as the reference model has it", motion.name),
        time: (0..samples).map(|t| motion.start + t as f64 / motion.rate).collect(),
        position: motion.q.clone(),
        velocity: None,
        torque,
        fixed: motion.fixed.clone(),
    }
}
