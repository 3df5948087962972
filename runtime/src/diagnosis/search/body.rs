//! A body is physically consistent, or it is not named.

use crate::diagnosis::judging::significance::Evidence;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rules::{BODY_REACH, NO_BODY};
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::term::Accepted;
use crate::effects::Form;
use crate::estimation::{NearestBody, nearest_body};
use nalgebra::{DMatrix, DVector};

/// How far from its link a body can be, m: [`BODY_REACH`] times the lengths of the robot's table together; nothing is known
/// of it where the table has no lengths.
fn reach(context: &Context<'_>) -> Option<f64> {
    let frames = &context.model.robot().frames;
    let length: f64 = frames.iter().map(|f| f.d.abs() + f.b.abs() + f.r.abs()).sum();
    (length > 0.0).then_some(BODY_REACH * length)
}

/// The body nearest to fitted amplitudes, and whether what it costs is no more than their uncertainty; `inflation` is the
/// factor on the standard deviations of a white residual.
fn nearest(
    context: &Context<'_>,
    information: &DMatrix<f64>,
    amplitude: &DVector<f64>,
    inflation: f64,
) -> Option<(NearestBody, bool)> {
    let information = information / (inflation * inflation).max(1.0);
    let body = nearest_body(&information, amplitude, reach(context))?;
    let numbers = (0..amplitude.len()).filter(|&k| information[(k, k)] > 0.0).count().max(1);
    // The residual's variance is known from hundreds of rows.
    let evidence = Evidence::fisher(body.cost, numbers, f64::MAX);
    let is_one = evidence.p_value >= NO_BODY;
    Some((body, is_one))
}

/// Whether amplitudes, beside a model, are those of a law that can be: only bodies can be none.
pub(in crate::diagnosis) fn can_be(
    context: &Context<'_>,
    form: Form,
    (information, amplitude): (&DMatrix<f64>, &DVector<f64>),
    inflation: f64,
) -> bool {
    if !matches!(form, Form::Body(_)) {
        return true;
    }
    nearest(context, information, amplitude, inflation).is_some_and(|(_, is_one)| is_one)
}

/// Ten parameters of the body that an accepted term is, and whether it is one; `None` for a law that is no body.
pub(in crate::diagnosis) fn of_term(
    model: &ExtendedModel<'_>,
    term: &Accepted,
) -> Option<(NearestBody, bool)> {
    let Form::Body(_) = term.effect.form() else { return None };
    let place = model.terms.iter().position(|t| t.effect == term.effect && t.place == term.place)?;
    let regression = model.regression(term.effect.properties().window);
    let range = regression.term_columns.get(place)?.clone();
    let information = regression.fit.information(range.clone())?;
    let amplitude = DVector::from_iterator(range.len(), range.map(|c| regression.fit.chi[c]));
    nearest(&model.context, &information, &amplitude, term.inflation)
}
