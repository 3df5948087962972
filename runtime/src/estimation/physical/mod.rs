//! The best parameters that a real robot can have: what a recording says where the fit is held to physics.
//!
//! Least squares is free to give a link a negative inertia or a joint a friction that drives it. A robot that fits its
//! recording does so by little; a recording that another robot made, or whose axes, signs or units are mixed up, needs
//! such parameters. The best physically possible fit therefore tells whether the recording can be this robot's.

mod body;
mod constraint;
mod ellipsoid;
mod interior_point;
mod near_prior;
mod newton_step;
mod prior;
mod prior_problem;
mod prior_weight;
mod problem;
mod pseudo_inertia;
mod release;

use super::observe::Observation;
use super::weights::stack_all_rows;
use super::{Estimate, per_equation, relative_error};
use crate::model::Robot;
use problem::Problem;

pub use body::{NearestBody, nearest_body};
pub use constraint::Constraint;
pub use ellipsoid::{ellipsoid_margin, uniform_body};
pub use near_prior::{EllipsoidBound, NearPrior, near_prior};
pub use prior::{NearPriorError, Prior};
pub use release::{Released, released};

/// The best fit whose parameters belong to real bodies and whose friction dissipates.
#[derive(Debug, Clone, PartialEq)]
pub struct PhysicalFit {
    /// Base parameters.
    pub chi: Vec<f64>,
    /// ||Y - W chi|| / ||Y|| over all equations.
    pub relative_error: Option<f64>,
    /// The same per joint.
    pub per_equation: Vec<Option<f64>>,
    /// Mean square of its weighted errors over that of the free fit, each freedom counted: 1 where physics costs
    /// nothing.
    pub strain: f64,
}

/// Fits an observation of torques with parameters that a robot can have, in the weights of a free estimate.
///
/// Physically possible is (Sousa and Cortesao 2014; Wensing, Kim and Slotine 2018): the pseudo-inertia of every link is
/// positive semidefinite; rotor inertias at the motors are not negative; the line Fc + Fv v does not lie below zero at
/// the mean speed |v| of its rows, nor at that weighted by |v|. The least-squares line of any friction that
/// dissipates obeys the latter, Stribeck's with its falling branch as well, so that no law of friction is demanded.
///
/// The problem is convex. It is solved with a logarithmic barrier and Newton's method, the distance to the optimum
/// being the number of constraints over the weight of the equations (Boyd and Vandenberghe 2004, chapter 11). `None`
/// where that distance was not reached, or where the observation is not one of torques by this robot.
pub fn physical_fit(robot: &Robot, observation: &Observation, estimate: &Estimate) -> Option<PhysicalFit> {
    if observation.unknowns.len() != robot.base.len() {
        return None;
    }
    let sigma = sigmas(observation, estimate)?;
    // Errors count all rows. A friction and an offset that only rows around a reversal tell apart can be anything for a fit
    // whose moment of the reversal is free, and leave any error in these rows.
    let stacked = stack_all_rows(observation, &sigma);
    let unknowns = stacked.unknowns();
    let free = stacked.r(unknowns, unknowns).powi(2);
    if !(free.is_finite() && free > 0.0) {
        return None;
    }
    let unweighted = stack_all_rows(observation, &vec![1.0; observation.groups.len()]);
    let problem = Problem::new(robot, &stacked, &unweighted, free);
    let standard = problem.solve()?;
    let chi = robot.base_from_standard(standard.as_slice());
    let freedom = estimate.degrees_of_freedom.max(1) as f64 / stacked.rows() as f64;
    let strain = freedom * stacked.residual_norm(&chi).powi(2) / free;
    Some(PhysicalFit {
        relative_error: relative_error(observation, &chi),
        per_equation: per_equation(observation, &chi),
        chi,
        strain,
    })
}

/// The standard deviation of each group's errors, 1 for a group of zeros; `None` where an equation has none.
fn sigmas(observation: &Observation, estimate: &Estimate) -> Option<Vec<f64>> {
    let of = |trajectory, equation| {
        let found = estimate.errors.iter().find(|e| e.trajectory == trajectory && e.equation == equation)?;
        let found = found.sigma.unwrap_or(1.0);
        (found > 0.0).then_some(found)
    };
    let sigma = |g: &super::observe::EquationFactor| match g.factor.rows() {
        0 => Some(1.0),
        _ => of(g.trajectory, g.equation),
    };
    observation.groups.iter().map(sigma).collect()
}

#[cfg(test)]
mod log_cholesky_tests;
#[cfg(test)]
mod testing;
#[cfg(test)]
mod tests;
