//! The skew of the torques behind the positions: measured before anything else, and named where it explains enough.

use crate::diagnosis::candidates::trial::delay_columns;
use crate::diagnosis::error::{DiagnosisError, SingularDesign};
use crate::diagnosis::explanation::finding::{told, unit_term};
use crate::diagnosis::explanation::words;
use crate::diagnosis::judging::held_out::HeldOutSquares;
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::judging::significance::Evidence;
use crate::diagnosis::outcome::{Finding, ParameterValue};
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rules::{DELAY_DEVIATION, LONGEST_BLOCK, NAMED_DELAY, NAMED_DELAY_SAMPLES, SEARCHES};
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::settings::Settings;
use crate::effects::{EffectKind, EffectTerm, Place};

/// Skew of the torques behind the positions.
pub(in crate::diagnosis) struct Skew {
    /// s.
    pub value: f64,
    /// Its standard deviation, s: that of the fit, or as blocks of motion differ, whichever is larger.
    sigma: f64,
    evidence: Evidence,
}

impl Skew {
    /// Of a design without a column for it.
    ///
    /// # Errors
    /// [`SingularDesign`] where there is no fit.
    pub fn of(context: &Context<'_>, mut design: Design) -> Result<Self, SingularDesign> {
        for column in delay_columns(context, &design) {
            design.push(column);
        }
        design.refresh();
        let fit = Fit::weighted(&design, &vec![1.0; design.joints])?;
        let column = design.columns.len() - 1;
        Ok(Self::known(fit.chi[column], (&design, &fit), column))
    }

    /// A skew that is known as well as the parameter of a column is.
    fn known(value: f64, (design, fit): (&Design, &Fit), column: usize) -> Self {
        let white = fit.variances()[column].max(0.0);
        let rows = design.rows_within(LONGEST_BLOCK);
        let by_blocks = fit.variance_by_blocks(design, &fit.residual(design), column, rows);
        let (variance, widened, freedom) = match by_blocks {
            Some(seen) => (white.max(seen.variance), white.max(seen.widened()), seen.freedom),
            None => (white, white, f64::INFINITY),
        };
        let evidence = Evidence::student(value.abs() / variance.sqrt().max(1e-300), freedom);
        Self { value, sigma: widened.sqrt(), evidence }
    }

    /// One minus the probability that there is none and it comes as far, in one direction or the other.
    fn confidence(&self) -> f64 {
        self.evidence.confidence(2)
    }

    /// What is to be expected of all skew, s, where so much of it was taken out of the motions before and skews are zero within
    /// a standard deviation of so much: the best linear prediction, next to nothing where a skew is hardly known.
    pub fn expected(&self, before: f64, deviation: f64) -> f64 {
        let known = deviation * deviation / (deviation * deviation + self.sigma * self.sigma);
        known * (before + self.value)
    }
}

/// Standard deviation of skews before anything is known of one, s.
pub(in crate::diagnosis) fn usual_deviation(context: &Context<'_>) -> f64 {
    DELAY_DEVIATION.max(1.0 / context.rate())
}

/// The delay as a finding, where it is more than sampling, certainly there, and explains enough. `skew` is all of it, s.
///
/// # Errors
/// [`SingularDesign`] where a split has no fit.
pub(in crate::diagnosis) fn finding(
    model: &ExtendedModel<'_>,
    skew: f64,
    settings: &Settings,
) -> Result<Option<Finding>, SingularDesign> {
    if (skew * model.context.rate()).abs() < NAMED_DELAY_SAMPLES || skew.abs() < NAMED_DELAY {
        return Ok(None);
    }
    let slow = &model.slow;
    let known = Skew::known(skew, (&slow.design, &slow.fit), slow.design.parameters);
    if known.confidence() < 1.0 - (1.0 - settings.least_confidence) / SEARCHES {
        return Ok(None);
    }
    let seen = model.slow.curves();
    let with = slow.held_out(false, &seen)?;
    let unaware = HeldOutSquares::of(&with_skew(slow, skew), &slow.sigma, false, &seen)?;
    let all: Vec<usize> = (0..slow.design.joints).collect();
    let weigh =
        |h: &HeldOutSquares| -> f64 { h.left.iter().zip(&slow.sigma).map(|(l, s)| l / (s * s)).sum() };
    let share = 1.0 - weigh(&with) / weigh(&unaware);
    if share < settings.least_share {
        return Ok(None);
    }
    let (value, sigma) = (known.value, known.sigma);
    let delay = ParameterValue { value, sigma, unit: "s".into() };
    let mut finding = Finding {
        confidence: told(known.confidence()),
        significance: known.evidence.significance,
        parameters: [("delay".to_string(), delay)].into_iter().collect(),
        held_out_before: unaware.error_on(&all),
        held_out_after: with.error_on(&all),
        share,
        ..Finding::of(EffectTerm {
            amplitude: vec![value],
            sigma: vec![sigma],
            ..unit_term(EffectKind::TimeDelay, Place::Variant(0), Vec::new())
        })
    };
    finding.sentence = words::sentence(model.context.model.robot(), EffectKind::TimeDelay, &finding);
    Ok(Some(finding))
}

/// Errors of the standard model on held-out motion, fast rows, with the skew left in the torques.
///
/// # Errors
/// [`DiagnosisError`] where a split has no fit.
pub(in crate::diagnosis) fn unaware(
    model: &ExtendedModel<'_>,
    skew: f64,
) -> Result<HeldOutSquares, DiagnosisError> {
    let seen = model.fast.curves();
    let fast = &model.standard()?.fast;
    Ok(HeldOutSquares::of(&with_skew(fast, skew), &fast.sigma, model.change, &seen)?)
}

/// The rows as they would be with the skew left in the torques: the torque's own rate of change, as much of it as the
/// skew moved, and no column for it.
fn with_skew(regression: &Regression, skew: f64) -> Design {
    let p = regression.design.parameters;
    let taken = skew - regression.fit.chi[p];
    let mut design = regression.design.clone();
    let column = std::mem::replace(&mut design.columns[p], vec![0.0; design.rows.len()]);
    design.y = regression.design.y.iter().zip(&column).map(|(y, c)| y + taken * c).collect();
    design.refresh();
    design
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::normal;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    /// A skew of noise that lasts as long as a block, of which the column has the same memory.
    fn of_noise(rng: &mut Pcg64) -> Skew {
        const ROWS: usize = 600;
        let mut lasting = || {
            let mut x = normal(rng);
            let next = |_| {
                x = 0.9 * x + (1.0_f64 - 0.81).sqrt() * normal(rng);
                x
            };
            (0..ROWS).map(next).collect::<Vec<f64>>()
        };
        let (column, y) = (lasting(), lasting());
        let design = Design::made_up(1, &[(0, true)], ROWS, vec![column], y);
        let fit = Fit::whole(&design, &[1.0]).expect("a small problem is regular");
        Skew::known(fit.chi[0], (&design, &fit), 0)
    }

    #[test]
    fn noise_that_lasts_is_no_certain_skew() {
        let mut rng = Pcg64::seed_from_u64(41);
        let (runs, level) = (2000, 0.01);
        let told = (0..runs).filter(|_| of_noise(&mut rng).confidence() > 1.0 - level).count();
        println!("{told} of {runs}");
        assert!(told as f64 <= 2.5 * level * f64::from(runs), "{told} of {runs}");
    }

    #[test]
    fn of_a_skew_that_is_hardly_known_next_to_nothing_is_expected() {
        let known = |sigma| Skew { value: 0.02, sigma, evidence: Evidence::NONE };
        approx::assert_relative_eq!(known(1e-6).expected(0.01, 0.01), 0.03, max_relative = 1e-6);
        approx::assert_relative_eq!(known(0.01).expected(0.0, 0.01), 0.01, max_relative = 1e-12);
        assert!(known(1.0).expected(0.0, 0.01) < 1e-5);
    }
}
