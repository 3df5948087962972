//! Tests of a gain over blocks of motion, and their p-values corrected for the number of comparisons.

use crate::diagnosis::rules::{HIGHEST_CONFIDENCE, LEAST_BLOCKS, LEAST_CARRYING_BLOCKS};
use statrs::distribution::{ContinuousCDF, FisherSnedecor, StudentsT};

/// How sure it is that a gain is no accident.
#[derive(Debug, Clone, Copy)]
pub(in crate::diagnosis) struct Evidence {
    /// In standard errors.
    pub significance: f64,
    /// Probability that noise alone comes as far.
    pub p_value: f64,
    /// Number of tests made on these rows, of which this is the best; multiplies the Bonferroni count.
    pub comparisons: usize,
}

impl Evidence {
    pub const NONE: Self = Self { significance: 0.0, p_value: 0.5, comparisons: 1 };

    /// Of a number that is this many standard errors above zero, these with so many degrees of freedom (Student).
    pub fn student(significance: f64, freedom: f64) -> Self {
        let p_value = StudentsT::new(0.0, 1.0, freedom.max(1.0)).map_or(1.0, |t| t.sf(significance));
        Self { significance, p_value, comparisons: 1 }
    }

    /// Of `numbers` numbers whose squares, in units of their covariance, add up to `squares`, the covariance with so
    /// many degrees of freedom (Fisher).
    pub fn fisher(squares: f64, numbers: usize, freedom: f64) -> Self {
        let k = numbers as f64;
        let p_value = FisherSnedecor::new(k, freedom).map_or(1.0, |f| f.sf(squares.max(0.0) / k));
        Self { significance: squares.max(0.0).sqrt(), p_value, comparisons: 1 }
    }

    /// One minus the probability that the best of `tries` candidates comes as far by accident (Bonferroni).
    pub fn confidence(&self, tries: usize) -> f64 {
        (1.0 - self.p_value * (tries * self.comparisons) as f64).clamp(0.0, HIGHEST_CONFIDENCE)
    }
}

/// Inner products over a block of motion of the predicted change with the residual and with itself.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::diagnosis) struct Block {
    pub with_residual: f64,
    pub squares: f64,
}

impl Block {
    /// Squares of the residual that the change takes away.
    pub fn gain(&self) -> f64 {
        2.0 * self.with_residual - self.squares
    }
}

/// The slope of the residual on the predicted change, in standard errors of a jackknife over blocks.
///
/// A change that is an accident of the other motion has a slope of zero; one that is real and known exactly has one.
/// Its degrees of freedom count the blocks that the change is spread over.
pub(in crate::diagnosis) fn slope(blocks: &[Block]) -> Evidence {
    let squares: f64 = blocks.iter().map(|b| b.squares).sum();
    // Blocks that carry the change: their number if it is spread evenly, fewer if few of them hold most of it.
    let carrying = squares * squares / blocks.iter().map(|b| b.squares * b.squares).sum::<f64>().max(1e-300);
    if carrying < LEAST_CARRYING_BLOCKS {
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
    Evidence::student(slope / variance.sqrt().max(1e-12), carrying - 1.0)
}

/// The mean gain of a block in standard errors: weaker than the slope where few blocks say little, stronger where few
/// blocks say nearly everything.
pub(in crate::diagnosis) fn mean_gain(blocks: &[Block]) -> Evidence {
    mean_root(&blocks.iter().map(Block::gain).collect::<Vec<f64>>())
}

/// Gains are heavy-tailed, so their signed square roots are compared with zero.
pub(in crate::diagnosis) fn mean_root(gains: &[f64]) -> Evidence {
    let roots: Vec<f64> = gains.iter().map(|g| g.signum() * g.abs().sqrt()).collect();
    let n = roots.len() as f64;
    if n < LEAST_BLOCKS {
        return Evidence::NONE;
    }
    let mean = roots.iter().sum::<f64>() / n;
    let variance = roots.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0);
    Evidence::student(mean / (variance / n).sqrt().max(1e-12), n - 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::judging::testing::correlated;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    #[test]
    fn confidence_counts_every_candidate_and_knows_that_few_blocks_say_little() {
        let at = Evidence::student;
        assert!(at(5.0, 100.0).confidence(100) > 0.999);
        assert!(at(5.0, 100.0).confidence(100_000) < at(5.0, 100.0).confidence(100));
        // Student's tail beyond 4 standard errors with 8 degrees of freedom is 0.0019749 (scipy.stats.t.sf).
        assert!((at(4.0, 8.0).confidence(100) - (1.0 - 100.0 * 0.001_974_886)).abs() < 1e-6);
        // Fisher's tail beyond 6 with 2 and 20 degrees of freedom is 0.0091 (scipy.stats.f.sf); one number is Student's.
        assert!((Evidence::fisher(12.0, 2, 20.0).p_value - 0.009_094_947).abs() < 1e-8);
        assert!((Evidence::fisher(9.0, 1, 20.0).p_value - 2.0 * at(3.0, 20.0).p_value).abs() < 1e-12);
        assert_eq!(at(0.0, 100.0).confidence(100), 0.0);
        assert_eq!(Evidence::NONE.confidence(1), 0.5);
    }

    fn blocks_of(change: &[f64], residual: &[f64], rows: usize) -> Vec<Block> {
        let pairs = change.chunks(rows).zip(residual.chunks(rows));
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
        pairs.map(|(c, r)| Block { with_residual: dot(c, r), squares: dot(c, c) }).collect()
    }

    /// How often a change that has nothing to do with the residual has a p-value below each of these levels.
    fn false_positives(rows: usize, per_block: usize, levels: [f64; 2]) -> [f64; 2] {
        let mut rng = Pcg64::seed_from_u64(20);
        let runs = 50_000;
        let mut below = [0; 2];
        for _ in 0..runs {
            let change = correlated(&mut rng, rows, 0.9);
            let residual = correlated(&mut rng, rows, 0.5);
            let p_value = slope(&blocks_of(&change, &residual, per_block)).p_value;
            below.iter_mut().zip(levels).for_each(|(b, level)| *b += usize::from(p_value < level));
        }
        below.map(|b| b as f64 / runs as f64)
    }

    #[test]
    fn noise_passes_the_slope_test_at_most_twice_as_often_as_its_p_value_says_where_residuals_are_correlated()
    {
        // Autocorrelations 0.5, 0.25, 0.125: a decorrelation lag of three rows; blocks of six.
        let [often, seldom] = false_positives(180, 6, [0.01, 0.001]);
        println!("{:.2} % below 1 %, {:.3} % below 0.1 %", 100.0 * often, 100.0 * seldom);
        assert!(often < 0.02, "{often}");
        assert!(seldom < 0.002, "{seldom}");
    }

    #[test]
    fn noise_passes_the_test_of_the_mean_gain_no_more_often_than_its_p_value_says() {
        // A change that is not there only costs: its gains are negative in the mean, so that the test is conservative.
        let mut rng = Pcg64::seed_from_u64(22);
        let (runs, level) = (10_000, 0.01);
        let below = (0..runs)
            .filter(|_| {
                let change = correlated(&mut rng, 240, 0.9);
                let residual = correlated(&mut rng, 240, 0.5);
                mean_gain(&blocks_of(&change, &residual, 10)).p_value < level
            })
            .count() as f64;
        let expected = level * f64::from(runs);
        assert!(below < expected + 4.0 * expected.sqrt(), "{below} of at most {expected} expected");
    }

    #[test]
    fn the_mean_root_of_symmetric_gains_is_as_significant_as_its_p_value_says() {
        let mut rng = Pcg64::seed_from_u64(23);
        let (runs, level) = (20_000, 0.05);
        let below = (0..runs)
            .filter(|_| {
                let gains = correlated(&mut rng, 24, 0.0);
                mean_root(&gains).p_value < level
            })
            .count() as f64;
        let expected = level * f64::from(runs);
        let deviation = (expected * (1.0 - level)).sqrt();
        assert!((below - expected).abs() < 4.0 * deviation, "{below} of {expected} expected");
    }

    #[test]
    fn a_real_change_passes_with_a_slope_where_its_gains_are_too_uneven_for_a_mean() {
        let mut rng = Pcg64::seed_from_u64(21);
        let change: Vec<f64> =
            (0..108).map(|k| if k % 18 < 6 { 3.0 } else { 0.3 } * f64::from(k % 2)).collect();
        let noise = correlated(&mut rng, 108, 0.5);
        let residual: Vec<f64> = change.iter().zip(&noise).map(|(c, n)| c + 0.3 * n).collect();
        let blocks = blocks_of(&change, &residual, 6);
        assert!(slope(&blocks).p_value < 1e-4, "{:?}", slope(&blocks));
        assert!(slope(&blocks).p_value < mean_gain(&blocks).p_value);
    }

    #[test]
    fn one_block_that_carries_everything_is_no_evidence() {
        let mut blocks = vec![Block { with_residual: 0.01, squares: 0.01 }; 20];
        blocks[7] = Block { with_residual: 100.0, squares: 100.0 };
        assert_eq!(slope(&blocks).significance, 0.0);
        assert_eq!(mean_gain(&blocks[..3]).significance, 0.0);
    }

    #[test]
    fn nothing_at_all_is_no_evidence() {
        assert_eq!(slope(&[]).significance, 0.0);
        assert_eq!(slope(&[Block::default(); 10]).significance, 0.0);
        assert_eq!(mean_root(&[0.0; 10]).significance, 0.0);
    }
}
