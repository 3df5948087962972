//! The estimators: IDIM and PIM, ordinary and weighted least squares.
//! Equation numbers are those of Gautier and Briot.

use super::Factor;
use super::blocks::block_sigmas;
use super::essential::eliminate;
use super::observe::{Equations, Observation};
use super::outcome::{Essential, Estimate, Method, ParameterEstimate, Solver, Warning};
use super::residuals::{errors_of, per_equation, relative_error};
use super::robust::reweight;
use super::solve::{Solution, back_substitute};
use super::total::{NoGenericSolution, total_least_squares};
use super::weights::{Weights, equal, from_own_fits, iterate, solve_active, stack};
use crate::model::JointNumber;

/// How parameters are estimated from an observation.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimateSettings {
    /// Whether equations are weighted by their errors, per joint and trajectory.
    pub weighted: bool,
    /// How the equations are solved.
    pub solver: Solver,
    /// The paper's r_sigma for the essential parameters (10 to 30); `None`: they are not looked for.
    pub r_sigma: Option<f64>,
    /// Condition number of the scaled W above which a warning names the parameters concerned.
    pub worst_condition: f64,
    /// Whether standard deviations by blocks of time are worked out.
    pub block_sigmas: bool,
}

impl Default for EstimateSettings {
    fn default() -> Self {
        EstimateSettings {
            weighted: true,
            solver: Solver::LeastSquares,
            r_sigma: Some(20.0),
            worst_condition: 1000.0,
            block_sigmas: true,
        }
    }
}

impl EstimateSettings {
    /// The defaults for a method.
    pub fn for_method(method: Method) -> EstimateSettings {
        EstimateSettings {
            weighted: method.is_weighted(),
            solver: method.solver(),
            ..EstimateSettings::default()
        }
    }
}

/// Estimates the parameters of an observation (15), weighted or not, with standard deviations (16) to (19).
///
/// What the data do not determine is named in the warnings and set to zero, never inverted. The standard deviations
/// of a total least-squares estimate are those of least squares with its residual, to first order.
pub fn estimate(observation: &Observation, settings: &EstimateSettings) -> Estimate {
    let mut warnings = Vec::new();
    // Which columns are independent does not depend on the weights.
    let first = if settings.weighted { from_own_fits(observation) } else { equal(observation) };
    let everything = stack(observation, &first.sigma).solve();
    let active = everything.kept.clone();
    let robust = (settings.solver == Solver::Robust).then(|| reweight(observation, &active));
    if let Some(robust) = robust.as_ref().filter(|r| !r.converged) {
        warnings.push(Warning::NotConverged { iterations: robust.iterations });
    }
    // What is solved; errors are always those of the observation as it is.
    let counted = robust.as_ref().map_or(observation, |r| &r.observation);
    let first = if robust.is_some() { from_own_fits(counted) } else { first };
    let weights =
        if settings.weighted { choose_weights(counted, &active, first, &mut warnings) } else { first };
    let stacked = stack(counted, &weights.sigma).select(&active);
    let mut solution = stacked.solve();
    if settings.solver == Solver::Total
        && solve_total(observation, &active, &stacked, &mut solution) == Err(NoGenericSolution)
    {
        warnings.push(Warning::NoTotalSolution);
    }

    let chi = spread(&solution.chi, &active, observation.unknowns.len());
    let noise = solution.residual_norm.powi(2) / (solution.degrees_of_freedom.max(1)) as f64;
    let by_blocks =
        if settings.block_sigmas { block_sigmas(counted, &active, &weights.sigma, &chi) } else { None };
    let parameters =
        described(observation, &active, &solution.chi, &solution.variance, noise, by_blocks.as_deref());
    describe_dependence(observation, &everything, &mut warnings);
    if solution.condition > settings.worst_condition {
        warnings.push(Warning::BadlyConditioned {
            condition: solution.condition,
            parameters: strongest(observation, &solution.weakest, &active),
        });
    }
    let errors = errors_of(observation, &chi, &weights.sigma, settings.weighted);
    let per_equation = per_equation(observation, &chi);
    warnings.extend(not_explained(observation, &per_equation));
    let essential =
        settings.r_sigma.map(|r_sigma| simplified(counted, &active, &weights, r_sigma, settings.weighted));
    Estimate {
        method: method_of(observation, settings),
        parameters,
        errors,
        relative_error: relative_error(observation, &chi),
        per_equation,
        rows: stacked.rows(),
        degrees_of_freedom: solution.degrees_of_freedom,
        condition: solution.condition,
        iterations: weights.iterations,
        low_blocks: robust.map_or_else(Vec::new, |r| r.low),
        warnings,
        essential,
    }
}

/// Replaces the values of a least-squares solution by those of total least squares.
fn solve_total(
    observation: &Observation,
    active: &[usize],
    stacked: &Factor,
    solution: &mut Solution,
) -> Result<(), NoGenericSolution> {
    let exact: Vec<bool> = active.iter().map(|&l| observation.exact[l]).collect();
    let chi = total_least_squares(stacked, &exact)?;
    solution.residual_norm = stacked.residual_norm(&chi);
    solution.chi = chi;
    Ok(())
}

/// The equations of which the model explains less than no model at all.
fn not_explained(observation: &Observation, per_equation: &[f64]) -> Vec<Warning> {
    let worse = per_equation.iter().enumerate().filter(|(_, error)| **error > 1.0);
    worse
        .map(|(equation, &relative_error)| Warning::NotExplained {
            joint: joint_of(observation, equation),
            relative_error,
        })
        .collect()
}

fn method_of(observation: &Observation, settings: &EstimateSettings) -> Method {
    let power = observation.equations != Equations::Torque;
    match (settings.solver, settings.weighted, power) {
        (Solver::Robust, _, false) => Method::IdimIrls,
        (Solver::Robust, _, true) => Method::PimIrls,
        (Solver::Total, _, false) => Method::IdimTls,
        (Solver::Total, _, true) => Method::PimTls,
        (_, false, false) => Method::IdimOls,
        (_, true, false) => Method::IdimWls,
        (_, false, true) => Method::PimOls,
        (_, true, true) => Method::PimWls,
    }
}

/// Iterated weights, or those of the equations' own fits where the iteration gives up on an equation.
fn choose_weights(
    observation: &Observation,
    active: &[usize],
    own: Weights,
    warnings: &mut Vec<Warning>,
) -> Weights {
    let iterated = iterate(observation, active, &own);
    let before = per_equation(observation, &solve_active(observation, active, &own.sigma));
    let after = per_equation(observation, &solve_active(observation, active, &iterated.sigma));
    let mut collapsed = false;
    for (equation, (&before, &after)) in before.iter().zip(&after).enumerate() {
        if after > 1.0 && before < after {
            collapsed = true;
            let joint = joint_of(observation, equation);
            warnings.push(Warning::WeightCollapsed { joint, relative_error: after });
        }
    }
    if collapsed {
        return own;
    }
    if !iterated.converged {
        warnings.push(Warning::NotConverged { iterations: iterated.iterations });
    }
    iterated
}

/// The joint whose torque an equation gives; `None` for the power model.
fn joint_of(observation: &Observation, equation: usize) -> Option<JointNumber> {
    observation.left_out.iter().find(|rows| rows.equation == equation).and_then(|rows| rows.joint)
}

fn spread(values: &[f64], active: &[usize], unknowns: usize) -> Vec<f64> {
    let mut chi = vec![0.0; unknowns];
    for (&l, &x) in active.iter().zip(values) {
        chi[l] = x;
    }
    chi
}

fn described(
    observation: &Observation,
    active: &[usize],
    chi: &[f64],
    variance: &[f64],
    noise: f64,
    by_blocks: Option<&[f64]>,
) -> Vec<ParameterEstimate> {
    let mut parameters: Vec<ParameterEstimate> = observation
        .unknowns
        .iter()
        .map(|name| ParameterEstimate {
            name: name.clone(),
            value: 0.0,
            sigma: None,
            sigma_blocks: None,
            relative_sigma_percent: None,
        })
        .collect();
    for (place, &l) in active.iter().enumerate() {
        let sigma = (noise * variance[place]).sqrt();
        let parameter = &mut parameters[l];
        parameter.value = chi[place];
        parameter.sigma = Some(sigma);
        parameter.sigma_blocks = by_blocks.map(|s| s[place]);
        parameter.relative_sigma_percent = Some(100.0 * sigma / chi[place].abs()).filter(|r| r.is_finite());
    }
    parameters
}

fn describe_dependence(observation: &Observation, everything: &Solution, warnings: &mut Vec<Warning>) {
    for group in &everything.dependent {
        let Some((&parameter, others)) = group.split_first() else { continue };
        warnings.push(Warning::NotDetermined {
            parameter: observation.unknowns[parameter].clone(),
            from: others.iter().map(|&l| observation.unknowns[l].clone()).collect(),
        });
    }
}

/// Names of the parameters with the largest shares of a direction, the strongest first.
fn strongest(observation: &Observation, direction: &[f64], active: &[usize]) -> Vec<String> {
    let largest = direction.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let mut shares: Vec<(f64, usize)> = direction.iter().zip(active).map(|(x, &l)| (x.abs(), l)).collect();
    shares.retain(|&(share, _)| share > 0.3 * largest);
    shares.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    shares.into_iter().map(|(_, l)| observation.unknowns[l].clone()).collect()
}

fn simplified(
    observation: &Observation,
    active: &[usize],
    weights: &Weights,
    r_sigma: f64,
    weighted: bool,
) -> Essential {
    let stacked = stack(observation, &weights.sigma).select(active);
    let elimination = eliminate(&stacked, active, r_sigma);
    let weights = if weighted { iterate(observation, &elimination.kept, weights) } else { weights.clone() };
    let reduced = stack(observation, &weights.sigma).select(&elimination.kept);
    let (values, variance) = back_substitute(&reduced);
    let freedom = reduced.rows().saturating_sub(values.len()).max(1) as f64;
    let noise = reduced.residual_norm(&values).powi(2) / freedom;
    let chi = spread(&values, &elimination.kept, observation.unknowns.len());
    let all = described(observation, &elimination.kept, &values, &variance, noise, None);
    Essential {
        parameters: elimination.kept.iter().map(|&l| all[l].clone()).collect(),
        cancelled: elimination.cancelled.iter().map(|&l| observation.unknowns[l].clone()).collect(),
        relative_error: relative_error(observation, &chi),
    }
}

#[cfg(test)]
#[path = "estimate_tests.rs"]
mod tests;
