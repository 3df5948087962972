//! From the path of a recording to motions that a model can be evaluated on.

use std::path::Path;

use dynid_runtime::estimation::observe::{Equations, Observation, ObserveError, ObserveSettings, observe};
use dynid_runtime::estimation::{Bandwidth, Piecewise, choose_bandwidth};
use dynid_runtime::model::Robot;
use dynid_runtime::recording::{Loader, Manifest, RecordingError, RowReport, Side, Trajectory, load};
use dynid_runtime::signal::{Motion, Preparation, SignalError, prepare_all};

use crate::arguments::{Sampling, Source};
use crate::failure::Failure;
use crate::output::Bar;
use crate::robots::{Dynamics, found_again, resolve};

/// A recording that was read.
pub struct Measured {
    /// The robot's dynamics.
    pub dynamics: Dynamics,
    /// The title of the recording.
    pub title: String,
    /// How the robot is found again: its name, or the path of its YAML.
    pub robot: String,
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
    /// Side of the gear that was recorded.
    pub side: Side,
    /// Its motions: filtered, differentiated, on a uniform grid.
    pub motions: Vec<Motion>,
    /// What was left out.
    pub rows: LeftOut,
    /// How equations are sampled from it.
    pub settings: ObserveSettings,
}

impl Recorded {
    /// The robot and the title, on one line.
    pub fn heading(&self) -> String {
        heading(self.dynamics.model().robot(), &self.title)
    }
}

/// A robot and the title of its recording, on one line.
pub fn heading(robot: &Robot, title: &str) -> String {
    if title.is_empty() { robot.name.to_string() } else { format!("{}: {title}", robot.name) }
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
    Ok(Measured { dynamics, title: manifest.title, robot, side: manifest.side, trajectories, rows })
}

/// Prepares the motions of a recording.
///
/// # Errors
/// [`Failure::Data`] where no motion can be prepared.
pub fn prepared(measured: Measured, options: &Source, sampling: &Sampling) -> Result<Recorded, Failure> {
    let Measured { dynamics, title, robot, side, trajectories, mut rows } = measured;
    let joints = dynamics.model().robot().joints();
    let (preparation, settings) = bandwidth(options, sampling, &trajectories, joints)?;
    let (motions, too_short) = prepare_all(&trajectories, &preparation)
        .map_err(|error| Failure::Data(in_recording(&options.recording, &error)))?;
    rows.too_short = too_short.iter().map(SignalError::to_string).collect();
    Ok(Recorded { dynamics, title, robot, side, motions, rows, settings })
}

/// [`measure`] and [`prepared`].
///
/// # Errors
/// As theirs.
pub fn read(options: &Source, sampling: &Sampling) -> Result<Recorded, Failure> {
    prepared(measure(options)?, options, sampling)
}

/// Rows of a piece of a long recording: what is in memory at once is a few times as much.
pub const PIECE: usize = 100_000;

/// A recording that was observed.
pub struct Observed {
    /// The recording; of a long one the motions of its first pieces only.
    pub recorded: Recorded,
    /// One observation of the whole recording for each kind of equations that was asked for.
    pub observations: Vec<Observation>,
    /// Whether the motions are the whole recording.
    pub whole: bool,
}

/// Reads and observes a recording. One of more than [`PIECE`] rows is read, prepared, observed and dropped piece by
/// piece; the band and the speeds of standstill then are those of its first pieces.
///
/// # Errors
/// As of [`read`] and of the observation.
pub fn read_observed(
    options: &Source,
    sampling: &Sampling,
    equations: &[Equations],
) -> Result<Observed, Failure> {
    let failure = |error: ObserveError| observe_failure(&options.recording, &error);
    let (manifest, dynamics, robot) = opened(options)?;
    let window = window(options.from, options.to)?;
    let model = dynamics.model();
    let mut loader = Loader::new(&manifest, model.robot(), PIECE).map_err(recording_failure)?;
    let mut first = Vec::new();
    let mut names = vec![None; manifest.trajectories.len()];
    let (mut rows, mut long) = (0, false);
    while let Some(piece) = next_piece(&mut loader, window)? {
        rows += piece.time.len();
        first.push((loader.window(), piece));
        long = rows > PIECE;
        if long {
            break;
        }
    }
    if first.is_empty() {
        return Err(nothing_in_window(options));
    }
    if !long {
        let rows = LeftOut { rows: loader.into_report(), too_short: Vec::new() };
        let trajectories = first.into_iter().map(|(_, piece)| piece).collect();
        let (title, side) = (manifest.title, manifest.side);
        let measured = Measured { dynamics, title, robot, side, trajectories, rows };
        let recorded = prepared(measured, options, sampling)?;
        let bar = Bar::new("samples");
        let progress = |done, all| bar.at(done, all);
        let model = recorded.dynamics.model();
        let observations = equations
            .iter()
            .map(|&e| observe(model, &recorded.motions, e, None, &recorded.settings, Some(&progress)))
            .collect::<Result<_, _>>()
            .map_err(failure)?;
        return Ok(Observed { recorded, observations, whole: true });
    }
    // Pieces of one window of the recording are one trajectory: they get its first piece's name.
    let mut named = |window: usize, mut piece: Trajectory| {
        if let Some(name) = names.get_mut(window) {
            piece.name = name.get_or_insert(piece.name).clone();
        }
        piece
    };
    let first: Vec<Trajectory> = first.into_iter().map(|(window, piece)| named(window, piece)).collect();
    let (preparation, settings) = bandwidth(options, sampling, &first, model.robot().joints())?;
    let (mut all, motions) =
        Piecewise::new(model, equations, first, preparation, settings.clone()).map_err(failure)?;
    while let Some(piece) = next_piece(&mut loader, window)? {
        all.add(&named(loader.window(), piece)).map_err(failure)?;
    }
    let (observations, too_short) = all.finish().map_err(failure)?;
    let rows = LeftOut { rows: loader.into_report(), too_short };
    let (title, side) = (manifest.title.clone(), manifest.side);
    let recorded = Recorded { title, robot, side, motions, rows, settings, dynamics };
    Ok(Observed { recorded, observations, whole: false })
}

/// The next piece that has rows within the window.
fn next_piece(loader: &mut Loader<'_>, window: Option<[f64; 2]>) -> Result<Option<Trajectory>, Failure> {
    while let Some(piece) = loader.next_trajectory().map_err(recording_failure)? {
        let inside = match window {
            Some(window) => piece.within(window),
            None => Some(piece),
        };
        if inside.is_some() {
            return Ok(inside);
        }
    }
    Ok(None)
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
fn bandwidth(
    options: &Source,
    sampling: &Sampling,
    trajectories: &[Trajectory],
    joints: usize,
) -> Result<(Preparation, ObserveSettings), Failure> {
    let (band, cutoff) = match sampling.band {
        Some(band) => (band, Bandwidth::cutoff_of(band, trajectories)),
        None => {
            let chosen = choose_bandwidth(trajectories)
                .map_err(|error| Failure::Data(in_recording(&options.recording, &error)))?;
            (chosen.band, Some(chosen.cutoff))
        }
    };
    let preparation = Preparation { cutoff: sampling.rows.cutoff.or(cutoff), ..Preparation::default() };
    Ok((preparation, sampling.settings(joints, band)))
}

/// What the observation refuses, as the end of a command.
pub fn observe_failure(recording: &Path, error: &ObserveError) -> Failure {
    match error {
        ObserveError::NoRows { .. } | ObserveError::Signal(_) => {
            Failure::Data(in_recording(recording, error))
        }
        _ => Failure::Input(in_recording(recording, error)),
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
    words.extend(left_out.too_short.iter().map(|what| format!("left out: {what}")));
    words
}
