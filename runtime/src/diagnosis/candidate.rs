//! What is tried: every effect of the catalogue at every place, with a grid of shapes, as columns on the rows.

use super::context::Context;
use super::design::{Design, dot};
use super::parallel;
use crate::effects::{EffectKind, Form, Place};
use nalgebra::DMatrix;

/// A column on the rows: for each joint that it acts on, the values at all of the joint's rows.
pub(super) type Sparse = Vec<(usize, Vec<f64>)>;

/// One shape of a candidate.
pub(super) struct Trial {
    pub shape: Vec<f64>,
    pub columns: Vec<Sparse>,
    /// Inner products with the design's columns and y, and with each other: `[joint][segment]`; empty where the
    /// trial does not act on the joint.
    pub products: Vec<Vec<Products>>,
}

/// Inner products of a trial on one group of rows.
#[derive(Clone)]
pub(super) struct Products {
    /// With every column of the design, p x k.
    pub with: DMatrix<f64>,
    /// With y, k.
    pub y: Vec<f64>,
    /// With each other, k x k.
    pub own: DMatrix<f64>,
}

/// An effect at a place.
pub(super) struct Candidate {
    pub effect: EffectKind,
    pub place: Place,
    /// Joints whose residual the effect must explain a share of.
    pub own: Vec<usize>,
    pub trials: Vec<Trial>,
    /// How many shapes were tried to find the best.
    pub shapes: usize,
    /// The amplitude, where the effect's law leaves none free.
    pub fixed: Option<f64>,
    /// Whether a negative amplitude is something else.
    pub only_positive: bool,
}

/// Columns of an effect on the rows of a design. Motions of a baseline are left at zero where `change` is set.
pub(super) fn columns(
    context: &Context<'_>,
    design: &Design,
    effect: EffectKind,
    place: Place,
    shape: &[f64],
    change: bool,
) -> Vec<Sparse> {
    let mut out: Vec<Sparse> = Vec::new();
    for k in 0..context.signals.len() {
        let silent = change && !context.signals[k].fresh;
        // A silent motion still needs to know which joints the columns act on.
        let mut series = context.series(k, effect, place, shape);
        if silent {
            for (_, values) in series.iter_mut().flatten() {
                values.fill(0.0);
            }
        }
        for (a, column) in series.iter().enumerate() {
            if out.len() <= a {
                out.push(column.iter().map(|(j, _)| (*j, Vec::new())).collect());
            }
            for ((j, rows), (_, values)) in out[a].iter_mut().zip(column) {
                design.sample(*j, k, values, rows);
            }
        }
    }
    out
}

/// The same on all rows of the design, zero where a column does not act.
pub(super) fn dense_columns(
    context: &Context<'_>,
    design: &Design,
    effect: EffectKind,
    place: Place,
    shape: &[f64],
    change: bool,
) -> Vec<Vec<f64>> {
    columns(context, design, effect, place, shape, change).iter().map(|c| dense(design, c)).collect()
}

/// The skew of the torques behind the positions, which is always fitted along.
pub(super) fn delay_columns(context: &Context<'_>, design: &Design) -> Vec<Vec<f64>> {
    dense_columns(context, design, EffectKind::TimeDelay, Place::Variant(0), &[], false)
}

fn dense(design: &Design, column: &Sparse) -> Vec<f64> {
    let mut full = vec![0.0; design.rows.len()];
    for (j, values) in column {
        full[design.of_joint(*j)].copy_from_slice(values);
    }
    full
}

impl Trial {
    pub fn new(design: &Design, shape: Vec<f64>, columns: Vec<Sparse>) -> Self {
        let mut trial = Self { shape, columns, products: Vec::new() };
        trial.refresh(design);
        trial
    }

    /// Inner products with the design as it is now.
    pub fn refresh(&mut self, design: &Design) {
        self.refresh_from(design, 0);
    }

    /// The same where neither the trial's own columns nor the design's before `first` have changed.
    pub fn refresh_from(&mut self, design: &Design, first: usize) {
        let (p, k) = (design.columns.len(), self.columns.len());
        let old = std::mem::take(&mut self.products);
        self.products = (0..design.joints)
            .map(|j| {
                let mine: Vec<Option<&[f64]>> = self
                    .columns
                    .iter()
                    .map(|c| c.iter().find(|(i, _)| *i == j).map(|(_, v)| v.as_slice()))
                    .collect();
                if mine.iter().all(Option::is_none) {
                    return Vec::new();
                }
                let start = design.of_joint(j).start;
                design.ranges[j]
                    .iter()
                    .enumerate()
                    .map(|(g, range)| {
                        let local = range.start - start..range.end - start;
                        let slice = |a: usize| mine[a].map_or(&[][..], |v| &v[local.clone()]);
                        let before = old.get(j).and_then(|segments| segments.get(g));
                        let kept = before.map_or(0, |_| first);
                        Products {
                            with: DMatrix::from_fn(p, k, |i, a| match before {
                                Some(before) if i < kept => before.with[(i, a)],
                                _ => dot_or_zero(&design.columns[i][range.clone()], slice(a)),
                            }),
                            y: (0..k).map(|a| dot_or_zero(&design.y[range.clone()], slice(a))).collect(),
                            own: match before {
                                Some(before) if kept > 0 => before.own.clone(),
                                _ => DMatrix::from_fn(k, k, |a, b| dot_or_zero(slice(a), slice(b))),
                            },
                        }
                    })
                    .collect()
            })
            .collect();
    }

    /// The trial's columns on all rows of the design.
    pub fn dense(&self, design: &Design) -> Vec<Vec<f64>> {
        self.columns.iter().map(|column| dense(design, column)).collect()
    }
}

fn dot_or_zero(a: &[f64], b: &[f64]) -> f64 {
    if a.len() == b.len() { dot(a, b) } else { 0.0 }
}

/// Which effects are looked for, and on which rows.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pace {
    /// As slow as the motion.
    Slow,
    /// Faster than the motion.
    Fast,
}

/// The pace that shows an effect best.
pub(super) fn pace(effect: EffectKind) -> Pace {
    match effect {
        EffectKind::TorqueRipple | EffectKind::JointElasticity | EffectKind::Backlash => Pace::Fast,
        _ => Pace::Slow,
    }
}

/// Places and shapes of every effect that this pace shows. `orders[j]` are ripple orders seen on joint j.
pub(super) fn proposals(
    context: &Context<'_>,
    wanted: Pace,
    change: bool,
    orders: &[Vec<f64>],
) -> Vec<(EffectKind, Place, Vec<Vec<f64>>)> {
    let robot = context.model.robot();
    let n = robot.joints();
    let mut list = Vec::new();
    for effect in EffectKind::ALL {
        if pace(effect) != wanted || (effect.needs_baseline() && !change) {
            continue;
        }
        match effect.form() {
            Form::Joint(law) => {
                for (j, seen) in orders.iter().enumerate() {
                    let mut shapes = law.shapes(&context.scales[j]);
                    if effect == EffectKind::TorqueRipple {
                        shapes.extend(seen.iter().map(|&o| vec![o]));
                    }
                    list.push((effect, Place::Joint(j), shapes));
                }
            }
            Form::Sensitivity(law) => {
                // The same robot in two recordings has the same geometry, and the delay is taken out of all anyway.
                if effect == EffectKind::TimeDelay || (change && effect == EffectKind::GeometryError) {
                    continue;
                }
                let count = if law.together() { 1 } else { law.variants(robot).len() };
                list.extend((0..count).map(|v| (effect, Place::Variant(v), vec![vec![]])));
            }
            Form::Compliance(law) => {
                let shapes: Vec<Vec<f64>> = law.shapes().iter().map(|s| s.to_vec()).collect();
                list.extend((0..n).map(|j| (effect, Place::Joint(j), shapes.clone())));
            }
            Form::Body(law) => {
                list.extend(law.links(robot).into_iter().map(|l| (effect, Place::Link(l), vec![vec![]])));
            }
            Form::Coupled => {
                let shapes: Vec<Vec<f64>> =
                    crate::effects::CoupledTransmission::RATIOS.iter().map(|&r| vec![r]).collect();
                for b in 1..n {
                    for (a, c) in [(b - 1, b), (b, b - 1)] {
                        let known = robot.drive.gear.get(c * n + a).is_some_and(|g| *g != 0.0);
                        if !known {
                            list.push((effect, Place::Pair(a, c), shapes.clone()));
                        }
                    }
                }
            }
            Form::Window => {}
        }
    }
    list
}

/// Builds candidates on several threads; the order of the result does not depend on their number.
pub(super) fn build(
    context: &Context<'_>,
    design: &Design,
    proposals: &[(EffectKind, Place, Vec<Vec<f64>>)],
    change: bool,
    threads: usize,
    report: &(dyn Fn(f64) + Sync),
) -> Vec<Candidate> {
    let built = parallel::map(threads, proposals.len(), |k| {
        let (effect, place, shapes) = &proposals[k];
        report(k as f64 / proposals.len() as f64);
        make(context, design, *effect, *place, shapes, change)
    });
    built.into_iter().filter(|c| !c.trials.is_empty()).collect()
}

/// One candidate with all of its shapes.
pub(super) fn make(
    context: &Context<'_>,
    design: &Design,
    effect: EffectKind,
    place: Place,
    shapes: &[Vec<f64>],
    change: bool,
) -> Candidate {
    let trials: Vec<Trial> = shapes
        .iter()
        .map(|shape| {
            Trial::new(design, shape.clone(), columns(context, design, effect, place, shape, change))
        })
        .filter(|t| t.columns.iter().all(|c| c.iter().flat_map(|(_, v)| v).all(|x| x.is_finite())))
        .collect();
    let own = match (effect.form(), place) {
        (_, Place::Joint(j)) => vec![j],
        (_, Place::Pair(a, b)) => vec![a, b],
        _ => (0..design.joints).collect(),
    };
    let fixed = matches!(effect.form(), Form::Compliance(_)).then_some(1.0);
    let only_positive = matches!(effect.form(), Form::Joint(law) if law.only_positive());
    Candidate { effect, place, own, shapes: trials.len(), trials, fixed, only_positive }
}
