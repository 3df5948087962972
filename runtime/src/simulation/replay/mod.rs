//! A diagnosis checked by forward simulation: the identified robot follows the recorded motion in closed loop, once
//! without and once with what was found, and its torques are set beside the recorded ones.

mod compare;
mod follow;
#[cfg(test)]
mod tests;

pub use compare::{ClosedLoop, Compared};

use crate::diagnosis::Diagnosis;
use crate::effects::EffectTerm;
use crate::estimation::choose_bandwidth;
use crate::model::Model;
use crate::recording::Trajectory;
use crate::signal::{Preparation, SignalError, prepare_all};
use crate::simulation::error::SimulationError;
use compare::{Comparison, shifted, smooth};
use follow::{follow, left_out};
use std::fmt;
use thiserror::Error;

/// Torques are compared below this frequency, Hz, or the recording's own band where that is lower.
const BAND: f64 = 25.0;

/// Which of the two models is simulated.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Variant {
    /// The standard model.
    Without,
    /// The model with the findings.
    With,
}

impl fmt::Display for Variant {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Without => "without",
            Self::With => "with",
        })
    }
}

/// Why a recording cannot be set beside a simulation.
#[derive(Debug, Error)]
#[non_exhaustive]
pub enum ReplayError {
    /// The identified parameters are no robot that could move: not every set that fits torques is.
    #[error("the identified robot cannot be simulated {which} the findings: {error}")]
    Simulation {
        /// With which of the two.
        which: Variant,
        /// What the simulation says.
        error: SimulationError,
    },
    /// The recording cannot be prepared.
    #[error(transparent)]
    Signal(#[from] SignalError),
    /// The diagnosis is one of a robot with another number of joints.
    #[error("the diagnosis has speeds of standstill for {found} joints, the robot has {expected}")]
    Joints {
        /// Joints of the robot.
        expected: usize,
        /// Speeds of standstill in the diagnosis.
        found: usize,
    },
}

/// Lets the standard model and the model with the findings follow the motions of a recording.
///
/// The controller feeds the standard model's torque forward and closes the loop on the positions with the robot's
/// nominal gains, or with gains that place every joint's poles at 8 Hz. Torques are compared where a joint is faster than
/// the diagnosis's speed of standstill. `name` is what the recording is called; `progress` gets the share that is done.
///
/// # Errors
/// Parameters that cannot be simulated, motions that cannot be prepared, a diagnosis of another robot.
pub fn replay(
    model: &dyn Model,
    name: &str,
    motions: &[Trajectory],
    diagnosis: &Diagnosis,
    progress: &dyn Fn(f64),
) -> Result<ClosedLoop, ReplayError> {
    let chosen = choose_bandwidth(motions)?;
    let band = chosen.band.min(BAND);
    let settings = Preparation { cutoff: Some(chosen.cutoff), ..Preparation::default() };
    let (prepared, _) = prepare_all(motions, &settings)?;
    let slowest = &diagnosis.sampling.standstill_speeds;
    let (expected, found) = (model.robot().joints(), slowest.len());
    if expected != found {
        return Err(ReplayError::Joints { expected, found });
    }
    let terms = diagnosis.terms();
    let standing = terms.get(diagnosis.findings.len()..).unwrap_or_default();
    let known = &diagnosis.standard.chi;
    let variants: [(Variant, &[f64], &[EffectTerm]); 2] =
        [(Variant::Without, known, standing), (Variant::With, &diagnosis.model.chi, &terms)];
    let mut comparison = Comparison::new(model.robot().joints());
    for (k, motion) in prepared.iter().enumerate() {
        let recorded = smooth(&shifted(motion, diagnosis.delay), motion.rate, band)?;
        let mut simulated = Vec::new();
        for (v, &(which, chi, terms)) in variants.iter().enumerate() {
            let followed = follow(model, motion, known, chi, terms)
                .map_err(|error| ReplayError::Simulation { which, error })?;
            simulated.push(smooth(&followed.torque, motion.rate, band)?);
            comparison.track(v, &followed.tracking_error);
            progress((k as f64 + 0.5 * (v + 1) as f64) / prepared.len() as f64);
        }
        comparison.add(motion, slowest, &recorded, &simulated);
    }
    Ok(ClosedLoop {
        recording: name.to_owned(),
        left_out: left_out(model, known, &terms),
        ..comparison.finish()
    })
}
