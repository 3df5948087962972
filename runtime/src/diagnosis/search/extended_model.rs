//! The standard model with accepted effects, fitted on the rows of both smoothing windows.

use crate::diagnosis::candidates::companions::companions;
use crate::diagnosis::candidates::gains::{deviation_of_gains, gain_columns};
use crate::diagnosis::candidates::nuisances::{
    NUISANCES, SKEW_COLUMNS, always_there, more_of_standing_laws, standing_curves, standing_from,
};
use crate::diagnosis::candidates::trial::dense_columns;
use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::judging::skew::usual_deviation;
use crate::diagnosis::rows::additions::{Additions, NumberError};
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::prior::Prior;
use crate::diagnosis::rules::{GAIN_DEVIATION, MOST_REFITS, SETTLED_ERROR, SETTLED_PARAMETER};
use crate::diagnosis::search::bench::Bench;
use crate::diagnosis::search::term::{Accepted, Law};
use crate::diagnosis::search::term_columns::{LastingColumns, large_error, put_terms, recorded_larger_on};
use crate::effects::SmoothingWindow;
use crate::parallel;
use std::ops::Range;
use std::sync::Arc;

/// The standard model, the effects that were accepted, and both regressions with them.
#[derive(Clone)]
pub(in crate::diagnosis) struct ExtendedModel<'a> {
    pub context: Context<'a>,
    pub slow: Regression,
    pub fast: Regression,
    /// What evidence on the slow and on the fast rows is compared with.
    pub benches: [Bench; 2],
    pub terms: Vec<Accepted>,
    /// By how much the torques of each joint are recorded larger than they are, as a part of them, where a term says so.
    pub factors: Vec<f64>,
    /// Whether only what changed since a baseline is looked for.
    pub change: bool,
    /// Laws and amplitudes of the terms that columns are made with, beside the parameters of the context.
    followed: Vec<(Law, Vec<f64>)>,
    /// Columns that the terms have on the slow and on the fast rows.
    lasting: [LastingColumns; 2],
}

impl<'a> ExtendedModel<'a> {
    /// Without any effect; nuisances are always fitted along. Of these the skew of the torques is known to be small: what
    /// was to be expected of it has been taken out of the motions.
    ///
    /// # Errors
    /// [`SingularDesign`] where there is no fit.
    pub fn new(
        context: Context<'a>,
        slow: Design,
        fast: Design,
        change: bool,
    ) -> Result<Self, SingularDesign> {
        let regression = |mut design: Design| {
            let nuisances = always_there(&context, &design, change);
            design.shrunk = standing_curves(&context, &design);
            // Beside a baseline its rows say as much.
            if let Some(reference) = context.reference.as_ref().filter(|_| context.is_alone()) {
                let first = design.parameters + standing_from(design.joints);
                design.prior = reference.prior_with_laws(first, &design.known).map(Arc::new);
            }
            let skew = design.parameters..design.parameters + SKEW_COLUMNS;
            let with_skew = Prior::with_zeros(design.prior.as_deref(), skew, usual_deviation(&context));
            design.prior = Some(Arc::new(with_skew));
            Regression::new(design, nuisances)
        };
        let (slow, fast) = (regression(slow)?, regression(fast)?);
        let bench = |r: &Regression| Bench::new(&context, &r.design, companions(&context, &r.design), change);
        let benches = [bench(&slow), bench(&fast)];
        let factors = vec![0.0; slow.design.joints];
        let (terms, followed, lasting) = (Vec::new(), Vec::new(), [Vec::new(), Vec::new()]);
        Ok(Self { context, slow, fast, benches, terms, factors, change, followed, lasting })
    }

    /// The regression on the rows of a window.
    pub fn regression(&self, window: SmoothingWindow) -> &Regression {
        match window {
            SmoothingWindow::Slow => &self.slow,
            SmoothingWindow::Fast => &self.fast,
        }
    }

    /// What evidence on the rows of a window is compared with.
    pub fn bench(&self, window: SmoothingWindow) -> &Bench {
        match window {
            SmoothingWindow::Slow => &self.benches[0],
            SmoothingWindow::Fast => &self.benches[1],
        }
    }

    /// Puts the terms into both regressions, and lets columns that are made of what is fitted follow it.
    ///
    /// # Errors
    /// [`SingularDesign`] where there is no fit.
    pub fn refit(&mut self) -> Result<(), SingularDesign> {
        let mut deviation = GAIN_DEVIATION;
        let robot = self.context.model.robot();
        let of_robot = |term: &Accepted| {
            NumberError::of_robot(robot, (term.effect, term.place), &term.shape, !self.change)
        };
        self.context.take_errors(self.terms.iter().filter_map(of_robot).collect());
        for round in 1..=MOST_REFITS {
            let terms = (&self.terms[..], &self.factors[..], &mut self.lasting[0]);
            put_terms(&mut self.slow, (&self.context, self.change), terms, deviation)?;
            let before = deviation;
            deviation = self.deviation_of_gains(before);
            let gains_settled = (deviation - before).abs() <= SETTLED_PARAMETER * before;
            if gains_settled && self.is_settled() || round == MOST_REFITS {
                break;
            }
            self.follow();
        }
        let mut fits = [(&mut self.slow, None, Ok(())), (&mut self.fast, Some(&mut self.lasting[1]), Ok(()))];
        parallel::for_each(self.context.threads, &mut fits, |(regression, lasting, outcome)| {
            let put = lasting.as_mut().map_or(Ok(()), |lasting| {
                let terms = (&self.terms[..], &self.factors[..], &mut **lasting);
                put_terms(regression, (&self.context, self.change), terms, deviation)
            });
            *outcome = put.and_then(|()| regression.hold_out());
        });
        fits.into_iter().try_for_each(|(_, _, outcome)| outcome)
    }

    /// Whether what was fitted is what columns were made of: parameters and amplitudes within a tenth of their standard
    /// deviations, errors of numbers and of drives within what they are known to.
    fn is_settled(&self) -> bool {
        let Regression { design, fit, term_columns, .. } = &self.slow;
        let variances = fit.variances();
        let near = |column: usize, before: f64| {
            (fit.chi[column] - before).abs() <= SETTLED_PARAMETER * variances[column].max(0.0).sqrt()
        };
        let stays = |new: f64, old: f64, unit: f64| (new - old).abs() <= SETTLED_ERROR * unit;
        let of_terms = || self.terms.iter().zip(term_columns);
        let laws_stay = self.followed.len() == self.terms.len()
            && of_terms().zip(&self.followed).all(|((term, columns), (law, amplitude))| {
                let amplitudes_stay = || columns.clone().zip(amplitude).all(|(c, &before)| near(c, before));
                match self.errors_of(term, columns) {
                    Some(errors) => {
                        errors.len() == term.shape.len()
                            && errors.iter().zip(&term.shape).all(|(&new, &old)| stays(new, old, new.abs()))
                    }
                    None => term.law() == *law && columns.len() == amplitude.len() && amplitudes_stay(),
                }
            });
        let factors_stay = || {
            of_terms().all(|(term, columns)| {
                let Some(joint) = recorded_larger_on(term) else { return true };
                let factor = columns.clone().map(|c| fit.chi[c]).sum::<f64>();
                stays(factor, self.factors[joint], 1.0 + factor.abs())
            })
        };
        let parameters_stay = || (0..design.parameters).all(|k| near(k, self.context.chi[k]));
        laws_stay && factors_stay() && parameters_stay()
    }

    /// Takes what was fitted for what columns are made of: parameters, bodies and laws beside them, factors of torques; an error
    /// that is not small bends its own column, whose derivatives are taken along the way to it.
    fn follow(&mut self) {
        let Regression { design, fit, term_columns, .. } = &self.slow;
        let chi = fit.chi.iter().take(design.parameters).copied().collect();
        for (term, columns) in self.terms.iter().zip(term_columns) {
            if let Some(joint) = recorded_larger_on(term) {
                self.factors[joint] = columns.clone().map(|c| fit.chi[c]).sum();
            }
        }
        let errors: Vec<_> = self.terms.iter().zip(term_columns).map(|(t, c)| self.errors_of(t, c)).collect();
        for (term, errors) in self.terms.iter_mut().zip(errors) {
            if let Some(errors) = errors {
                term.shape = errors;
            }
        }
        let amplitudes = |columns: &Range<usize>| columns.clone().map(|c| fit.chi[c]).collect();
        self.followed =
            self.terms.iter().zip(term_columns).map(|(t, columns)| (t.law(), amplitudes(columns))).collect();
        self.context.update(chi);
        self.context.take(self.additions());
    }

    /// How far each number is off that a term says is off, as it was fitted; `None` for every other law.
    fn errors_of(&self, term: &Accepted, columns: &Range<usize>) -> Option<Vec<f64>> {
        let most = term.effect.form().sensitivity()?.largest_error();
        Some(columns.clone().map(|c| self.slow.fit.chi[c].clamp(-most, most)).collect())
    }

    /// Whether a term is an error of a number of the robot or of a drive that is not small.
    pub fn is_large_error(&self, k: usize) -> bool {
        let robot = self.context.model.robot();
        large_error(robot, &self.terms[k], &self.factors, self.change).is_some()
    }

    /// How much the gains differ that bodies show.
    fn deviation_of_gains(&self, before: f64) -> f64 {
        let Regression { design, fit, gains, .. } = &self.slow;
        if gains.is_empty() {
            return before;
        }
        let variances = fit.variances();
        let shown = gains.clone().filter(|&c| design.columns[c].iter().any(|x| *x != 0.0));
        let of: Vec<(f64, f64)> = shown.map(|c| (fit.chi[c], variances[c])).collect();
        deviation_of_gains(&of, before)
    }

    /// Bodies and laws that the robot has beside its parameters: those of a reference, and those among the terms, with what the
    /// slow rows say of them. What is a change was not there in the baseline.
    fn additions(&self) -> Additions {
        let mut additions = self.context.additions_before();
        for (term, columns) in self.terms.iter().zip(&self.slow.term_columns) {
            let amplitude: Vec<f64> = columns.clone().map(|c| self.slow.fit.chi[c]).collect();
            let (law, shape) = ((term.effect, term.place), (&term.shape[..], None));
            additions.add(self.context.model.robot(), law, shape, &amplitude, !self.change);
        }
        additions
    }

    /// A copy without any term: the standard model.
    ///
    /// # Errors
    /// [`SingularDesign`] where there is no fit.
    pub fn standard(&self) -> Result<Self, SingularDesign> {
        let mut copy = self.clone();
        copy.terms.clear();
        copy.refit()?;
        Ok(copy)
    }

    /// A copy without one of the terms, everything else refitted.
    ///
    /// # Errors
    /// [`SingularDesign`] where there is no fit without it.
    pub fn without(&self, term: usize) -> Result<Self, SingularDesign> {
        let mut copy = self.clone();
        copy.terms.remove(term);
        copy.refit()?;
        Ok(copy)
    }

    /// A copy without the nuisances that laws are judged beside, everything else refitted: what a model that is saved
    /// predicts has no part of them.
    ///
    /// # Errors
    /// As [`Self::without`].
    pub fn without_nuisances(&self) -> Result<Self, SingularDesign> {
        let mut copy = self.clone();
        for regression in [&mut copy.slow, &mut copy.fast] {
            let first = regression.design.parameters + SKEW_COLUMNS;
            let joints = regression.design.joints;
            regression.silence(first..first + NUISANCES * joints);
        }
        copy.refit()?;
        Ok(copy)
    }

    /// The columns of a law on all rows of a design of the same motions, one per amplitude.
    pub fn columns_of(&self, design: &Design, term: &Accepted) -> Vec<Vec<f64>> {
        dense_columns(&self.context, design, term.effect, term.place, &term.shape, self.change)
    }

    /// The columns on the rows of another design of the same motions whose amplitudes the motions tell: the base parameters, but
    /// where a reference knows them, friction and nuisances, and the laws that were found.
    pub fn fitted_on(&self, design: &Design) -> Vec<Vec<f64>> {
        let known = self.context.reference.is_some() && self.context.is_alone();
        let mut columns = if known { Vec::new() } else { design.columns.clone() };
        columns.extend(always_there(&self.context, design, self.change).split_off(SKEW_COLUMNS));
        for term in self.terms.iter().filter(|term| term.fixed.is_none()) {
            columns.extend(self.columns_of(design, term));
        }
        columns
    }

    /// What the model with all terms leaves of the torques on the rows of another design of the same motions, of this window, as it
    /// was fitted on its own rows of it: how the nuisances bend a course over frequency holds up to where they were fitted, and no
    /// further.
    pub fn residual_on(&self, design: &Design, window: SmoothingWindow) -> Vec<f64> {
        let mut residual = design.y.clone();
        let mut subtract = |column: &[f64], x: f64| {
            residual.iter_mut().zip(column).for_each(|(r, c)| *r -= c * x);
        };
        let of_window = self.regression(window);
        let chi = &of_window.fit.chi;
        for (column, &x) in design.columns.iter().zip(chi.iter()) {
            subtract(column, x);
        }
        let always = always_there(&self.context, design, self.change);
        for (k, column) in always.iter().enumerate() {
            subtract(column, chi[design.parameters + k]);
        }
        if let Some(more) = more_of_standing_laws(&self.context, design) {
            subtract(&more, 1.0);
        }
        for (c, column) in of_window.gains.clone().zip(gain_columns(&self.context, design)) {
            subtract(&column, chi[c]);
        }
        for (term, range) in self.terms.iter().zip(&of_window.term_columns) {
            for (k, column) in self.columns_of(design, term).iter().enumerate() {
                subtract(column, term.fixed.unwrap_or_else(|| chi[range.start + k]));
            }
        }
        residual
    }
}
