//! `dynid validate MODEL REC`: does an identified model predict another recording?

use std::path::{Path, PathBuf};

use clap::Args;
use dynid_runtime::diagnosis::term_torques;
use dynid_runtime::estimation::observe::{Equations, Observation, observe};
use dynid_runtime::estimation::{Identified, Observed, errors_against, per_equation, relative_error};
use dynid_runtime::model::Model;
use dynid_runtime::report::{percent, significant};
use dynid_runtime::signal::Motion;

use super::diagnose::diagnosis_failure;
use crate::failure::{Failure, file_failure};
use crate::models;
use crate::output::{Bar, print, table, write_json};
use crate::recorded::{Recorded, RecordingOptions, left_out_words, observe_failure, read};

/// Band in which models are compared unless something else is asked for, Hz: models that were identified in wider bands
/// are judged on the same rows as those of a diagnosis.
const COMPARED: f64 = 25.0;

/// What to predict, with what.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A model saved by `identify --out` or `diagnose --out`
    model: PathBuf,
    #[command(flatten)]
    recording: RecordingOptions,
    /// Write the result for other programs; `-` is standard output
    #[arg(long)]
    json: Option<PathBuf>,
}

/// Predicts, prints, saves.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let identified = read_model(&arguments.model)?;
    let mut options = arguments.recording.clone();
    // The model was identified for a robot; the same is used unless something else is asked for.
    // A robot whose YAML is not where it was then is the one that the recording names.
    let still_there = models::find(&identified.robot).is_some() || Path::new(&identified.robot).is_file();
    options.robot = options.robot.or_else(|| still_there.then(|| identified.robot.clone()));
    options.sampling.band = options.sampling.band.or(Some(identified.band.min(COMPARED)));
    let recorded = read(&options)?;
    let Prediction { observation, errors } = prediction(&recorded, &identified, &arguments.model)?;
    if let Some(path) = &arguments.json {
        let observed = Observed {
            samples: observation.samples,
            trajectories: &observation.trajectories,
            left_out: &observation.left_out,
            settings: &recorded.settings,
        };
        let left_out = recorded.rows.rows.left_out;
        write_json(path, &identified.validated(&observed, errors.clone(), left_out))?;
        if path == Path::new("-") {
            return Ok(());
        }
    }
    print(&recorded.heading());
    for line in left_out_words(&recorded.rows) {
        print(&line);
    }
    let used: usize = observation.left_out.iter().map(|l| l.used).sum();
    let slow: usize = observation.left_out.iter().map(|l| l.standstill).sum();
    print(&format!(
        "{used} equations of {} Hz bandwidth, {slow} left out where the joint hardly moves",
        significant(recorded.settings.band, 3)
    ));
    if !identified.effects.is_empty() {
        let names: Vec<&str> = identified.effects.iter().map(|term| term.effect.id()).collect();
        print(&format!("effects in the model: {}", names.join(", ")));
    }
    let rows = errors.1.iter().enumerate().map(|(j, e)| vec![(j + 1).to_string(), percent(*e)]).collect();
    print(&format!("\n{}", table(&["<joint", "relative error"], rows)));
    print(&format!("\nrelative error of the torques {}", percent(errors.0)));
    Ok(())
}

/// A recording seen by a model.
pub(super) struct Prediction {
    /// The recording's equations, without the effects of the model.
    pub observation: Observation,
    /// Relative error of the torques, overall and per joint.
    pub errors: (f64, Vec<f64>),
}

/// Predicts the torques of a recording with a model and its effects.
///
/// # Errors
/// [`Failure::Input`] where the model is of another robot; [`Failure::Data`] where no row can be used.
pub(super) fn prediction(
    recorded: &Recorded,
    identified: &Identified,
    model_path: &Path,
) -> Result<Prediction, Failure> {
    let model = recorded.dynamics.model();
    let chi = known_parameters(identified, model, model_path)?;
    let bar = Bar::new("samples");
    let observed = |motions: &[Motion]| {
        let progress = |done, all| bar.at(done, all);
        observe(model, motions, Equations::Torque, None, &recorded.settings, Some(&progress))
            .map_err(|error| observe_failure(model_path, &error))
    };
    let observation = observed(&recorded.motions)?;
    if identified.effects.is_empty() {
        let errors = (relative_error(&observation, &chi), per_equation(&observation, &chi));
        return Ok(Prediction { observation, errors });
    }
    // What the effects explain is taken from the torques; the error still counts against the torques as measured.
    let mut rest = recorded.motions.clone();
    for motion in &mut rest {
        let torques = term_torques(model, &chi, &identified.effects, motion)
            .map_err(|error| diagnosis_failure(model_path, &error))?;
        for (measured, effect) in motion.torque.iter_mut().zip(&torques) {
            for (m, e) in measured.iter_mut().zip(effect) {
                *m -= e;
            }
        }
    }
    let unexplained = observed(&rest)?;
    let errors = errors_against(&unexplained, &observation, &chi);
    Ok(Prediction { observation, errors })
}

/// chi of a saved model for a robot.
///
/// # Errors
/// [`Failure::Input`] with the parameter that the model does not have.
pub(super) fn known_parameters(
    identified: &Identified,
    model: &dyn Model,
    path: &Path,
) -> Result<Vec<f64>, Failure> {
    identified.chi(model.robot()).map_err(|missing| {
        Failure::Input(format!(
            "{}: it has no {missing}, which {} needs: it was identified for another robot",
            path.display(),
            model.robot().name
        ))
    })
}

/// Reads a saved model.
///
/// # Errors
/// [`Failure::Input`] with file, line and column.
pub(super) fn read_model(path: &Path) -> Result<Identified, Failure> {
    let text = std::fs::read_to_string(path).map_err(|error| file_failure("read the model", path, &error))?;
    serde_json::from_str(&text).map_err(|error| {
        Failure::Input(format!(
            "{}:{}:{}: not a saved model: {error}",
            path.display(),
            error.line(),
            error.column()
        ))
    })
}
