//! Standard deviations of the numbers of accepted laws.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rows::prior::Prior;
use crate::diagnosis::rules::{LARGEST_SHAPE_SIGMA, LONGEST_BLOCK, PLAY_BESIDE_UNSEEN};
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::tangents::{along_parameters, tangents};
use crate::effects::{Form, PLAY, SmoothingWindow};
use crate::parallel;
use std::sync::Arc;

/// Standard deviations of the amplitudes of a law and of the numbers of its shape.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Deviations {
    pub amplitude: Vec<f64>,
    pub shape: Vec<f64>,
}

impl Deviations {
    /// Of as many numbers, which are not asked for.
    pub fn none(amplitudes: usize, shape: usize) -> Self {
        Self { amplitude: vec![0.0; amplitudes], shape: vec![0.0; shape] }
    }
}

/// Those of all laws of a model, whose numbers are estimated together: the numbers of their shapes enter through the
/// derivative of the columns (variable projection, Golub and Pereyra 1973), and the columns of base parameters are the
/// derivatives of all that is made of them, the load that a gear loses a part of too. Each is the larger of two: with the
/// noise that the test of the law allowed for, and as blocks of motion differ.
///
/// # Errors
/// [`SingularDesign`] where there is no fit with these derivatives.
pub(in crate::diagnosis) fn deviations(model: &ExtendedModel<'_>) -> Result<Vec<Deviations>, SingularDesign> {
    let none = |k: usize| Deviations::none(0, model.terms[k].shape.len());
    let mut all: Vec<Deviations> = (0..model.terms.len()).map(none).collect();
    for window in [SmoothingWindow::Slow, SmoothingWindow::Fast] {
        let laws = |k: &usize| model.terms[*k].effect.properties().window == window;
        let judged: Vec<usize> = (0..all.len()).filter(laws).collect();
        if judged.is_empty() {
            continue;
        }
        let linearised = Linearised::new(model, window)?;
        let found =
            parallel::map(model.context.threads, judged.len(), |i| linearised.of_term(model, judged[i]));
        judged.into_iter().zip(found).for_each(|(k, found)| all[k] = found);
    }
    Ok(all)
}

/// A model at its optimum, linear in the numbers of all shapes.
struct Linearised {
    design: Design,
    fit: Fit,
    residual: Vec<f64>,
    window: SmoothingWindow,
    /// Column, and which number of the shape of which term it belongs to.
    shapes: Vec<(usize, [usize; 2])>,
}

impl Linearised {
    fn new(model: &ExtendedModel<'_>, window: SmoothingWindow) -> Result<Self, SingularDesign> {
        let side = model.regression(window);
        let mut design = side.design.clone();
        let mut first = design.columns.len();
        let mut shapes = Vec::new();
        let slopes = parallel::map(model.context.threads, model.terms.len(), |k| {
            let amplitude: Vec<f64> = side.term_columns[k].clone().map(|c| side.fit.chi[c]).collect();
            let of_shape = tangents(model, &side.design, &model.terms[k], &amplitude);
            (of_shape, along_parameters(model, side, &model.terms[k], &amplitude))
        });
        for (k, (of_shape, of_parameters)) in slopes.into_iter().enumerate() {
            for (i, slope) in of_shape {
                let c = design.columns.len();
                design.push(slope);
                shapes.push((c, [k, i]));
                // Beyond that nothing is known of a number, and the others are told beside it all the same.
                let most = largest(model.terms[k].shape[i]);
                if most > 0.0 {
                    design.prior = Some(Arc::new(Prior::with_zeros(design.prior.as_deref(), c..c + 1, most)));
                }
            }
            for (i, slope) in of_parameters {
                first = first.min(i);
                design.columns[i].iter_mut().zip(slope).for_each(|(column, slope)| *column += slope);
            }
        }
        design.refresh_from(first);
        let fit = Fit::whole(&design, &side.sigma)?;
        let residual = fit.residual(&design);
        Ok(Self { design, fit, residual, window, shapes })
    }

    fn of_term(&self, model: &ExtendedModel<'_>, k: usize) -> Deviations {
        let term = &model.terms[k];
        let variances = self.fit.variances();
        let rows = self.design.rows_within(LONGEST_BLOCK);
        // The first allows for the noise of the test; by blocks also noise of longer memory and what the law lacks count.
        let sd = |c: usize| {
            let white = term.inflation * term.inflation * variances[c];
            let by_blocks = self.fit.variance_by_blocks(&self.design, &self.residual, c, rows);
            white.max(by_blocks.map_or(0.0, |by_blocks| by_blocks.widened())).max(0.0).sqrt()
        };
        let amplitude = model.regression(self.window).term_columns[k].clone().map(sd).collect();
        let mut shape = vec![0.0; term.shape.len()];
        for &(c, [_, i]) in self.shapes.iter().filter(|(_, [of, _])| *of == k) {
            shape[i] = sd(c).min(largest(term.shape[i]));
        }
        if let Form::Compliance(law) = term.effect.form() {
            let highest = 0.5 / self.design.step;
            let unseen = law.unseen(&term.shape, highest);
            if !unseen.is_empty() {
                // What the play is told beside differs with them.
                shape[PLAY] = shape[PLAY].hypot(PLAY_BESIDE_UNSEEN * term.shape[PLAY]);
            }
            for i in unseen {
                shape[i] = largest(term.shape[i]);
            }
        }
        Deviations { amplitude, shape }
    }
}

/// The largest standard deviation of a number of a shape that is told.
fn largest(number: f64) -> f64 {
    LARGEST_SHAPE_SIGMA * number.abs()
}
