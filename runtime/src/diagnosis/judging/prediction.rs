//! What a candidate that was fitted to some segments changes on others.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::candidates::trial::Trial;
use crate::diagnosis::judging::folds::Fold;
use crate::diagnosis::judging::partial_regression::{BySegment, Residualised};
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::{Fit, add_rows};
use crate::diagnosis::rows::gram::dot;
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
            let [fitted, moved] = [chi, d].map(|x| dot(gram.row(i), x.as_slice()));
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

    /// What the trial changes on some rows of a joint.
    pub fn changes(&self, design: &Design, joint: usize, rows: &[usize]) -> Vec<f64> {
        let first = design.of_joint(joint).start;
        let mut changes = vec![0.0; rows.len()];
        for (column, a) in self.trial.on_joint(joint).into_iter().zip(&self.amplitude) {
            column.into_iter().for_each(|column| add_rows(&mut changes, *a, column, (rows, first)));
        }
        for (column, shift) in design.columns.iter().zip(&self.shift).filter(|(_, shift)| **shift != 0.0) {
            add_rows(&mut changes, *shift, column, (rows, 0));
        }
        changes
    }

    /// Standard deviation of what is gained on some rows of each joint by the error of the parameters that were fitted
    /// elsewhere and that the change meets in the residual; in units of the noise variance.
    pub fn deviation_by_parameters(&self, design: &Design, rows: &[Vec<usize>]) -> f64 {
        let mut with = DVector::zeros(design.columns.len());
        for (joint, rows) in rows.iter().enumerate() {
            let weight = self.fit.sigma[joint].powi(-2);
            let changes = self.changes(design, joint, rows);
            for (with, column) in with.iter_mut().zip(&design.columns) {
                *with +=
                    weight * changes.iter().zip(rows).map(|(change, &r)| change * column[r]).sum::<f64>();
            }
        }
        2.0 * with.dot(&self.fit.solve(&with)).max(0.0).sqrt()
    }

    /// On some rows of a joint: squares of the residual that are gone, and those of the residual without the trial.
    pub fn gain_on(&self, design: &Design, joint: usize, rows: &[usize]) -> [f64; 2] {
        let residual = self.fit.residual_on(design, rows);
        let both = residual.iter().zip(self.changes(design, joint, rows));
        both.fold([0.0, 0.0], |[gone, squares], (residual, change)| {
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
