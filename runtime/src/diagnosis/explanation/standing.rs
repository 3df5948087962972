//! Laws that a reference has already: there before and now.

use crate::diagnosis::candidates::nuisances::standing_from;
use crate::diagnosis::outcome::Standing;
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::effects::EffectTerm;

/// Laws of the reference with the amplitudes that reference and recording have together, and the column of the first of
/// each on the slow rows where it has columns.
pub(in crate::diagnosis) fn terms(model: &ExtendedModel<'_>) -> Vec<(EffectTerm, Option<usize>)> {
    let Some(reference) = &model.context.reference else { return Vec::new() };
    let fit = &model.slow.fit;
    let variances = fit.variances();
    let design = &model.slow.design;
    let mut next = design.parameters + standing_from(design.joints);
    let lasting = reference.effects().iter().filter(|t| t.distortion().is_none() && t.wrenches.is_empty());
    lasting
        .map(|term| {
            if term.transmission().is_some() {
                return (term.clone(), None);
            }
            let first = next;
            next += term.amplitude.len();
            let amplitude = (first..next).zip(&term.amplitude).map(|(c, a)| a + fit.chi[c]).collect();
            let sigma = (first..next).map(|c| variances[c].max(0.0).sqrt()).collect();
            (EffectTerm { amplitude, sigma, ..term.clone() }, Some(first))
        })
        .collect()
}

/// One of them as it is told.
pub(in crate::diagnosis) fn told(term: &EffectTerm) -> Standing {
    Standing { effect: term.id().into(), joints: term.joints.clone(), term: term.clone() }
}
