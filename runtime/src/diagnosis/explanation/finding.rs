//! An accepted effect, or a contact, as a finding.

use crate::diagnosis::contact::search::Contacts;
use crate::diagnosis::error::DiagnosisError;
use crate::diagnosis::explanation::curves;
use crate::diagnosis::explanation::deviations::Deviations;
use crate::diagnosis::explanation::free_form;
use crate::diagnosis::explanation::quantities::{Quantified, quantified};
use crate::diagnosis::explanation::standard_model::estimated;
use crate::diagnosis::explanation::words;
use crate::diagnosis::outcome::{Alternative, Finding, ParameterValue, WithoutIt};
use crate::diagnosis::rules::{HIGHEST_CONFIDENCE, RIGHT_NAMES};
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::term::Accepted;
use crate::effects::{EffectKind, EffectTerm, Form, Place, UserLaw};
use crate::model::{JointIndex, Robot};

/// The confidence that is told: that what was found is no accident, and that it has the right name.
pub(in crate::diagnosis) fn told(no_accident: f64) -> f64 {
    no_accident.clamp(0.0, HIGHEST_CONFIDENCE) * RIGHT_NAMES
}

/// A term without amplitudes: what an effect at a place with a shape is.
pub(in crate::diagnosis) fn unit_term(effect: EffectKind, place: Place, shape: Vec<f64>) -> EffectTerm {
    EffectTerm {
        effect,
        place,
        joints: Vec::new(),
        shape,
        amplitude: Vec::new(),
        sigma: Vec::new(),
        scale: None,
        wrenches: Vec::new(),
    }
}

/// Numbers j of the joints that an effect at a place is named on.
pub(in crate::diagnosis) fn named_on(robot: &Robot, effect: EffectKind, place: Place) -> Vec<usize> {
    let joints = effect.form().named_joints(robot, place).into_iter();
    joints.map(|j| robot.joint_number(JointIndex(j)).0).collect()
}

/// Term k of a model as a finding, given the standard deviations of its numbers. The model stays as it is: the errors without
/// the term are those of a copy.
///
/// # Errors
/// [`DiagnosisError`] where the model without the term has no fit.
pub(in crate::diagnosis) fn of_term(
    model: &ExtendedModel<'_>,
    k: usize,
    deviations: Deviations,
) -> Result<Finding, DiagnosisError> {
    let accepted = &model.terms[k];
    let window = accepted.effect.properties().window;
    let regression = model.regression(window);
    let range = regression.term_columns[k].clone();
    let amplitude: Vec<f64> = range.map(|c| regression.fit.chi[c]).collect();
    let Quantified { parameters, amplitude, sigma } = quantified(model, k, amplitude, deviations);
    let reduced = model.without(k)?;
    let seen = regression.curves();
    let after = regression.held_out(false, &seen)?.error_on(&accepted.shows_on);
    let before = reduced.regression(window).held_out(false, &seen)?.error_on(&accepted.shows_on);
    let mut finding = Finding {
        confidence: told(accepted.confidence),
        significance: accepted.significance,
        parameters: parameters.iter().map(|p| (p.name.clone(), p.into())).collect(),
        held_out_before: before,
        held_out_after: after,
        share: 1.0 - (after / before).powi(2),
        alternatives: alternatives(model, k),
        curve: curves::of_term(model, accepted, k),
        more_curves: free_form::curves(model, k).into_iter().skip(1).collect(),
        variables: variables(model.context.model.robot(), accepted),
        proposal: free_form::proposal(model, k),
        without: Some(WithoutIt { chi: estimated(&reduced.slow).chi, effects: terms(&reduced) }),
        ..Finding::of(with_amplitude(model, accepted, amplitude, sigma))
    };
    finding.sentence = words::sentence(model.context.model.robot(), accepted.effect, &finding);
    Ok(finding)
}

/// Variables of a term that its effect does not say.
fn variables(robot: &Robot, accepted: &Accepted) -> Vec<String> {
    match accepted.effect.form() {
        Form::Free => free_form::variables(robot, &accepted.shape),
        Form::User => accepted.place.law().map_or_else(Vec::new, UserLaw::inputs),
        _ => Vec::new(),
    }
}

/// All laws of a model with their amplitudes, whose uncertainty nobody asks for.
pub(in crate::diagnosis) fn terms(model: &ExtendedModel<'_>) -> Vec<EffectTerm> {
    (0..model.terms.len()).map(|k| bare_term(model, k)).collect()
}

/// One of them.
fn bare_term(model: &ExtendedModel<'_>, k: usize) -> EffectTerm {
    let accepted = &model.terms[k];
    let regression = model.regression(accepted.effect.properties().window);
    let amplitude: Vec<f64> = regression.term_columns[k].clone().map(|c| regression.fit.chi[c]).collect();
    let deviations = Deviations::none(amplitude.len(), accepted.shape.len());
    let Quantified { amplitude, sigma, .. } = quantified(model, k, amplitude, deviations);
    with_amplitude(model, accepted, amplitude, sigma)
}

/// A term as a model keeps it.
fn with_amplitude(
    model: &ExtendedModel<'_>,
    accepted: &Accepted,
    amplitude: Vec<f64>,
    sigma: Vec<f64>,
) -> EffectTerm {
    EffectTerm {
        joints: named_on(model.context.model.robot(), accepted.effect, accepted.place),
        amplitude,
        sigma,
        scale: accepted.place.law_of().map(|j| model.context.scales[j].into()),
        ..unit_term(accepted.effect, accepted.place, accepted.shape.clone())
    }
}

/// The rivals of a term, and why they were not chosen.
fn alternatives(model: &ExtendedModel<'_>, k: usize) -> Vec<Alternative> {
    let accepted = &model.terms[k];
    let percent = |fraction: f64| 100.0 * fraction.clamp(0.0, 1.0);
    let over = |rival: &crate::diagnosis::search::term::Rival| {
        let variables = free_form::variables(model.context.model.robot(), &rival.shape);
        if variables.is_empty() { String::new() } else { format!("over {}: ", variables.join(" and ")) }
    };
    let alternative = |rival: &crate::diagnosis::search::term::Rival| Alternative {
        effect: rival.effect.id_at(rival.place).into(),
        joints: named_on(model.context.model.robot(), rival.effect, rival.place),
        why_not: format!(
            "{}explains {:.0} % of what held-out motion leaves open, against {:.0} %",
            over(rival),
            percent(rival.explained_fraction),
            percent(accepted.explained_fraction)
        ),
        share: rival.explained_fraction,
    };
    accepted.rivals.iter().map(alternative).collect()
}

/// The contacts as one finding, in the units of the robot's joints.
pub(in crate::diagnosis) fn of_contacts(robot: &Robot, contacts: &Contacts) -> Finding {
    let largest = contacts.wrenches.iter().max_by(|a, b| norm(a.force).total_cmp(&norm(b.force)));
    let mut parameters = std::collections::BTreeMap::new();
    let value = |value: f64, unit: &str| ParameterValue { value, sigma: 0.0, unit: unit.into() };
    parameters.insert("windows".into(), value(contacts.wrenches.len() as f64, "1"));
    if let Some(w) = largest.filter(|w| norm(w.force) > 0.0) {
        parameters.insert("largest_force".into(), value(norm(w.force), "N"));
        parameters.insert("link".into(), value(w.link as f64, "1"));
    }
    let joints = contacts.wrenches.iter().flat_map(|w| &w.joint_torques);
    if let Some(most) = joints.max_by(|a, b| a.largest.abs().total_cmp(&b.largest.abs())) {
        let unit = words::torque_unit(robot, most.joint).into();
        let torque = ParameterValue { value: most.largest, sigma: most.sigma, unit };
        parameters.insert("largest_joint_torque".into(), torque);
        parameters.insert("joint".into(), value(most.joint as f64, "1"));
    }
    let squares = contacts.squares;
    let mut finding = Finding {
        confidence: told(1.0 - contacts.doubt),
        parameters,
        held_out_before: (squares.before / squares.torque).sqrt(),
        held_out_after: (squares.after / squares.torque).sqrt(),
        share: 1.0 - squares.after / squares.before,
        contacts: contacts.wrenches.clone(),
        ..Finding::of(EffectTerm {
            wrenches: contacts.wrenches.clone(),
            ..unit_term(EffectKind::Contact, Place::Robot, Vec::new())
        })
    };
    finding.sentence = words::contact(robot, &finding);
    finding
}

fn norm(f: [f64; 3]) -> f64 {
    f.iter().map(|x| x * x).sum::<f64>().sqrt()
}
