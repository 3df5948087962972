//! Robust estimation: blocks of time that do not fit count less (iteratively reweighted least squares).

use super::Factor;
use super::observe::{EquationFactor, Observation, TimeBlock};
use super::outcome::BlockWeight;
use super::weights::{from_own_fits, iterate, residual_norm, solve_active};
use crate::statistics::median::median;

/// A block may deviate this many times as much as the typical one at full weight (Huber's constant).
const HUBER: f64 = 1.5;
/// Largest change of a weight at which the iteration has converged.
const CONVERGED: f64 = 1e-3;
/// Most iterations.
const ITERATIONS: usize = 50;

/// An observation whose blocks are scaled by what they count.
pub(super) struct Reweighted {
    pub observation: Observation,
    /// Blocks that count less than half.
    pub low: Vec<BlockWeight>,
    pub iterations: usize,
    pub converged: bool,
}

/// Huber's M-estimator (Huber 1964; Holland and Welsch 1977) with a block of time of one equation as the unit: a
/// contact, a stall or a burst of noise disturbs rows that follow each other. The residual of a block is its root
/// mean square; the scale is the median over the equation's blocks.
pub(super) fn reweight(observation: &Observation, active: &[usize]) -> Reweighted {
    let mut weights: Vec<Vec<f64>> =
        observation.blocks.iter().map(|b| vec![1.0; b.equations.len()]).collect();
    let mut scaled = observation.clone();
    let mut iterations = 0;
    let mut converged = false;
    while iterations < ITERATIONS && !converged {
        let sigma = iterate(&scaled, active, &from_own_fits(&scaled)).sigma;
        let chi = solve_active(&scaled, active, &sigma);
        let new = huber(&observation.blocks, &chi);
        let change = new.iter().flatten().zip(weights.iter().flatten()).map(|(a, b)| (a - b).abs());
        converged = change.fold(0.0, f64::max) < CONVERGED;
        weights = new;
        scaled = scale(observation, &weights);
        iterations += 1;
    }
    let low = observation
        .blocks
        .iter()
        .zip(&weights)
        .flat_map(|(block, weights)| {
            block.equations.iter().zip(weights).filter(|(_, w)| **w < 0.5).map(|(e, &weight)| BlockWeight {
                trajectory: block.trajectory,
                equation: e.equation,
                time: block.time,
                weight,
            })
        })
        .collect();
    scale_rows(&mut scaled, &weights);
    Reweighted { observation: scaled, low, iterations, converged }
}

/// Weight of each block and equation.
fn huber(blocks: &[TimeBlock], chi: &[f64]) -> Vec<Vec<f64>> {
    let equations = blocks.iter().map(|b| b.equations.len()).max().unwrap_or(0);
    let residual = |e: &EquationFactor| residual_norm(e, chi) / (e.factor.rows() as f64).sqrt();
    let scales: Vec<f64> = (0..equations)
        .map(|k| {
            let own = blocks.iter().filter_map(|b| b.equations.get(k)).filter(|e| e.factor.rows() > 0);
            median(&mut own.map(residual).collect::<Vec<_>>())
        })
        .collect();
    blocks
        .iter()
        .map(|b| {
            let weight = |(e, scale): (&EquationFactor, &f64)| {
                let size = if e.factor.rows() > 0 { residual(e) } else { 0.0 };
                if size > HUBER * scale { HUBER * scale / size } else { 1.0 }
            };
            b.equations.iter().zip(&scales).map(weight).collect()
        })
        .collect()
}

/// The observation with each block's rows multiplied by the root of its weight.
fn scale(observation: &Observation, weights: &[Vec<f64>]) -> Observation {
    let mut scaled = observation.clone();
    for group in &mut scaled.groups {
        group.factor = Factor::new(group.columns.len());
    }
    for (block, weights) in scaled.blocks.iter_mut().zip(weights) {
        for (equation, weight) in block.equations.iter_mut().zip(weights) {
            let own: Vec<usize> = (0..equation.columns.len()).collect();
            let mut factor = Factor::new(own.len());
            factor.merge_weighted(&equation.factor, &own, weight.sqrt());
            equation.factor = factor;
            let group = scaled
                .groups
                .iter_mut()
                .find(|g| g.trajectory == equation.trajectory && g.equation == equation.equation);
            if let Some(group) = group.filter(|_| equation.factor.rows() > 0) {
                group.factor.merge(&equation.factor);
            }
        }
    }
    scaled
}

/// The rows, where they were kept, multiplied by the root of the weight of their block.
fn scale_rows(observation: &mut Observation, weights: &[Vec<f64>]) {
    let Observation { rows: Some(rows), blocks, .. } = observation else { return };
    for (block, weights) in blocks.iter().zip(weights) {
        for rows in rows.iter_mut().filter(|r| r.trajectory == block.trajectory) {
            let Some(weight) = weights.get(rows.equation).filter(|w| **w < 1.0) else { continue };
            let count = rows.y.len();
            let inside = |t: f64| t >= block.time[0] && t <= block.time[1];
            for t in (0..count).filter(|&t| inside(rows.time[t])) {
                rows.y[t] *= weight.sqrt();
                rows.w.iter_mut().skip(t).step_by(count).for_each(|w| *w *= weight.sqrt());
            }
        }
    }
}
