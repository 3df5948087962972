//! Laws over any variables on a joint: which are tried, and which explain most.

use crate::diagnosis::candidates::candidate::{Candidate, make};
use crate::diagnosis::candidates::glance::Glance;
use crate::diagnosis::judging::judge::Verdict;
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::free::values;
use crate::diagnosis::rules::{FREE_FORM_PAIRS, FREE_FORM_SINGLES, FREE_FORM_TAIL};
use crate::effects::{Axis, EffectKind, FreeLaw, Place, Together, Variable};
use crate::parallel;

/// A law that was judged.
pub(in crate::diagnosis) struct Judged {
    pub law: FreeLaw,
    pub candidate: Candidate,
    pub verdict: Verdict,
}

/// Laws of a joint that gain on held-out motion, those that gain most first, and how many were tried.
pub(in crate::diagnosis) struct Screened {
    /// Over one variable.
    pub single: Vec<Judged>,
    /// Over two.
    pub pairs: Vec<Judged>,
    pub tried: usize,
}

/// Judges the laws over one variable on a joint, and over two, that gain most at a first look.
pub(in crate::diagnosis) fn screen(
    context: &Context<'_>,
    regression: &Regression,
    joint: usize,
    change: bool,
    threads: usize,
) -> Screened {
    let axes = axes(context, regression, joint);
    let judged = |laws: &[FreeLaw]| {
        let shapes: Vec<Vec<f64>> = laws.iter().map(FreeLaw::shape).collect();
        let place = Place::Joint(joint);
        let candidate = make(context, &regression.design, EffectKind::FreeForm, place, &shapes, change);
        let verdict = regression.judge(&candidate)?;
        let law = laws.get(verdict.trial)?.clone();
        Some(Judged { law, candidate, verdict })
    };
    let glance = Glance::new(context, regression, joint, &axes);
    let own = Variable::Position(joint);
    let gains = parallel::map(threads, axes.len(), |k| {
        let gains = alone(axes[k], own).into_iter().map(|law| glance.gain(&law, &[k]));
        gains.fold(f64::NEG_INFINITY, f64::max)
    });
    let most = most_gained(&gains, FREE_FORM_SINGLES);
    // Narrow bends must show on held-out motion: noise that lasts has some of its own.
    let single = sorted(parallel::map(threads, most.len(), |k| {
        let laws = alone(axes[most[k]], own).into_iter().filter_map(|law| judged(&[law]));
        laws.max_by(|a, b| a.verdict.total().total_cmp(&b.verdict.total()))
    }));
    let pairs: Vec<[usize; 2]> =
        (0..axes.len()).flat_map(|a| (a + 1..axes.len()).map(move |b| [a, b])).collect();
    // Products; sums with the best variable: it may be half of one; and what two do in proportion, or by what they are together.
    let best = single.first().and_then(|j| axes.iter().position(|a| a.variable == j.law.axes[0].variable));
    let gains = parallel::map(threads, pairs.len(), |k| {
        let two = pairs[k].map(|a| axes[a]);
        let of = |ways: &[Together]| {
            let gains = ways.iter().map(|&way| glance.gain(&FreeLaw::two(way, two), &pairs[k]));
            gains.fold(f64::NEG_INFINITY, f64::max)
        };
        let with_best = best.is_some_and(|b| pairs[k].contains(&b));
        let few = [&[Together::Lines][..], of_a_kind(context, joint, two)].concat();
        [of(&[Together::Multiplied]), of(if with_best { &[Together::Added] } else { &[] }), of(&few)]
    });
    let mut order: Vec<usize> = Vec::new();
    for way in 0..3 {
        let left = |k: usize| if order.contains(&k) { f64::NEG_INFINITY } else { gains[k][way] };
        let left: Vec<f64> = (0..pairs.len()).map(left).collect();
        order.extend(most_gained(&left, FREE_FORM_PAIRS));
    }
    let judge_pair = |k: usize| judged(&of_two(context, joint, pairs[order[k]].map(|a| axes[a])));
    let judged_pairs = sorted(parallel::map(threads, order.len(), judge_pair));
    let special: usize =
        pairs.iter().map(|pair| of_a_kind(context, joint, pair.map(|a| axes[a])).len()).sum();
    Screened { single, pairs: judged_pairs, tried: 3 * axes.len() + 2 * pairs.len() + special }
}

/// The laws over one variable: in proportion to it, which over the joint's own position is a spring of the catalogue; a curve;
/// and one with narrow bends.
fn alone(axis: Axis, own: Variable) -> Vec<FreeLaw> {
    let line = (axis.variable != own).then(|| FreeLaw::line(axis));
    line.into_iter().chain([FreeLaw::one(axis), FreeLaw::fine(axis)]).collect()
}

/// The ways in which only two variables of one kind come together on a joint: positions of one unit may be one, and what its
/// friction was after a rest may fade.
fn of_a_kind(context: &Context<'_>, joint: usize, two: [Axis; 2]) -> &'static [Together] {
    let of_one_unit = |[a, b]: [usize; 2]| context.scales[a].kind == context.scales[b].kind;
    match two.map(|axis| axis.variable) {
        [Variable::Position(a), Variable::Position(b)] if of_one_unit([a, b]) => &Together::OF_POSITIONS,
        two if two.contains(&Variable::Speed(joint)) && FreeLaw::may_fade(two) => &[Together::Fading],
        _ => &[],
    }
}

/// The laws over two variables on a joint.
fn of_two(context: &Context<'_>, joint: usize, two: [Axis; 2]) -> Vec<FreeLaw> {
    let ways = Together::OF_ANY_TWO.iter().chain(of_a_kind(context, joint, two));
    ways.map(|&way| FreeLaw::two(way, two)).collect()
}

/// The law over two of these variables that gains most on held-out motion, as a candidate.
pub(in crate::diagnosis) fn best_of_pairs(
    context: &Context<'_>,
    regression: &Regression,
    joint: usize,
    over: &[Variable],
    change: bool,
) -> Option<Candidate> {
    let axes = axes(context, regression, joint);
    let axes: Vec<Axis> = axes.into_iter().filter(|a| over.contains(&a.variable)).collect();
    let pairs = (0..axes.len()).flat_map(|a| (a + 1..axes.len()).map(move |b| [a, b]));
    let shapes = pairs.flat_map(|[a, b]| of_two(context, joint, [axes[a], axes[b]])).map(|law| law.shape());
    let place = Place::Joint(joint);
    let of_shape = |shape| make(context, &regression.design, EffectKind::FreeForm, place, &[shape], change);
    let judged = shapes.map(of_shape).filter_map(|c| Some((regression.judge(&c)?.total(), c)));
    judged.max_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, candidate)| candidate)
}

/// The first so many that gain, those that gain most first.
fn most_gained(gains: &[f64], count: usize) -> Vec<usize> {
    let mut ranked: Vec<usize> = (0..gains.len()).filter(|&k| gains[k] > 0.0).collect();
    ranked.sort_by(|&a, &b| gains[b].total_cmp(&gains[a]));
    ranked.truncate(count);
    ranked
}

fn sorted(judged: Vec<Option<Judged>>) -> Vec<Judged> {
    let mut list: Vec<Judged> = judged.into_iter().flatten().filter(|j| j.verdict.total() > 0.0).collect();
    list.sort_by(|a, b| b.verdict.total().total_cmp(&a.verdict.total()));
    list
}

/// Variables that a torque of the joint may depend on, each with the interval that nearly all of its values in the
/// recording lie in.
fn axes(context: &Context<'_>, regression: &Regression, joint: usize) -> Vec<Axis> {
    let design = &regression.design;
    let moves = |v: &Variable| match v {
        Variable::Torque(_) | Variable::Time => true,
        _ => v.joint().is_none_or(|k| !design.of_joint(k).is_empty()),
    };
    let interval = |variable: Variable| {
        let targets = (0..context.signals.len()).filter(|&k| context.signals[k].is_target);
        let mut all: Vec<f64> = targets.flat_map(|k| values(context, k, variable)).collect();
        all.retain(|x| x.is_finite());
        all.sort_by(f64::total_cmp);
        let cut = (FREE_FORM_TAIL * all.len() as f64) as usize;
        let (low, high) = (*all.get(cut)?, *all.get(all.len().checked_sub(cut + 1)?)?);
        (high > low).then_some(Axis { variable, centre: 0.5 * (low + high), half: 0.5 * (high - low) })
    };
    Variable::all(joint, design.joints).into_iter().filter(moves).filter_map(interval).collect()
}
