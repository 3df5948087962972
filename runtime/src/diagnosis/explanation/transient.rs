//! What is in the model without being named: it was there at the beginning of the motion only.

use crate::diagnosis::outcome::{Finding, Transient};
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::transient::faded_after;

/// The transients among the effects of the terms of a model, in order, and what is named.
pub(in crate::diagnosis) fn told_apart(
    model: &ExtendedModel<'_>,
    effects: Vec<Finding>,
) -> (Vec<Transient>, Vec<Finding>) {
    let (mut transients, mut named) = (Vec::new(), Vec::new());
    for (accepted, finding) in model.terms.iter().zip(effects) {
        if !accepted.is_transient {
            named.push(finding);
            continue;
        }
        let design = &model.regression(accepted.effect.properties().window).design;
        let columns = model.columns_of(design, accepted);
        transients.push(Transient {
            effect: finding.effect,
            joints: finding.joints,
            faded_after: faded_after(design, &columns),
            term: finding.term,
        });
    }
    (transients, named)
}
