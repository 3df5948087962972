//! The skew of the torques behind the positions, named where it explains enough.

use crate::diagnosis::error::{DiagnosisError, SingularDesign};
use crate::diagnosis::explanation::finding::{told, unit_term};
use crate::diagnosis::explanation::words;
use crate::diagnosis::judging::held_out::HeldOutSquares;
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::judging::skew::{BetweenMotions, Skew};
use crate::diagnosis::outcome::{Finding, ParameterValue};
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::{NAMED_DELAY, NAMED_DELAY_SAMPLES};
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::settings::Settings;
use crate::effects::{EffectKind, EffectTerm, Place};

/// The delay as a finding, where it is more than sampling, certainly there, more than motions of a baseline differ in, and
/// explains enough. `skew` is all of it that was not there before, s.
///
/// # Errors
/// [`SingularDesign`] where a split has no fit.
pub(in crate::diagnosis) fn finding(
    model: &ExtendedModel<'_>,
    skew: f64,
    settings: &Settings,
) -> Result<Option<Finding>, SingularDesign> {
    if (skew * model.context.rate()).abs() < NAMED_DELAY_SAMPLES || skew.abs() < NAMED_DELAY {
        return Ok(None);
    }
    let slow = &model.slow;
    let known = if model.context.is_alone() {
        Skew::known(skew, (&slow.design, &slow.fit), slow.design.parameters)
    } else {
        let of_target = Skew::of_target(&model.context, (&slow.design, &slow.sigma), skew)?;
        let of_baseline = BetweenMotions::of_baseline(&model.context, (&slow.design, &slow.sigma))?;
        let reference = model.context.reference.as_ref();
        of_target.beside(of_baseline.known_to(reference.map_or(0.0, |r| r.delay_sigma())))
    };
    if known.confidence() < settings.confidence_of_one_search() {
        return Ok(None);
    }
    let seen = model.slow.curves();
    let with = slow.held_out(false, &seen)?;
    let unaware = HeldOutSquares::of(&with_skew(slow, skew), &slow.sigma, false, &seen)?;
    let all: Vec<usize> = (0..slow.design.joints).collect();
    let weigh =
        |h: &HeldOutSquares| -> f64 { h.left.iter().zip(&slow.sigma).map(|(l, s)| l / (s * s)).sum() };
    let share = 1.0 - weigh(&with) / weigh(&unaware);
    if share < settings.least_share {
        return Ok(None);
    }
    let delay = ParameterValue { value: known.value, sigma: known.sigma, unit: "s".into() };
    let mut finding = Finding {
        confidence: told(known.confidence()),
        significance: known.evidence.significance,
        parameters: [("delay".to_string(), delay)].into_iter().collect(),
        held_out_before: unaware.error_on(&all),
        held_out_after: with.error_on(&all),
        share,
        ..Finding::of(EffectTerm {
            amplitude: vec![known.value],
            sigma: vec![known.sigma],
            ..unit_term(EffectKind::TimeDelay, Place::Variant(0), Vec::new())
        })
    };
    finding.sentence = words::sentence(model.context.model.robot(), EffectKind::TimeDelay, &finding);
    Ok(Some(finding))
}

/// Errors of the standard model on held-out motion, fast rows, with the skew left in the torques.
///
/// # Errors
/// [`DiagnosisError`] where a split has no fit.
pub(in crate::diagnosis) fn unaware(
    model: &ExtendedModel<'_>,
    skew: f64,
) -> Result<HeldOutSquares, DiagnosisError> {
    let seen = model.fast.curves();
    let fast = &model.standard()?.fast;
    Ok(HeldOutSquares::of(&with_skew(fast, skew), &fast.sigma, model.change, &seen)?)
}

/// The rows as they would be with the skew left in the torques of the recording: the torque's own rate of change, as much of
/// it as the skew moved, and no column for it.
fn with_skew(regression: &Regression, skew: f64) -> Design {
    let p = regression.design.parameters;
    let taken = skew - regression.fit.chi[p];
    let mut design = regression.design.clone();
    let column = std::mem::replace(&mut design.columns[p], vec![0.0; design.rows.len()]);
    for g in design.target_segments() {
        for r in (0..design.joints).flat_map(|j| design.ranges[j][g].clone()) {
            design.y[r] += taken * column[r];
        }
    }
    design.refresh();
    design
}
