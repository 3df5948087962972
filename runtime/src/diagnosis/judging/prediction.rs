//! What a candidate that was fitted to some segments changes on others.
//!
//! The error e of a prediction has the covariance V = I + W Σ Wᵀ, in units of the noise: what the fitted segments leave open of
//! the other parameters, Σ, is a part of it, and may be most of it where they are slow or short. Squares of the error are
//! therefore eᵀ V⁻¹ e, by which an open direction tells nothing and no direction is asked to be known better than it is; where
//! nothing is open they are eᵀ e. V⁻¹ e is what a fit to all segments, those that are predicted among them, leaves of their
//! rows, so that the squares are sums over rows of two residuals' products (recursive residuals; Brown, Durbin and Evans
//! 1975). The amplitudes of what is judged are parameters like the others: what is left open of them has its price
//! ([`Residualised::less_known_than`]).

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::candidates::trial::Trial;
use crate::diagnosis::judging::folds::Fold;
use crate::diagnosis::judging::partial_regression::{BySegment, Residualised};
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::judging::significance::Block;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::{Fit, add_rows, products_on};
use crate::diagnosis::rows::gram::dot;
use nalgebra::DVector;

/// A fit with a trial: the amplitudes, one per column of the trial, and what the parameters change by, one per column of the
/// design.
struct Extended<'a> {
    fit: &'a Fit,
    amplitude: DVector<f64>,
    shift: DVector<f64>,
}

impl<'a> Extended<'a> {
    fn new(fit: &'a Fit, part: &Residualised, amplitude: DVector<f64>) -> Self {
        let shift = -(&part.coefficients * &amplitude);
        Self { fit, amplitude, shift }
    }
}

/// A trial beside what was fitted to some segments, and beside what was fitted to all.
pub(in crate::diagnosis) struct Prediction<'a> {
    trial: &'a Trial,
    fitted: Extended<'a>,
    all: Extended<'a>,
    /// What the parameters of all change by where the trial has the amplitudes of the fitted segments.
    shift_as_fitted: DVector<f64>,
}

impl<'a> Prediction<'a> {
    /// Of a trial that was residualised on the columns of each of two fits, to some segments and to all, with the amplitudes
    /// that it has beside them.
    pub fn new(
        (fitted, own, amplitude): (&'a Fit, &Residualised, DVector<f64>),
        (all, part, of_all): (&'a Fit, &Residualised, DVector<f64>),
        trial: &'a Trial,
    ) -> Self {
        let shift_as_fitted = -(&part.coefficients * &amplitude);
        let fitted = Extended::new(fitted, own, amplitude);
        Self { trial, fitted, all: Extended::new(all, part, of_all), shift_as_fitted }
    }

    /// The trial.
    pub fn trial(&self) -> &'a Trial {
        self.trial
    }

    /// Its amplitudes in the fitted segments, one per column.
    pub fn amplitude(&self) -> &DVector<f64> {
        &self.fitted.amplitude
    }

    /// Squares that are gone on the rows of one joint in one segment, unweighted.
    pub fn gain(&self, design: &Design, joint: usize, segment: usize) -> f64 {
        let gram = design.gram(joint, segment);
        let (fitted, all) = (&self.fitted, &self.all);
        // With e what is left without the trial, and c what it changes: e c' + e' c - c c'.
        let (mut linear, mut square) = (0.0, 0.0);
        for i in 0..gram.columns() {
            let (d, e) = (fitted.shift[i], all.shift[i]);
            if d == 0.0 && e == 0.0 {
                continue;
            }
            let made = |x: &DVector<f64>| dot(gram.row(i), x.as_slice());
            let y = gram.with_y(i);
            linear += e * (y - made(&fitted.fit.chi)) + d * (y - made(&all.fit.chi));
            square += e * made(&fitted.shift);
        }
        if let Some(product) = self.trial.products.get(joint).and_then(|s| s.get(segment)) {
            let (a, b) = (&fitted.amplitude, &all.amplitude);
            for k in 0..a.len() {
                let column = product.with.column(k);
                let y = product.y[k];
                linear += b[k] * (y - column.dot(&fitted.fit.chi)) + a[k] * (y - column.dot(&all.fit.chi));
                square += a[k] * column.dot(&all.shift) + b[k] * column.dot(&fitted.shift);
                for l in 0..b.len() {
                    square += a[k] * b[l] * product.own[(k, l)];
                }
            }
        }
        linear - square
    }

    /// What the trial changes on some rows of a joint, with these amplitudes and shifts of the parameters.
    fn changes(
        &self,
        (amplitude, shift): (&DVector<f64>, &DVector<f64>),
        design: &Design,
        (joint, rows): (usize, &[usize]),
    ) -> Vec<f64> {
        let first = design.of_joint(joint).start;
        let mut changes = vec![0.0; rows.len()];
        for (column, a) in self.trial.on_joint(joint).into_iter().zip(amplitude) {
            column.into_iter().for_each(|column| add_rows(&mut changes, *a, column, (rows, first)));
        }
        for (column, shift) in design.columns.iter().zip(shift).filter(|(_, shift)| **shift != 0.0) {
            add_rows(&mut changes, *shift, column, (rows, 0));
        }
        changes
    }

    /// Inner products of what the trial changes with what is left, and with itself, on each of some rows of a joint.
    pub fn blocks(&self, design: &Design, joint: usize, rows: &[usize]) -> Vec<Block> {
        let [(left, change), (left_by_all, change_by_all)] = [&self.fitted, &self.all].map(|beside| {
            let changes = self.changes((&beside.amplitude, &beside.shift), design, (joint, rows));
            (beside.fit.residual_on(design, rows), changes)
        });
        let of_row = |i: usize| Block {
            with_residual: 0.5 * (left[i] * change_by_all[i] + left_by_all[i] * change[i]),
            squares: change[i] * change_by_all[i],
        };
        (0..rows.len()).map(of_row).collect()
    }

    /// Standard deviation of what is gained on some rows of each joint by the error of the parameters that were fitted
    /// elsewhere and that the change meets in the residual; in units of the noise variance.
    pub fn deviation_by_parameters(&self, design: &Design, rows: &[Vec<usize>]) -> f64 {
        // c is the change beside fitted parameters, u = V⁻¹ c that beside all: the part that is not noise of the variance
        // 4 uᵀ V u of the gain is 4 uᵀ (V - I) u = 4 uᵀ (c - u).
        let amplitude = &self.fitted.amplitude;
        let of_joint = |(joint, rows): (usize, &Vec<usize>)| {
            let [c, u] = [&self.fitted.shift, &self.shift_as_fitted]
                .map(|shift| self.changes((amplitude, shift), design, (joint, rows)));
            let weight = self.fitted.fit.sigma[joint].powi(-2);
            weight * u.iter().zip(&c).map(|(u, c)| u * (c - u)).sum::<f64>()
        };
        2.0 * rows.iter().enumerate().map(of_joint).sum::<f64>().max(0.0).sqrt()
    }

    /// On some rows of a joint: squares that are gone, and those without the trial.
    pub fn gain_on(&self, design: &Design, joint: usize, rows: &[usize]) -> [f64; 2] {
        let gone = self.blocks(design, joint, rows).iter().map(Block::gain).sum();
        [gone, products_on(design, [self.fitted.fit, self.all.fit], rows)]
    }
}

impl Regression {
    /// A trial with amplitudes from the segments of a fold, everything else refitted to them.
    pub fn predict_from_others<'a>(
        &'a self,
        candidate: &Candidate,
        trial: &'a Trial,
        fold: &'a Fold,
    ) -> Option<Prediction<'a>> {
        let part = fold.fit.project_out(trial)?;
        let (amplitude, _) = part.solve(candidate)?;
        let all = self.fit.project_out(trial)?;
        let (of_all, _) = all.solve(candidate)?;
        Some(Prediction::new((&fold.fit, &part, amplitude), (&self.fit, &all, of_all), trial))
    }

    /// Amplitudes on a single motion: refitting all standard parameters to a part of it would drown every candidate in
    /// their extrapolation. The trial is residualised on the `whole` motion, and only its amplitude is fitted to the
    /// segments of the fold.
    pub fn amplitude_from_rest_of_motion(
        &self,
        candidate: &Candidate,
        (whole, parts): (&Residualised, &BySegment),
        fold: &Fold,
    ) -> Option<DVector<f64>> {
        parts.on(&fold.fit.train, &self.sigma, whole).solve(candidate).map(|(amplitude, _)| amplitude)
    }

    /// What a trial with these amplitudes changes.
    pub fn predict_from_rest_of_motion<'a>(
        &'a self,
        candidate: &Candidate,
        trial: &'a Trial,
        (whole, parts): (&Residualised, &BySegment),
        fold: &Fold,
    ) -> Option<Prediction<'a>> {
        let amplitude = self.amplitude_from_rest_of_motion(candidate, (whole, parts), fold)?;
        let whole = (&self.fit, whole, amplitude);
        Some(Prediction::new(whole.clone(), whole, trial))
    }
}
