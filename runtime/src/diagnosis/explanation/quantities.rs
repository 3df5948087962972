//! The quantities of an accepted effect that a person knows, with their uncertainty.

use crate::diagnosis::explanation::deviations::Deviations;
use crate::diagnosis::explanation::free_form;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rules::QUANTITY_STEP;
use crate::diagnosis::search::body;
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::term::{Accepted, Mode};
use crate::effects::{BodyEstimate, Compliance, CoupledRotor, Form, HEARD_JOINT, Parameter, numbers_at};
use crate::model::JointIndex;

/// What a finding and a model keep of an accepted effect.
pub(in crate::diagnosis) struct Quantified {
    /// The quantities a person knows.
    pub parameters: Vec<Parameter>,
    /// Amplitudes of a model's term, see [`crate::effects::EffectTerm`].
    pub amplitude: Vec<f64>,
    /// Their standard deviations.
    pub sigma: Vec<f64>,
}

/// The quantities of term `k` that a person knows, with the uncertainty of shapes propagated to first order; from the amplitudes
/// and the standard deviations of amplitudes and shape.
pub(in crate::diagnosis) fn quantified(
    model: &ExtendedModel<'_>,
    k: usize,
    amplitude: Vec<f64>,
    deviations: Deviations,
) -> Quantified {
    let (context, term) = (&model.context, &model.terms[k]);
    let Deviations { amplitude: sigma, shape: shape_sigma } = deviations;
    let parameters = match term.effect.form() {
        Form::Joint(law) | Form::Heard(law) => term.place.law_of().map(|j| {
            let of = |shape: &[f64]| law.parameters(&context.scales[j], shape, &amplitude, &sigma);
            let mut list = propagate(of, &term.shape, &shape_sigma);
            if term.place.hears().is_some() {
                let number = context.model.robot().joint_number(JointIndex(j)).0;
                list.push(Parameter::new(HEARD_JOINT, number as f64, 0.0, "1"));
            }
            list
        }),
        Form::Compliance(law) => {
            if let Some(j) = term.place.joint() {
                return transmission(context, law, j, term, &shape_sigma);
            }
            None
        }
        Form::Sensitivity(law) => term.place.variant().map(|v| {
            let wanted = numbers_at(law, context.model.robot(), v);
            let of = wanted.iter().zip(amplitude.iter().zip(&sigma));
            of.map(|(variant, (a, s))| law.quantity(variant, *a, *s)).collect()
        }),
        Form::Body(_) => return body(model, term, amplitude, sigma),
        Form::Coupled => term.shape.first().map(|&ratio| {
            let ratio_sigma = shape_sigma.first().copied().unwrap_or(0.0);
            CoupledRotor { ratio }.parameters(&amplitude, &sigma, ratio_sigma)
        }),
        Form::Free => free_form::swing(model, k, &amplitude, &sigma).map(|swing| vec![swing]),
        Form::User => term.place.law().map(|law| {
            let unit = context.scales[law.joint()].kind.torque_unit();
            law.parameters([&amplitude, &sigma], [&term.shape, &shape_sigma], unit)
        }),
        Form::Window => None,
    };
    Quantified { parameters: parameters.unwrap_or_default(), amplitude, sigma }
}

/// The body that is nearest to the fitted numbers; where its mass does not show, its first moment about the axis of the
/// joint that carries it.
fn body(model: &ExtendedModel<'_>, term: &Accepted, fitted: Vec<f64>, sigma: Vec<f64>) -> Quantified {
    let amplitude = body::of_term(model, term).map_or(fitted, |(body, _)| body.parameters.to_vec());
    // A column that is nothing says nothing of its amplitude.
    let shown: Vec<f64> = sigma.iter().map(|s| if *s > 0.0 { *s } else { f64::INFINITY }).collect();
    let robot = model.context.model.robot();
    let carrier = term.place.link().and_then(|frame| robot.joint_of_frame().get(frame).copied().flatten());
    let axis = carrier.map(|j| robot.joint_number(JointIndex(j)).0);
    let slack = 3.0 * sigma.iter().take(6).fold(0.0_f64, |a, b| a.max(*b));
    let parameters = BodyEstimate::from_parameters(&amplitude, slack).parameters(&shown, axis);
    Quantified { parameters, amplitude, sigma }
}

/// A compliant transmission has no amplitude of its own: a model keeps its constants.
fn transmission(
    context: &Context<'_>,
    law: &dyn Compliance,
    j: usize,
    term: &Accepted,
    shape_sigma: &[f64],
) -> Quantified {
    let of = |shape: &[f64]| -> Vec<Parameter> {
        law.describe(&context.transmission(j, shape))
            .into_iter()
            .map(|(name, value, unit)| Parameter::new(name, value, 0.0, unit))
            .collect()
    };
    let mut parameters = propagate(of, &term.shape, shape_sigma);
    // Shapes that are far from the best and leave hardly more are as likely as their likelihood says.
    for (i, p) in parameters.iter_mut().enumerate() {
        let apart = |mode: &Mode| of(&mode.shape).get(i).map_or(0.0, |q| q.value - p.value);
        let variance: f64 = term.modes.iter().map(|mode| mode.weight * apart(mode).powi(2)).sum();
        p.sigma = p.sigma.hypot(variance.sqrt());
    }
    Quantified {
        parameters,
        amplitude: context.transmission(j, &term.shape).amplitude().to_vec(),
        sigma: vec![0.0; 4],
    }
}

/// Quantities of a shape; the standard deviations of its numbers through a difference.
pub(super) fn propagate(
    of: impl Fn(&[f64]) -> Vec<Parameter>,
    shape: &[f64],
    shape_sigma: &[f64],
) -> Vec<Parameter> {
    let mut list = of(shape);
    for (i, &s) in shape_sigma.iter().enumerate() {
        if s == 0.0 {
            continue;
        }
        let step = QUANTITY_STEP * shape[i].abs().max(1e-9);
        let mut moved = shape.to_vec();
        moved[i] += step;
        for (p, q) in list.iter_mut().zip(of(&moved)) {
            p.sigma = p.sigma.hypot((q.value - p.value) / step * s);
        }
    }
    list
}
