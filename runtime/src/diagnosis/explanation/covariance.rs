//! How parameters and laws of a model vary together, in a residual that is made white.

use crate::diagnosis::judging::projection::factored;
use crate::diagnosis::judging::regressors::Regressors;
use crate::diagnosis::judging::white_products::Background;
use crate::diagnosis::rules::UNDETERMINED;
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::effects::{EffectTerm, SmoothingWindow};

/// Upper triangle, row by row, of the covariance of the base parameters and of the amplitudes of `terms`, of which the
/// first `columns.len()` have the given columns of the slow rows; those that have none vary by themselves with their
/// standard deviations. Rows of what is not determined are zero.
///
/// It is the inverse of the information that the rows have once an autoregression has made the residual white
/// (generalised least squares; Aitken 1936). Amplitudes whose standard deviation is larger for another reason, such as
/// that they differ from unit to unit, keep that.
pub(in crate::diagnosis) fn upper(
    model: &ExtendedModel<'_>,
    terms: &[(&EffectTerm, Option<usize>)],
    threads: usize,
) -> Option<Vec<f64>> {
    let (regression, bench) = (&model.slow, model.bench(SmoothingWindow::Slow));
    let (design, residual) = (&regression.design, regression.residual());
    // What is free in every motion of a baseline would leave friction out of it.
    let nothing_free = vec![Vec::new(); design.joints];
    let regressors = Regressors { free: &nothing_free, ..bench.regressors(design) };
    let background = Background::new(&bench.units, &regressors, &residual, threads);
    let products = background.with(&bench.units, &regressors, &[], &residual).products;
    let p = design.columns.len();
    let whole = products.whole(&bench.units, &regressors, p);
    let information = whole.view((0, 0), (p, p)).into_owned();
    let (factor, scale) = factored(&information)?;
    let inverse = factor.inverse();
    // Place and standard deviation that is at least there.
    let mut of: Vec<(Option<usize>, f64)> = (0..design.parameters).map(|k| (Some(k), 0.0)).collect();
    for (term, first) in terms {
        let sigma = |k: usize| term.sigma.get(k).copied().unwrap_or(0.0);
        of.extend((0..term.amplitude.len()).map(|k| (first.map(|f| f + k), sigma(k))));
    }
    let variance = |c: usize| inverse[(c, c)] * scale[c] * scale[c];
    let is_determined = |c: usize| scale[c] > 0.0 && inverse[(c, c)] * UNDETERMINED * UNDETERMINED < 1.0;
    let entry = |i: usize, k: usize| match (of[i], of[k]) {
        ((Some(a), least_a), (Some(b), least_b)) if is_determined(a) && is_determined(b) => {
            let wider = |c: usize, least: f64| (least / variance(c).sqrt()).max(1.0);
            inverse[(a, b)] * scale[a] * scale[b] * wider(a, least_a) * wider(b, least_b)
        }
        ((None, sigma), _) if i == k => sigma * sigma,
        _ => 0.0,
    };
    let upper: Vec<f64> =
        (0..of.len()).flat_map(|i| (i..of.len()).map(move |k| (i, k))).map(|(i, k)| entry(i, k)).collect();
    upper.iter().all(|x| x.is_finite()).then_some(upper)
}
