//! A law over any variables, for a person: its variables, its swing, its curves with their band, a short formula.

use crate::diagnosis::explanation::binned::binned;
use crate::diagnosis::explanation::proposal::{Point, propose};
use crate::diagnosis::outcome::Curve;
use crate::diagnosis::rows::free::values;
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::term::Accepted;
use crate::effects::{Axis, Form, FreeLaw, Parameter, Seen, Together, Variable};
use crate::model::{JointIndex, JointKind, Robot};
use crate::report::significant;

/// Points of a variable at which a law is evaluated.
const POINTS: usize = 41;

/// Names of the variables of a term; none for a law of the catalogue.
pub(in crate::diagnosis) fn variables(robot: &Robot, shape: &[f64]) -> Vec<String> {
    let law = FreeLaw::from_shape(shape, robot.joints());
    law.map_or_else(Vec::new, |law| law.axes.iter().map(|a| a.variable.name(robot)).collect())
}

/// The law of a term, where it is one over any variables.
fn law_of(model: &ExtendedModel<'_>, term: &Accepted) -> Option<(FreeLaw, usize)> {
    match term.effect.form() {
        Form::Free => {
            let law = FreeLaw::from_shape(&term.shape, model.context.model.robot().joints())?;
            Some((law, term.place.joint()?))
        }
        _ => None,
    }
}

/// Values of the columns of a law where its variables have these values.
fn columns(law: &FreeLaw, joint: usize, at: &[f64]) -> Vec<f64> {
    let seen: Vec<Seen> = law.axes.iter().zip(at).map(|(axis, value)| axis.seen_on(joint, *value)).collect();
    let mut out = Vec::with_capacity(law.amplitudes());
    law.columns(&seen, &mut out);
    out
}

fn product(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Standard deviation of a law where its columns have these values.
fn deviation(covariance: &[Vec<f64>], columns: &[f64]) -> f64 {
    let variance: f64 = columns.iter().zip(covariance).map(|(c, row)| c * product(row, columns)).sum();
    variance.max(0.0).sqrt()
}

/// Values of a variable from one end of its interval to the other, without its middle, where a direction changes.
fn grid(axis: &Axis) -> impl Iterator<Item = f64> + use<> {
    let (low, step) = (axis.centre - axis.half, 2.0 * axis.half / (POINTS - 1) as f64);
    (0..POINTS).map(move |k| low + (k as f64 + 1e-3) * step)
}

/// Difference between the largest and the smallest torque of law `k` at the rows of its joint that move in the same
/// direction: what it adds to all of those, friction and offset of the joint may take over. `sigma` are the standard deviations
/// of its amplitudes.
pub(in crate::diagnosis) fn swing(
    model: &ExtendedModel<'_>,
    k: usize,
    amplitude: &[f64],
    sigma: &[f64],
) -> Option<Parameter> {
    let term = &model.terms[k];
    let joint = term.place.joint()?;
    let (design, context) = (&model.slow.design, &model.context);
    let dense = model.columns_of(design, term);
    let covariance = with_deviations(covariance(model, k), sigma);
    let forward = |r: usize| context.signals[design.rows[r].signal].dq[joint][design.rows[r].centre] > 0.0;
    let of_direction = |direction: bool| {
        let rows = design.of_joint(joint).filter(|&r| forward(r) == direction);
        let all: Vec<Vec<f64>> = rows.map(|r| dense.iter().map(|c| c[r]).collect()).collect();
        let by_torque =
            |a: &&Vec<f64>, b: &&Vec<f64>| product(a, amplitude).total_cmp(&product(b, amplitude));
        let (top, bottom) = (all.iter().max_by(by_torque)?, all.iter().min_by(by_torque)?);
        let difference: Vec<f64> = top.iter().zip(bottom).map(|(t, b)| t - b).collect();
        Some((product(&difference, amplitude), deviation(&covariance, &difference)))
    };
    let both = [true, false].into_iter().filter_map(of_direction);
    let (swing, deviation) = both.max_by(|a, b| a.0.total_cmp(&b.0))?;
    Some(Parameter::new("swing", swing, deviation, context.scales[joint].kind.torque_unit()))
}

/// A covariance of the same correlations whose standard deviations are these.
fn with_deviations(mut covariance: Vec<Vec<f64>>, sigma: &[f64]) -> Vec<Vec<f64>> {
    let scale: Vec<f64> =
        (sigma.iter().enumerate()).map(|(i, s)| s / covariance[i][i].sqrt().max(f64::MIN_POSITIVE)).collect();
    for (i, row) in covariance.iter_mut().enumerate() {
        row.iter_mut().zip(&scale).for_each(|(c, s)| *c *= scale[i] * s);
    }
    covariance
}

/// Covariance of the amplitudes of term `k`, row by row.
fn covariance(model: &ExtendedModel<'_>, k: usize) -> Vec<Vec<f64>> {
    let fit = &model.slow.fit;
    let range = model.slow.term_columns[k].clone();
    let inflation = model.terms[k].inflation.powi(2);
    let row = |c: usize| {
        let mut unit = nalgebra::DVector::zeros(fit.chi.len());
        unit[c] = 1.0;
        let solved = fit.solve(&unit);
        range.clone().map(|i| inflation * solved[i]).collect()
    };
    range.clone().map(row).collect()
}

/// A law over each of its variables, with what the rest of the model leaves and the band of twice the law's standard
/// deviation; none for a law of the catalogue.
pub(in crate::diagnosis) fn curves(model: &ExtendedModel<'_>, k: usize) -> Vec<Curve> {
    let term = &model.terms[k];
    let Some((law, joint)) = law_of(model, term) else { return Vec::new() };
    let (design, context) = (&model.slow.design, &model.context);
    let amplitude: Vec<f64> = model.slow.term_columns[k].clone().map(|c| model.slow.fit.chi[c]).collect();
    let covariance = covariance(model, k);
    let residual = model.slow.residual();
    let dense: Vec<&[f64]> =
        model.slow.term_columns[k].clone().map(|c| design.columns[c].as_slice()).collect();
    let number = |j: usize| context.model.robot().joint_number(JointIndex(j)).0;
    let drawn = |over: Vec<Vec<f64>>, variable: String| {
        let mut rows = Vec::new();
        let mut spread = Vec::new();
        for r in design.of_joint(joint).filter(|&r| context.signals[design.rows[r].signal].is_target) {
            let x: Vec<f64> = dense.iter().map(|c| c[r]).collect();
            let torque = product(&x, &amplitude);
            let at = over[design.rows[r].signal][design.rows[r].centre];
            rows.push((at, residual[r] + torque, torque));
            spread.push((at, deviation(&covariance, &x), 0.0));
        }
        let mut curve = binned(rows);
        curve.variable = variable;
        curve.unit = context.scales[joint].kind.torque_unit().into();
        curve.band = binned(spread).residual.iter().map(|s| 2.0 * s).collect();
        curve
    };
    let motions = || 0..context.signals.len();
    if let (Some(sum), [a, b]) = (law.sum(), law.axes.as_slice()) {
        let of_motion = |s| {
            let [a, b] = [a, b].map(|axis| values(context, s, axis.variable));
            a.iter().zip(&b).map(|(a, b)| sum.of(*a, *b)).collect()
        };
        let name = sum_in_words(&law, number);
        return vec![drawn(
            motions().map(of_motion).collect(),
            format!("{name}, {}", unit(model, a.variable)),
        )];
    }
    let of_axis = |axis: &Axis| {
        let over = motions().map(|s| values(context, s, axis.variable)).collect();
        drawn(over, label(model, axis.variable))
    };
    law.axes.iter().map(of_axis).collect()
}

fn unit(model: &ExtendedModel<'_>, variable: Variable) -> &'static str {
    let kind = |j: usize| model.context.scales[j].kind;
    variable.unit(variable.joint().map_or(JointKind::Revolute, kind))
}

/// A variable with its unit, as an axis is called.
pub(in crate::diagnosis) fn label(model: &ExtendedModel<'_>, variable: Variable) -> String {
    let number = |j: usize| model.context.model.robot().joint_number(JointIndex(j)).0;
    format!("{}, {}", variable.words(number), unit(model, variable))
}

/// What a person calls the sum, or the difference, that a law is over.
fn sum_in_words(law: &FreeLaw, number: impl Fn(usize) -> usize + Copy) -> String {
    let names: Vec<String> = law.axes.iter().map(|axis| axis.variable.words(number)).collect();
    let what = if law.together == Together::Sum { "sum" } else { "difference" };
    format!("{what} of the {}", names.join(" and the "))
}

/// What a person calls that which a law depends on.
pub(in crate::diagnosis) fn in_words(law: &FreeLaw, number: impl Fn(usize) -> usize + Copy) -> String {
    if law.sum().is_some() {
        return format!("the {}", sum_in_words(law, number));
    }
    let names: Vec<String> =
        law.axes.iter().map(|axis| format!("the {}", axis.variable.words(number))).collect();
    names.join(" and ")
}

/// A short formula that stays within the band of a law over one variable, or over one times the direction of the joint;
/// `None` where none does.
pub(in crate::diagnosis) fn proposal(model: &ExtendedModel<'_>, k: usize) -> Option<String> {
    let term = &model.terms[k];
    let (law, joint) = law_of(model, term)?;
    let amplitude: Vec<f64> = model.slow.term_columns[k].clone().map(|c| model.slow.fit.chi[c]).collect();
    let covariance = covariance(model, k);
    let robot = model.context.model.robot();
    let unit = model.context.scales[joint].kind.torque_unit();
    if law.together == Together::Lines {
        return Some(format!("{} {unit}", lines(robot, &law, &amplitude)));
    }
    let is_angle = |axis: &Axis| matches!(axis.variable, Variable::Position(j) if model.context.scales[j].kind != JointKind::Prismatic);
    let points = |over: &Axis, at: &dyn Fn(f64) -> Vec<f64>| -> Vec<Point> {
        let point = |x: f64| {
            let c = at(x);
            Point { x, y: product(&c, &amplitude), sigma: deviation(&covariance, &c) }
        };
        grid(over).map(point).collect()
    };
    if let (Some(sum), [a, b]) = (law.sum(), law.axes.as_slice()) {
        let over = Axis { centre: sum.centre, half: sum.half, ..*a };
        let points = points(&over, &|x| columns(&law, joint, &[x - sum.of(0.0, b.centre), b.centre]));
        let sign = if sum.sign > 0.0 { '+' } else { '-' };
        let name = format!("({} {sign} {})", a.variable.name(robot), b.variable.name(robot));
        return propose(&points, &name, is_angle(a)).map(|formula| format!("{formula} {unit}"));
    }
    let own_speed = |a: &&Axis| a.variable == Variable::Speed(joint);
    let (axis, direction) = match (law.axes.as_slice(), law.together) {
        ([axis], Together::One | Together::Fine) => (axis, None),
        (axes, Together::Multiplied | Together::Fading) => {
            (axes.iter().find(|a| !own_speed(a))?, Some(axes.iter().find(own_speed)?))
        }
        _ => return None,
    };
    // Along a direction, the torque without what grows with the speed: that of the middle of the faster half.
    let at = |x: f64| match direction {
        None => columns(&law, joint, &[x]),
        Some(speed) => {
            let of = |v: f64| {
                let at: Vec<f64> = law.axes.iter().map(|a| if own_speed(&a) { v } else { x }).collect();
                columns(&law, joint, &at)
            };
            let fast = 0.5 * (speed.centre.abs() + speed.half);
            of(fast).iter().zip(of(-fast)).map(|(a, b)| 0.5 * (a - b)).collect()
        }
    };
    let formula = propose(&points(axis, &at), &axis.variable.name(robot), is_angle(axis))?;
    Some(match direction {
        None => format!("{formula} {unit}"),
        Some(speed) => format!("sign({})·({formula}) {unit}", speed.variable.name(robot)),
    })
}

/// What a law in proportion to its variables is, but for a constant.
fn lines(robot: &Robot, law: &FreeLaw, amplitude: &[f64]) -> String {
    let mut left = amplitude.iter();
    let mut words = String::new();
    let mut add = |number: f64, what: &str| {
        let joined = match (words.is_empty(), number < 0.0) {
            (true, _) => significant(number, 3),
            (false, true) => format!(" - {}", significant(-number, 3)),
            (false, false) => format!(" + {}", significant(number, 3)),
        };
        words.push_str(&format!("{joined}·{what}"));
    };
    for axis in &law.axes {
        let name = axis.variable.name(robot);
        if let Some(slope) = left.next() {
            add(slope / axis.half, &name);
        }
        let direction = if axis.variable.has_direction() { left.next() } else { None };
        if let Some(step) = direction {
            add(*step, &format!("sign({name})"));
        }
    }
    words
}
