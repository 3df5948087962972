//! `dynid diagnose REC`: which physics is missing, where, and does adding it help on motion that was held back?

use std::path::{Path, PathBuf};

use clap::Args;
use dynid_runtime::diagnosis::{Diagnosis, DiagnosisError, Progress, Settings, diagnose, term_torques};
use dynid_runtime::estimation::{Identified, NamedParameter};
use dynid_runtime::model::{Model, Robot, torques};
use dynid_runtime::recording::Trajectory;
use dynid_runtime::report::{percent, significant};
use dynid_runtime::signal::Motion;

use super::validate::{known_parameters, prediction, read_model};
use crate::failure::Failure;
use crate::output::{Bar, print, table, write, write_json};
use crate::pages::diagnosis::{Extras, KeptApart, confidence_words, joint_words, page};
use crate::recorded::{Measured, RecordingOptions, left_out_words, measure, read};
use dynid_runtime::simulation::replay::{ClosedLoop, replay};

/// What to diagnose and where to put it.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    recording: RecordingOptions,
    /// A recording of the same robot before it changed: only what changed is looked for
    #[arg(long)]
    baseline: Option<PathBuf>,
    /// A model of the same robot before it changed, saved by `identify` or `diagnose`: only what changed is looked for
    #[arg(long, conflicts_with = "baseline")]
    reference: Option<PathBuf>,
    /// A recording that takes no part in the diagnosis: the errors on it are reported before and after
    #[arg(long)]
    test: Option<PathBuf>,
    /// Simulate the identified robot along the recorded motion without and with the findings, however long the
    /// recording (up to 30 s of motion it is done anyway)
    #[arg(long)]
    closed_loop: bool,
    /// Save the model with the effects that were found
    #[arg(long)]
    out: Option<PathBuf>,
    /// Write a page with the verdict, the plots and the numbers
    #[arg(long)]
    report: Option<PathBuf>,
    /// Write the result for other programs; `-` is standard output
    #[arg(long)]
    json: Option<PathBuf>,
}

/// Band in which models with effects are compared on other recordings unless another is asked for, Hz: that of the
/// diagnosis' faster rows.
const BAND: f64 = 25.0;

/// Motion that is simulated without being asked for, s.
const QUICK: f64 = 30.0;

/// Diagnoses, prints, saves.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let measured = measure(&arguments.recording)?;
    let model = measured.dynamics.model();
    let baseline = match (&arguments.baseline, &arguments.reference) {
        (Some(path), _) => measure(&other(&arguments.recording, path))?.trajectories,
        (None, Some(path)) => as_the_reference(path, &arguments.recording)?,
        (None, None) => Vec::new(),
    };
    let bar = Bar::new("diagnosis");
    let outcome = diagnose(model, &measured.trajectories, &baseline, &Settings::default(), &bar);
    drop(bar);
    let diagnosis = outcome.map_err(|error| diagnosis_failure(&arguments.recording.recording, &error))?;
    let standard = saved(model.robot(), &arguments.recording, &diagnosis, false);
    let improved = saved(model.robot(), &arguments.recording, &diagnosis, true);
    let kept_apart = match &arguments.test {
        Some(path) => Some(tested(&other(&arguments.recording, path), &standard, &improved)?),
        None => None,
    };
    let forward = simulated(&measured, &diagnosis, arguments.closed_loop);
    let extras = Extras { kept_apart, forward };
    if arguments.json.as_deref() != Some(Path::new("-")) {
        print(&summary(&measured, &diagnosis, &extras));
    }
    if let Some(path) = &arguments.json {
        write_json(path, &for_programs(&diagnosis, &extras)?)?;
    }
    if let Some(path) = &arguments.out {
        write_json(path, &improved)?;
    }
    if let Some(path) = &arguments.report {
        write(path, &page(&measured.title, &diagnosis, &extras, &left_out_words(&measured.rows)))?;
    }
    Ok(())
}

/// The motions of the recording with the torques that a reference model gives them: what the robot would have been
/// recorded with before it changed.
fn as_the_reference(path: &Path, options: &RecordingOptions) -> Result<Vec<Trajectory>, Failure> {
    let reference = read_model(path)?;
    let recorded = read(options)?;
    let model = recorded.dynamics.model();
    let chi = known_parameters(&reference, model, path)?;
    recorded
        .motions
        .iter()
        .map(|motion| {
            let effects = term_torques(model, &chi, &reference.effects, motion)
                .map_err(|error| diagnosis_failure(path, &error))?;
            Ok(predicted(model, &chi, motion, effects))
        })
        .collect()
}

/// A motion with the torques of chi added to `torque`.
fn predicted(model: &dyn Model, chi: &[f64], motion: &Motion, mut torque: Vec<Vec<f64>>) -> Trajectory {
    let modelled = torques(model, chi, motion.state_slices().states());
    for (torque, modelled) in torque.iter_mut().flatten().zip(modelled.iter().flatten()) {
        *torque += modelled;
    }
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

/// The recording by forward simulation, where there is something to compare and the recording is short or it was
/// asked for; otherwise why not.
fn simulated(measured: &Measured, diagnosis: &Diagnosis, asked: bool) -> Option<Result<ClosedLoop, String>> {
    let duration: f64 =
        measured.trajectories.iter().filter_map(|t| Some(t.time.last()? - t.time.first()?)).sum();
    if diagnosis.findings.is_empty() || (duration > QUICK && !asked) {
        return None;
    }
    let bar = Bar::new("simulation");
    let progress = |done: f64| bar.share(done, "simulation");
    let model = measured.dynamics.model();
    Some(
        replay(model, &measured.title, &measured.trajectories, diagnosis, &progress)
            .map_err(|error| error.to_string()),
    )
}

/// The same options for another recording of the robot, over all of its time.
fn other(options: &RecordingOptions, path: &Path) -> RecordingOptions {
    RecordingOptions { recording: path.to_path_buf(), from: None, to: None, ..options.clone() }
}

/// What a diagnosis refuses, as the end of a command.
pub(crate) fn diagnosis_failure(recording: &Path, error: &DiagnosisError) -> Failure {
    Failure::Data(format!("{}: {error}", recording.display()))
}

impl Progress for Bar {
    fn at(&self, done: f64, what: &str) {
        self.share(done, what);
    }
}

/// The standard model, or the model with the findings, in the form that `validate` reads.
fn saved(
    robot: &Robot,
    options: &RecordingOptions,
    diagnosis: &Diagnosis,
    with_findings: bool,
) -> Identified {
    let (estimated, errors) = if with_findings {
        (&diagnosis.model, &diagnosis.after)
    } else {
        (&diagnosis.standard, &diagnosis.before)
    };
    let base_parameters = robot
        .base
        .iter()
        .zip(estimated.chi.iter().zip(&estimated.sigma))
        .map(|(base, (&value, &sigma))| NamedParameter {
            name: base.name.to_string(),
            value,
            sigma: Some(sigma),
            relative_sigma_percent: Some(100.0 * sigma / value.abs()).filter(|r| r.is_finite()),
            sigma_blocks: None,
            unit: base.unit.to_string(),
        })
        .collect();
    Identified {
        robot: options.robot.clone().unwrap_or_else(|| robot.name.to_string()),
        method: "diagnosis".to_owned(),
        samples: diagnosis.rows,
        relative_error: errors.relative_error,
        per_joint: errors.per_joint.clone(),
        power_relative_error: None,
        base_parameters,
        essential_parameters: None,
        condition_number: 0.0,
        rows_left_out: 0,
        equations: Vec::new(),
        band: options.sampling.band.unwrap_or(BAND),
        warnings: Vec::new(),
        effects: if with_findings { diagnosis.terms() } else { Vec::new() },
    }
}

/// The errors of both models on a recording that took no part.
fn tested(
    options: &RecordingOptions,
    standard: &Identified,
    improved: &Identified,
) -> Result<KeptApart, Failure> {
    let mut options = options.clone();
    options.sampling.band = Some(standard.band);
    let recorded = read(&options)?;
    let errors = |model: &Identified| prediction(&recorded, model, &options.recording).map(|p| p.errors);
    Ok(KeptApart { name: recorded.title.clone(), before: errors(standard)?, after: errors(improved)? })
}

/// The JSON of the contract: everything but the curves that only a plot needs.
fn for_programs(diagnosis: &Diagnosis, extras: &Extras) -> Result<serde_json::Value, Failure> {
    let mut value = serde_json::to_value(diagnosis)
        .map_err(|error| Failure::Data(format!("the result cannot be written as JSON: {error}")))?;
    if let Some(object) = value.as_object_mut() {
        object.remove("series");
        object.remove("spectra");
        if let Some(test) = &extras.kept_apart {
            object.insert(
                "test".to_owned(),
                serde_json::json!({
                    "recording": test.name,
                    "before": test.before.0, "after": test.after.0,
                    "per_joint_before": test.before.1, "per_joint_after": test.after.1,
                }),
            );
        }
        let forward = match &extras.forward {
            Some(Ok(run)) => serde_json::to_value(run).ok(),
            Some(Err(reason)) => Some(serde_json::json!({ "not_simulated": reason })),
            None => None,
        };
        if let Some(forward) = forward {
            object.insert("closed_loop".to_owned(), forward);
        }
    }
    Ok(value)
}

fn summary(measured: &Measured, diagnosis: &Diagnosis, extras: &Extras) -> String {
    let mut text = format!("{}: {}\n", diagnosis.robot, measured.title);
    for line in left_out_words(&measured.rows) {
        text.push_str(&format!("{line}\n"));
    }
    text.push('\n');
    for sentence in &diagnosis.verdict {
        text.push_str(&format!("{sentence}\n"));
    }
    let mut rows = vec![
        vec![
            "fitted motion".to_owned(),
            percent(diagnosis.before.relative_error),
            percent(diagnosis.after.relative_error),
        ],
        vec![
            format!("held back ({})", diagnosis.held_out.how),
            percent(diagnosis.held_out.before),
            percent(diagnosis.held_out.after),
        ],
    ];
    if let Some(test) = &extras.kept_apart {
        rows.push(vec![format!("kept apart ({})", test.name), percent(test.before.0), percent(test.after.0)]);
    }
    if let Some(Ok(run)) = &extras.forward {
        rows.push(vec!["by forward simulation".to_owned(), percent(run.before), percent(run.after)]);
    }
    text.push('\n');
    text.push_str(&table(&["<relative error of the torques", "before", "after"], rows));
    if let Some(Err(reason)) = &extras.forward {
        text.push_str(&format!("\n{reason}"));
    }
    for finding in &diagnosis.findings {
        text.push_str(&format!("\n\n{} on {}\n", finding.effect, joint_words(&finding.joints)));
        text.push_str(&format!("  {}\n", finding.sentence));
        let numbers: Vec<String> = finding
            .parameters
            .iter()
            .map(|(name, p)| {
                let sigma =
                    if p.sigma > 0.0 { format!(" +- {}", significant(p.sigma, 2)) } else { String::new() };
                format!("{name} {}{sigma} {}", significant(p.value, 4), p.unit)
            })
            .collect();
        text.push_str(&format!("  {}\n", numbers.join(", ")));
        text.push_str(&format!(
            "  held-out error of its joints {} -> {}, {}",
            percent(finding.held_out_before),
            percent(finding.held_out_after),
            confidence_words(finding.confidence)
        ));
    }
    for c in &diagnosis.cannot_tell {
        text.push_str(&format!(
            "\n\ncannot tell {} on {} apart: {}",
            c.between.join(" and "),
            joint_words(&c.joints),
            c.experiment
        ));
    }
    text
}
