//! The estimators: IDIM and PIM, ordinary and weighted least squares.
//! Equation numbers are those of Gautier and Briot.

use super::Factor;
use super::attenuation::{Attenuation, corrected};
use super::blocks::block_sigmas;
use super::cautions::{describe_dependence, few_rows, joint_of, not_explained, strongest};
use super::deviations::{Deviations, described, lasting_deviations, upper_covariance};
use super::essential::simplified;
use super::method::{Method, Solver};
use super::observe::{Equations, Observation};
use super::outcome::Estimate;
use super::residuals::{errors_of, per_equation, relative_error};
use super::robust::{Reweighted, reweight};
use super::settings::EstimateSettings;
use super::solve::{Solution, inverse_gram};
use super::total::{NoGenericSolution, total_least_squares};
use super::warning::Warning;
use super::weights::{Weights, equal, from_own_fits, iterate, solve_active, spread, stack};

/// Estimates the parameters of an observation (15), weighted or not, with standard deviations (16) to (19).
///
/// What the data do not determine is named in the warnings and set to zero, never inverted. Total least squares has no
/// standard deviations: those that it could state rest on errors of the columns that are independent and of one size,
/// which those of one filtered position signal are not.
pub fn estimate(observation: &Observation, settings: &EstimateSettings) -> Estimate {
    match observation.without_fixed() {
        None => of_free(observation, observation, settings),
        Some(free) => of_free(&free, observation, settings),
    }
}

/// Solves the equations of the `free` unknowns; errors are those of all equations as they were observed.
fn of_free(free: &Observation, observation: &Observation, settings: &EstimateSettings) -> Estimate {
    let mut warnings = Vec::new();
    let solved = solve(free, settings, &mut warnings);
    let Solved { everything, active, weights, rows, solution, .. } = &solved;
    let chi = observation.with_fixed(spread(&solution.chi, active, observation.unknowns.len()));
    let deviations = deviations_of(&solved, free, settings, &chi);
    let parameters = described(observation, active, &solution.chi, &deviations);
    describe_dependence(observation, everything, &mut warnings);
    if solution.condition > settings.worst_condition {
        warnings.push(Warning::BadlyConditioned {
            condition: solution.condition,
            parameters: strongest(observation, &solution.weakest, active),
        });
    }
    if settings.weighted {
        warnings.extend(few_rows(observation));
    }
    let per_equation = per_equation(observation, &chi);
    warnings.extend(not_explained(observation, &per_equation));
    let essential = settings.r_sigma.map(|r_sigma| {
        let inflation: Vec<f64> = (0..active.len()).map(|p| deviations.inflation(p)).collect();
        let simple =
            simplified(solved.counted(free), active, weights, r_sigma, settings.weighted, &inflation);
        if observation.fixed.is_empty() { simple } else { simple.with_fixed(observation) }
    });
    let covariance = upper_covariance(observation.unknowns.len(), active, &deviations);
    Estimate {
        method: method_of(observation, settings),
        parameters,
        errors: errors_of(observation, &chi, &weights.sigma, settings.weighted),
        relative_error: relative_error(observation, &chi),
        per_equation,
        rows: rows.rows(),
        degrees_of_freedom: solution.degrees_of_freedom,
        condition: solution.condition,
        iterations: weights.iterations,
        low_blocks: solved.robust.as_ref().map_or_else(Vec::new, |r| r.low.clone()),
        warnings,
        covariance,
        essential,
    }
}

/// What the equations were solved with, and what came of it.
struct Solved {
    /// The unweighted solution of all unknowns, which says what is determined at all.
    everything: Solution,
    /// The unknowns that are, ascending.
    active: Vec<usize>,
    /// What a robust estimate counts less.
    robust: Option<Reweighted>,
    weights: Weights,
    /// The weighted rows in the active unknowns.
    rows: Factor,
    /// Their solution.
    solution: Solution,
    /// What was added to it for noise in the columns.
    attenuation: Option<Attenuation>,
}

impl Solved {
    /// What is solved: the observation, or that of which some blocks count less. Errors are always those of the
    /// observation as it is.
    fn counted<'a>(&'a self, observation: &'a Observation) -> &'a Observation {
        self.robust.as_ref().map_or(observation, |r| &r.observation)
    }
}

fn solve(observation: &Observation, settings: &EstimateSettings, warnings: &mut Vec<Warning>) -> Solved {
    // Which columns are independent does not depend on the weights.
    let first = if settings.weighted { from_own_fits(observation) } else { equal(observation) };
    let everything = stack(observation, &first.sigma).solve();
    let active = everything.kept.clone();
    let robust = (settings.solver == Solver::Robust).then(|| reweight(observation, &active));
    if let Some(robust) = robust.as_ref().filter(|r| !r.converged) {
        warnings.push(Warning::NotConverged { iterations: robust.iterations });
    }
    let counted = robust.as_ref().map_or(observation, |r| &r.observation);
    let first = if robust.is_some() { from_own_fits(counted) } else { first };
    let weights = if settings.weighted { choose_weights(counted, &active, first, warnings) } else { first };
    let rows = stack(counted, &weights.sigma).select(&active);
    let mut solution = rows.solve();
    let mut attenuation = None;
    if settings.solver == Solver::Total {
        if solve_total(observation, &active, &rows, &mut solution) == Err(NoGenericSolution) {
            warnings.push(Warning::NoTotalSolution);
        }
        warnings.push(Warning::NoDeviations);
    } else {
        attenuation = corrected(counted, &active, &weights.sigma, &rows, &solution.chi);
        if attenuation.as_ref().is_some_and(|a| a.hides_some) {
            warnings.push(Warning::NoisyColumns);
        }
    }
    if let Some(attenuation) = &attenuation {
        solution.chi.clone_from(&attenuation.chi);
        solution.residual_norm = rows.residual_norm(&attenuation.chi);
    }
    Solved { everything, active, robust, weights, rows, solution, attenuation }
}

fn deviations_of(
    solved: &Solved,
    observation: &Observation,
    settings: &EstimateSettings,
    chi: &[f64],
) -> Deviations {
    let Solved { active, weights, solution, attenuation, .. } = solved;
    let counted = solved.counted(observation);
    let noise = solution.residual_norm.powi(2) / (solution.degrees_of_freedom.max(1)) as f64;
    let known = settings.solver != Solver::Total;
    let lasting = (known && settings.lasting_noise)
        .then(|| lasting_deviations(counted, active, weights, settings.weighted, attenuation.as_ref()));
    let lasting = lasting.flatten();
    Deviations {
        together: lasting.clone().unwrap_or_else(|| inverse_gram(&solved.rows)),
        known,
        white: solution.variance.iter().map(|v| (noise * v).sqrt()).collect(),
        blocks: if settings.block_sigmas { block_sigmas(counted, active, &weights.sigma, chi) } else { None },
        lasting: lasting.map(|all| all.diagonal().iter().map(|v| v.sqrt()).collect()),
        attenuation: attenuation.clone(),
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
    for (equation, errors) in before.iter().zip(&after).enumerate() {
        let (Some(before), Some(after)) = errors else { continue };
        if *after > 1.0 && before < after {
            collapsed = true;
            let joint = joint_of(observation, equation);
            warnings.push(Warning::WeightCollapsed { joint, relative_error: *after });
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

#[cfg(test)]
#[path = "estimate_tests.rs"]
mod tests;
