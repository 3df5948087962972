//! How sure it is that a gain is no accident, where residuals are not white and many candidates were tried.

use super::candidate::Candidate;
use super::design::Design;
use super::fit::Fit;
use super::judge::{Fold, Verdict, own_part, rest_of_motion, single_motion};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// How sure it is that a gain is no accident.
#[derive(Debug, Clone, Copy)]
pub(super) struct Evidence {
    /// In standard errors.
    pub significance: f64,
    /// Degrees of freedom of the standard error.
    pub freedom: f64,
}

impl Evidence {
    pub const NONE: Self = Self { significance: 0.0, freedom: 1.0 };

    /// One minus the probability that the best of `tries` candidates comes as far by accident (Bonferroni), by
    /// Student's distribution.
    pub fn confidence(&self, tries: usize) -> f64 {
        let tail = StudentsT::new(0.0, 1.0, self.freedom.max(1.0)).map_or(1.0, |t| t.sf(self.significance));
        (1.0 - tail * tries as f64).clamp(0.0, 0.9999)
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
    Evidence { significance: (correlation(0) - mean) / variance.sqrt().max(1e-12), freedom: n - 1.0 }
}

/// Significance of the held-out gain in standard errors over blocks of motion, whatever depends on what in a block.
///
/// Gains of blocks are heavy-tailed, so their signed square roots are compared with zero.
pub(super) fn block_evidence(
    design: &Design,
    whole: &Fit,
    folds: &[Fold],
    sigma: &[f64],
    candidate: &Candidate,
    verdict: &Verdict,
) -> Evidence {
    let trial = &candidate.trials[verdict.trial];
    let dense = trial.dense(design);
    let single = single_motion(design);
    let everything = vec![true; design.segments.len()];
    let mut per_block = std::collections::BTreeMap::<usize, f64>::new();
    for fold in folds {
        let fit = if single { whole } else { &fold.fit };
        let train = if single { &everything } else { &fold.train };
        let Some(own) = own_part(design, fit, sigma, trial, train) else { return Evidence::NONE };
        let fitted =
            if single { rest_of_motion(design, whole, sigma, trial, &own, &fold.train) } else { own };
        let Some((a, _)) = fitted.solve(candidate) else { return Evidence::NONE };
        let d = -(&fitted.x * &a);
        for (j, &s) in sigma.iter().enumerate() {
            for g in (0..design.segments.len()).filter(|&g| fold.test[g]) {
                for r in design.ranges[j][g].clone() {
                    let mut residual = design.y[r];
                    let mut move_ = 0.0;
                    for (k, column) in design.columns.iter().enumerate() {
                        residual -= column[r] * fit.chi[k];
                        move_ += column[r] * d[k];
                    }
                    for (k, column) in dense.iter().enumerate() {
                        move_ += column[r] * a[k];
                    }
                    let after = residual - move_;
                    *per_block.entry(design.rows[r].block).or_default() +=
                        (residual * residual - after * after) / (s * s);
                }
            }
        }
    }
    let roots: Vec<f64> = per_block.values().map(|d| d.signum() * d.abs().sqrt()).collect();
    let n = roots.len() as f64;
    if n < 4.0 {
        return Evidence::NONE;
    }
    let mean = roots.iter().sum::<f64>() / n;
    let variance = roots.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (n - 1.0);
    Evidence { significance: mean / (variance / n).sqrt().max(1e-12), freedom: n - 1.0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn confidence_counts_every_candidate_and_knows_that_few_blocks_say_little() {
        let at = |significance, freedom| Evidence { significance, freedom };
        assert!(at(5.0, 100.0).confidence(100) > 0.999);
        assert!(at(5.0, 100.0).confidence(100_000) < at(5.0, 100.0).confidence(100));
        // Student's tail beyond 4 standard errors with 8 degrees of freedom is 0.0019749 (scipy.stats.t.sf).
        assert!((at(4.0, 8.0).confidence(100) - (1.0 - 100.0 * 0.001_974_886)).abs() < 1e-6);
        assert_eq!(at(0.0, 100.0).confidence(100), 0.0);
        assert_eq!(Evidence::NONE.confidence(1), 0.5);
    }
}
