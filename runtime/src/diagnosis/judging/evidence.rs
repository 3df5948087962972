//! How sure it is that a gain is no accident, where residuals are not white and many candidates were tried.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::judging::folds::{Fold, single_motion};
use crate::diagnosis::judging::judge::Verdict;
use crate::diagnosis::judging::memory::{Memory, forgotten, places};
use crate::diagnosis::judging::partial_regression::{own_part, rest_of_motion};
use crate::diagnosis::judging::significance::{Block, Evidence, mean_gain, mean_root, slope};
use crate::diagnosis::rows::design::{Design, LONGEST_BLOCK};
use crate::diagnosis::rows::fit::Fit;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// Shifts in time that a waveform is compared with.
const SHIFTS: usize = 100;

/// Evidence for a law that leaves no amplitude free: its own part is correlated with the residual as it is, and with
/// the residual shifted in time, which has the same spectrum and nothing to do with the law.
pub(in crate::diagnosis) fn waveform_evidence(
    design: &Design,
    whole: &Fit,
    sigma: &[f64],
    candidate: &Candidate,
    trial: usize,
) -> Evidence {
    let trial = &candidate.trials[trial];
    let everything = vec![true; design.segments.len()];
    let Some(own) = own_part(design, whole, sigma, trial, &everything) else { return Evidence::NONE };
    let residual = whole.residual(design);
    let mut waveform = vec![0.0; design.rows.len()];
    for column in own.columns(design, trial) {
        waveform.iter_mut().zip(&column).for_each(|(w, c)| *w += c);
    }
    let correlation = |shift: usize| -> f64 {
        let of_joint = |j: usize| {
            let range = design.of_joint(j);
            let rows = range.len();
            let by = rows * shift / SHIFTS;
            let (r, w) = (&residual[range.clone()], &waveform[range]);
            let wrapped = crate::diagnosis::rows::design::dot(&r[by..], &w[..rows - by])
                + crate::diagnosis::rows::design::dot(&r[..by], &w[rows - by..]);
            wrapped / (sigma[j] * sigma[j])
        };
        (0..design.joints).map(of_joint).sum()
    };
    let null: Vec<f64> = (2..SHIFTS - 1).map(correlation).collect();
    let n = null.len() as f64;
    let mean = null.iter().sum::<f64>() / n;
    let variance = null.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0);
    let evidence = Evidence::student((correlation(0) - mean) / variance.sqrt().max(1e-12), n - 1.0);
    Evidence { looks: candidate.shapes, ..evidence }
}

/// Evidence that what a candidate changes is really there, in a recording with too few blocks of motion to compare:
/// its amplitudes against their covariance in a residual that remembers (Wald's test with the residual's own
/// autocorrelation, taken with the candidate fitted).
///
/// Only for laws of one joint: what residuals of different joints have in common is not counted.
fn memory_evidence(
    design: &Design,
    whole: &Fit,
    sigma: &[f64],
    candidate: &Candidate,
    trial: usize,
) -> Option<Evidence> {
    let trial = &candidate.trials[trial];
    let everything = vec![true; design.segments.len()];
    let own = own_part(design, whole, sigma, trial, &everything)?;
    let (amplitude, _) = own.solve(candidate)?;
    let all = own.columns(design, trial);
    let residual = whole.residual(design);
    let mut left = residual.clone();
    for (column, a) in all.iter().zip(amplitude.iter()) {
        left.iter_mut().zip(column).for_each(|(r, c)| *r -= a * c);
    }
    let determined = own.determined();
    let columns: Vec<Vec<f64>> = determined.iter().map(|&k| all[k].clone()).collect();
    let k = columns.len();
    // What the fit takes out of the residual makes the noise look smaller than it is.
    let (rows, fitted) = (design.rows.len() as f64, (design.columns.len() + k) as f64);
    let spared = 1.0 - fitted / rows;
    if spared <= 0.0 {
        return None;
    }
    let mut products = DVector::zeros(k);
    let mut covariance = DMatrix::zeros(k, k);
    let mut freedom = f64::INFINITY;
    for (j, s) in sigma.iter().enumerate() {
        let places = places(design, j);
        let memory = Memory::of(&places, &left, design.rows_within(LONGEST_BLOCK));
        let weight = 1.0 / (s * s);
        covariance += memory.covariance(&places, &columns) * (weight * weight / spared);
        for r in design.of_joint(j) {
            for (product, column) in products.iter_mut().zip(&columns) {
                *product += weight * column[r] * residual[r];
            }
        }
        if candidate.own.contains(&j) {
            freedom = freedom.min(memory.independent_rows() * spared);
        }
    }
    let squares = products.dot(&covariance.cholesky()?.solve(&products));
    let evidence = Evidence::fisher(squares, k, freedom);
    Some(Evidence { looks: UNSEEN * candidate.shapes, ..evidence })
}

/// Evidence that what a candidate predicts for held-back motion is really there, whatever depends on what within a
/// block of motion.
///
/// With enough blocks it is their mean gain. A short recording has too few for any mean of gains to say much: there the
/// residual's memory tells how much a law of one joint stands out, and for laws of several joints, blocks are only as
/// long as the residual remembers, and the slope of the residual on the predicted change of torque is looked at as well.
pub(in crate::diagnosis) fn block_evidence(
    design: &Design,
    whole: &Fit,
    folds: &[Fold],
    sigma: &[f64],
    candidate: &Candidate,
    verdict: &Verdict,
) -> Evidence {
    // Shapes are chosen on other motion than they are judged on; on a single motion they are not.
    let shapes = if single_motion(design) { candidate.shapes } else { 1 };
    let of = |per_block| {
        let blocks = blocks(design, whole, folds, sigma, (candidate, verdict.trial), per_block);
        blocks.map(|b| b.into_values().collect::<Vec<Block>>())
    };
    if !design.short {
        let long = of(design.rows_within(LONGEST_BLOCK));
        return long.map_or(Evidence::NONE, |long| Evidence { looks: shapes, ..mean_gain(&long) });
    }
    if candidate.own.len() == 1 {
        return memory_evidence(design, whole, sigma, candidate, verdict.trial).unwrap_or(Evidence::NONE);
    }
    let Some(short) = of(rows_per_block(design, &whole.residual(design), &candidate.own)) else {
        return Evidence::NONE;
    };
    let (slope, gain) = (slope(&short), mean_gain(&short));
    let better = if slope.tail < gain.tail { slope } else { gain };
    Evidence { looks: 2 * LEANING * shapes, ..better }
}

/// Probability that a law which gains more than its rival on held-back motion does so by accident: their gains are
/// compared block by block.
pub(in crate::diagnosis) fn doubt(
    design: &Design,
    whole: &Fit,
    folds: &[Fold],
    sigma: &[f64],
    law: (&Candidate, usize),
    rival: (&Candidate, usize),
) -> f64 {
    let per_block = rows_per_block(design, &whole.residual(design), &law.0.own);
    let of = |which| blocks(design, whole, folds, sigma, which, per_block);
    let (Some(law), Some(rival)) = (of(law), of(rival)) else { return 0.0 };
    let ahead: Vec<f64> = law.iter().map(|(k, b)| b.gain() - rival.get(k).map_or(0.0, Block::gain)).collect();
    mean_root(&ahead).tail
}

/// What a trial of a candidate, fitted to the other motion, changes on each block of held-back motion.
fn blocks(
    design: &Design,
    whole: &Fit,
    folds: &[Fold],
    sigma: &[f64],
    (candidate, trial): (&Candidate, usize),
    per_block: usize,
) -> Option<BTreeMap<(usize, usize), Block>> {
    let trial = &candidate.trials[trial];
    let dense = trial.dense(design);
    let single = single_motion(design);
    let everything = vec![true; design.segments.len()];
    let mut blocks = BTreeMap::<(usize, usize), Block>::new();
    for fold in folds {
        let fit = if single { whole } else { &fold.fit };
        let train = if single { &everything } else { &fold.train };
        let own = own_part(design, fit, sigma, trial, train)?;
        let fitted =
            if single { rest_of_motion(design, whole, sigma, trial, &own, &fold.train) } else { own };
        let (a, _) = fitted.solve(candidate)?;
        let d = -(&fitted.x * &a);
        for (j, &s) in sigma.iter().enumerate() {
            for g in (0..design.segments.len()).filter(|&g| fold.test[g]) {
                for r in design.ranges[j][g].clone() {
                    let mut residual = design.y[r];
                    let mut change = 0.0;
                    for (k, column) in design.columns.iter().enumerate() {
                        residual -= column[r] * fit.chi[k];
                        change += column[r] * d[k];
                    }
                    for (k, column) in dense.iter().enumerate() {
                        change += column[r] * a[k];
                    }
                    let block = blocks.entry(design.block(design.rows[r], per_block)).or_default();
                    block.with_residual += change * residual / (s * s);
                    block.squares += change * change / (s * s);
                }
            }
        }
    }
    Some(blocks)
}

/// Shortest block, s.
const SHORTEST_BLOCK: f64 = 0.1;
/// Blocks are this many times as long as the residual remembers.
const MEMORIES: usize = 2;

/// Accidents come this many times as often as the tail says where neighbouring blocks still lean on each other.
const LEANING: usize = 2;
/// The same where a residual remembers for longer than it looks.
const UNSEEN: usize = 4;

/// Rows of a block: a few times the lag at which the residual of the slowest of these joints has forgotten itself.
fn rows_per_block(design: &Design, residual: &[f64], joints: &[usize]) -> usize {
    let longest = design.rows_within(LONGEST_BLOCK);
    let shortest = design.rows_within(SHORTEST_BLOCK);
    let memory = |&j: &usize| forgotten(&places(design, j), residual, longest);
    (MEMORIES * joints.iter().map(memory).max().unwrap_or(longest)).clamp(shortest, longest.max(shortest))
}
