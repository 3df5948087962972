//! Times that were wrong by a factor, as a finding; and what they do to the numbers of others.

use crate::diagnosis::explanation::finding::{told, unit_term};
use crate::diagnosis::explanation::words;
use crate::diagnosis::judging::held_out::HeldOutSquares;
use crate::diagnosis::judging::significance::Evidence;
use crate::diagnosis::outcome::Finding;
use crate::diagnosis::rate::{LAW, WrongRate};
use crate::diagnosis::rules::LONGEST_BLOCK;
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::effects::{EffectTerm, Form};
use crate::model::Robot;
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

/// Where times are found to be wrong among other laws, the numbers of these are in the seconds that were declared: they are told
/// in those of the robot, with what is not known of the rate as a part of their deviation.
pub(in crate::diagnosis) fn in_true_seconds(robot: &Robot, findings: &mut [Finding]) {
    let of_rate = |f: &Finding| (f.term.effect, f.term.place) == LAW;
    let Some(wrong) = findings.iter().find(|f| of_rate(f)) else { return };
    let (&[logarithm], &[deviation]) = (&wrong.term.amplitude[..], &wrong.term.sigma[..]) else { return };
    for finding in findings.iter_mut().filter(|f| !of_rate(f)) {
        let mut told_anew = false;
        for number in finding.parameters.values_mut() {
            let power = seconds(&number.unit);
            if power != 0.0 {
                let factor = (-power * logarithm).exp();
                number.value *= factor;
                number.sigma = (factor * number.sigma).hypot(power * deviation * number.value);
                told_anew = true;
            }
        }
        if told_anew {
            finding.sentence = words::sentence(robot, finding.term.effect, finding);
        }
    }
}

/// The power of a second in a unit.
fn seconds(unit: &str) -> f64 {
    let count = |product: &str| product.split('.').filter(|factor| *factor == "s").count() as f64;
    match unit.split_once('/') {
        Some((above, below)) => count(above) - count(below),
        None if unit == "Hz" => -1.0,
        None => count(unit),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::outcome::ParameterValue;
    use crate::effects::{EffectKind, Place};
    use crate::model::Model;
    use crate::testing::vertical_axis;
    use approx::assert_relative_eq;

    #[test]
    fn the_power_of_a_second_is_read_from_a_unit() {
        let units = ["s", "N.m.s/rad", "N.s/m", "rad/s", "m/s", "Hz", "N.m", "1", "kg.m2", "rad"];
        assert_eq!(units.map(seconds), [1.0, 1.0, 1.0, -1.0, -1.0, -1.0, 0.0, 0.0, 0.0, 0.0]);
    }

    #[test]
    fn numbers_beside_a_wrong_rate_are_in_the_seconds_of_the_robot() {
        let model = vertical_axis(&["ZZ1", "Fv1", "Fc1"]);
        let rate = Finding::of(EffectTerm {
            amplitude: vec![1.25_f64.ln()],
            sigma: vec![0.01],
            ..unit_term(LAW.0, LAW.1, vec![1.25_f64.ln()])
        });
        let mut drift = Finding::of(unit_term(EffectKind::FrictionDrift, Place::Joint(0), vec![1.0, 10.0]));
        let number = |value, sigma, unit: &str| ParameterValue { value, sigma, unit: unit.into() };
        drift.parameters.insert("tau".into(), number(10.0, 0.0, "s"));
        drift.parameters.insert("coulomb".into(), number(2.0, 0.3, "N.m"));
        let mut findings = [drift, rate];
        in_true_seconds(model.robot(), &mut findings);
        let [tau, coulomb] = ["tau", "coulomb"].map(|name| &findings[0].parameters[name]);
        assert_relative_eq!(tau.value, 8.0, max_relative = 1e-12);
        assert_relative_eq!(tau.sigma, 0.08, max_relative = 1e-12);
        assert_eq!((coulomb.value, coulomb.sigma), (2.0, 0.3));
        assert!(findings[0].sentence.contains("8.00"), "{}", findings[0].sentence);
    }
}
