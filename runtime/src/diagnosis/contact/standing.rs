//! Pushes against a robot that holds still, from a model that its motion has told.

use crate::diagnosis::contact::force::{JointRow, as_torques, best_link};
use crate::diagnosis::contact::rest::{Load, Push, Seen, Standing, averaged, band, look, stretches};
use crate::diagnosis::contact::search::Contacts;
use crate::diagnosis::contact::spread::spread;
use crate::diagnosis::contact::squares::{Squares, mean_beside};
use crate::diagnosis::predict::torques_on;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::signals::{ModelTorques, Signals};
use crate::diagnosis::rules::{FORCE_EXPLAINS, FORCE_STEP_AT_REST};
use crate::effects::{ContactForce, CoupledRotor, EffectTerm, Form, JointTorque};
use nalgebra::Vector3;
use std::ops::Range;

/// What is seen of the outside while the robot holds still.
pub(in crate::diagnosis) struct AtRest {
    pub wrenches: Vec<ContactForce>,
    /// Of the torques beyond gravity while pushed.
    pub squares: Squares,
    /// Least probability that static friction explains a push.
    pub doubt: f64,
    /// Torques that are off for as long as the robot stands, with the index of their motion.
    pub loads: Vec<(usize, Load)>,
    /// Time of standing that was looked at, s.
    pub time: f64,
    /// Coulomb friction of each joint that can be judged.
    pub coulomb: Vec<Option<f64>>,
    /// Squares per joint of the torque beyond gravity and static friction, of the same outside of pushes, and of the
    /// torque itself, while the robot stands.
    pub by_joint: [Vec<f64>; 3],
}

impl AtRest {
    /// The pushes; rows that are at rest are not used for anything else anyway.
    pub fn contacts(&self, motions: usize) -> Option<Contacts> {
        (!self.wrenches.is_empty()).then(|| Contacts {
            windows: vec![Vec::new(); motions],
            wrenches: self.wrenches.clone(),
            squares: self.squares,
            doubt: self.doubt,
        })
    }
}

/// Looks at all motions of the recording that is diagnosed. `laws` are those that it has beside its parameters, `known` the
/// joints whose friction is known; below the speeds of `slowest` a joint stands.
pub(in crate::diagnosis) fn at_rest(
    context: &Context<'_>,
    laws: &[EffectTerm],
    known: &[bool],
    slowest: &[f64],
) -> AtRest {
    let uneven = uneven_over_the_path(context, laws, slowest);
    let laws = laws_at_rest(context, laws);
    let coulomb: Vec<Option<f64>> = coulomb(context)
        .into_iter()
        .zip(&laws.friction)
        .zip(known)
        .map(|((c, more), known)| Some(c + more).filter(|c| *known && c.is_finite() && *c > 0.0))
        .collect();
    let mut found = AtRest {
        wrenches: Vec::new(),
        squares: Squares::default(),
        doubt: 1.0,
        loads: Vec::new(),
        time: 0.0,
        coulomb: coulomb.clone(),
        by_joint: std::array::from_fn(|_| vec![0.0; coulomb.len()]),
    };
    let targets = context.signals.iter().enumerate().filter(|(_, s)| s.is_target);
    let targets: Vec<_> = targets.map(|(k, s)| (k, s, holds_still(s, slowest))).collect();
    let times = targets.iter().map(|(_, s, (_, still))| stretches(still, s.rate).len()).sum();
    for (k, s, (inside, still)) in targets {
        if !still.contains(&true) {
            continue;
        }
        let beyond: Vec<Vec<f64>> = beyond_gravity(context, s, laws.torque.get(k))
            .into_iter()
            .map(|x| x[inside.clone()].to_vec())
            .collect();
        let standing = Standing {
            rate: s.rate,
            start: s.time(inside.start),
            beyond: &beyond,
            still: &still,
            coulomb: &coulomb,
            uneven: &uneven,
            times,
        };
        let Seen { pushes, loads, time } = look(&standing);
        found.time += time;
        found.loads.extend(loads.into_iter().map(|load| (k, load)));
        for t in stretches(&still, s.rate).into_iter().flat_map(|[a, b]| a..b) {
            let time = standing.start + t as f64 / s.rate;
            let pushed = pushes.iter().any(|p| (p.window[0]..=p.window[1]).contains(&time));
            for (j, c) in coulomb.iter().enumerate() {
                let Some(c) = c else { continue };
                let out = (beyond[j][t].abs() - band(*c, uneven[j])).max(0.0).powi(2);
                found.by_joint[0][j] += out;
                found.by_joint[1][j] += if pushed { 0.0 } else { out };
                found.by_joint[2][j] += s.torque[j][t + inside.start].powi(2);
            }
        }
        for push in &pushes {
            found.doubt = found.doubt.min(push.doubt);
            let wrench = wrench(context, s, inside.start, &standing, push, &mut found.squares);
            found.wrenches.push(wrench);
        }
    }
    found
}

/// The samples of a motion without its ends, and whether the whole robot holds still at each.
fn holds_still(s: &Signals, slowest: &[f64]) -> (Range<usize>, Vec<bool>) {
    let from = s.edge_samples.min(s.len());
    let inside = from..s.len().saturating_sub(s.edge_samples).max(from);
    let slow = |t: usize| s.dq.iter().zip(slowest).all(|(dq, least)| dq[t].abs() < *least);
    let still = inside.clone().map(slow).collect();
    (inside, still)
}

/// What the torque of each joint changes by along its path that the model does not know, as a standard deviation: where the joint
/// stands it stands still with it, as the ripple of a motor does. It is seen while the robot moves, in all motions, with the noise
/// that is there at rest too; 0 where it is less than that.
fn uneven_over_the_path(context: &Context<'_>, laws: &[EffectTerm], slowest: &[f64]) -> Vec<f64> {
    let joints = context.model.robot().joints();
    let of_laws = torques_on(context.model, &context.chi, laws, context.signals).ok();
    let (mut moving, mut standing) = (vec![Vec::new(); joints], vec![Vec::new(); joints]);
    for (k, s) in context.signals.iter().enumerate() {
        let (inside, still) = holds_still(s, slowest);
        let at_rest = stretches(&still, s.rate);
        let model = context.torques(k);
        for (j, torque) in s.whole_torque().into_iter().enumerate() {
            let known = |t: usize| model.total[j][t] + of_laws.as_ref().map_or(0.0, |laws| laws[k][j][t]);
            let left: Vec<f64> = inside.clone().map(|t| torque[t] - known(t)).collect();
            let own = left.iter().zip(&s.dq[j][inside.clone()]).filter(|(_, dq)| dq.abs() >= slowest[j]);
            moving[j].extend(own.map(|(left, _)| *left));
            for [from, to] in &at_rest {
                let torque = &torque[inside.start + from..inside.start + to];
                standing[j]
                    .extend(torque.iter().zip(averaged(torque, s.rate)).map(|(torque, mean)| torque - mean));
            }
        }
    }
    let both = moving.into_iter().zip(standing);
    let beyond_noise = |(moving, standing): (Vec<f64>, Vec<f64>)| {
        let [all, noise] = [moving, standing].map(|values| spread(values.into_iter()));
        (all * all - noise * noise).max(0.0).sqrt()
    };
    both.map(beyond_noise).collect()
}

/// What laws are at rest.
struct LawsAtRest {
    /// Torque in the middle of the band of dry friction, `[motion][j][t]`; none without laws.
    torque: Vec<Vec<Vec<f64>>>,
    /// The most that they add to the dry friction of each joint.
    friction: Vec<f64>,
}

/// The laws as nothing moves: the mean of both directions, and half of the difference, which is friction. That of a rotor which
/// two joints drive turns its sign over more than the speed of rest.
fn laws_at_rest(context: &Context<'_>, laws: &[EffectTerm]) -> LawsAtRest {
    let mut friction = vec![0.0_f64; context.model.robot().joints()];
    let toward = |speed: f64| {
        let at: Vec<Signals> = context.signals.iter().map(|s| resting(s, s.q.clone(), speed)).collect();
        torques_on(context.model, &context.chi, laws, &at).ok().filter(|_| !laws.is_empty())
    };
    let (Some(mut torque), Some(back)) = (toward(SLOW), toward(-SLOW)) else {
        return LawsAtRest { torque: Vec::new(), friction };
    };
    for (forth, back) in torque.iter_mut().zip(&back) {
        for ((forth, back), most) in forth.iter_mut().zip(back).zip(&mut friction) {
            for (f, b) in forth.iter_mut().zip(back) {
                *most = most.max(0.5 * (*f - b));
                *f = 0.5 * (*f + b);
            }
        }
    }
    for law in laws.iter().filter(|law| matches!(law.effect.form(), Form::Coupled)) {
        let (Some(pair), Some(&ratio)) = (law.place.pair(), law.shape.first()) else { continue };
        for (joint, dry) in pair.into_iter().zip(CoupledRotor { ratio }.dry_friction(&law.amplitude)) {
            if let Some(friction) = friction.get_mut(joint) {
                *friction += dry;
            }
        }
    }
    LawsAtRest { torque, friction }
}

/// Torque beyond gravity, offset and `laws`, `[j][t]`, as if nothing moved: at rest speeds and accelerations are noise.
fn beyond_gravity(context: &Context<'_>, s: &Signals, laws: Option<&Vec<Vec<f64>>>) -> Vec<Vec<f64>> {
    let model = ModelTorques::new(context.model, &context.chi, &resting(s, s.q.clone(), 0.0));
    let mut beyond = s.whole_torque();
    for (j, beyond) in beyond.iter_mut().enumerate() {
        for (y, (total, friction)) in beyond.iter_mut().zip(model.total[j].iter().zip(&model.friction[j])) {
            *y -= total - friction;
        }
        if let Some(laws) = laws {
            beyond.iter_mut().zip(&laws[j]).for_each(|(y, law)| *y -= law);
        }
    }
    beyond
}

/// Dry friction of each joint: the most that any joints may have together where they turn a common motor.
fn coulomb(context: &Context<'_>) -> Vec<f64> {
    let n = context.model.robot().joints();
    let Some(s) = context.signals.first() else { return vec![0.0; n] };
    let mut most = vec![0.0_f64; n];
    // All joints one way, and each one against the others.
    for against in 0..=n {
        let mut one =
            resting(s, s.q.iter().map(|q| q.first().copied().into_iter().collect()).collect(), SLOW);
        if let Some(dq) = one.dq.get_mut(against) {
            dq.iter_mut().for_each(|v| *v = -*v);
        }
        let torques = ModelTorques::new(context.model, &context.chi, &one);
        for (most, friction) in most.iter_mut().zip(&torques.friction) {
            *most = most.max(friction.first().map_or(0.0, |f| f.abs()));
        }
    }
    most
}

/// A speed at which only dry friction is felt, rad/s or m/s.
const SLOW: f64 = 1e-9;

/// Positions at which all joints have one speed and no acceleration.
fn resting(s: &Signals, q: Vec<Vec<f64>>, speed: f64) -> Signals {
    let like = |value: f64| -> Vec<Vec<f64>> { q.iter().map(|x| vec![value; x.len()]).collect() };
    Signals::without_torque(&s.name, s.rate, s.start, [q.clone(), like(speed), like(0.0)])
}

/// A push as a force on a link where at least two joints see it and one force explains them; else as joint torques.
fn wrench(
    context: &Context<'_>,
    s: &Signals,
    offset: usize,
    standing: &Standing<'_>,
    push: &Push,
    squares: &mut Squares,
) -> ContactForce {
    let sample = |time: f64| (((time - standing.start) * standing.rate).round().max(0.0)) as usize;
    let last = standing.still.len().saturating_sub(1);
    let (from, to) = (sample(push.window[0]).min(last), sample(push.window[1]).min(last));
    let step = ((FORCE_STEP_AT_REST * standing.rate) as usize).max(1);
    let instants: Vec<usize> = (from..=to).step_by(step).collect();
    let sigma: Vec<f64> = standing.coulomb.iter().map(|c| c.unwrap_or(1.0) / 3.0_f64.sqrt()).collect();
    let rows = |t: usize| -> Vec<JointRow> {
        let known = standing.coulomb.iter().enumerate().filter(|(_, c)| c.is_some());
        known
            .map(|(joint, _)| JointRow {
                joint,
                residual: standing.beyond[joint][t],
                y: s.torque[joint][t + offset],
                sigma: sigma[joint],
            })
            .collect()
    };
    let course = |beyond: &Vec<f64>| -> Vec<f64> { instants.iter().map(|&t| beyond[t]).collect() };
    let courses: Vec<Vec<f64>> = standing.beyond.iter().map(course).collect();
    for (i, &t) in instants.iter().enumerate() {
        for JointRow { joint: j, residual: beyond, y: torque, sigma } in rows(t) {
            *squares += Squares {
                before: (beyond / sigma).powi(2),
                after: ((beyond - mean_beside(&courses[j], i)) / sigma).powi(2),
                torque: (torque / sigma).powi(2),
            };
        }
    }
    let felt = push.joints.iter();
    let felt = felt.map(|p| JointTorque { joint: p.joint, mean: p.mean, largest: p.largest, sigma: p.sigma });
    let mut wrench = as_torques(context.model.robot(), &s.name, push.window, push.edges, felt.collect());
    if push.joints.len() < 2 {
        return wrench;
    }
    let all: Vec<(usize, Vec<JointRow>)> = instants.iter().map(|&t| (t + offset, rows(t))).collect();
    let whole: f64 =
        all.iter().flat_map(|(_, rows)| rows).map(|row| (row.residual / row.sigma).powi(2)).sum();
    let best = best_link(context, s, all.iter().map(|(t, rows)| (*t, rows.as_slice())));
    if let Some(link) = best.filter(|link| 1.0 - link.left / whole >= FORCE_EXPLAINS) {
        let mean = link.forces.iter().sum::<Vector3<f64>>() / link.forces.len().max(1) as f64;
        let largest =
            link.forces.iter().max_by(|a, b| a.norm().total_cmp(&b.norm())).copied().unwrap_or(mean);
        wrench.link = link.frame + 1;
        wrench.force = [largest[0], largest[1], largest[2]];
        wrench.mean_force = [mean[0], mean[1], mean[2]];
    }
    wrench
}
