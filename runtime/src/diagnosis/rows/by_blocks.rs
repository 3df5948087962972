//! How much parameters vary as blocks of motion show it.

use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rules::LEAST_OF_A_BLOCK;
use crate::statistics::student::student_factor;
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;
use std::ops::Range;

/// The variance of one parameter as blocks of motion show it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::diagnosis) struct OneOfBlocks {
    pub variance: f64,
    /// Degrees of freedom that it has.
    pub freedom: f64,
}

impl OneOfBlocks {
    /// The variance such that 1.96 of its standard deviations are half an interval of 95 %.
    pub fn widened(&self) -> f64 {
        self.variance * student_factor(self.freedom).powi(2)
    }
}

/// A covariance as blocks of motion show it.
pub(in crate::diagnosis) struct OfBlocks {
    pub matrix: DMatrix<f64>,
    /// Number of blocks.
    pub blocks: usize,
}

impl Fit {
    /// Variance of the parameter of a column where blocks of motion, of `rows` rows, err independently of each other, each by
    /// as much as its residual shows, as [`Self::covariance_by_blocks`] has it, but with what the fit takes of the squares of a
    /// block given back to it, and with the degrees of freedom of blocks that count differently (Bell and McCaffrey 2002, with
    /// independent rows as the working model). None where no row knows of the parameter.
    pub fn variance_by_blocks(
        &self,
        design: &Design,
        residual: &[f64],
        column: usize,
        rows: usize,
    ) -> Option<OneOfBlocks> {
        let weights = self.weights_of(column);
        let mut blocks: BTreeMap<(usize, usize), BlockError> = BTreeMap::new();
        for (j, sigma) in self.sigma.iter().enumerate() {
            let per_variance = 1.0 / (sigma * sigma);
            for row in design.of_joint(j) {
                let influence = influence(design, &weights, row);
                let block = blocks.entry(design.block(design.rows[row], rows));
                let block = block.or_insert_with(|| BlockError::none(self.chi.len()));
                block.error += influence * residual[row] * per_variance;
                block.expected += influence * influence * per_variance;
                for (fitted, c) in block.fitted.iter_mut().zip(&design.columns) {
                    *fitted += influence * per_variance * c[row];
                }
            }
        }
        let blocks: Vec<BlockError> = blocks.into_values().filter(|block| block.expected > 0.0).collect();
        if blocks.is_empty() {
            return None;
        }
        // With independent rows the errors of blocks b and c have the covariance expected_b (b = c) less fitted_b G^-1
        // fitted_c, each scaled such that the diagonal is what is expected: its trace, and that of its square.
        let (mut variance, mut trace, mut squares) = (0.0, 0.0, 0.0);
        let mut between = DMatrix::zeros(self.chi.len(), self.chi.len());
        for block in &blocks {
            let fitted = self.solve(&block.fitted);
            let taken = block.fitted.dot(&fitted);
            let scale = (1.0 - taken / block.expected).max(LEAST_OF_A_BLOCK).recip();
            variance += scale * block.error * block.error;
            trace += scale * (block.expected - taken);
            squares += scale * scale * block.expected * (block.expected - 2.0 * taken);
            between.ger(scale, &fitted, &block.fitted, 1.0);
        }
        squares += between.component_mul(&between.transpose()).sum();
        Some(OneOfBlocks { variance, freedom: trace * trace / squares })
    }

    /// Covariance of the parameters of columns where blocks of motion, of `rows` rows, err independently of each other, each
    /// by as much as its residual shows: for noise that lasts, and for what the model lacks (White 1980; Liang and Zeger
    /// 1986).
    pub fn covariance_by_blocks(
        &self,
        design: &Design,
        residual: &[f64],
        columns: Range<usize>,
        rows: usize,
    ) -> OfBlocks {
        let k = columns.len();
        let weights: Vec<DVector<f64>> = columns.map(|column| self.weights_of(column)).collect();
        let mut blocks: BTreeMap<(usize, usize), DVector<f64>> = BTreeMap::new();
        for (j, sigma) in self.sigma.iter().enumerate() {
            for row in design.of_joint(j) {
                let block =
                    blocks.entry(design.block(design.rows[row], rows)).or_insert_with(|| DVector::zeros(k));
                let error = residual[row] / (sigma * sigma);
                for (sum, w) in block.iter_mut().zip(&weights) {
                    *sum += influence(design, w, row) * error;
                }
            }
        }
        let count = blocks.len().max(2) as f64;
        let squares = blocks.values().fold(DMatrix::zeros(k, k), |sum, b| sum + b * b.transpose());
        OfBlocks { matrix: squares * (count / (count - 1.0)), blocks: blocks.len() }
    }

    /// What makes the parameter of a column of the columns' inner products with the torques.
    fn weights_of(&self, column: usize) -> DVector<f64> {
        self.solve(&DVector::from_fn(self.chi.len(), |i, _| if i == column { 1.0 } else { 0.0 }))
    }
}

/// What one unit of a row's torque, weighted, does to the parameter with these weights.
fn influence(design: &Design, weights: &DVector<f64>, row: usize) -> f64 {
    design.columns.iter().zip(weights.iter()).map(|(c, w)| c[row] * w).sum()
}

/// What a block of motion does to one parameter.
struct BlockError {
    /// By its residual.
    error: f64,
    /// The square of it that independent rows make expected, in units of their variance.
    expected: f64,
    /// Its influence in the space of the design's columns: the part of `expected` that the fit takes.
    fitted: DVector<f64>,
}

impl BlockError {
    fn none(parameters: usize) -> Self {
        Self { error: 0.0, expected: 0.0, fitted: DVector::zeros(parameters) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    /// Twelve blocks of 20 rows, noise that is one number a block and one a row, and a column that only the first `shown`
    /// blocks have: how often value +- 1.96 standard deviations holds the truth, and +- that of equal blocks.
    fn coverage(shown: usize) -> [f64; 2] {
        const ROWS: usize = 20;
        const BLOCKS: usize = 12;
        const TRUTH: f64 = 2.0;
        let mut rng = Pcg64::seed_from_u64(11);
        let runs = 3000;
        let mut inside = [0, 0];
        for _ in 0..runs {
            let mut normal = || -> f64 { StandardNormal.sample(&mut rng) };
            let all = ROWS * BLOCKS;
            let level: Vec<f64> = (0..BLOCKS).map(|_| normal()).collect();
            let own: Vec<f64> =
                (0..all).map(|r| if r / ROWS < shown { 1.0 + 0.3 * normal() } else { 0.0 }).collect();
            let others: Vec<Vec<f64>> = (0..3).map(|_| (0..all).map(|_| normal()).collect()).collect();
            let y = (0..all).map(|r| TRUTH * own[r] + level[r / ROWS] + 0.5 * normal()).collect();
            let columns = std::iter::once(own).chain(others).collect();
            let design = Design::made_up(1, &[(0, true)], all, columns, y);
            let fit = Fit::whole(&design, &[1.0]).expect("a small problem is regular");
            let residual = fit.residual(&design);
            let of_equal = fit.covariance_by_blocks(&design, &residual, 0..1, ROWS).matrix[(0, 0)];
            let by_blocks =
                fit.variance_by_blocks(&design, &residual, 0, ROWS).expect("every block knows of it");
            let variances = [by_blocks.widened(), of_equal];
            for (inside, variance) in inside.iter_mut().zip(variances) {
                *inside += usize::from((fit.chi[0] - TRUTH).abs() <= 1.96 * variance.sqrt());
            }
        }
        inside.map(|n| n as f64 / f64::from(runs))
    }

    #[test]
    fn an_interval_holds_however_few_blocks_tell_the_parameter() {
        for shown in [3, 5, 12] {
            let [corrected, of_equal] = coverage(shown);
            // 3000 draws: one standard deviation is 0.4 %.
            assert!(
                (0.935..0.975).contains(&corrected),
                "{shown} blocks: {corrected}, {of_equal} of equal ones"
            );
            assert!(of_equal < corrected, "{shown} blocks: {of_equal}");
        }
    }
}
