//! How sure it is that a gain is no accident, where residuals are not white and many candidates were tried.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::judging::ar1::{Ar1, Places, decorrelation_lag};
use crate::diagnosis::judging::judge::Verdict;
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::judging::significance::{Block, Evidence, mean_gain, mean_root, slope};
use crate::diagnosis::rows::gram::dot;
use crate::diagnosis::rules::{
    AUTOCORRELATION_INFLATION, BLOCK_CORRELATION_INFLATION, LAGS_PER_BLOCK, LONGEST_BLOCK, SHIFTS,
    SHIFTS_LEFT_OUT, SHORTEST_BLOCK,
};
use nalgebra::{DMatrix, DVector};
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

    /// Wald's test of the amplitudes with the residual's own AR(1) autocorrelation, taken with the candidate fitted:
    /// for a recording with too few blocks of motion to compare. `None` where there are no degrees of freedom left.
    ///
    /// Only for laws of one joint: what residuals of different joints have in common is not counted.
    fn autocorrelation_evidence(&self, candidate: &Candidate, trial: usize) -> Option<Evidence> {
        let trial = &candidate.trials[trial];
        let design = &self.design;
        let part = self.fit.project_out(trial)?;
        let (amplitude, _) = part.solve(candidate)?;
        let all = part.columns(design, trial);
        let residual = self.residual();
        let mut left = residual.clone();
        for (column, a) in all.iter().zip(amplitude.iter()) {
            left.iter_mut().zip(column).for_each(|(r, c)| *r -= a * c);
        }
        let columns: Vec<Vec<f64>> = part.determined().into_iter().map(|k| all[k].clone()).collect();
        let k = columns.len();
        // The fit makes the residual smaller than the noise by this factor of its squares.
        let (rows, fitted) = (design.rows.len() as f64, (design.columns.len() + k) as f64);
        let spared = 1.0 - fitted / rows;
        if spared <= 0.0 {
            return None;
        }
        let mut products = DVector::zeros(k);
        let mut covariance = DMatrix::zeros(k, k);
        let mut freedom = f64::INFINITY;
        for (j, s) in self.sigma.iter().enumerate() {
            let places = Places::of(design, j);
            let noise = Ar1::of(&places, &left, design.rows_within(LONGEST_BLOCK));
            let weight = 1.0 / (s * s);
            covariance += noise.covariance(&places, &columns) * (weight * weight / spared);
            for r in design.of_joint(j) {
                for (product, column) in products.iter_mut().zip(&columns) {
                    *product += weight * column[r] * residual[r];
                }
            }
            if candidate.own.contains(&j) {
                freedom = freedom.min(noise.independent_rows() * spared);
            }
        }
        let squares = products.dot(&covariance.cholesky()?.solve(&products));
        let evidence = Evidence::fisher(squares, k, freedom);
        Some(Evidence { comparisons: AUTOCORRELATION_INFLATION * candidate.shapes, ..evidence })
    }

    /// Evidence that what a candidate predicts for held-out motion is really there, whatever depends on what within a
    /// block of motion.
    ///
    /// With enough blocks it is their mean gain. A short recording has too few for a mean to say much: there a law of
    /// one joint is tested against AR(1) noise; for laws of several joints, blocks are only as long as the residual is
    /// correlated, and the slope of the residual on the predicted change of torque is tested too.
    pub fn block_evidence(&self, candidate: &Candidate, verdict: &Verdict) -> Evidence {
        let design = &self.design;
        // Shapes are chosen on other motion than they are judged on; on a single motion they are not.
        let shapes = if design.is_single_motion() { candidate.shapes } else { 1 };
        let of = |per_block| {
            let blocks = self.blocks((candidate, verdict.trial), per_block);
            blocks.map(|b| b.into_values().collect::<Vec<Block>>())
        };
        if !design.short {
            let long = of(design.rows_within(LONGEST_BLOCK));
            return long.map_or(Evidence::NONE, |long| Evidence { comparisons: shapes, ..mean_gain(&long) });
        }
        if candidate.own.len() == 1 {
            return self.autocorrelation_evidence(candidate, verdict.trial).unwrap_or(Evidence::NONE);
        }
        let Some(short) = of(self.rows_per_block(&candidate.own)) else {
            return Evidence::NONE;
        };
        let (slope, gain) = (slope(&short), mean_gain(&short));
        let better = if slope.p_value < gain.p_value { slope } else { gain };
        Evidence { comparisons: 2 * BLOCK_CORRELATION_INFLATION * shapes, ..better }
    }

    /// Probability that a law which gains more than its rival on held-out motion does so by accident: their gains are
    /// compared block by block.
    pub fn difference_p_value(&self, law: Law<'_>, rival: Law<'_>) -> f64 {
        let per_block = self.rows_per_block(&law.0.own);
        let (Some(law), Some(rival)) = (self.blocks(law, per_block), self.blocks(rival, per_block)) else {
            return 0.0;
        };
        let ahead: Vec<f64> =
            law.iter().map(|(k, b)| b.gain() - rival.get(k).map_or(0.0, Block::gain)).collect();
        mean_root(&ahead).p_value
    }

    /// What a trial of a candidate, fitted to the other motion, changes on each block of held-out motion.
    fn blocks(
        &self,
        (candidate, trial): Law<'_>,
        per_block: usize,
    ) -> Option<BTreeMap<(usize, usize), Block>> {
        let trial = &candidate.trials[trial];
        let design = &self.design;
        let dense = trial.dense(design);
        let whole = if design.is_single_motion() { Some(self.fit.project_out(trial)?) } else { None };
        let mut blocks = BTreeMap::<(usize, usize), Block>::new();
        for fold in &self.folds {
            let prediction = match &whole {
                Some(whole) => self.predict_from_rest_of_motion(candidate, trial, whole, fold)?,
                None => self.predict_from_others(candidate, trial, fold)?,
            };
            for (j, &s) in self.sigma.iter().enumerate() {
                for g in (0..design.segments.len()).filter(|&g| fold.test[g]) {
                    for r in design.ranges[j][g].clone() {
                        let mut residual = design.y[r];
                        let mut change = 0.0;
                        for (k, column) in design.columns.iter().enumerate() {
                            residual -= column[r] * prediction.fit.chi[k];
                            change += column[r] * prediction.shift[k];
                        }
                        for (k, column) in dense.iter().enumerate() {
                            change += column[r] * prediction.amplitude[k];
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
