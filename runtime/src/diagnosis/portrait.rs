//! An effect of the catalogue on a made-up motion: how its torque lies over the variable that reveals it.

use super::error::DiagnosisError;
use super::experiment::{Question, distances, typical_laws};
use super::explanation::curves::abscissa;
use super::rows::context::Context;
use super::rows::scales::scales;
use super::rows::signals::Signals;
use crate::effects::{
    BodyEstimate, CoupledRotor, EffectKind, EffectTerm, Form, HEARD_JOINT, Parameter, Place, Quantities,
    Transmission, numbers_at,
};
use crate::model::{JointIndex, Model};
use crate::signal::Motion;

/// Rows a second of the made-up motion, Hz, and its duration, s.
const RATE: f64 = 500.0;
const DURATION: f64 = 12.0;
/// Slow swing of each joint in parts of its reach, the quick one on it, and their frequencies, Hz; each joint is quicker
/// than the one before, so that no two do the same.
const SLOW: (f64, f64) = (0.8, 0.17);
const QUICK: (f64, f64) = (0.1, 0.71);
const QUICKER: f64 = 1.3;
/// Reach of a joint that no limit holds, rad or m: gravity pulls it both ways.
const REACH: f64 = 2.2;
/// Shift, mass and moment of inertia about its centre of the body that is drawn, m, kg and kg.m².
const BODY: (f64, f64, f64) = (0.1, 1.0, 0.002);

/// The joint (0-based) on which laws are compared, and the part from which one imitates another.
const IMITATED: usize = 0;
const HALF: f64 = 0.5;

/// An effect as it may be in a robot, and its torque.
#[derive(Debug, Clone, PartialEq)]
pub struct Portrait {
    /// Number of the joint whose torque it is.
    pub joint: usize,
    /// The quantities that it was drawn with.
    pub parameters: Vec<Parameter>,
    /// The law with those numbers, and by the names of its quantities; empty where no formula of one line says it.
    pub formula: String,
    /// All forms that the law has, by the names of its quantities.
    pub laws: Vec<String>,
    /// The quantities of all of its forms.
    pub quantities: Vec<Parameter>,
    /// The variable that the torque is drawn over, with its unit.
    pub variable: String,
    /// Unit of the torque.
    pub unit: String,
    /// Whether torques are counted along the motion, so that friction has one sign.
    pub along_motion: bool,
    /// (variable, torque) at every sample of the motion; the largest torque is about `size`.
    pub points: Vec<(f64, f64)>,
}

/// One number for each column, falling off, so that none of several is all of a law.
fn falling_off(count: usize) -> Vec<f64> {
    (0..count).map(|k| 0.8_f64.powi(k as i32)).collect()
}

/// Evaluates an effect on a made-up motion of a robot with the base parameters `chi`, with the middle of its shapes, at
/// the first place where it makes a torque, as large as `size`, N.m or N. `None` where it makes none anywhere, as what
/// belongs to one recording, or has no law before it is seen.
///
/// # Errors
/// [`DiagnosisError`] where the robot cannot be evaluated.
pub fn portrait(
    model: &dyn Model,
    chi: &[f64],
    effect: EffectKind,
    size: f64,
) -> Result<Option<Portrait>, DiagnosisError> {
    let signals = [Signals::of_motion(&made_up_motion(model))];
    let context = Context::new(model, &signals, scales(model, &signals, chi), chi.to_vec())?;
    let places = effect.form().places(model.robot());
    Ok(places.into_iter().find_map(|place| at_place(&context, effect, place, size)))
}

/// Every joint swings slowly over most of its reach, with quick reversals on the way.
fn made_up_motion(model: &dyn Model) -> Motion {
    let robot = model.robot();
    let samples = (DURATION * RATE) as usize;
    let reach = |j: usize| {
        let limits = robot.limits.position.get(j);
        limits.map_or([-REACH, REACH], |&[low, high]| [low.max(-REACH), high.min(REACH)])
    };
    let positions = |j: usize| -> Vec<f64> {
        let [low, high] = reach(j);
        let (middle, half) = (0.5 * (low + high), 0.5 * (high - low));
        let faster = QUICKER.powi(j as i32);
        let swing = |(share, frequency): (f64, f64), t: f64| {
            share * (2.0 * std::f64::consts::PI * frequency * faster * t + j as f64).sin()
        };
        (0..samples)
            .map(|k| k as f64 / RATE)
            .map(|t| middle + half * (swing(SLOW, t) + swing(QUICK, t)))
            .collect()
    };
    let q: Vec<Vec<f64>> = (0..robot.joints()).map(positions).collect();
    let slope = |x: &Vec<f64>| -> Vec<f64> {
        (0..x.len())
            .map(|k| {
                let (before, after) = (k.saturating_sub(1), (k + 1).min(x.len() - 1));
                (x[after] - x[before]) * RATE / (after - before) as f64
            })
            .collect()
    };
    let dq: Vec<Vec<f64>> = q.iter().map(slope).collect();
    let ddq = dq.iter().map(slope).collect();
    let torque = vec![vec![0.0; samples]; q.len()];
    let (name, fixed) = (String::new(), Vec::new());
    Motion { name, rate: RATE, start: 0.0, q, dq, ddq, torque, fixed, edge_samples: 0 }
}

/// The laws of a joint that imitate one of them on the made-up motion, the best first: each with the part of the squares that
/// the standard model leaves of the law and that the other one takes, where that is half of them or more.
///
/// # Errors
/// [`DiagnosisError`] where the robot cannot be evaluated.
pub fn imitators(
    model: &dyn Model,
    chi: &[f64],
    effect: EffectKind,
) -> Result<Vec<(EffectKind, f64)>, DiagnosisError> {
    let motion = made_up_motion(model);
    let noise = vec![1.0; model.robot().joints()];
    let mut found = Vec::new();
    for other in EffectKind::ALL.into_iter().filter(|other| *other != effect) {
        let both = typical_laws((model, chi), IMITATED, &[effect, other], 1.0, &motion)?;
        let laws: Vec<EffectTerm> = both.into_iter().flatten().collect();
        if laws.len() < 2 {
            continue;
        }
        let apart = distances(&Question { model, chi, noise: &noise, laws: &laws }, &motion)?.apart;
        // A law that has this one for a special case is not compared with it.
        let (Some(alone), Some(left)) = (apart[0][0].filter(|alone| *alone > 0.0), apart[0][1]) else {
            continue;
        };
        let part = 1.0 - (left / alone).powi(2);
        if part >= HALF {
            found.push((other, part));
        }
    }
    found.sort_by(|a, b| b.1.total_cmp(&a.1));
    Ok(found)
}

fn at_place(context: &Context<'_>, effect: EffectKind, place: Place, size: f64) -> Option<Portrait> {
    let shapes = effect.form().shapes(place, &context.scales);
    let shape = shapes.get(shapes.len() / 2)?;
    let columns = context.series(0, effect, place, shape);
    let mut amplitude = amplitudes(effect.form(), columns.len());
    let joints = context.model.robot().joints();
    let mut torques = vec![vec![0.0; context.signals[0].len()]; joints];
    for (column, a) in columns.iter().zip(&amplitude) {
        for (j, values) in column {
            torques[*j].iter_mut().zip(values).for_each(|(torque, value)| *torque += a * value);
        }
    }
    let largest = |torque: &Vec<f64>| torque.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
    let joint = (0..joints).max_by(|&a, &b| largest(&torques[a]).total_cmp(&largest(&torques[b])))?;
    let factor =
        if effect.form().fixed_amplitude().is_some() { 1.0 } else { size / largest(&torques[joint]) };
    if !factor.is_finite() || largest(&torques[joint]) == 0.0 {
        return None;
    }
    amplitude.iter_mut().for_each(|a| *a *= factor);
    let law = (effect, place, shape.as_slice());
    let properties = effect.properties();
    let sign =
        |t: usize| if properties.along_motion { context.signals[0].dq[joint][t].signum() } else { 1.0 };
    let drawn = torques[joint].iter().enumerate();
    let points = drawn.map(|(t, torque)| (abscissa(context, law, joint, (0, t)), sign(t) * factor * torque));
    let parameters = quantities(context, law, &amplitude);
    let all_shapes = effect.form().all_shapes(place, &context.scales);
    let (laws, all) = forms(context, (effect, place), &all_shapes);
    let scale = &context.scales[joint];
    Some(Portrait {
        joint: context.model.robot().joint_number(JointIndex(joint)).0,
        formula: effect.effect().formula(&Quantities::new(parameters.clone())),
        parameters,
        laws,
        quantities: all,
        variable: properties.abscissa.label(scale.kind),
        unit: scale.kind.torque_unit().to_owned(),
        along_motion: properties.along_motion,
        points: points.collect(),
    })
}

/// The formulas of all shapes of a law by the names of its quantities, and those quantities, each once.
fn forms(
    context: &Context<'_>,
    (effect, place): (EffectKind, Place),
    shapes: &[Vec<f64>],
) -> (Vec<String>, Vec<Parameter>) {
    let (mut laws, mut all) = (Vec::new(), Vec::<Parameter>::new());
    for shape in shapes {
        let columns = match effect.form() {
            Form::Joint(law) | Form::Heard(law) => law.amplitudes(shape),
            _ => context.series(0, effect, place, shape).len(),
        };
        let named = quantities(context, (effect, place, shape), &amplitudes(effect.form(), columns));
        for quantity in &named {
            if all.iter().all(|known| known.name != quantity.name) {
                all.push(quantity.clone());
            }
        }
        let formula = effect.effect().formula(&Quantities::new(named).by_name());
        if !formula.is_empty() && !laws.contains(&formula) {
            laws.push(formula);
        }
        if !matches!(effect.form(), Form::Joint(_) | Form::Heard(_)) {
            break;
        }
    }
    (laws, all)
}

/// Amplitudes of columns that can be drawn: those of a body are of one that can be.
fn amplitudes(form: Form, columns: usize) -> Vec<f64> {
    match form {
        Form::Body(_) => {
            let (x, m, inertia) = BODY;
            let across = inertia + m * x * x;
            vec![inertia, 0.0, 0.0, across, 0.0, across, m * x, 0.0, 0.0, m]
        }
        _ => form.fixed_amplitude().map_or_else(|| falling_off(columns), |a| vec![a; columns]),
    }
}

/// The quantities that a person knows of a law with these numbers.
fn quantities(
    context: &Context<'_>,
    (effect, place, shape): (EffectKind, Place, &[f64]),
    amplitude: &[f64],
) -> Vec<Parameter> {
    let sigma = vec![0.0; amplitude.len()];
    let robot = context.model.robot();
    match effect.form() {
        Form::Joint(law) | Form::Heard(law) => {
            let Some(of) = place.law_of() else { return Vec::new() };
            let mut list = law.parameters(&context.scales[of], shape, amplitude, &sigma);
            if place.hears().is_some() {
                let number = robot.joint_number(JointIndex(of)).0;
                list.push(Parameter::new(HEARD_JOINT, number as f64, 0.0, "1"));
            }
            list
        }
        Form::Sensitivity(law) => {
            let wanted = numbers_at(law, robot, place.variant().unwrap_or(0));
            wanted.iter().zip(amplitude).map(|(variant, a)| law.quantity(variant, *a, 0.0)).collect()
        }
        Form::Compliance(law) => {
            let t: Option<Transmission> = place.joint().map(|j| context.transmission(j, shape));
            let told = t.map_or_else(Vec::new, |t| law.describe(&t));
            told.into_iter().map(|(name, value, unit)| Parameter::new(name, value, 0.0, unit)).collect()
        }
        Form::Body(_) => BodyEstimate::from_parameters(amplitude, 0.0).parameters(&sigma, None),
        Form::Coupled => shape
            .first()
            .map_or_else(Vec::new, |&ratio| CoupledRotor { ratio }.parameters(amplitude, &sigma, 0.0)),
        Form::Window | Form::Free | Form::User => Vec::new(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::simulation::testing::arm;

    #[test]
    fn every_effect_that_has_places_is_drawn_as_large_as_asked_for() {
        let (model, standard) = arm();
        let chi = model.robot().base_from_standard(&standard);
        for effect in EffectKind::ALL {
            let drawn = portrait(&model, &chi, effect, 3.0).expect("an arm can be evaluated");
            let places = effect.form().places(model.robot());
            let Some(portrait) = drawn else {
                assert!(places.is_empty(), "{}", effect.id());
                continue;
            };
            let largest = portrait.points.iter().fold(0.0_f64, |most, p| most.max(p.1.abs()));
            if effect.form().fixed_amplitude().is_none() {
                assert!((largest - 3.0).abs() < 1e-9, "{}: {largest}", effect.id());
            }
            assert!(portrait.points.iter().all(|p| p.0.is_finite() && p.1.is_finite()), "{}", effect.id());
            assert!(!portrait.parameters.is_empty(), "{}", effect.id());
        }
    }

    #[test]
    fn a_law_that_bends_with_speed_imitates_another_one_and_a_wave_does_not() {
        let (model, standard) = arm();
        let chi = model.robot().base_from_standard(&standard);
        let found = imitators(&model, &chi, EffectKind::NonlinearViscous).expect("an arm");
        let part = |kind| found.iter().find(|(other, _)| *other == kind).map(|(_, part)| *part);
        assert!(part(EffectKind::Stribeck).is_some_and(|part| part > 0.5), "{found:?}");
        assert_eq!(part(EffectKind::TorqueRipple), None, "{found:?}");
        assert!(found.iter().all(|(_, part)| (0.5..=1.0).contains(part)), "{found:?}");
        assert!(imitators(&model, &chi, EffectKind::Payload).expect("an arm").is_empty());
    }

    #[test]
    fn a_stribeck_curve_peaks_beside_rest_and_has_the_sign_of_the_speed() {
        let (model, standard) = arm();
        let chi = model.robot().base_from_standard(&standard);
        let drawn = portrait(&model, &chi, EffectKind::Stribeck, 1.0).expect("an arm").expect("a law");
        assert_eq!(drawn.laws, ["fs·exp(-(dq / vs)²)·sign(dq)", "fs·exp(-|dq / vs|^delta)·sign(dq)"]);
        let vs = drawn.parameters.iter().find(|p| p.name == "vs").expect("a speed").value;
        for (speed, torque) in &drawn.points {
            assert!(torque * speed >= 0.0);
            let expected = (-(speed / vs).powi(2)).exp();
            assert!((torque.abs() - expected).abs() < 1e-6, "{speed} {torque}");
        }
    }
}
