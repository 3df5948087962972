//! The standard model before anything was added to it.

use crate::diagnosis::error::SingularDesign;
use crate::diagnosis::judging::held_out::HeldOutSquares;
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::outcome::{Errors, Estimated};
use crate::diagnosis::search::extended_model::ExtendedModel;

/// Fit and errors of the standard model alone.
pub(in crate::diagnosis) struct StandardModelFit {
    pub in_sample: Errors,
    /// Held out, fast rows.
    pub held: HeldOutSquares,
    pub estimated: Estimated,
    pub residual_slow: Vec<f64>,
    /// Held out, slow rows.
    pub held_slow: HeldOutSquares,
    /// Fitted torque of the fast rows.
    pub fitted_fast: Vec<f64>,
}

impl StandardModelFit {
    /// Of a model without terms.
    ///
    /// # Errors
    /// [`SingularDesign`] where a split has no fit.
    pub fn new(model: &ExtendedModel<'_>) -> Result<Self, SingularDesign> {
        let (slow, fast) = (&model.slow, &model.fast);
        let residual = fast.residual();
        Ok(Self {
            in_sample: in_sample(fast),
            held: fast.held_out(model.change, &[])?,
            estimated: estimated(slow),
            residual_slow: slow.residual(),
            held_slow: slow.held_out(model.change, &[])?,
            fitted_fast: residual.iter().enumerate().map(|(row, r)| fast.design.torque(row) - r).collect(),
        })
    }
}

/// Errors in the recording that is diagnosed, of the fit to all motion.
pub(in crate::diagnosis) fn in_sample(regression: &Regression) -> Errors {
    let design = &regression.design;
    let (mut left, mut whole) = (vec![0.0; design.joints], vec![0.0; design.joints]);
    for j in 0..design.joints {
        for g in design.target_segments() {
            left[j] += regression.fit.squares(design, j, g);
            whole[j] += design.torque_squares(j, g);
        }
    }
    Errors::of_squares(&left, &whole)
}

/// The base parameters with their standard deviations.
pub(in crate::diagnosis) fn estimated(regression: &Regression) -> Estimated {
    let p = regression.design.parameters;
    let variances = regression.fit.variances();
    Estimated {
        chi: regression.fit.chi.iter().take(p).copied().collect(),
        sigma: variances.iter().take(p).map(|v| v.max(0.0).sqrt()).collect(),
    }
}
