//! Weights per equation and trajectory: (20), (21), and their iteration to a fixed point.
//! Equation numbers are those of Gautier and Briot.

use super::observe::{EquationFactor, Observation};
use super::solve::back_substitute;
use super::{Factor, RANK_TOLERANCE};

/// Largest relative change of a sigma at which the weights have converged.
const CONVERGED: f64 = 1e-4;
/// Most iterations.
const ITERATIONS: usize = 100;
/// A sigma is at least this share of the root mean square of its Y, so that weights of perfect data stay finite.
const FLOOR: f64 = 1e-10;

/// The errors' standard deviation of each group of the observation.
#[derive(Debug, Clone)]
pub(super) struct Weights {
    pub sigma: Vec<f64>,
    pub iterations: usize,
    pub converged: bool,
}

/// All groups as one factor, each divided by its sigma.
pub(super) fn stack(observation: &Observation, sigma: &[f64]) -> Factor {
    let mut all = Factor::new(observation.unknowns.len());
    for (group, sigma) in observation.groups.iter().zip(sigma) {
        if group.factor.rows() > 0 {
            all.merge_weighted(&group.factor, &group.columns, 1.0 / sigma);
        }
    }
    all
}

/// Equal weights: ordinary least squares.
pub(super) fn equal(observation: &Observation) -> Weights {
    Weights { sigma: vec![1.0; observation.groups.len()], iterations: 0, converged: true }
}

/// The weights of (20): every equation is fitted alone, over all trajectories, and the error of each trajectory in
/// that fit is its sigma.
pub(super) fn from_own_fits(observation: &Observation) -> Weights {
    let equations = observation.groups.iter().map(|g| g.equation + 1).max().unwrap_or(0);
    let mut sigma = vec![1.0; observation.groups.len()];
    for equation in 0..equations {
        let own: Vec<usize> =
            (0..sigma.len()).filter(|&g| observation.groups[g].equation == equation).collect();
        let Some((&first, others)) = own.split_first() else { continue };
        let mut all = observation.groups[first].factor.clone();
        for &g in others {
            all.merge(&observation.groups[g].factor);
        }
        let independent = independent_columns(&all);
        let (solved, _) = back_substitute(&all.select(&independent));
        let mut chi = vec![0.0; all.unknowns()];
        for (&l, x) in independent.iter().zip(solved) {
            chi[l] = x;
        }
        let freedom = 1.0 - independent.len() as f64 / all.rows().max(1) as f64;
        for &g in &own {
            let factor = &observation.groups[g].factor;
            sigma[g] = sigma_of(factor, factor.residual_norm(&chi), freedom, all.norm_y(), all.rows());
        }
    }
    Weights { sigma, iterations: 0, converged: true }
}

/// Iterates: weights give parameters, whose errors give weights, until both agree. `active` are the unknowns that
/// are solved for; their columns are independent.
pub(super) fn iterate(observation: &Observation, active: &[usize], start: &Weights) -> Weights {
    let mut weights = Weights { sigma: start.sigma.clone(), iterations: 0, converged: false };
    let rows: usize = observation.groups.iter().map(|g| g.factor.rows()).sum();
    let freedom = 1.0 - active.len() as f64 / rows.max(1) as f64;
    while weights.iterations < ITERATIONS && !weights.converged {
        let chi = solve_active(observation, active, &weights.sigma);
        let mut change = 0.0_f64;
        for (group, sigma) in observation.groups.iter().zip(&mut weights.sigma) {
            let factor = &group.factor;
            if factor.rows() == 0 {
                continue;
            }
            let residual = residual_norm(group, &chi);
            let new = sigma_of(factor, residual, freedom, factor.norm_y(), factor.rows());
            change = change.max((new / *sigma - 1.0).abs());
            *sigma = new;
        }
        weights.iterations += 1;
        weights.converged = change < CONVERGED;
    }
    weights
}

/// The weighted least-squares parameters, zero where not active.
pub(super) fn solve_active(observation: &Observation, active: &[usize], sigma: &[f64]) -> Vec<f64> {
    let (solved, _) = back_substitute(&stack(observation, sigma).select(active));
    let mut chi = vec![0.0; observation.unknowns.len()];
    for (&l, x) in active.iter().zip(solved) {
        chi[l] = x;
    }
    chi
}

/// ||Y - W chi|| of a group, for all unknowns of the observation.
pub(super) fn residual_norm(group: &EquationFactor, chi: &[f64]) -> f64 {
    let own: Vec<f64> = group.columns.iter().map(|&u| chi[u]).collect();
    group.factor.residual_norm(&own)
}

/// Root mean square of a residual, corrected for the share of freedom that the fit has left, and never so small
/// that its inverse means nothing.
fn sigma_of(factor: &Factor, residual: f64, freedom: f64, norm_y: f64, rows: usize) -> f64 {
    let floor = FLOOR * norm_y / (rows.max(1) as f64).sqrt();
    let own = residual / (factor.rows().max(1) as f64 * freedom.max(1e-3)).sqrt();
    let sigma = own.max(floor);
    if sigma > 0.0 { sigma } else { 1.0 }
}

/// Columns that do not depend on those before them, ascending.
fn independent_columns(factor: &Factor) -> Vec<usize> {
    let norms = factor.column_norms();
    let mut kept = Vec::new();
    // A column that depends on earlier ones leaves nothing on the diagonal; where it is dropped, later columns
    // find their part below it, so that the triangle is made again without it.
    let mut reduced = factor.select(&(0..factor.unknowns()).collect::<Vec<_>>());
    let mut left: Vec<usize> = (0..factor.unknowns()).collect();
    let mut at = 0;
    while at < left.len() {
        if reduced.r(at, at).abs() > RANK_TOLERANCE * norms[left[at]] {
            kept.push(left[at]);
            at += 1;
        } else {
            left.remove(at);
            reduced = factor.select(&left);
        }
    }
    kept
}
