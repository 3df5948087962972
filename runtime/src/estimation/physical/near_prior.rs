//! The standard parameters nearest to a prior that have identified base parameters within their uncertainty.
//!
//! Torques determine base parameters; of the standard ones behind them a recording leaves a whole space. Here that one is
//! taken whose bodies are nearest to those of a prior (a URDF, a CAD model) in the entropic divergence
//! D(P | P0) = tr(P0⁻¹ P) - ln det(P0⁻¹ P) - 4 of pseudo-inertias (Lee, Wensing and Park 2020): it does not depend on the
//! choice of frames or units, and is infinite where a body stops being one, so that every body of the solution has a density
//! that is nowhere negative.
//!
//! min over x of ½ (K x - chi)ᵀ Λ (K x - chi) + γ R(x), with Λ the information of chi, is convex and smooth; Newton's method
//! with backtracking finds it for any γ, which is that of the least expected error (`prior_weight.rs`). A prior that agrees
//! with the data is not left; what the data leave open is the prior's.
//!
//! Where an ellipsoid is known that holds a link, its body stays within: tr(P Q) >= 0 (Wensing, Kim and Slotine 2018), linear in
//! x. R keeps P positive definite, so that these are the only constraints; Newton's method obeys them exactly, and bounds that
//! hold nothing back change nothing.

use nalgebra::DMatrix;

use super::ellipsoid::ellipsoid_margin;
use super::prior::{NearPriorError, Prior, check};
use super::prior_problem::Search;
use super::prior_weight::{Chosen, choose, path};
use crate::model::Robot;

/// What holds a body within its ellipsoid.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EllipsoidBound {
    /// tr(P Q) over the mass, 0 to 1: 0 where the ellipsoid holds the body back.
    pub margin: f64,
    /// The same of the prior; negative where the prior itself is not within.
    pub of_prior: f64,
    /// Whether the result would leave it.
    pub is_active: bool,
}

/// Standard parameters that bodies can have.
#[derive(Debug, Clone, PartialEq)]
pub struct NearPrior {
    /// In the order of the robot's standard parameters, `attached` counted in.
    pub standard: Vec<f64>,
    /// Their base parameters.
    pub chi: Vec<f64>,
    /// Of each standard parameter the part that the data decided, 0 to 1; the rest is the prior's.
    pub from_data: Vec<f64>,
    /// (K x - chi)ᵀ Λ (K x - chi) over the determined base parameters.
    pub distance: f64,
    /// The least that bodies can have of it: near 0 where the identified values are possible.
    pub least: f64,
    /// Base parameters of the bodies that have it.
    pub least_chi: Vec<f64>,
    /// Number of base parameters that the data determine.
    pub determined: usize,
    /// Weight of the prior that was chosen.
    pub gamma: f64,
    /// How many of the determined base parameters the data decide with it; the rest of them is the prior's.
    pub freedom: f64,
    /// Variance of the identified values over that of their covariance, as the least distance shows it; 1 or more.
    pub dispersion: f64,
    /// Chance of a least distance as large as this one where bodies have the true values.
    pub p_value: f64,
    /// Divergence of each frame's body from its prior; 0 where there is none.
    pub divergence: Vec<f64>,
    /// Each frame's ellipsoid; `None` where it has none.
    pub bounds: Vec<Option<EllipsoidBound>>,
}

/// Standard parameters nearest to `prior` that have the base parameters `chi` within their `covariance` (rows of zeros or
/// what is not finite: not determined).
///
/// Friction and offsets are taken as identified. Rotor inertias at the motors are positive.
///
/// # Errors
/// See [`NearPriorError`].
pub fn near_prior(
    robot: &Robot,
    chi: &[f64],
    covariance: &DMatrix<f64>,
    prior: &Prior,
) -> Result<NearPrior, NearPriorError> {
    check(robot, chi, covariance, prior)?;
    let search = Search::new(robot, chi, covariance, prior)?;
    let path = path(&search)?;
    let chosen = choose(&search, &path)?;
    let Some(nearest) = path.last() else { return Err(NearPriorError::NotConverged) };
    let found = outcome(&search, robot, prior, &chosen)?;
    let least_chi = robot.base_from_standard(nearest.x.as_slice());
    Ok(NearPrior { least: nearest.distance, least_chi, ..found })
}

/// The parameters of a minimum, and what decided them, but for the least distance.
fn outcome(
    search: &Search,
    robot: &Robot,
    prior: &Prior,
    chosen: &Chosen,
) -> Result<NearPrior, NearPriorError> {
    let (gamma, x) = (chosen.minimum.gamma, &chosen.minimum.x);
    let (step, _) = search.newton(gamma, x).ok_or(NearPriorError::NotConverged)?;
    let mut divergence = vec![0.0; robot.frames.len()];
    let mut bounds = vec![None; robot.frames.len()];
    for body in &search.bodies {
        divergence[body.frame] = search.divergence(body, x).unwrap_or_default();
        let (Some(place), Some(ellipsoid)) = (body.ellipsoid, &prior.ellipsoids[body.frame]) else {
            continue;
        };
        let attached = &prior.attached[body.frame];
        let own = std::array::from_fn(|k| x[body.link[k]] - attached[k]);
        let margin = |body: &[f64; 10]| ellipsoid_margin(ellipsoid, body).unwrap_or_default();
        bounds[body.frame] = Some(EllipsoidBound {
            margin: margin(&own),
            of_prior: prior.bodies[body.frame].as_ref().map_or(0.0, margin),
            is_active: step.multipliers[place] > 0.0,
        });
    }
    let from_data = step.part_of(&(&search.normal / gamma));
    let from_data = from_data.map(|part| part.iter().map(|x| x.clamp(0.0, 1.0)).collect());
    Ok(NearPrior {
        chi: robot.base_from_standard(x.as_slice()),
        from_data: from_data.unwrap_or_else(|| vec![0.0; x.len()]),
        standard: x.as_slice().to_vec(),
        distance: chosen.minimum.distance,
        least: 0.0,
        least_chi: Vec::new(),
        determined: search.determined,
        gamma,
        freedom: chosen.freedom,
        dispersion: chosen.dispersion,
        p_value: chosen.p_value,
        divergence,
        bounds,
    })
}

#[cfg(test)]
#[path = "near_prior_tests.rs"]
mod tests;
