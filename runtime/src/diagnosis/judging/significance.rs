//! Tests of a gain over blocks of motion, and their p-values corrected for the number of comparisons.

use crate::diagnosis::rules::{HIGHEST_CONFIDENCE, LEAST_BLOCKS};
use statrs::distribution::{ContinuousCDF, FisherSnedecor, StudentsT};

/// Degrees of freedom beyond which Fisher's distribution is that of chi-squared.
const LARGEST_FREEDOM: f64 = 1e6;

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
        let p_value =
            FisherSnedecor::new(k, freedom.min(LARGEST_FREEDOM)).map_or(1.0, |f| f.sf(squares.max(0.0) / k));
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

/// Of the mean of gains being above zero. Gains are heavy-tailed, so their signed square roots are compared with zero.
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
    fn nothing_at_all_is_no_evidence() {
        assert_eq!(mean_root(&[0.0; 10]).significance, 0.0);
        assert_eq!(mean_root(&[1.0; 3]).significance, 0.0);
    }
}
