//! Laws over any variables on a joint: which are tried, and which explain most.

use crate::diagnosis::candidates::candidate::{Candidate, make};
use crate::diagnosis::judging::judge::Verdict;
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::free::values;
use crate::diagnosis::rules::{AIC_PENALTY, CURVE_RIDGE, FREE_FORM_PAIRS, FREE_FORM_SINGLES, FREE_FORM_TAIL};
use crate::effects::{Axis, EffectKind, FreeLaw, Place, Seen, Together, Variable};
use crate::parallel;
use nalgebra::{DMatrix, DVector};

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
        let few = [&[Together::Lines][..], sums(context, two)].concat();
        [of(&[Together::Multiplied]), of(if with_best { &[Together::Added] } else { &[] }), of(&few)]
    });
    let mut order: Vec<usize> = Vec::new();
    for way in 0..3 {
        let left = |k: usize| if order.contains(&k) { f64::NEG_INFINITY } else { gains[k][way] };
        let left: Vec<f64> = (0..pairs.len()).map(left).collect();
        order.extend(most_gained(&left, FREE_FORM_PAIRS));
    }
    let judge_pair = |k: usize| judged(&of_two(context, pairs[order[k]].map(|a| axes[a])));
    let judged_pairs = sorted(parallel::map(threads, order.len(), judge_pair));
    let sums: usize = pairs.iter().map(|pair| sums(context, pair.map(|a| axes[a])).len()).sum();
    Screened { single, pairs: judged_pairs, tried: 3 * axes.len() + 2 * pairs.len() + sums }
}

/// The laws over one variable: in proportion to it, which over the joint's own position is a spring of the catalogue; a curve;
/// and one with narrow bends.
fn alone(axis: Axis, own: Variable) -> Vec<FreeLaw> {
    let line = (axis.variable != own).then(|| FreeLaw::line(axis));
    line.into_iter().chain([FreeLaw::one(axis), FreeLaw::fine(axis)]).collect()
}

/// The ways in which two variables may be one: positions of one unit.
fn sums(context: &Context<'_>, [a, b]: [Axis; 2]) -> &'static [Together] {
    let of_one_unit = |[a, b]: [usize; 2]| context.scales[a].kind == context.scales[b].kind;
    match [a.variable, b.variable] {
        [Variable::Position(a), Variable::Position(b)] if of_one_unit([a, b]) => &Together::OF_POSITIONS,
        _ => &[],
    }
}

/// The laws over two variables.
fn of_two(context: &Context<'_>, two: [Axis; 2]) -> Vec<FreeLaw> {
    let ways = Together::OF_ANY_TWO.iter().chain(sums(context, two));
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
    let shapes = pairs.flat_map(|[a, b]| of_two(context, [axes[a], axes[b]])).map(|law| law.shape());
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

/// Takes the parts along orthonormal vectors out of another.
fn take_out(orthonormal: &[DVector<f64>], vector: &mut DVector<f64>) {
    for q in orthonormal {
        let part = q.dot(vector);
        vector.axpy(-part, q, 1.0);
    }
}

/// A first look: laws at the middles of the rows of the joint alone, beside what the columns of the model make there.
struct Glance {
    /// Variables with their directions at the rows, `[axis][row]`.
    seen: Vec<Vec<Seen>>,
    /// Orthonormal columns of the model, one a row.
    model: DMatrix<f64>,
    /// What the model leaves, without what its columns make on these rows alone.
    residual: DVector<f64>,
    /// One over the variance of the residual.
    weight: f64,
}

impl Glance {
    fn new(context: &Context<'_>, regression: &Regression, joint: usize, axes: &[Axis]) -> Self {
        let design = &regression.design;
        let rows: Vec<usize> =
            design.target_segments().into_iter().flat_map(|g| design.ranges[joint][g].clone()).collect();
        let of_axis = |axis: &Axis| {
            let all: Vec<Vec<f64>> =
                (0..context.signals.len()).map(|k| values(context, k, axis.variable)).collect();
            let own = axis.variable == Variable::Speed(joint);
            let at = |&r: &usize| {
                let value = all[design.rows[r].signal][design.rows[r].centre];
                axis.seen(value, own.then_some(if value > 0.0 { 1.0 } else { -1.0 }))
            };
            rows.iter().map(at).collect()
        };
        let live = design.columns.iter().filter(|c| rows.iter().any(|&r| c[r] != 0.0));
        let mut columns: Vec<DVector<f64>> =
            live.map(|c| DVector::from_iterator(rows.len(), rows.iter().map(|&r| c[r]))).collect();
        let mut kept: Vec<DVector<f64>> = Vec::new();
        for column in &mut columns {
            let whole = column.norm();
            // Twice is enough (Giraud, Langou and Rozloznik 2005).
            for _ in 0..2 {
                take_out(&kept, column);
            }
            let left = column.norm();
            if left > 1e-6 * whole {
                kept.push(&*column / left);
            }
        }
        let left = regression.residual();
        let mut residual = DVector::from_iterator(rows.len(), rows.iter().map(|&r| left[r]));
        take_out(&kept, &mut residual);
        Self {
            seen: axes.iter().map(of_axis).collect(),
            model: DMatrix::from_fn(kept.len(), rows.len(), |k, r| kept[k][r]),
            residual,
            weight: regression.sigma[joint].powi(-2),
        }
    }

    /// What a law gains in units of the noise variance, after a penalty for its numbers.
    fn gain(&self, law: &FreeLaw, axes: &[usize]) -> f64 {
        let (rows, k) = (self.residual.len(), law.amplitudes());
        let mut z = DMatrix::zeros(rows, k);
        let (mut at, mut out) = (Vec::with_capacity(axes.len()), Vec::with_capacity(k));
        for r in 0..rows {
            at.clear();
            at.extend(axes.iter().map(|&a| self.seen[a][r]));
            law.columns(&at, &mut out);
            out.iter().enumerate().for_each(|(c, x)| z[(r, c)] = *x);
        }
        // Products of what the columns of the model do not make of the law.
        let made = &self.model * &z;
        let mut g = z.tr_mul(&z) - made.tr_mul(&made);
        let b = z.tr_mul(&self.residual);
        let largest = (0..k).map(|c| g[(c, c)]).fold(f64::MIN_POSITIVE, f64::max);
        for c in 0..k {
            g[(c, c)] += CURVE_RIDGE * largest;
        }
        let taken = g.cholesky().map_or(0.0, |factor| b.dot(&factor.solve(&b)));
        self.weight * taken - AIC_PENALTY * k as f64
    }
}
