//! From the path of a recording to motions that a model can be evaluated on.

use std::path::Path;

use dynid_runtime::estimation::observe::{Equations, Observation, ObserveError, ObserveSettings};
use dynid_runtime::estimation::{
    ObserveRecordingError, ObservedRecording, RecordedSettings, observe_recording,
};
use dynid_runtime::model::Robot;
use dynid_runtime::model_file::difference;
use dynid_runtime::plausibility::Judged;
use dynid_runtime::recording::{Manifest, RecordingError, RowReport, Side, Trajectory, load};
use dynid_runtime::signal::{Motion, SignalError, SpeedFault, contradicting_speeds, prepare_all};

use crate::arguments::{Sampling, Source};
use crate::failure::Failure;
use crate::output::{Bar, on_one_line};
use crate::robots::{Dynamics, found_again, resolve};

/// A recording that was read.
pub struct Measured {
    /// The robot's dynamics.
    pub dynamics: Dynamics,
    /// The title of the recording.
    pub title: String,
    /// How the robot is found again: its name, or the path of its YAML.
    pub robot: String,
    /// Names of the joints in the log, where the manifest says them.
    pub joints: Vec<String>,
    /// Side of the gear that was recorded.
    pub side: Side,
    /// Its motions as measured, within the window that was asked for.
    pub trajectories: Vec<Trajectory>,
    /// What was left out.
    pub rows: LeftOut,
}

/// What of the files was not used.
#[derive(Debug, Clone, Default)]
pub struct LeftOut {
    /// Rows that could not be right.
    pub rows: RowReport,
    /// Motions, or pieces between two gaps, that are too short to be filtered.
    pub too_short: Vec<String>,
}

/// A recording that was read and prepared.
pub struct Recorded {
    /// The robot's dynamics.
    pub dynamics: Dynamics,
    /// The title of the recording.
    pub title: String,
    /// How the robot is found again: its name, or the path of its YAML.
    pub robot: String,
    /// Names of the joints in the log, where the manifest says them.
    pub joints: Vec<String>,
    /// Side of the gear that was recorded.
    pub side: Side,
    /// Its motions: filtered, differentiated, on a uniform grid.
    pub motions: Vec<Motion>,
    /// What was left out.
    pub rows: LeftOut,
    /// Columns of speeds that contradict the positions.
    pub speeds: Vec<SpeedFault>,
    /// How equations are sampled from it.
    pub settings: ObserveSettings,
}

impl Recorded {
    /// What its plausibility is judged by.
    pub fn judged(&self) -> Judged<'_> {
        Judged {
            model: self.dynamics.model(),
            motions: &self.motions,
            settings: &self.settings,
            motor_side: self.side == Side::Motor,
        }
    }

    /// The robot and the title, on one line.
    pub fn heading(&self) -> String {
        heading(self.dynamics.model().robot(), &self.title)
    }
}

/// A robot and the title of its recording, on one line.
pub fn heading(robot: &Robot, title: &str) -> String {
    titled(&robot.name, title)
}

/// The name of a robot and a title, where there is one.
pub fn titled(robot: &str, title: &str) -> String {
    if title.is_empty() { robot.to_owned() } else { format!("{robot}: {title}") }
}

/// Reads a recording.
///
/// # Errors
/// [`Failure::Input`] for what is wrong in a file, [`Failure::Data`] where the rows cannot support an answer.
pub fn measure(options: &Source) -> Result<Measured, Failure> {
    let (manifest, dynamics, robot) = opened(options)?;
    measure_as(options, manifest, dynamics, robot)
}

/// Reads the recording of a manifest as one of a robot that was found before; `robot` is how it is found again.
///
/// # Errors
/// As of [`measure`].
pub fn measure_as(
    options: &Source,
    manifest: Manifest,
    dynamics: Dynamics,
    robot: String,
) -> Result<Measured, Failure> {
    let window = window(options.from, options.to)?;
    let recording = load(&manifest, dynamics.model().robot()).map_err(recording_failure)?;
    let trajectories: Vec<Trajectory> = match window {
        Some(window) => recording.trajectories.iter().filter_map(|t| t.within(window)).collect(),
        None => recording.trajectories,
    };
    if trajectories.is_empty() {
        return Err(nothing_in_window(options));
    }
    let rows = LeftOut { rows: recording.rows, too_short: Vec::new() };
    let title = on_one_line(&manifest.title);
    let (joints, side) = (manifest.joints, manifest.side);
    Ok(Measured { dynamics, title, robot, joints, side, trajectories, rows })
}

/// Prepares the motions of a recording.
///
/// # Errors
/// [`Failure::Data`] where no motion can be prepared.
pub fn prepared(measured: Measured, options: &Source, sampling: &Sampling) -> Result<Recorded, Failure> {
    let Measured { dynamics, title, robot, joints: names, side, trajectories, mut rows } = measured;
    let joints = dynamics.model().robot().joints();
    let failed = |error: SignalError| signal_failure(&options.recording, &error);
    let (preparation, settings) =
        recorded_settings(sampling, joints).chosen(&trajectories).map_err(failed)?;
    let (motions, too_short) = prepare_all(&trajectories, &preparation).map_err(failed)?;
    rows.too_short = too_short.iter().map(SignalError::to_string).collect();
    let speeds = contradicting_speeds(&trajectories, &preparation);
    Ok(Recorded { dynamics, title, robot, joints: names, side, motions, rows, speeds, settings })
}

/// [`measure`] and [`prepared`].
///
/// # Errors
/// As theirs.
pub fn read(options: &Source, sampling: &Sampling) -> Result<Recorded, Failure> {
    prepared(measure(options)?, options, sampling)
}

/// A recording that was observed.
pub struct Observed {
    /// The recording; of a long one the motions of its first pieces only.
    pub recorded: Recorded,
    /// One observation of the whole recording for each kind of equations that was asked for.
    pub observations: Vec<Observation>,
    /// Whether the motions are the whole recording.
    pub whole: bool,
}

/// Reads and observes a recording. One of more than [`dynid_runtime::estimation::PIECE`] rows is read, prepared, observed and dropped piece by
/// piece; the band and the speeds of standstill then are those of its first pieces.
///
/// # Errors
/// As of [`read`] and of the observation.
pub fn read_observed(
    options: &Source,
    sampling: &Sampling,
    equations: &[Equations],
) -> Result<Observed, Failure> {
    let (manifest, dynamics, robot) = opened(options)?;
    let window = window(options.from, options.to)?;
    let model = dynamics.model();
    let settings = recorded_settings(sampling, model.robot().joints());
    let bar = Bar::new("samples");
    let progress = |done, all| bar.at(done, all);
    let observed = observe_recording(&manifest, model, window, equations, &settings, Some(&progress));
    drop(bar);
    let observed = observed.map_err(|error| match error {
        ObserveRecordingError::Recording(error) => recording_failure(error),
        ObserveRecordingError::NothingInWindow { .. } => nothing_in_window(options),
        ObserveRecordingError::Observe(error) => observe_failure(&options.recording, &error),
        other => Failure::Input(in_recording(&options.recording, &other)),
    })?;
    let ObservedRecording { observations, motions, whole, settings, rows, speeds, left_out } = observed;
    let rows = LeftOut { rows, too_short: left_out };
    let (title, side, joints) = (on_one_line(&manifest.title), manifest.side, manifest.joints);
    let recorded = Recorded { dynamics, title, robot, joints, side, motions, rows, speeds, settings };
    Ok(Observed { recorded, observations, whole })
}

/// The manifest, the robot that is meant, and how it is found again.
fn opened(options: &Source) -> Result<(Manifest, Dynamics, String), Failure> {
    let manifest = Manifest::read(&options.recording).map_err(recording_failure)?;
    let (name, beside) = match &options.robot {
        Some(name) => (name, None),
        None => (&manifest.robot, Some(manifest.folder.as_path())),
    };
    let dynamics = resolve(name, beside)?;
    let found = found_again(&dynamics, name, beside);
    Ok((manifest, dynamics, found))
}

fn nothing_in_window(options: &Source) -> Failure {
    Failure::Data(format!("{}: no row lies between --from and --to", options.recording.display()))
}

/// How a recording is filtered and sampled, by the rule or as asked for.
fn recorded_settings(sampling: &Sampling, joints: usize) -> RecordedSettings {
    RecordedSettings { band: sampling.band, cutoff: sampling.rows.cutoff, rows: sampling.settings(joints) }
}

/// What the observation refuses, as the end of a command.
pub fn observe_failure(recording: &Path, error: &ObserveError) -> Failure {
    match error {
        ObserveError::NoRows { .. } => Failure::Data(in_recording(recording, error)),
        ObserveError::Signal(signal) => signal_failure(recording, signal),
        _ => Failure::Input(in_recording(recording, error)),
    }
}

/// What the filters refuse, as the end of a command: a frequency that was asked for, or what the motions are like.
fn signal_failure(recording: &Path, error: &SignalError) -> Failure {
    let words = in_recording(recording, error);
    match error {
        SignalError::Cutoff { .. } | SignalError::Band(_) | SignalError::TooManyTaps(_) => {
            Failure::Input(words)
        }
        _ => Failure::Data(words),
    }
}

/// The window that was asked for.
fn window(from: Option<f64>, to: Option<f64>) -> Result<Option<[f64; 2]>, Failure> {
    if from.is_none() && to.is_none() {
        return Ok(None);
    }
    let window = [from.unwrap_or(f64::NEG_INFINITY), to.unwrap_or(f64::INFINITY)];
    if window[0] < window[1] {
        Ok(Some(window))
    } else {
        Err(Failure::Input(format!("--from {} is not before --to {}", window[0], window[1])))
    }
}

/// What reading a recording refuses, as the end of a command.
pub fn recording_failure(error: RecordingError) -> Failure {
    if error.is_about_data() { Failure::Data(error.to_string()) } else { Failure::Input(error.to_string()) }
}

fn in_recording(path: &Path, error: &dyn std::error::Error) -> String {
    format!("{}: {error}", path.display())
}

/// What of the files was not used: a line about the rows that were left out, the first of them, the cuts; nothing
/// where every row was used.
pub fn left_out_words(left_out: &LeftOut) -> Vec<String> {
    let rows = &left_out.rows;
    let mut words = Vec::new();
    if rows.left_out > 0 {
        let reasons: Vec<String> =
            rows.by_reason.iter().map(|(reason, count)| format!("{count} {reason}")).collect();
        words.push(format!("{} of {} rows left out: {}", rows.left_out, rows.rows, reasons.join(", ")));
        words.extend(rows.examples.iter().map(|row| format!("  {row}")));
    }
    words.extend(rows.cuts.iter().map(|cut| {
        format!("{}: cut between {:.3} s and {:.3} s: {}", cut.trajectory, cut.after, cut.until, cut.what)
    }));
    words.extend(rows.notes.iter().cloned());
    words.extend(left_out.too_short.iter().map(|what| format!("left out: {what}")));
    words
}

/// Another recording, where it is one of the same robot.
///
/// # Errors
/// [`Failure::Input`] naming the recording, and what of its robot is another.
pub fn of_the_same_robot(other: Measured, measured: &Measured, path: &Path) -> Result<Measured, Failure> {
    let [robot, its] = [measured, &other].map(|m| m.dynamics.model().robot());
    match difference(its, robot) {
        None => Ok(other),
        Some(what) => Err(Failure::Input(format!(
            "{}: a recording of {}, not of the {} that is diagnosed ({what}); record the same robot, or correct robot: there",
            path.display(),
            its.name,
            robot.name
        ))),
    }
}
