//! `dynid validate MODEL REC`: does an identified model predict another recording?

use std::path::{Path, PathBuf};

use clap::Args;
use dynid_runtime::model_file::{EvaluatedRows, Identified};
use dynid_runtime::prediction::{Evaluation, Predictor, Prepared, evaluate, row_states};
use dynid_runtime::recording::Manifest;
use dynid_runtime::report::{percent, significant};

use crate::arguments::{ComparisonOptions, Source};
use crate::compared::{Compared, residual_file};
use crate::errors::{band_words, noise_words, prediction_failure};
use crate::failure::Failure;
use crate::output::{print, table, warn, write, write_json};
use crate::pages::validation::page;
use crate::provenance::Provenance;
use crate::recorded::{Measured, heading, left_out_words, measure_as, recording_failure};
use crate::robots::found_again;
use crate::saved::{known_parameters, read_model, robot_for};

/// What to predict, with what.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A model saved by `identify --out` or `diagnose --out`
    model: PathBuf,
    #[command(flatten)]
    recording: Source,
    #[command(flatten)]
    comparison: ComparisonOptions,
    /// Write a page with the torques, measured and predicted, and what the model leaves
    #[arg(long)]
    report: Option<PathBuf>,
    /// Write states, torques and residuals row by row: a table (.csv, .parquet) or messages (.mcap)
    #[arg(long, value_name = "FILE", value_parser = residual_file)]
    residuals: Option<PathBuf>,
    /// Write the result for other programs; `-` is standard output
    #[arg(long)]
    json: Option<PathBuf>,
}

/// Predicts, prints, saves.
pub(super) fn run(arguments: &Arguments, words: &[String]) -> Result<(), Failure> {
    let identified = read_model(&arguments.model)?;
    let (mut measured, prepared) = recording(arguments, &identified)?;
    measured.rows.too_short = prepared.too_short.iter().map(ToString::to_string).collect();
    let model = measured.dynamics.model();
    let chi = known_parameters(&identified, model.robot(), &arguments.model)?;
    let predictor = Predictor { chi: &chi, effects: &identified.effects, delay: identified.delay };
    let evaluation = evaluate(model, &[predictor], &prepared.motions, &prepared.settings, &[])
        .map_err(|error| prediction_failure(&arguments.recording.recording, &error))?;
    if arguments.report.is_some() || arguments.residuals.is_some() {
        let states = row_states(model, &chi, &prepared.motions, &prepared.settings)
            .map_err(|error| prediction_failure(&arguments.recording.recording, &error))?;
        let models = &["predicted"];
        let compared = Compared { robot: model.robot(), evaluation: &evaluation, states: &states, models };
        if let Some(path) = &arguments.residuals {
            compared.write(path, &measured.joints)?;
        }
        if let Some(path) = &arguments.report {
            let mut from = Provenance::of(words);
            from.file(&arguments.model)?;
            from.recording(&arguments.recording.recording, arguments.recording.robot.as_deref())?;
            let heading = heading(model.robot(), &measured.title);
            let mut notes = notes(arguments, &identified, &measured, &prepared, &evaluation);
            notes.extend(noise_words(&evaluation));
            write(path, &page(&heading, &identified, compared, &notes, &from))?;
        }
    }
    if let Some(path) = &arguments.json {
        if let Some(mut rows) = EvaluatedRows::evaluated(&evaluation, 0) {
            rows.rows_left_out = Some(measured.rows.rows.left_out);
            write_json(path, &identified.validated(rows))?;
        }
        if path == Path::new("-") {
            return Ok(());
        }
    }
    print(&summary(arguments, &identified, &measured, &prepared, &evaluation));
    Ok(())
}

/// The recording, as one of the robot that the model predicts.
fn recording(arguments: &Arguments, identified: &Identified) -> Result<(Measured, Prepared), Failure> {
    let source = &arguments.recording;
    let manifest = Manifest::read(&source.recording).map_err(recording_failure)?;
    let named = (manifest.robot.as_str(), manifest.folder.as_path());
    let chosen = robot_for(identified, &arguments.model, source.robot.as_deref(), named)?;
    chosen.warning.iter().for_each(|warning| warn(warning));
    let joints = chosen.dynamics.model().robot().joints();
    let robot = found_again(&chosen.dynamics, &identified.robot, None);
    let measured = measure_as(source, manifest, chosen.dynamics, robot)?;
    let prepared = arguments
        .comparison
        .comparison(joints)
        .prepare(&measured.trajectories)
        .map_err(|error| prediction_failure(&source.recording, &error))?;
    Ok((measured, prepared))
}

/// What was left out, which rows count, and what the model has beside its parameters.
fn notes(
    arguments: &Arguments,
    identified: &Identified,
    measured: &Measured,
    prepared: &Prepared,
    evaluation: &Evaluation,
) -> Vec<String> {
    let mut notes = left_out_words(&measured.rows);
    notes.push(band_words(evaluation, prepared, arguments.comparison.band));
    if !identified.effects.is_empty() {
        let names: Vec<&str> = identified.effects.iter().map(|term| term.id()).collect();
        notes.push(format!("effects in the model: {}", names.join(", ")));
    }
    if identified.delay != 0.0 {
        let delay = significant(1e3 * identified.delay, 3);
        notes.push(format!("delay of the torques in the model: {delay} ms"));
    }
    notes
}

fn summary(
    arguments: &Arguments,
    identified: &Identified,
    measured: &Measured,
    prepared: &Prepared,
    evaluation: &Evaluation,
) -> String {
    let robot = measured.dynamics.model().robot();
    let mut text = format!("{}\n", heading(robot, &measured.title));
    for line in notes(arguments, identified, measured, prepared, evaluation) {
        text.push_str(&format!("{line}\n"));
    }
    let Some(prediction) = evaluation.predictions.first() else { return text };
    let errors = &prediction.errors;
    let rows = errors
        .per_joint
        .iter()
        .enumerate()
        .map(|(j, e)| vec![crate::words::joint_number(robot, j), percent(*e)])
        .collect();
    text.push_str(&format!("\n{}", table(&["<joint", "relative error"], rows)));
    text.push_str(&format!("\n\nrelative error of the torques {}", percent(errors.relative_error)));
    if let Some(words) = noise_words(evaluation) {
        text.push_str(&format!("\n{words}"));
    }
    text
}
