//! What a candidate that was fitted to some segments changes on others.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::candidates::trial::Trial;
use crate::diagnosis::judging::folds::Fold;
use crate::diagnosis::judging::partial_regression::{BySegment, Residualised};
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use nalgebra::DVector;

/// A trial with its amplitudes, and what the other parameters of a fit change by when it is added.
pub(in crate::diagnosis) struct Prediction<'a> {
    pub fit: &'a Fit,
    pub trial: &'a Trial,
    /// One per column of the trial.
    pub amplitude: DVector<f64>,
    /// One per column of the design.
    pub shift: DVector<f64>,
}

impl<'a> Prediction<'a> {
    /// Of a trial that was residualised on the columns of `fit`.
    pub fn new(fit: &'a Fit, trial: &'a Trial, part: &Residualised, amplitude: DVector<f64>) -> Self {
        let shift = -(&part.coefficients * &amplitude);
        Self { fit, trial, amplitude, shift }
    }

    /// Squares of the residual that are gone on the rows of one joint in one segment, unweighted.
    pub fn gain(&self, design: &Design, joint: usize, segment: usize) -> f64 {
        let gram = design.gram(joint, segment);
        let (a, d, chi) = (&self.amplitude, &self.shift, &self.fit.chi);
        let (mut linear, mut square) = (0.0, 0.0);
        for i in 0..gram.columns() {
            if d[i] == 0.0 {
                continue;
            }
            let mut fitted = 0.0;
            let mut moved = 0.0;
            for (k, product) in gram.row(i).iter().enumerate() {
                fitted += product * chi[k];
                moved += product * d[k];
            }
            linear += d[i] * (gram.with_y(i) - fitted);
            square += d[i] * moved;
        }
        if let Some(product) = self.trial.products.get(joint).and_then(|s| s.get(segment)) {
            for k in 0..a.len() {
                let column = product.with.column(k);
                linear += a[k] * (product.y[k] - column.dot(chi));
                square += 2.0 * a[k] * column.dot(d);
                for l in 0..a.len() {
                    square += a[k] * a[l] * product.own[(k, l)];
                }
            }
        }
        2.0 * linear - square
    }

    /// At one row, given the values of the trial's columns there: the residual of the fit without the trial, and what the
    /// trial changes.
    pub fn at(&self, design: &Design, row: usize, law: impl Iterator<Item = f64>) -> (f64, f64) {
        let mut change: f64 = law.zip(self.amplitude.iter()).map(|(c, a)| a * c).sum();
        for (k, column) in design.columns.iter().enumerate() {
            change += column[row] * self.shift[k];
        }
        (self.fit.residual_at(design, row), change)
    }

    /// Standard deviation of what is gained on some rows, given with their joints, by the error of the parameters that were
    /// fitted elsewhere and that the change meets in the residual; in units of the noise variance.
    pub fn deviation_by_parameters(
        &self,
        design: &Design,
        rows: impl Iterator<Item = (usize, usize)>,
    ) -> f64 {
        let law: Vec<Vec<f64>> = self.trial.dense(design);
        let mut with = DVector::zeros(design.columns.len());
        for (joint, r) in rows {
            let weight = self.fit.sigma[joint].powi(-2);
            let (_, change) = self.at(design, r, law.iter().map(|c| c[r]));
            with.iter_mut().zip(&design.columns).for_each(|(w, c)| *w += weight * change * c[r]);
        }
        2.0 * with.dot(&self.fit.solve(&with)).max(0.0).sqrt()
    }

    /// On some rows of a joint: squares of the residual that are gone, and those of the residual without the trial.
    pub fn gain_on(&self, design: &Design, joint: usize, rows: impl Iterator<Item = usize>) -> [f64; 2] {
        let first = design.of_joint(joint).start;
        let law = self.trial.on_joint(joint);
        rows.fold([0.0, 0.0], |[gone, squares], r| {
            let values = law.iter().map(|c| c.map_or(0.0, |c| c[r - first]));
            let (residual, change) = self.at(design, r, values);
            [gone + change * (2.0 * residual - change), squares + residual * residual]
        })
    }
}

impl Regression {
    /// A trial with amplitudes from the segments of a fold, everything else refitted to them.
    pub fn predict_from_others<'a>(
        &self,
        candidate: &Candidate,
        trial: &'a Trial,
        fold: &'a Fold,
    ) -> Option<Prediction<'a>> {
        let part = fold.fit.project_out(trial)?;
        let (amplitude, _) = part.solve(candidate)?;
        Some(Prediction::new(&fold.fit, trial, &part, amplitude))
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
        Some(Prediction::new(&self.fit, trial, whole, amplitude))
    }
}
