//! In which band, and on which rows, models are compared.

use super::predictor::PredictionError;
use crate::estimation::observe::{ObserveError, ObserveSettings, Standstill};
use crate::estimation::{Bandwidth, choose_bandwidth};
use crate::recording::Trajectory;
use crate::signal::{Motion, Preparation, SignalError, prepare_all};

/// How a recording is sampled for a comparison. The default is the same for every model and recording.
///
/// The band is the smaller of what is asked for, [`Comparison::BAND`] where nothing is, and what the recording itself
/// carries by [`choose_bandwidth`]. The band that a model was identified in has no part in it: a model from a fast
/// recording is judged on a slow one where the slow one says something, not on its noise.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Comparison {
    /// Widest band, Hz; `None`: [`Comparison::BAND`].
    pub band: Option<f64>,
    /// Rows a second, Hz; `None`: twice the band.
    pub rate: Option<f64>,
    /// Cut-off of the position filter, Hz; `None`: twice the band, at most a fifth of the recording's rate.
    pub cutoff: Option<f64>,
    /// What is done with rows where a joint hardly moves.
    pub standstill: Standstill,
    /// Threads; 0: as many as the machine has.
    pub threads: usize,
}

/// A recording ready for [`super::evaluate`].
#[derive(Debug, Clone)]
pub struct Prepared {
    /// Its motions.
    pub motions: Vec<Motion>,
    /// How rows are sampled from them.
    pub settings: ObserveSettings,
    /// Pieces that are too short for the filters.
    pub too_short: Vec<SignalError>,
    /// The widest band that the recording carries, Hz.
    pub carried: f64,
}

impl Comparison {
    /// Band in which models are compared where nothing else is asked for, Hz.
    pub const BAND: f64 = 25.0;

    /// Filters the motions of a recording and settles the band.
    ///
    /// # Errors
    /// A band that is not positive, stamps or values that cannot be right, or motions that are all too short for the
    /// filters.
    pub fn prepare(&self, trajectories: &[Trajectory]) -> Result<Prepared, PredictionError> {
        if let Some(band) = self.band.filter(|band| !(band.is_finite() && *band > 0.0)) {
            return Err(ObserveError::Frequency { what: "band", value: band }.into());
        }
        let carried = choose_bandwidth(trajectories)?.band;
        let band = self.band.unwrap_or(Self::BAND).min(carried);
        let cutoff = self.cutoff.or_else(|| Bandwidth::cutoff_of(band, trajectories));
        let preparation = Preparation { cutoff, threads: self.threads, ..Preparation::default() };
        let (motions, too_short) = prepare_all(trajectories, &preparation)?;
        let settings = ObserveSettings {
            band,
            rate: self.rate,
            standstill: self.standstill.clone(),
            threads: self.threads,
            ..ObserveSettings::default()
        };
        Ok(Prepared { motions, settings, too_short, carried })
    }
}
