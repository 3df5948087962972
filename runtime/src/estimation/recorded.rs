//! A recording from its files to observations: whole where it fits into memory, else piece by piece.

use super::attenuation::UNCERTAINTY;
use super::observe::{Equations, Observation, ObserveError, ObserveSettings, Progress, observe};
use super::{Bandwidth, EncoderNoise, EstimateSettings, Piecewise, Warning, choose_bandwidth, estimate};
use crate::model::Model;
use crate::recording::{Loader, Manifest, RecordingError, RowReport, Trajectory};
use crate::signal::{
    Decimator, Motion, Preparation, SignalError, SpeedFault, contradicting_speeds, prepare_all,
};

/// Rows of a piece of a long recording: what is in memory at once is a few times as much.
pub const PIECE: usize = 100_000;

/// How a recording is filtered and sampled: in a given band, or in the one that the recording carries.
#[derive(Debug, Clone, Default)]
pub struct RecordedSettings {
    /// Band of the rows, Hz; `None`: by [`choose_bandwidth`].
    pub band: Option<f64>,
    /// Cut-off of the position filter, Hz; `None`: that of the band.
    pub cutoff: Option<f64>,
    /// Everything else of the rows; its own band is not used.
    pub rows: ObserveSettings,
}

impl RecordedSettings {
    /// The filters and the rows for these trajectories.
    ///
    /// # Errors
    /// Trajectories that no band can be chosen from.
    pub fn chosen(&self, trajectories: &[Trajectory]) -> Result<(Preparation, ObserveSettings), SignalError> {
        let (band, cutoff) = match self.band {
            Some(band) => (band, Bandwidth::cutoff_of(band, trajectories)),
            None => {
                let chosen = choose_bandwidth(trajectories)?;
                (chosen.band, Some(chosen.cutoff))
            }
        };
        let preparation = Preparation { cutoff: self.cutoff.or(cutoff), ..Preparation::default() };
        let mut rows = ObserveSettings { band, ..self.rows.clone() };
        if let Some(rate) = Bandwidth::rate_of(trajectories) {
            let filter = Decimator::for_rows(rate, rows.band, rows.rate)?;
            rows.acceleration_noise =
                EncoderNoise::of(trajectories)?.in_accelerations(rate, &preparation, &filter)?;
        }
        Ok((preparation, rows))
    }
}

/// A recording that was observed.
#[derive(Debug)]
pub struct ObservedRecording {
    /// One observation of the whole recording for each kind of equations that was asked for.
    pub observations: Vec<Observation>,
    /// Its motions; of a long recording those of its first pieces only.
    pub motions: Vec<Motion>,
    /// Whether the motions are the whole recording.
    pub whole: bool,
    /// How the equations were sampled.
    pub settings: ObserveSettings,
    /// Rows that could not be right.
    pub rows: RowReport,
    /// Columns of speeds that contradict the positions; of a long recording those of its first pieces.
    pub speeds: Vec<SpeedFault>,
    /// Motions, or pieces of them, that gave no rows, and why.
    pub left_out: Vec<String>,
}

/// Why a recording cannot be observed.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ObserveRecordingError {
    /// A file cannot be read or does not fit the robot.
    #[error(transparent)]
    Recording(#[from] RecordingError),
    /// No row lies in the window.
    #[error("no row lies between {} s and {} s", window[0], window[1])]
    NothingInWindow {
        /// The window, s.
        window: [f64; 2],
    },
    /// Its motions cannot be filtered or observed.
    #[error(transparent)]
    Observe(#[from] ObserveError),
}

impl From<SignalError> for ObserveRecordingError {
    fn from(error: SignalError) -> Self {
        Self::Observe(error.into())
    }
}

/// Reads the rows of a recording within a `window` of time, s, and observes them.
///
/// A recording of more than [`PIECE`] rows is read, prepared, observed and dropped piece by piece
/// ([`observe_in_pieces`]). `progress` is told of a shorter one only.
///
/// # Errors
/// Files that cannot be read or do not fit the robot, a window without rows, motions that cannot be filtered or
/// observed.
pub fn observe_recording(
    manifest: &Manifest,
    model: &dyn Model,
    window: Option<[f64; 2]>,
    equations: &[Equations],
    settings: &RecordedSettings,
    progress: Option<Progress<'_>>,
) -> Result<ObservedRecording, ObserveRecordingError> {
    let mut read = |take: &mut Take<'_, ObserveRecordingError>| {
        let mut pieces = Pieces {
            loader: Loader::new(manifest, model.robot(), PIECE)?,
            window,
            names: vec![None; manifest.trajectories.len()],
        };
        let mut is_empty = true;
        while let Some((trajectory, piece)) = pieces.next()? {
            is_empty = false;
            let motion = pieces.motion_of(trajectory, &piece);
            take(piece, motion)?;
        }
        if is_empty {
            let window = window.unwrap_or([f64::NEG_INFINITY, f64::INFINITY]);
            return Err(ObserveRecordingError::NothingInWindow { window });
        }
        Ok(pieces.loader.into_report())
    };
    let (observed, rows) = observe_in_pieces(model, equations, settings, &mut read, progress)?;
    Ok(ObservedRecording { rows, ..observed })
}

/// Takes the next piece of a recording, and the name of the motion that it is of.
pub type Take<'a, E> = dyn FnMut(Trajectory, String) -> Result<(), E> + 'a;

/// Observes a recording that `read` hands over piece by piece. One of more than [`PIECE`] rows is not held: its pieces are
/// prepared, observed and dropped, and the band and the speeds of standstill are those of its first ones.
///
/// Of a recording in whose band the correction for the noise of the encoders is too uncertain ([`observe_trajectories`])
/// a long one is read once more, for a narrower band. What `read` returned the last time is given back.
///
/// # Errors
/// Those of `read`, and motions that cannot be filtered or observed.
pub fn observe_in_pieces<R, E: From<ObserveError>>(
    model: &dyn Model,
    equations: &[Equations],
    settings: &RecordedSettings,
    read: &mut dyn FnMut(&mut Take<'_, E>) -> Result<R, E>,
    progress: Option<Progress<'_>>,
) -> Result<(ObservedRecording, R), E> {
    let mut once = |settings: &RecordedSettings| {
        let mut first: Vec<(Trajectory, String)> = Vec::new();
        let (mut rows, mut long) = (0, None);
        let returned = read(&mut |piece, motion| {
            let Some(long) = &mut long else {
                rows += piece.time.len();
                first.push((piece, motion));
                if rows > PIECE {
                    long = Some(Long::begin(std::mem::take(&mut first), model, equations, settings)?);
                }
                return Ok(());
            };
            long.all.add(&Trajectory { name: motion, ..piece }).map_err(E::from)
        })?;
        let observed = match long {
            Some(long) => long.finish()?,
            None => {
                let whole: Vec<Trajectory> = first.into_iter().map(|(piece, _)| piece).collect();
                observe_trajectories(&whole, model, equations, settings, progress)?
            }
        };
        Ok::<_, E>((observed, returned))
    };
    let observed = once(settings)?;
    if settings.band.is_none()
        && !observed.0.whole
        && let Some(narrower) = narrower_band(&observed.0)
    {
        // Short motions may have no rows in a narrow band.
        return Ok(once(&RecordedSettings { band: Some(narrower), ..settings.clone() }).unwrap_or(observed));
    }
    Ok(observed)
}

/// A recording that is too long to be held, on its way.
struct Long<'a> {
    all: Piecewise<'a>,
    motions: Vec<Motion>,
    settings: ObserveSettings,
    speeds: Vec<SpeedFault>,
}

impl<'a> Long<'a> {
    fn begin(
        first: Vec<(Trajectory, String)>,
        model: &'a dyn Model,
        equations: &'a [Equations],
        settings: &RecordedSettings,
    ) -> Result<Self, ObserveError> {
        let named = |(piece, name)| Trajectory { name, ..piece };
        let first: Vec<Trajectory> = first.into_iter().map(named).collect();
        let (preparation, settings) = settings.chosen(&first)?;
        let speeds = contradicting_speeds(&first, &preparation);
        let (all, motions) = Piecewise::new(model, equations, first, preparation, settings.clone())?;
        Ok(Self { all, motions, settings, speeds })
    }

    fn finish(self) -> Result<ObservedRecording, ObserveError> {
        let Self { all, motions, settings, speeds } = self;
        let (observations, left_out) = all.finish()?;
        let rows = RowReport::default();
        Ok(ObservedRecording { observations, motions, whole: false, settings, rows, speeds, left_out })
    }
}

/// A correction for the noise of the encoders may be this share of the standard deviation beside it: what is not known
/// of it then makes that deviation larger by less than a twentieth.
const CORRECTION: f64 = 0.5;

/// Observes trajectories that fit into memory, and keeps the rows.
///
/// Where no band is asked for it is the one of [`choose_bandwidth`], or a narrower one: accelerations are noisy by the
/// fourth power of the frequency, and what that noise takes away from the inertias is given back, but not for certain.
/// The band is narrowed until the correction is at most half a standard deviation of each parameter of the first
/// equations.
///
/// # Errors
/// Trajectories that cannot be filtered or observed.
pub fn observe_trajectories(
    trajectories: &[Trajectory],
    model: &dyn Model,
    equations: &[Equations],
    settings: &RecordedSettings,
    progress: Option<Progress<'_>>,
) -> Result<ObservedRecording, ObserveError> {
    let observed = |settings: &RecordedSettings| {
        let (preparation, rows) = settings.chosen(trajectories)?;
        let rows = ObserveSettings { keep_rows: true, ..rows };
        let (motions, too_short) = prepare_all(trajectories, &preparation)?;
        let observations = equations
            .iter()
            .map(|&equations| observe(model, &motions, equations, None, &rows, progress))
            .collect::<Result<_, ObserveError>>()?;
        let left_out = too_short.iter().map(SignalError::to_string).collect();
        let settings = ObserveSettings { keep_rows: settings.rows.keep_rows, ..rows };
        let rows = RowReport::default();
        Ok::<_, ObserveError>(ObservedRecording {
            observations,
            motions,
            whole: true,
            settings,
            rows,
            speeds: contradicting_speeds(trajectories, &preparation),
            left_out,
        })
    };
    let mut widest = observed(settings)?;
    if settings.band.is_some() {
        return Ok(widest);
    }
    // Noise in WT W grows with the fifth power of the band, so that once is enough but for rounding.
    for _ in 0..2 {
        let Some(narrower) = narrower_band(&widest) else { break };
        // Short motions may have no rows in a narrow band.
        let Ok(next) = observed(&RecordedSettings { band: Some(narrower), ..settings.clone() }) else {
            break;
        };
        widest = next;
    }
    Ok(widest)
}

/// The band in which the correction for the noise of the encoders is at most [`CORRECTION`], where it is more.
fn narrower_band(observed: &ObservedRecording) -> Option<f64> {
    let ratio = observed.observations.first().map_or(0.0, largest_correction);
    let band = observed.settings.band;
    let narrower = Bandwidth::up_to(band * (CORRECTION / ratio).powf(0.2));
    (ratio > CORRECTION && narrower < band).then_some(narrower)
}

/// The largest correction for the noise of the encoders, in units of the standard deviation beside it; zero where some
/// parameters have nothing but noise to tell them apart, as they have in every band.
fn largest_correction(observation: &Observation) -> f64 {
    if observation.noise_of_columns.is_none() {
        return 0.0;
    }
    let block_sigmas = observation.rows.is_none();
    let settings = EstimateSettings { r_sigma: None, block_sigmas, ..EstimateSettings::default() };
    let found = estimate(observation, &settings);
    if found.warnings.contains(&Warning::NoisyColumns) {
        return 0.0;
    }
    let ratios = found.parameters.into_iter().filter_map(|p| {
        let correction = p.correction?.abs();
        let beside = p.sigma?.powi(2) - (UNCERTAINTY * correction).powi(2);
        (beside > 0.0).then(|| correction / beside.sqrt())
    });
    ratios.fold(0.0, f64::max)
}

/// The pieces of a recording that have rows within a window of time.
struct Pieces<'a> {
    loader: Loader<'a>,
    window: Option<[f64; 2]>,
    /// For each trajectory of the manifest the name of its first piece.
    names: Vec<Option<String>>,
}

impl Pieces<'_> {
    /// The next piece, and the trajectory of the manifest that it is of.
    fn next(&mut self) -> Result<Option<(usize, Trajectory)>, RecordingError> {
        while let Some(piece) = self.loader.next_trajectory()? {
            let inside = match self.window {
                Some(window) => piece.within(window),
                None => Some(piece),
            };
            if let Some(piece) = inside {
                return Ok(Some((self.loader.window(), piece)));
            }
        }
        Ok(None)
    }

    /// Name of the motion that a piece is of: that of the first piece of its trajectory.
    fn motion_of(&mut self, trajectory: usize, piece: &Trajectory) -> String {
        match self.names.get_mut(trajectory) {
            Some(name) => name.get_or_insert_with(|| piece.name.clone()).clone(),
            None => piece.name.clone(),
        }
    }
}
