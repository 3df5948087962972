//! What a report draws: residuals over the variable that reveals an effect, and torques before and after.

use crate::diagnosis::explanation::binned::binned;
use crate::diagnosis::explanation::fine_law::fine_law;
use crate::diagnosis::explanation::free_form;
use crate::diagnosis::explanation::standard_model::StandardModelFit;
use crate::diagnosis::outcome::{Curve, Mismatch, TorqueSeries, Unexplained};
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::{Design, RowAt};
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rows::free::values;
use crate::diagnosis::rows::signals::Signals;
use crate::diagnosis::rules::{BINS, LEAST_DIFFERENCES, LEAST_MISMATCH, ORDERED_BY_VARIABLE};
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::term::Accepted;
use crate::effects::{Abscissa, EffectKind, Place, Variable};
use crate::model::JointIndex;

/// The variable that reveals a law with these numbers, on a joint at a sample of a motion.
pub(in crate::diagnosis) fn abscissa(
    context: &Context<'_>,
    (effect, place, shape): (EffectKind, Place, &[f64]),
    joint: usize,
    (signal, t): (usize, usize),
) -> f64 {
    let s = &context.signals[signal];
    match effect.properties().abscissa {
        Abscissa::Speed => s.dq[joint][t],
        Abscissa::Position => s.q[joint][t],
        Abscissa::Acceleration => s.ddq[joint][t],
        Abscissa::Load => context.torques(signal).rigid[joint][t],
        Abscissa::ModelTorque => context.drives(signal)[joint][t],
        Abscissa::HeardTorque => context.drives(signal)[place.law_of().unwrap_or(joint)][t],
        Abscissa::Time => s.time(t),
        Abscissa::SinceReversal => since_reversal(s, joint, t),
        Abscissa::WaveAngle => {
            let order = shape.first().copied().unwrap_or(1.0);
            (order * s.q[joint][t]).rem_euclid(2.0 * std::f64::consts::PI)
        }
    }
}

fn since_reversal(s: &Signals, joint: usize, t: usize) -> f64 {
    let sign = s.dq[joint][t].signum();
    let mut k = t;
    while k > 0 && s.dq[joint][k - 1] * sign > 0.0 {
        k -= 1;
    }
    (s.q[joint][t] - s.q[joint][k]).abs()
}

/// The first variable of a law of the user.
fn first_variable(model: &ExtendedModel<'_>, term: &Accepted) -> Option<Variable> {
    let law = term.place.law()?;
    law.variables(model.context.model.robot()).ok()?.first().copied()
}

/// The residual that a term has to explain on its first joint, and the term, over the variable that reveals it.
pub(in crate::diagnosis) fn of_term(model: &ExtendedModel<'_>, term: &Accepted, k: usize) -> Option<Curve> {
    let joint = *term.own.first()?;
    if let Some(curve) = free_form::curves(model, k).into_iter().next() {
        return Some(curve);
    }
    let side = model.regression(term.effect.properties().window);
    let design = &side.design;
    let dense = model.columns_of(design, term);
    let amplitude: Vec<f64> = match term.fixed {
        Some(a) => vec![a],
        None => side.term_columns[k].clone().map(|c| side.fit.chi[c]).collect(),
    };
    let residual = side.fit.residual(design);
    let properties = term.effect.properties();
    let signals = model.context.signals;
    let along = |signal: usize, t: usize| {
        if properties.along_motion { signals[signal].dq[joint][t].signum() } else { 1.0 }
    };
    let variable = first_variable(model, term);
    let over: Option<Vec<Vec<f64>>> =
        variable.map(|v| (0..signals.len()).map(|k| values(&model.context, k, v)).collect());
    let at = |signal: usize, t: usize| match &over {
        Some(of_motion) => of_motion[signal][t],
        None => abscissa(&model.context, (term.effect, term.place, &term.shape), joint, (signal, t)),
    };
    let rows: Vec<(f64, f64, f64)> = design
        .of_joint(joint)
        .filter(|&r| signals[design.rows[r].signal].is_target)
        .map(|r| {
            let law: f64 = dense.iter().zip(&amplitude).map(|(c, a)| a * c[r]).sum();
            let (signal, t) = (design.rows[r].signal, design.rows[r].centre);
            let sign = along(signal, t);
            (at(signal, t), sign * (residual[r] + law), sign * law)
        })
        .collect();
    let mut curve = binned(rows);
    curve.fine = fine_law(model, (term, &amplitude), joint, at, along);
    let kind = |j: usize| model.context.scales[j].kind;
    let name = match variable {
        Some(variable) => free_form::label(model, variable),
        None => properties.abscissa.label(kind(joint)),
    };
    curve.variable =
        if properties.along_motion { format!("{name} (torques along the motion)") } else { name };
    curve.unit = model.context.scales[joint].kind.torque_unit().into();
    Some(curve)
}

/// Share of the variance of `residual` that bins over a variable explain, beyond what bins explain by chance.
fn explained(values: Vec<f64>, residual: &[f64]) -> f64 {
    let n = residual.len() as f64;
    let total: f64 = residual.iter().map(|r| r * r).sum();
    if n < 2.0 * BINS as f64 || total == 0.0 {
        return 0.0;
    }
    let rows = values.into_iter().zip(residual).map(|(x, r)| (x, *r, 0.0)).collect();
    let curve = binned(rows);
    let size = n / curve.x.len() as f64;
    let between: f64 = curve.residual.iter().map(|r| r * r * size).sum();
    between / total - curve.x.len() as f64 / n
}

/// Where the standard model fails, joint by joint.
pub(in crate::diagnosis) fn mismatch(
    model: &ExtendedModel<'_>,
    standard: &StandardModelFit,
) -> Vec<Mismatch> {
    let design = &model.slow.design;
    let context = &model.context;
    let robot = context.model.robot();
    let mut list = Vec::new();
    let mut shares = Vec::new();
    for j in 0..design.joints {
        let floor = noise_floor(design, &model.slow.fit, j);
        let rows = design.count(j, |g| design.segments[g].is_target);
        shares.push((standard.held_slow.left[j] / (floor * floor).max(1e-300) - rows as f64).max(0.0));
    }
    let all: f64 = shares.iter().sum::<f64>().max(1e-300);
    for (j, share) in shares.iter().enumerate() {
        let share = share / all;
        let where_ = if share > LEAST_MISMATCH {
            ordered_by(model, j, &standard.residual_slow)
        } else {
            "nothing beyond the noise".into()
        };
        list.push(Mismatch { joint: robot.joint_number(JointIndex(j)).0, share, where_ });
    }
    list.sort_by(|a, b| b.share.total_cmp(&a.share));
    list
}

/// Which variable orders a residual of the slow rows on a joint, in words.
fn ordered_by(model: &ExtendedModel<'_>, j: usize, residual: &[f64]) -> String {
    let (design, context) = (&model.slow.design, &model.context);
    let rows: Vec<usize> = design.of_joint(j).collect();
    let residual: Vec<f64> = rows.iter().map(|&r| residual[r]).collect();
    let over = |f: &dyn Fn(&Signals, &RowAt) -> f64| -> f64 {
        let values =
            rows.iter().map(|&r| f(&context.signals[design.rows[r].signal], &design.rows[r])).collect();
        explained(values, &residual)
    };
    let candidates = [
        ("changes with the speed", over(&|s, r| s.dq[j][r.centre])),
        ("changes with the position", over(&|s, r| s.q[j][r.centre])),
        ("changes with the acceleration", over(&|s, r| s.ddq[j][r.centre])),
        ("changes with time", over(&|s, r| s.time(r.centre))),
        (
            "has the sign of the speed and grows with the load torque",
            over(&|s, r| context.torques(r.signal).rigid[j][r.centre] * s.dq[j][r.centre].signum()),
        ),
    ];
    match candidates.iter().max_by(|a, b| a.1.total_cmp(&b.1)) {
        Some((words, e)) if *e > ORDERED_BY_VARIABLE => {
            format!("while moving; {words} ({:.0} % of it)", 100.0 * e.min(1.0))
        }
        _ => "while moving; no single variable orders it".into(),
    }
}

/// Standard deviation of what changes from row to row: noise, whatever slow effects remain. Rows of a Hann window
/// half a window apart correlate by 1/6, so that r - (before + after) / 2 has 7/6 of the variance.
pub(in crate::diagnosis) fn noise_floor(design: &Design, fit: &Fit, joint: usize) -> f64 {
    let residual = fit.residual(design);
    let (mut sum, mut count) = (0.0, 0.0);
    for range in &design.ranges[joint] {
        for r in range.clone().skip(1) {
            if r + 1 >= range.end {
                break;
            }
            let (a, b, c) = (design.rows[r - 1], design.rows[r], design.rows[r + 1]);
            if b.centre - a.centre == c.centre - b.centre
                && b.centre - a.centre <= 2 * design.spacing(b.signal)
            {
                sum += (residual[r] - 0.5 * (residual[r - 1] + residual[r + 1])).powi(2);
                count += 1.0;
            }
        }
    }
    let rms = |x: f64, n: f64| if n > 0.0 { (x / n).sqrt() } else { 0.0 };
    let range = design.of_joint(joint);
    let n = range.len() as f64;
    let whole = rms(residual[range].iter().map(|r| r * r).sum(), n);
    if count < LEAST_DIFFERENCES { whole } else { rms(sum, count) / (7.0_f64 / 6.0).sqrt() }
        .min(whole)
        .max(1e-12)
}

/// What nothing explains.
pub(in crate::diagnosis) fn unexplained(model: &ExtendedModel<'_>) -> Unexplained {
    let design = &model.slow.design;
    let residual = model.slow.fit.residual(design);
    let mut out = Unexplained::default();
    let (mut open, mut all) = (Vec::new(), 0.0);
    for j in 0..design.joints {
        let floor = noise_floor(design, &model.slow.fit, j);
        let squares: f64 = design.of_joint(j).map(|r| residual[r] * residual[r]).sum();
        let noise = floor * floor * design.of_joint(j).len() as f64;
        let share = (1.0 - noise / squares.max(1e-300)).max(0.0);
        out.per_joint.push(share);
        open.push(share * squares / (floor * floor).max(1e-300));
        all += squares / (floor * floor).max(1e-300);
        let rows = design
            .of_joint(j)
            .map(|r| {
                (model.context.signals[design.rows[r].signal].dq[j][design.rows[r].centre], residual[r], 0.0)
            })
            .collect();
        let mut curve = binned(rows);
        curve.variable = format!("joint speed, {}", model.context.scales[j].kind.speed_unit());
        curve.unit = model.context.scales[j].kind.torque_unit().into();
        out.curves.push(curve);
    }
    let left: f64 = open.iter().sum();
    out.share = left / f64::max(all, 1e-300);
    let joint = |(j, open): (usize, &f64)| Mismatch {
        joint: model.context.model.robot().joint_number(JointIndex(j)).0,
        share: open / left.max(1e-300),
        where_: ordered_by(model, j, &residual),
    };
    let most = open.iter().enumerate().max_by(|a, b| a.1.total_cmp(b.1)).filter(|_| left > 0.0);
    out.most = most.map(joint);
    out
}

/// Torques of the joints that have findings, in the first new motion; the first joint where there are none.
pub(in crate::diagnosis) fn series(model: &ExtendedModel<'_>, before: &[f64]) -> Vec<TorqueSeries> {
    let design = &model.fast.design;
    let context = &model.context;
    let Some(signal) = context.signals.iter().position(|s| s.is_target) else { return Vec::new() };
    let mut joints: Vec<usize> = model.terms.iter().flat_map(|t| t.own.iter().copied()).collect();
    joints.sort_unstable();
    joints.dedup();
    if joints.is_empty() {
        joints.push(0);
    }
    let residual = model.fast.fit.residual(design);
    joints
        .into_iter()
        .map(|j| {
            let mut s = TorqueSeries {
                motion: context.signals[signal].name.clone(),
                joint: context.model.robot().joint_number(JointIndex(j)).0,
                ..TorqueSeries::default()
            };
            for (range, _) in design.of_signal(j, signal) {
                for r in range {
                    let measured =
                        design.smooth(signal, &context.signals[signal].torque[j], design.rows[r].centre);
                    s.time.push(context.signals[signal].time(design.rows[r].centre));
                    s.measured.push(measured);
                    s.before.push(before[r]);
                    s.after.push(measured - residual[r]);
                }
            }
            s
        })
        .collect()
}
