//! Times that were wrong by a factor, as a finding.

use crate::diagnosis::explanation::finding::{told, unit_term};
use crate::diagnosis::explanation::words;
use crate::diagnosis::judging::held_out::HeldOutSquares;
use crate::diagnosis::judging::significance::Evidence;
use crate::diagnosis::outcome::Finding;
use crate::diagnosis::rate::{LAW, WrongRate};
use crate::diagnosis::rules::LONGEST_BLOCK;
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::effects::{EffectTerm, Form};
use std::collections::BTreeSet;

/// The finding; `held` are the errors of the model at the right rate.
pub(in crate::diagnosis) fn finding(
    model: &ExtendedModel<'_>,
    wrong: &WrongRate,
    held: &HeldOutSquares,
) -> Finding {
    let (effect, place) = LAW;
    let robot = model.context.model.robot();
    let design = &model.slow.design;
    let per_block = design.rows_within(LONGEST_BLOCK);
    let blocks: BTreeSet<_> = design.rows.iter().map(|&r| design.block(r, per_block)).collect();
    let ratio = wrong.logarithm.abs() / wrong.sigma.max(1e-300);
    let evidence = Evidence::student(ratio, blocks.len().saturating_sub(1) as f64);
    let quantity = match effect.form() {
        Form::Sensitivity(law) => {
            let variants = law.variants(robot);
            variants.first().map(|v| law.quantity(v, wrong.logarithm, wrong.sigma))
        }
        _ => None,
    };
    let before = wrong.errors.relative_error.unwrap_or_default();
    let after = held.errors().relative_error.unwrap_or_default();
    let mut finding = Finding {
        confidence: told(evidence.confidence(1)),
        significance: evidence.significance,
        parameters: quantity.iter().map(|p| (p.name.clone(), p.into())).collect(),
        held_out_before: before,
        held_out_after: after,
        share: 1.0 - (after / before.max(f64::MIN_POSITIVE)).powi(2),
        ..Finding::of(EffectTerm {
            amplitude: vec![wrong.logarithm],
            sigma: vec![wrong.sigma],
            ..unit_term(effect, place, vec![wrong.logarithm])
        })
    };
    finding.sentence = words::sentence(robot, effect, &finding);
    finding
}
