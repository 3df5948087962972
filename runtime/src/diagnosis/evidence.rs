//! How sure it is that a gain is no accident, where residuals are not white and many candidates were tried.

use super::candidate::Candidate;
use super::design::Design;
use super::fit::Fit;
use super::judge::{Fold, Verdict, own_part, rest_of_motion, single_motion};
use statrs::distribution::{ContinuousCDF, StudentsT};
use std::collections::BTreeMap;

/// How sure it is that a gain is no accident.
#[derive(Debug, Clone, Copy)]
pub(super) struct Evidence {
    /// In standard errors.
    pub significance: f64,
    /// Degrees of freedom of the standard error.
    pub freedom: f64,
    /// Ways of looking at the same rows, of which this is the best.
    pub looks: usize,
}

impl Evidence {
    pub const NONE: Self = Self { significance: 0.0, freedom: 1.0, looks: 1 };

    /// One minus the probability that the best of `tries` candidates comes as far by accident (Bonferroni), by
    /// Student's distribution.
    pub fn confidence(&self, tries: usize) -> f64 {
        (1.0 - self.tail() * (tries * self.looks) as f64).clamp(0.0, 0.9999)
    }

    /// Probability that an accident comes as far.
    fn tail(&self) -> f64 {
        StudentsT::new(0.0, 1.0, self.freedom.max(1.0)).map_or(1.0, |t| t.sf(self.significance))
    }
}

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
    Evidence { looks: 2, ..better }
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

/// Rows of a block: a few times the lag at which the residual of the slowest of these joints has forgotten itself.
fn rows_per_block(design: &Design, residual: &[f64], joints: &[usize]) -> usize {
    let longest = (LONGEST_BLOCK / design.step).ceil() as usize;
    let shortest = (SHORTEST_BLOCK / design.step).ceil() as usize;
    let forgotten =
        |j: usize| (1..longest).find(|&lag| autocorrelation(design, residual, j, lag) < FORGOTTEN);
    let memory = joints.iter().map(|&j| forgotten(j).unwrap_or(longest)).max().unwrap_or(longest);
    (MEMORIES * memory).clamp(shortest, longest.max(shortest))
}

/// Correlation of a joint's residual with itself `lag` rows later, over pairs of rows that are there.
fn autocorrelation(design: &Design, residual: &[f64], joint: usize, lag: usize) -> f64 {
    let (mut products, mut pairs, mut squares, mut rows) = (0.0, 0, 0.0, 0);
    for signal in 0..=design.segments.iter().map(|s| s.signal).max().unwrap_or(0) {
        let at: Vec<usize> =
            design.of_signal(joint, signal).into_iter().flat_map(|(range, _)| range).collect();
        let step = lag * design.spacing(signal);
        let mut later = at.iter().peekable();
        for &r in &at {
            squares += residual[r] * residual[r];
            rows += 1;
            let wanted = design.rows[r].centre + step;
            while later.next_if(|&&l| design.rows[l].centre < wanted).is_some() {}
            if let Some(&&l) = later.peek()
                && design.rows[l].centre == wanted
            {
                products += residual[r] * residual[l];
                pairs += 1;
            }
        }
    }
    if pairs == 0 || squares == 0.0 { 0.0 } else { products / pairs as f64 / (squares / rows as f64) }
}

/// Inner products over a block of motion of the predicted change with the residual and with itself.
#[derive(Debug, Clone, Copy, Default)]
struct Block {
    with_residual: f64,
    squares: f64,
}

impl Block {
    /// Squares of the residual that the change takes away.
    fn gain(&self) -> f64 {
        2.0 * self.with_residual - self.squares
    }
}

/// The slope of the residual on the predicted change, in standard errors of a jackknife over blocks.
///
/// A change that is an accident of the other motion has a slope of zero; one that is real and known exactly has one.
/// Its degrees of freedom count the blocks that the change is spread over.
fn slope(blocks: &[Block]) -> Evidence {
    let squares: f64 = blocks.iter().map(|b| b.squares).sum();
    // Blocks that carry the change: their number if it is spread evenly, fewer if few of them hold most of it.
    let carrying = squares * squares / blocks.iter().map(|b| b.squares * b.squares).sum::<f64>().max(1e-300);
    if carrying < 3.0 {
        return Evidence::NONE;
    }
    let slope = blocks.iter().map(|b| b.with_residual).sum::<f64>() / squares;
    let variance: f64 = blocks
        .iter()
        .map(|b| {
            let without = (b.with_residual - slope * b.squares) / (squares - b.squares).max(1e-9 * squares);
            without * without
        })
        .sum();
    Evidence { significance: slope / variance.sqrt().max(1e-12), freedom: carrying - 1.0, looks: 1 }
}

/// The mean gain of a block in standard errors: weaker than the slope where few blocks say little, stronger where few
/// blocks say nearly everything.
fn mean_gain(blocks: &[Block]) -> Evidence {
    mean_root(&blocks.iter().map(Block::gain).collect::<Vec<f64>>())
}

/// Gains are heavy-tailed, so their signed square roots are compared with zero.
fn mean_root(gains: &[f64]) -> Evidence {
    let roots: Vec<f64> = gains.iter().map(|g| g.signum() * g.abs().sqrt()).collect();
    let n = roots.len() as f64;
    if n < 4.0 {
        return Evidence::NONE;
    }
    let mean = roots.iter().sum::<f64>() / n;
    let variance = roots.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0);
    Evidence { significance: mean / (variance / n).sqrt().max(1e-12), freedom: n - 1.0, looks: 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn confidence_counts_every_candidate_and_knows_that_few_blocks_say_little() {
        let at = |significance, freedom| Evidence { significance, freedom, looks: 1 };
        assert!(at(5.0, 100.0).confidence(100) > 0.999);
        assert!(at(5.0, 100.0).confidence(100_000) < at(5.0, 100.0).confidence(100));
        // Student's tail beyond 4 standard errors with 8 degrees of freedom is 0.0019749 (scipy.stats.t.sf).
        assert!((at(4.0, 8.0).confidence(100) - (1.0 - 100.0 * 0.001_974_886)).abs() < 1e-6);
        assert_eq!(at(0.0, 100.0).confidence(100), 0.0);
        assert_eq!(Evidence::NONE.confidence(1), 0.5);
    }
}
