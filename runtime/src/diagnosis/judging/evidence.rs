//! How sure it is that a waveform without a free amplitude is there, and that one law gains more than another.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::judging::autocorrelation::{Places, decorrelation_lag};
use crate::diagnosis::judging::hull::{Beyond, Curve};
use crate::diagnosis::judging::regression::{Regression, is_beyond};
use crate::diagnosis::judging::significance::{Block, Evidence, mean_root};
use crate::diagnosis::rows::gram::dot;
use crate::diagnosis::rules::{LAGS_PER_BLOCK, LONGEST_BLOCK, SHIFTS, SHIFTS_LEFT_OUT, SHORTEST_BLOCK};
use std::collections::BTreeMap;

/// One shape of a candidate, by its index.
type Law<'a> = (&'a Candidate, usize);

impl Regression {
    /// Evidence for a law that leaves no amplitude free: its residualised columns are correlated with the residual as
    /// it is, and with the residual shifted in time, which has the same spectrum and nothing to do with the law.
    pub fn waveform_evidence(&self, candidate: &Candidate, trial: usize) -> Evidence {
        let trial = &candidate.trials[trial];
        let design = &self.design;
        let Some(part) = self.fit.project_out(trial) else { return Evidence::NONE };
        let residual = self.residual();
        let mut waveform = vec![0.0; design.rows.len()];
        for column in part.columns(design, trial) {
            waveform.iter_mut().zip(&column).for_each(|(w, c)| *w += c);
        }
        let ranges: Vec<_> = (0..design.joints).map(|j| design.of_joint(j)).collect();
        let evidence = shift_test(&residual, &waveform, &ranges, &self.sigma);
        Evidence { comparisons: candidate.shapes, ..evidence }
    }

    /// Probability that a law which gains more than its rival on held-out motion does so by accident: their gains are
    /// compared block by block, on rows that both say something of.
    pub fn difference_p_value(&self, law: Law<'_>, rival: Law<'_>) -> f64 {
        let per_block = self.rows_per_block(&law.0.own);
        let curve = |(candidate, trial): Law<'_>| Curve::of(candidate, &candidate.trials[trial]);
        let curves: Vec<Curve> = [law, rival].into_iter().filter_map(curve).collect();
        let blocks = |law| self.blocks(law, &curves, per_block);
        let (Some(law), Some(rival)) = (blocks(law), blocks(rival)) else { return 0.0 };
        let ahead: Vec<f64> =
            law.iter().map(|(k, b)| b.gain() - rival.get(k).map_or(0.0, Block::gain)).collect();
        mean_root(&ahead).p_value
    }

    /// What a trial of a candidate, fitted to the other motion, changes on each block of held-out motion.
    fn blocks(
        &self,
        (candidate, trial): Law<'_>,
        curves: &[Curve],
        per_block: usize,
    ) -> Option<BTreeMap<(usize, usize), Block>> {
        let trial = &candidate.trials[trial];
        let design = &self.design;
        let whole = if design.is_single_motion() { Some(self.fit.project_out(trial)?) } else { None };
        let whole = whole.map(|whole| (self.by_segment(&whole, trial), whole));
        let mut blocks = BTreeMap::<(usize, usize), Block>::new();
        for fold in &self.folds {
            let prediction = match &whole {
                Some((parts, whole)) => {
                    self.predict_from_rest_of_motion(candidate, trial, (whole, parts), fold)?
                }
                None => self.predict_from_others(candidate, trial, fold)?,
            };
            let beyond = Beyond::each(design, curves, &fold.fit.train);
            for (j, &s) in self.sigma.iter().enumerate() {
                for g in fold.held() {
                    let seen = |r: &usize| {
                        !is_beyond(&self.beyond, *r) && !beyond.iter().any(|beyond| beyond.contains(*r))
                    };
                    let rows: Vec<usize> = design.ranges[j][g].clone().filter(seen).collect();
                    let residual = prediction.fit.residual_on(design, &rows);
                    let changes = prediction.changes(design, j, &rows);
                    for ((&r, residual), change) in rows.iter().zip(residual).zip(changes) {
                        let block = blocks.entry(design.block(design.rows[r], per_block)).or_default();
                        block.with_residual += change * residual / (s * s);
                        block.squares += change * change / (s * s);
                    }
                }
            }
        }
        Some(blocks)
    }

    /// Rows of a block: a few times the decorrelation lag of the residual of the slowest of these joints.
    fn rows_per_block(&self, joints: &[usize]) -> usize {
        let design = &self.design;
        let residual = self.residual();
        let longest = design.rows_within(LONGEST_BLOCK);
        let shortest = design.rows_within(SHORTEST_BLOCK);
        let lag = |&j: &usize| decorrelation_lag(&Places::of(design, j), &residual, longest);
        let rows = LAGS_PER_BLOCK * joints.iter().map(lag).max().unwrap_or(longest);
        rows.clamp(shortest, longest.max(shortest))
    }
}

/// Correlation of a waveform with a residual, in standard deviations of its correlations with the residual shifted in
/// time (around the ends), joint by joint in `ranges`.
fn shift_test(
    residual: &[f64],
    waveform: &[f64],
    ranges: &[std::ops::Range<usize>],
    sigma: &[f64],
) -> Evidence {
    let correlation = |shift: usize| -> f64 {
        let of_joint = |(range, s): (&std::ops::Range<usize>, &f64)| {
            let rows = range.len();
            let by = rows * shift / SHIFTS;
            let (r, w) = (&residual[range.clone()], &waveform[range.clone()]);
            let wrapped = dot(&r[by..], &w[..rows - by]) + dot(&r[..by], &w[rows - by..]);
            wrapped / (s * s)
        };
        ranges.iter().zip(sigma).map(of_joint).sum()
    };
    let null: Vec<f64> = (SHIFTS_LEFT_OUT..SHIFTS - (SHIFTS_LEFT_OUT - 1)).map(correlation).collect();
    let n = null.len() as f64;
    let mean = null.iter().sum::<f64>() / n;
    let variance = null.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0);
    Evidence::student((correlation(0) - mean) / variance.sqrt().max(1e-12), n - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::judging::testing::correlated;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    #[test]
    fn a_waveform_that_is_not_there_passes_the_shift_test_as_often_as_its_p_value_says() {
        let mut rng = Pcg64::seed_from_u64(40);
        let (rows, runs, level) = (600, 4000, 0.05);
        for rho in [0.0, 0.7] {
            let below = (0..runs)
                .filter(|_| {
                    let residual = correlated(&mut rng, rows, rho);
                    let waveform = correlated(&mut rng, rows, 0.5);
                    shift_test(&residual, &waveform, std::slice::from_ref(&(0..rows)), &[1.0]).p_value < level
                })
                .count() as f64;
            let expected = level * f64::from(runs);
            let deviation = (expected * (1.0 - level)).sqrt();
            assert!((below - expected).abs() < 4.0 * deviation, "{rho}: {below} of {expected} expected");
        }
    }

    #[test]
    fn a_waveform_that_is_there_stands_out_of_its_shifts() {
        let mut rng = Pcg64::seed_from_u64(41);
        let noise = correlated(&mut rng, 600, 0.7);
        let waveform = correlated(&mut rng, 600, 0.5);
        let residual: Vec<f64> = noise.iter().zip(&waveform).map(|(n, w)| n + w).collect();
        assert!(shift_test(&residual, &waveform, std::slice::from_ref(&(0..600)), &[1.0]).p_value < 1e-6);
    }
}
