//! Whether the numbers of a law, as the whole model has them in the end, are certainly not zero.
//!
//! A law is named for what it explained when it joined the model. Beside laws that joined later, with its shape tuned and
//! over all motion, its amplitudes may be known worse than that: nobody bets on a law whose own interval holds zero.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::partial_regression::of_one_sign;
use crate::diagnosis::judging::significance::Evidence;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rules::LONGEST_BLOCK;
use crate::diagnosis::search::state::Search;
use crate::diagnosis::search::term::Accepted;
use crate::diagnosis::settings::Settings;
use crate::parallel;
use nalgebra::DMatrix;
use std::ops::Range;

/// One minus the probability that amplitudes of these columns come as far from zero by accident: with the noise that
/// `inflation` allows for (Wald), and as blocks of motion differ (Hotelling), whichever says less.
pub(super) fn of_amplitudes(fit: &Fit, design: &Design, columns: Range<usize>, inflation: f64) -> f64 {
    let numbers = columns.len();
    let Some(squares) = fit.wald(columns.clone()) else { return 0.0 };
    let white = Evidence::fisher(squares / (inflation * inflation), numbers, f64::INFINITY);
    let rows = design.rows_within(LONGEST_BLOCK);
    let seen = fit.covariance_by_blocks(design, &fit.residual(design), columns.clone(), rows);
    let amplitudes = fit.chi.rows(columns.start, numbers);
    let by_blocks = match seen.matrix.cholesky() {
        Some(factor) if seen.blocks > numbers => {
            let freedom = (seen.blocks - numbers) as f64;
            let squares = amplitudes.dot(&factor.solve(&amplitudes));
            Evidence::fisher(squares * freedom / (seen.blocks as f64 - 1.0), numbers, freedom)
        }
        // So few blocks say nothing of so many numbers.
        _ => white,
    };
    white.confidence(1).min(by_blocks.confidence(1))
}

impl Search<'_> {
    /// Takes out the laws whose amplitudes may be zero beside all others, the least certain first, and is no surer of the
    /// others than their amplitudes allow.
    ///
    /// # Errors
    /// [`SingularDesign`] where the model without a law has no fit.
    pub(super) fn take_out_uncertain(&mut self, settings: &Settings) -> Result<(), SingularDesign> {
        loop {
            let certainty = parallel::map(self.threads(), self.model.terms.len(), |k| self.certainty(k));
            let least = certainty.iter().enumerate().min_by(|a, b| a.1.total_cmp(b.1));
            match least {
                Some((k, &certain)) if certain < settings.least_confidence => {
                    let term = self.model.terms.remove(k);
                    self.rejected.push(term);
                    self.refit_and_update()?;
                }
                _ => {
                    for (term, certain) in self.model.terms.iter_mut().zip(certainty) {
                        term.confidence = term.confidence.min(certain);
                    }
                    return Ok(());
                }
            }
        }
    }

    /// The certainty of the amplitudes of term k; full where its law leaves none free, none where it has become something
    /// else beside the others.
    fn certainty(&self, k: usize) -> f64 {
        let term: &Accepted = &self.model.terms[k];
        let regression = self.model.regression(term.effect.properties().window);
        let columns = regression.term_columns[k].clone();
        if columns.is_empty() {
            return 1.0;
        }
        let (fit, design) = (&regression.fit, &regression.design);
        let amplitudes = fit.chi.rows_range(columns.clone()).into_owned();
        let holds = |s: DMatrix<f64>| of_one_sign(s.clone(), s * &amplitudes, amplitudes.clone()).is_some();
        if term.effect.form().only_positive() && !fit.information(columns.clone()).is_some_and(holds) {
            return 0.0;
        }
        of_amplitudes(fit, design, columns, term.inflation)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::judging::regression::Regression;
    use crate::diagnosis::judging::testing::correlated;
    use crate::testing::normal;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    const SEGMENTS: [(usize, bool); 2] = [(0, true), (1, true)];
    const ROWS: usize = 500;

    /// How sure the amplitudes of two slow columns are, of which the first has this factor in noise that lasts.
    fn certainty(rng: &mut Pcg64, factor: f64) -> f64 {
        let rows = SEGMENTS.len() * ROWS;
        let columns: Vec<Vec<f64>> = (0..4).map(|_| correlated(rng, rows, 0.9)).collect();
        let noise = correlated(rng, rows, 0.8);
        let y =
            (0..rows).map(|r| noise[r] + 2.0 * columns[0][r] + factor * columns[2][r] + 0.1 * normal(rng));
        let y = y.collect();
        let design = Design::made_up(1, &SEGMENTS, ROWS, columns, y);
        let regression = Regression::new(design, Vec::new()).expect("a small problem is regular");
        of_amplitudes(&regression.fit, &regression.design, 2..4, 1.0)
    }

    #[test]
    fn amplitudes_that_noise_made_are_as_seldom_certain_as_their_confidence_says() {
        let mut rng = Pcg64::seed_from_u64(31);
        let sure = (0..600).filter(|_| certainty(&mut rng, 0.0) >= 0.95).count();
        println!("{sure} of 600");
        // Thirty of them, and four standard deviations of that.
        assert!((10..=51).contains(&sure), "{sure} of 600");
    }

    #[test]
    fn amplitudes_of_a_law_that_is_there_are_certain() {
        let mut rng = Pcg64::seed_from_u64(32);
        let sure = (0..100).filter(|_| certainty(&mut rng, 0.5) >= 0.99).count();
        assert!(sure >= 95, "{sure} of 100");
    }
}
