//! Which body or rotor keeps the identified base parameters from being those of a robot.

use nalgebra::DMatrix;

use super::constraint::Constraint;
use super::prior::{NearPriorError, Prior, check};
use super::prior_problem::Search;
use super::prior_weight::path;
use crate::model::Robot;

/// What the rest of a robot could have if one constraint were none.
#[derive(Debug, Clone, PartialEq)]
pub struct Released {
    /// The constraint.
    pub what: Constraint,
    /// The least distance of [`NearPrior`](super::NearPrior) without it: at most that with it, and far below where this body
    /// or rotor is what cannot be.
    pub least: f64,
    /// Base parameters at that distance.
    pub chi: Vec<f64>,
}

/// The least distance with each constraint left out alone, those first without which it is smallest; arguments as of
/// [`near_prior`](super::near_prior).
///
/// # Errors
/// See [`NearPriorError`].
pub fn released(
    robot: &Robot,
    chi: &[f64],
    covariance: &DMatrix<f64>,
    prior: &Prior,
) -> Result<Vec<Released>, NearPriorError> {
    check(robot, chi, covariance, prior)?;
    let bodies = (0..robot.frames.len()).map(Constraint::Body);
    let mut all = Vec::new();
    for what in bodies.chain((0..robot.joints()).map(Constraint::Rotor)) {
        let mut search = Search::new(robot, chi, covariance, prior)?;
        if !search.release(what) {
            continue;
        }
        // What cannot be found says nothing of this one.
        let Ok(path) = path(&search) else { continue };
        let Some(nearest) = path.last() else { continue };
        let chi = robot.base_from_standard(nearest.x.as_slice());
        all.push(Released { what, least: nearest.distance, chi });
    }
    all.sort_by(|a, b| a.least.total_cmp(&b.least));
    Ok(all)
}
