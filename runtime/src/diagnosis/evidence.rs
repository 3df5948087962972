//! How sure it is that a gain is no accident, where residuals are not white and many candidates were tried.

use super::candidate::Candidate;
use super::design::Design;
use super::fit::Fit;
use super::judge::{Fold, Verdict, own_part, rest_of_motion, single_motion};
use super::significance::{Block, Evidence, mean_gain, mean_root, slope};
use std::collections::BTreeMap;

/// Shifts in time that a waveform is compared with.
const SHIFTS: usize = 100;

/// Evidence for a law that leaves no amplitude free: its own part is correlated with the residual as it is, and with
/// the residual shifted in time, which has the same spectrum and nothing to do with the law.
pub(super) fn waveform_evidence(
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
    for (k, column) in trial.dense(design).iter().enumerate() {
        waveform.iter_mut().zip(column).for_each(|(w, c)| *w += c);
        for (i, made) in design.columns.iter().enumerate() {
            let x = own.x[(i, k)];
            if x != 0.0 {
                waveform.iter_mut().zip(made).for_each(|(w, c)| *w -= x * c);
            }
        }
    }
    let correlation = |shift: usize| -> f64 {
        let of_joint = |j: usize| {
            let range = design.of_joint(j);
            let rows = range.len();
            let by = rows * shift / SHIFTS;
            let (r, w) = (&residual[range.clone()], &waveform[range]);
            let wrapped =
                super::design::dot(&r[by..], &w[..rows - by]) + super::design::dot(&r[..by], &w[rows - by..]);
            wrapped / (sigma[j] * sigma[j])
        };
        (0..design.joints).map(of_joint).sum()
    };
    let null: Vec<f64> = (2..SHIFTS - 1).map(correlation).collect();
    let n = null.len() as f64;
    let mean = null.iter().sum::<f64>() / n;
    let variance = null.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0);
    Evidence {
        significance: (correlation(0) - mean) / variance.sqrt().max(1e-12),
        freedom: n - 1.0,
        looks: 1,
    }
}

/// Evidence that what a candidate predicts for held-back motion is really there, whatever depends on what within a
/// block of motion.
///
/// With enough blocks it is their mean gain. A short recording has too few for any mean of gains to say much: there
/// blocks are only as long as the residual remembers, and the slope of the residual on the predicted change of torque
/// is looked at as well.
pub(super) fn block_evidence(
    design: &Design,
    whole: &Fit,
    folds: &[Fold],
    sigma: &[f64],
    candidate: &Candidate,
    verdict: &Verdict,
) -> Evidence {
    let of = |per_block| {
        let blocks = blocks(design, whole, folds, sigma, (candidate, verdict.trial), per_block);
        blocks.map(|b| b.into_values().collect::<Vec<Block>>())
    };
    let longest = (LONGEST_BLOCK / design.step).ceil() as usize;
    let Some(long) = of(longest) else { return Evidence::NONE };
    if long.len() >= ENOUGH_BLOCKS {
        return mean_gain(&long);
    }
    let Some(short) = of(rows_per_block(design, &whole.residual(design), &candidate.own)) else {
        return Evidence::NONE;
    };
    let (slope, gain) = (slope(&short), mean_gain(&short));
    let better = if slope.tail() < gain.tail() { slope } else { gain };
    Evidence { looks: 2 * LEANING, ..better }
}

/// Probability that a law which gains more than its rival on held-back motion does so by accident: their gains are
/// compared block by block.
pub(super) fn doubt(
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
    mean_root(&ahead).tail()
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

/// Longest block of motion, s.
pub(super) const LONGEST_BLOCK: f64 = 0.5;
/// From this many blocks of that length on, their mean gain decides alone.
const ENOUGH_BLOCKS: usize = 24;
/// Shortest block, s.
const SHORTEST_BLOCK: f64 = 0.1;
/// Autocorrelation below which a residual has forgotten.
const FORGOTTEN: f64 = 0.2;
/// Blocks are this many times as long as the residual remembers.
const MEMORIES: usize = 2;

/// Accidents come this many times as often as the tail says where neighbouring blocks still lean on each other.
const LEANING: usize = 2;

/// Rows of a block: a few times the lag at which the residual of the slowest of these joints has forgotten itself.
fn rows_per_block(design: &Design, residual: &[f64], joints: &[usize]) -> usize {
    let longest = (LONGEST_BLOCK / design.step).ceil() as usize;
    let shortest = (SHORTEST_BLOCK / design.step).ceil() as usize;
    let motions = design.segments.iter().map(|s| s.signal + 1).max().unwrap_or(0);
    let memory = |j: usize| {
        let motion = |signal: usize| {
            let rows = design.of_signal(j, signal).into_iter().flat_map(|(range, _)| range);
            rows.map(|r| (design.rows[r].centre / design.spacing(signal), residual[r])).collect()
        };
        let series: Vec<Vec<(usize, f64)>> = (0..motions).map(motion).collect();
        (1..longest).find(|&lag| autocorrelation(&series, lag) < FORGOTTEN).unwrap_or(longest)
    };
    let memory = joints.iter().map(|&j| memory(j)).max().unwrap_or(longest);
    (MEMORIES * memory).clamp(shortest, longest.max(shortest))
}

/// Correlation of series with themselves `lag` places later, over pairs of places that are there.
fn autocorrelation(series: &[Vec<(usize, f64)>], lag: usize) -> f64 {
    let (mut products, mut pairs, mut squares, mut places) = (0.0, 0, 0.0, 0);
    for series in series {
        let mut later = series.iter().peekable();
        for &(place, x) in series {
            squares += x * x;
            places += 1;
            while later.next_if(|(l, _)| *l < place + lag).is_some() {}
            if let Some((_, y)) = later.peek().filter(|(l, _)| *l == place + lag) {
                products += x * y;
                pairs += 1;
            }
        }
    }
    if pairs == 0 || squares == 0.0 { 0.0 } else { products / pairs as f64 / (squares / places as f64) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn correlation_looks_at_pairs_of_rows_that_are_there() {
        // A square wave of period 4, with rows missing: 1 after four rows, -1 after two, nothing after one.
        let wave = |k: usize| if k % 4 < 2 { 1.0 } else { -1.0 };
        let rows = [(0..400).filter(|k| k % 37 != 0).map(|k| (k, wave(k))).collect()];
        assert!((autocorrelation(&rows, 4) - 1.0).abs() < 1e-12);
        assert!((autocorrelation(&rows, 2) + 1.0).abs() < 1e-12);
        assert!(autocorrelation(&rows, 1).abs() < 0.02);
        assert_eq!(autocorrelation(&[vec![(0, 1.0), (9, 1.0)]], 1), 0.0);
    }
}
