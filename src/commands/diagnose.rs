//! `dynid diagnose REC`: which physics is missing, where, and does adding it help on held-out motion?

pub mod compare;
mod extras;
pub mod mistakes;
pub mod reference;

use std::path::{Path, PathBuf};
use std::sync::Arc;

use clap::Args;
use dynid_runtime::confirmation::{ConfirmationError, diagnose_and_confirm};
use dynid_runtime::diagnosis::{Diagnosis, DiagnosisError, Progress, Settings, diagnose};
use dynid_runtime::estimation::choose_bandwidth;
use dynid_runtime::law_file;
use dynid_runtime::model::{JointIndex, Robot};
use dynid_runtime::model_file::{Covariance, EvaluatedRows, Identified};
use dynid_runtime::report::capital;
use dynid_runtime::signal::{Preparation, SpeedFault, contradicting_speeds};
use dynid_runtime::simulation::replay::{ClosedLoop, replay};

use crate::arguments::{DiagnosisOptions, Source};
use crate::compared::residual_file;
use crate::errors::prediction_failure;
use crate::estimated::named;
use crate::failure::Failure;
use crate::origin::recorded_from;
use crate::output::{Bar, can_write, print, write, write_json};
use crate::pages::diagnosis::{Extras, page, summary};
use crate::recorded::{Measured, left_out_words, measure, of_the_same_robot};
use crate::speeds::{and_of_speeds, speed_words};

use compare::{Test, test_words, tested};

/// What to diagnose and where to put it.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    #[command(flatten)]
    recording: Source,
    #[command(flatten)]
    sampling: DiagnosisOptions,
    /// A recording of the same robot before it changed: it is diagnosed first, and only what changed since is looked for
    #[arg(long)]
    baseline: Option<PathBuf>,
    /// A model of the same robot before it changed, saved by `identify` or `diagnose`: its parameters and laws, as well as
    /// it knows them, are no news, nor is what differs anyway between the motions that it is from, where these are as they
    /// were
    #[arg(long, conflicts_with = "baseline")]
    reference: Option<PathBuf>,
    /// Laws of your own that are tried beside those of the catalogue: a YAML list of {id, joint, law, unit, shapes}
    #[arg(long)]
    laws: Option<PathBuf>,
    /// A test recording, which takes no part in the diagnosis: the errors on it are reported before and after
    #[arg(long)]
    test: Option<PathBuf>,
    /// Simulate the identified robot along the recorded motion without and with the findings, however long the
    /// recording (up to 30 s of motion it is done anyway)
    #[arg(long)]
    closed_loop: bool,
    /// Diagnose even where a wrong sign, order, unit or robot explains the recording far better
    #[arg(long)]
    implausible: bool,
    /// Save the model with the effects that were found
    #[arg(long)]
    out: Option<PathBuf>,
    /// Write a page with the verdict, the plots and the numbers
    #[arg(long)]
    report: Option<PathBuf>,
    /// Write states, torques and residuals row by row: a table (.csv, .parquet) or messages (.mcap)
    #[arg(long, value_name = "FILE", value_parser = residual_file)]
    residuals: Option<PathBuf>,
    /// Write the result for other programs; `-` is standard output
    #[arg(long)]
    json: Option<PathBuf>,
}

/// Motion that is simulated without being asked for, s.
const QUICK: f64 = 30.0;

/// Diagnoses, prints, saves.
pub(super) fn run(arguments: &Arguments, words: &[String]) -> Result<(), Failure> {
    let source = &arguments.recording;
    can_write([&arguments.json, &arguments.out, &arguments.residuals, &arguments.report])?;
    let measured = measure(source)?;
    let model = measured.dynamics.model();
    let mut baseline = match &arguments.baseline {
        Some(path) => of_the_same_robot(measure(&source.other(path))?, &measured, path)?.trajectories,
        None => Vec::new(),
    };
    if !arguments.implausible {
        mistakes::check(&source.recording, &measured, &arguments.sampling)?;
    }
    let mut settings = settings(&arguments.sampling, model.robot().joints());
    let mut lost = None;
    if let Some(path) = &arguments.reference {
        let before = reference::read(path, (source, &measured))?;
        settings.reference = Some(Arc::new(before.reference));
        (baseline, lost) = (before.origin.motions, before.origin.lost);
    }
    if let Some(path) = &arguments.laws {
        settings.laws =
            law_file::read(path, model.robot()).map_err(|error| Failure::Input(error.to_string()))?;
    }
    let test = match &arguments.test {
        Some(path) => {
            let test = of_the_same_robot(measure(&source.other(path))?, &measured, path)?;
            Some(Test::new(test, path, &arguments.sampling)?)
        }
        None => None,
    };
    let speeds = contradicting(&measured, &arguments.sampling);
    let bar = Bar::new("diagnosis");
    let outcome = match &test {
        Some(test) => {
            diagnose_and_confirm(model, &measured.trajectories, &baseline, &test.prepared, &settings, &bar)
        }
        None => diagnose(model, &measured.trajectories, &baseline, &settings, &bar).map_err(Into::into),
    };
    drop(bar);
    let failure =
        |error: ConfirmationError| confirmation_failure(&source.recording, arguments.test.as_deref(), &error);
    let robot = model.robot();
    let mut diagnosis =
        outcome.map_err(|error| and_of_speeds(failure(error), &speed_words(&speeds, robot)))?;
    tell_speeds(&mut diagnosis, speeds, robot);
    diagnosis.verdict.extend(lost);
    let tested = match (&test, &arguments.test) {
        (Some(test), Some(path)) => Some(tested(test, path, &diagnosis)?),
        _ => None,
    };
    diagnosis.verdict.extend(tested.as_ref().and_then(|tested| test_words(tested, &diagnosis)));
    let extras = extras::of(arguments, words, &measured, &diagnosis, tested)?;
    hand_out(arguments, &measured, &diagnosis, &extras)
}

/// Prints, and writes what was asked for.
fn hand_out(
    arguments: &Arguments,
    measured: &Measured,
    diagnosis: &Diagnosis,
    extras: &Extras,
) -> Result<(), Failure> {
    if arguments.json.as_deref() != Some(Path::new("-")) {
        print(&summary(measured, diagnosis, extras));
    }
    if let Some(path) = &arguments.json {
        write_json(path, &for_programs(diagnosis, extras)?)?;
    }
    if let Some(path) = &arguments.out {
        let recording = Some(recorded_from(&arguments.recording, path)?);
        write_json(path, &Identified { recording, ..improved(measured, diagnosis, extras) })?;
    }
    if let Some(path) = &arguments.residuals {
        let Some(compared) = extras.compared() else {
            return Err(Failure::Data(format!(
                "{}: too short for rows of 25 Hz bandwidth, of which --residuals are",
                arguments.recording.recording.display()
            )));
        };
        compared.write(path, &measured.joints)?;
    }
    if let Some(path) = &arguments.report {
        write(path, &page(&measured.title, diagnosis, extras, &left_out_words(&measured.rows)))?;
    }
    Ok(())
}

/// The settings of a diagnosis as they were asked for.
fn settings(options: &DiagnosisOptions, joints: usize) -> Settings {
    let mut settings = Settings::default();
    settings.band = options.band;
    settings.cutoff = options.cutoff;
    settings.standstill_speeds = options.speeds(joints);
    settings.single_joint_contacts = !options.no_single_joint_contacts;
    settings.threads = options.threads;
    settings
}

/// The recording by forward simulation, where there is something to compare and the recording is short or it was
/// asked for; otherwise why not.
fn simulated(measured: &Measured, diagnosis: &Diagnosis, asked: bool) -> Option<Result<ClosedLoop, String>> {
    let duration: f64 =
        measured.trajectories.iter().filter_map(|t| Some(t.time.last()? - t.time.first()?)).sum();
    let nothing_moves = diagnosis.not_judged.len() == measured.dynamics.model().robot().joints();
    if diagnosis.findings.is_empty() || nothing_moves || (duration > QUICK && !asked) {
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

/// Tells of columns of speeds that contradict the positions, where their joints moved.
pub fn tell_speeds(diagnosis: &mut Diagnosis, speeds: Vec<SpeedFault>, robot: &Robot) {
    // The speed of a joint that stands is noise.
    let moves = |f: &SpeedFault| {
        !diagnosis.not_judged.iter().any(|n| n.joint == robot.joint_number(JointIndex(f.joint)).0)
    };
    let speeds: Vec<SpeedFault> = speeds.into_iter().filter(moves).collect();
    diagnosis.verdict.extend(speed_words(&speeds, robot).iter().map(|words| format!("{}.", capital(words))));
}

/// Columns of speeds that contradict the positions, in the band of the diagnosis.
pub fn contradicting(measured: &Measured, options: &DiagnosisOptions) -> Vec<SpeedFault> {
    let chosen = || choose_bandwidth(&measured.trajectories).ok().map(|chosen| chosen.cutoff);
    let cutoff = options.cutoff.or_else(chosen);
    contradicting_speeds(&measured.trajectories, &Preparation { cutoff, ..Preparation::default() })
}

/// What a diagnosis with a test recording refuses, as the end of a command.
pub fn confirmation_failure(recording: &Path, test: Option<&Path>, error: &ConfirmationError) -> Failure {
    match (error, test) {
        (ConfirmationError::Test(error), Some(path)) => prediction_failure(path, error),
        (ConfirmationError::Diagnosis(error), _) => diagnosis_failure(recording, error),
        (error, _) => Failure::Data(format!("{}: {error}", recording.display())),
    }
}

/// What a diagnosis refuses, as the end of a command.
pub fn diagnosis_failure(recording: &Path, error: &DiagnosisError) -> Failure {
    let words = format!("{}: {error}", recording.display());
    match error {
        DiagnosisError::Setting { .. } | DiagnosisError::StandstillSpeeds { .. } => Failure::Input(words),
        _ => Failure::Data(words),
    }
}

impl Progress for Bar {
    fn at(&self, done: f64, what: &str) {
        self.share(done, what);
    }
}

/// The model with the findings, in the form that `validate` and `simulate` read.
pub fn improved(measured: &Measured, diagnosis: &Diagnosis, extras: &Extras) -> Identified {
    let robot = measured.dynamics.model().robot();
    let parameters = named(robot, &diagnosis.model);
    let own = || EvaluatedRows {
        samples: measured.trajectories.iter().map(|t| t.time.len()).sum(),
        rows_left_out: None,
        equations: Vec::new(),
        band: diagnosis.sampling.band,
        errors: diagnosis.after.clone(),
        noise: None,
    };
    let mut rows = extras.evaluation().and_then(|e| EvaluatedRows::evaluated(e, 1)).unwrap_or_else(own);
    rows.rows_left_out = Some(measured.rows.rows.left_out);
    Identified {
        effects: diagnosis.terms(),
        delay: diagnosis.delay,
        delay_sigma: Some(diagnosis.delay_sigma),
        standstill: Some(diagnosis.sampling.standstill_speeds.clone()),
        between_motions: diagnosis.between_motions.clone(),
        covariance: diagnosis.covariance.clone().and_then(|upper| {
            let amplitudes: Vec<usize> = diagnosis.terms().iter().map(|t| t.amplitude.len()).collect();
            Covariance::new(robot, &amplitudes, upper)
        }),
        ..Identified::with_parameters(robot, &measured.robot, "diagnosis", rows, parameters)
    }
}

/// The JSON of the contract: everything but the curves that only a plot needs.
///
/// # Errors
/// [`Failure::Data`] where a number of it has no form in JSON.
pub fn for_programs(diagnosis: &Diagnosis, extras: &Extras) -> Result<serde_json::Value, Failure> {
    let mut value = serde_json::to_value(diagnosis)
        .map_err(|error| Failure::Data(format!("the result cannot be written as JSON: {error}")))?;
    let Some(object) = value.as_object_mut() else { return Ok(value) };
    object.remove("series");
    object.remove("spectra");
    if let Some(evaluation) = extras.evaluation() {
        for (key, prediction) in ["before", "after"].into_iter().zip(&evaluation.predictions) {
            let mut errors = serde_json::json!(prediction.errors);
            errors["band"] = evaluation.band.into();
            object.insert(key.to_owned(), errors);
        }
    }
    if let Some(test) = &extras.tested
        && let [before, after] = test.evaluation.predictions.as_slice()
    {
        let test = serde_json::json!({
            "recording": test.name,
            "band": test.evaluation.band,
            "rows": test.evaluation.used(),
            "noise": after.noise.as_ref().map(|noise| noise.relative_error),
            "noise_before": before.noise.as_ref().map(|noise| noise.relative_error),
            "before": before.errors.relative_error, "after": after.errors.relative_error,
            "per_joint_before": before.errors.per_joint, "per_joint_after": after.errors.per_joint,
        });
        object.insert("test".to_owned(), test);
    }
    let forward = match &extras.forward {
        Some(Ok(run)) => serde_json::to_value(run).ok(),
        Some(Err(reason)) => Some(serde_json::json!({ "not_simulated": reason })),
        None => None,
    };
    if let Some(forward) = forward {
        object.insert("closed_loop".to_owned(), forward);
    }
    Ok(value)
}
