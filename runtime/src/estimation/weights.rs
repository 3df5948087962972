//! Weights per equation and trajectory: (20), (21), and their iteration to a fixed point.
//! Equation numbers are those of Gautier and Briot.

use super::memory::rows_worth_one;
use super::observe::{EquationFactor, Observation};
use super::solve::{back_substitute, inverse_gram};
use super::{Factor, RANK_TOLERANCE};
use crate::statistics::moderation::{Lent, Prior, Variance};
use nalgebra::DMatrix;
use std::borrow::Cow;

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
    /// For each group the degrees of freedom that the fit leaves in it.
    pub freedom: Vec<f64>,
    /// For each group how many of its rows say as much about the size of its errors as one independent row.
    pub rows_worth_one: Vec<f64>,
    pub iterations: usize,
    pub converged: bool,
}

/// All groups as one factor, each divided by its sigma.
pub(super) fn stack(observation: &Observation, sigma: &[f64]) -> Factor {
    stacked(observation, sigma, |group| Cow::Borrowed(&group.factor))
}

/// The same of all rows, with what the moments of the reversals take.
pub(super) fn stack_all_rows(observation: &Observation, sigma: &[f64]) -> Factor {
    stacked(observation, sigma, |group| Cow::Owned(group.of_all_rows()))
}

fn stacked<'a>(
    observation: &'a Observation,
    sigma: &[f64],
    factor: impl Fn(&'a EquationFactor) -> Cow<'a, Factor>,
) -> Factor {
    let mut all = Factor::new(observation.unknowns.len());
    for (group, sigma) in observation.groups.iter().zip(sigma).filter(|(g, _)| g.factor.rows() > 0) {
        all.merge_weighted(&factor(group), &group.columns, 1.0 / sigma);
    }
    all
}

/// Equal weights: ordinary least squares.
pub(super) fn equal(observation: &Observation) -> Weights {
    let count = observation.groups.len();
    Weights {
        sigma: vec![1.0; count],
        freedom: rows_of(observation),
        rows_worth_one: vec![1.0; count],
        iterations: 0,
        converged: true,
    }
}

/// The weights of (20): every equation is fitted alone, over all trajectories, and the error of each trajectory in
/// that fit is its sigma.
pub(super) fn from_own_fits(observation: &Observation) -> Weights {
    let mut weights = equal(observation);
    let mut found = vec![Variance::of_squares(0.0, 0.0); observation.groups.len()];
    let equations = by_equation(observation);
    let mut fits = vec![vec![0.0; observation.unknowns.len()]; equations.len()];
    for (own, chi) in equations.iter().zip(&mut fits) {
        let Some((&first, others)) = own.split_first() else { continue };
        let mut all = observation.groups[first].factor.clone();
        for &g in others {
            all.merge(&observation.groups[g].factor);
        }
        let independent = independent_columns(&all);
        let reduced = all.select(&independent);
        let (solved, _) = back_substitute(&reduced);
        let inverse = inverse_gram(&reduced);
        let columns = &observation.groups[first].columns;
        for (&l, x) in independent.iter().zip(solved) {
            chi[columns[l]] = x;
        }
        let places: Vec<(usize, usize)> =
            independent.iter().enumerate().map(|(place, &l)| (l, place)).collect();
        for &g in own {
            let factor = &observation.groups[g].factor;
            let leverage = leverage(&gram(factor), &places, &inverse);
            found[g] = squares(factor, residual_norm(&observation.groups[g], chi), leverage);
        }
    }
    let worth = rows_worth_one(observation, &fits);
    weights.rows_worth_one = observation.groups.iter().map(|g| worth[g.equation]).collect();
    settle(observation, &equations, &found, &mut weights);
    weights
}

/// Iterates: weights give parameters, whose errors give weights, until both agree. `active` are the unknowns that
/// are solved for; their columns are independent.
///
/// The errors of a group are counted against the degrees of freedom that the weighted fit leaves in it, which is its
/// share of restricted maximum likelihood (Patterson and Thompson 1971), and its variance is moderated by those of the
/// other trajectories of its joint: a trajectory with fewer rows than parameters would else be interpolated, and the
/// smaller its error the larger its weight. Rows of noise that lasts say less about its size ([`rows_worth_one`]): weights of
/// so many rows would scatter by more than they are believed to, and the estimate with them.
pub(super) fn iterate(observation: &Observation, active: &[usize], start: &Weights) -> Weights {
    let mut weights = Weights { iterations: 0, converged: false, ..start.clone() };
    let mut place = vec![None; observation.unknowns.len()];
    for (p, &l) in active.iter().enumerate() {
        place[l] = Some(p);
    }
    let grams: Vec<DMatrix<f64>> = observation.groups.iter().map(|g| gram(&g.factor)).collect();
    let places: Vec<Vec<(usize, usize)>> = observation
        .groups
        .iter()
        .map(|g| g.columns.iter().enumerate().filter_map(|(c, &u)| place[u].map(|p| (c, p))).collect())
        .collect();
    let equations = by_equation(observation);
    while weights.iterations < ITERATIONS && !weights.converged {
        let stacked = stack(observation, &weights.sigma).select(active);
        let (solved, _) = back_substitute(&stacked);
        let inverse = inverse_gram(&stacked);
        let mut chi = vec![0.0; observation.unknowns.len()];
        for (&l, x) in active.iter().zip(solved) {
            chi[l] = x;
        }
        let before = weights.sigma.clone();
        let found: Vec<Variance> = observation
            .groups
            .iter()
            .enumerate()
            .map(|(g, group)| {
                let leverage = leverage(&grams[g], &places[g], &inverse) / before[g].powi(2);
                squares(&group.factor, residual_norm(group, &chi), leverage)
            })
            .collect();
        settle(observation, &equations, &found, &mut weights);
        let rows = |g: usize| observation.groups[g].factor.rows();
        let change = (0..before.len()).filter(|&g| rows(g) > 0).map(|g| weights.sigma[g] / before[g] - 1.0);
        weights.converged = change.fold(0.0, |m: f64, c| m.max(c.abs())) < CONVERGED;
        weights.iterations += 1;
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
pub(crate) fn residual_norm(group: &EquationFactor, chi: &[f64]) -> f64 {
    let own: Vec<f64> = group.columns.iter().map(|&u| chi[u]).collect();
    group.factor.residual_norm(&own)
}

/// The groups of each equation.
pub(super) fn by_equation(observation: &Observation) -> Vec<Vec<usize>> {
    let equations = observation.groups.iter().map(|g| g.equation + 1).max().unwrap_or(0);
    let of = |equation| {
        let groups = observation.groups.iter().enumerate();
        groups.filter(|(_, g)| g.equation == equation && g.factor.rows() > 0).map(|(k, _)| k).collect()
    };
    (0..equations).map(of).collect()
}

fn rows_of(observation: &Observation) -> Vec<f64> {
    observation.groups.iter().map(|g| g.factor.rows() as f64).collect()
}

/// WT W of a group.
fn gram(factor: &Factor) -> DMatrix<f64> {
    let k = factor.unknowns();
    let r = DMatrix::from_fn(k + 1, k, |i, l| factor.r(i, l));
    r.tr_mul(&r)
}

/// Trace of a group's part of the hat matrix, W A^-1 WT, for rows of weight one; `places` are (column of the group,
/// place in A).
fn leverage(gram: &DMatrix<f64>, places: &[(usize, usize)], inverse: &DMatrix<f64>) -> f64 {
    let mut trace = 0.0;
    for &(a, pa) in places {
        for &(b, pb) in places {
            trace += gram[(a, b)] * inverse[(pa, pb)];
        }
    }
    trace
}

fn squares(factor: &Factor, residual: f64, leverage: f64) -> Variance {
    let rows = factor.rows() as f64;
    Variance::of_squares(residual * residual, (rows - leverage).clamp(0.0, rows))
}

/// The standard deviations of the groups from their squares, never so small that their inverse means nothing. An equation
/// that the fit leaves no freedom, as one of a single trajectory with fewer rows than parameters, is lent the relative
/// error of the others.
fn settle(observation: &Observation, equations: &[Vec<usize>], squares: &[Variance], weights: &mut Weights) {
    let mean_square = |g: usize| {
        let factor = &observation.groups[g].factor;
        factor.norm_y().powi(2) / factor.rows().max(1) as f64
    };
    let lent = Lent::of((0..squares.len()).map(|g| (squares[g], mean_square(g))));
    for own in equations {
        let known =
            |g: usize| Variance { freedom: squares[g].freedom / weights.rows_worth_one[g], ..squares[g] };
        let seen: Vec<Variance> = own.iter().map(|&g| known(g)).collect();
        let prior = Prior::of_groups(&seen);
        let freedom = own.iter().map(|&g| squares[g].freedom).sum();
        for (&g, &seen) in own.iter().zip(&seen) {
            let moderated = prior.map_or(0.0, |prior| prior.moderate(seen).value);
            let variance = lent.completed(moderated, freedom, mean_square(g));
            let sigma = variance.sqrt().max(FLOOR * mean_square(g).sqrt());
            weights.sigma[g] = if sigma > 0.0 { sigma } else { 1.0 };
            weights.freedom[g] = squares[g].freedom;
        }
    }
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

/// Values of some unknowns among all of them; the others are zero.
pub(super) fn spread(values: &[f64], active: &[usize], unknowns: usize) -> Vec<f64> {
    let mut chi = vec![0.0; unknowns];
    for (&l, &x) in active.iter().zip(values) {
        chi[l] = x;
    }
    chi
}
