//! Recordings longer than the memory: prepared, observed and dropped piece by piece.

use super::observe::{Equations, Observation, ObserveError, ObserveSettings, Standstill, observe};
use crate::model::Model;
use crate::recording::Trajectory;
use crate::signal::{Motion, Preparation, SignalError, StandstillSpeeds, prepare, prepare_all};

/// A recording that is observed piece by piece: what is kept is orthogonal factors.
///
/// Every piece is filtered on its own, so that the rows within the reach of the filters from its ends are left out.
/// Pieces with the name of an earlier one continue it.
pub struct Piecewise<'a> {
    model: &'a dyn Model,
    equations: &'a [Equations],
    preparation: Preparation,
    settings: ObserveSettings,
    observations: Vec<Option<Observation>>,
    left_out: Vec<String>,
}

impl<'a> Piecewise<'a> {
    /// Starts with the first pieces, from which the speeds of standstill are taken for all. Gives their motions back.
    /// The threads of the settings prepare, too.
    ///
    /// # Errors
    /// As of the preparation, where none of the pieces can be prepared, and of the observation.
    pub fn new(
        model: &'a dyn Model,
        equations: &'a [Equations],
        first: Vec<Trajectory>,
        mut preparation: Preparation,
        mut settings: ObserveSettings,
    ) -> Result<(Self, Vec<Motion>), ObserveError> {
        settings.keep_rows = false;
        preparation.threads = settings.threads;
        let (motions, too_short) = prepare_all(&first, &preparation)?;
        drop(first);
        if settings.standstill == Standstill::Automatic {
            settings.standstill = Standstill::Detected(StandstillSpeeds::of(&motions));
        }
        let left_out = too_short.iter().map(SignalError::to_string).collect();
        let observations = vec![None; equations.len()];
        let mut all = Self { model, equations, preparation, settings, observations, left_out };
        for motion in &motions {
            all.observe(motion)?;
        }
        Ok((all, motions))
    }

    /// Takes in the next piece. One that is too short, or in which no joint moves, is left out and named.
    ///
    /// # Errors
    /// Stamps or values that cannot be right; misuse of the observation.
    pub fn add(&mut self, piece: &Trajectory) -> Result<(), ObserveError> {
        match prepare(piece, &self.preparation) {
            Ok(motion) => self.observe(&motion),
            Err(error @ SignalError::TooShort { .. }) => {
                self.left_out.push(error.to_string());
                Ok(())
            }
            Err(error) => Err(error.into()),
        }
    }

    fn observe(&mut self, motion: &Motion) -> Result<(), ObserveError> {
        for (equations, merged) in self.equations.iter().zip(&mut self.observations) {
            let piece = std::slice::from_ref(motion);
            match observe(self.model, piece, *equations, None, &self.settings, None) {
                Ok(piece) => match merged {
                    Some(merged) => merged.merge(piece)?,
                    None => *merged = Some(piece),
                },
                Err(ObserveError::NoRows { reason }) => {
                    self.left_out.push(format!("{} from {:.3} s: {reason}", motion.name, motion.start));
                }
                Err(error) => return Err(error),
            }
        }
        Ok(())
    }

    /// One observation for each kind of equations, and the pieces that were left out.
    ///
    /// # Errors
    /// [`ObserveError::NoRows`] where no piece had a row.
    pub fn finish(self) -> Result<(Vec<Observation>, Vec<String>), ObserveError> {
        let reason = self.left_out.first().cloned().unwrap_or_else(|| "there is no motion".to_owned());
        let all: Option<Vec<Observation>> = self.observations.into_iter().collect();
        all.map(|all| (all, self.left_out)).ok_or(ObserveError::NoRows { reason })
    }
}
