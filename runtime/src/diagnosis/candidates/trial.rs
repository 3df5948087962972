//! A shape of an effect at a place as columns on the rows, and their inner products with the design.

use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::gram::dot;
use crate::diagnosis::rows::series::Series;
use crate::diagnosis::rules::OWN_FRACTION;
use crate::effects::{EffectKind, EffectTerm, Place};
use nalgebra::DMatrix;

/// A column on the rows: for each joint that it acts on, the values at all of the joint's rows.
pub(in crate::diagnosis) type Sparse = Vec<(usize, Vec<f64>)>;

/// One shape of a candidate.
pub(in crate::diagnosis) struct Trial {
    pub shape: Vec<f64>,
    pub columns: Vec<Sparse>,
    /// Inner products with the design's columns and y, and with each other: `[joint][segment]`; empty where the
    /// trial does not act on the joint.
    pub products: Vec<Vec<Products>>,
    /// Columns that must have a part of their own.
    pub needed: usize,
    /// Least fraction of a column's squares that is a part of its own.
    pub own_fraction: f64,
}

/// Inner products of a trial on one group of rows.
#[derive(Clone)]
pub(in crate::diagnosis) struct Products {
    /// With every column of the design, p x k.
    pub with: DMatrix<f64>,
    /// With y, k.
    pub y: Vec<f64>,
    /// With each other, k x k.
    pub own: DMatrix<f64>,
}

/// Columns of an effect on the rows of a design. Motions of a baseline are left at zero where `change` is set.
pub(in crate::diagnosis) fn columns(
    context: &Context<'_>,
    design: &Design,
    effect: EffectKind,
    place: Place,
    shape: &[f64],
    change: bool,
) -> Vec<Sparse> {
    let silent = |k: usize| change && !context.signals[k].is_target;
    gathered(context, design, silent, |k| context.series(k, effect, place, shape))
}

/// Columns of every motion on its rows, zero in those that are silent. They act on the same joints in every motion.
pub(super) fn gathered(
    context: &Context<'_>,
    design: &Design,
    silent: impl Fn(usize) -> bool,
    of_motion: impl Fn(usize) -> Vec<Series>,
) -> Vec<Sparse> {
    let signals = 0..context.signals.len();
    let Some(loud) = signals.clone().find(|&k| !silent(k)) else { return Vec::new() };
    let first: Vec<Series> = of_motion(loud);
    let mut out: Vec<Sparse> =
        first.iter().map(|column| column.iter().map(|(j, _)| (*j, Vec::new())).collect()).collect();
    let mut first = Some(first);
    for k in signals {
        if silent(k) {
            for (j, rows) in out.iter_mut().flatten() {
                rows.resize(rows.len() + design.rows_in(*j, k), 0.0);
            }
            continue;
        }
        let series = first.take_if(|_| k == loud).unwrap_or_else(|| of_motion(k));
        for (column, series) in out.iter_mut().zip(&series) {
            for ((j, rows), (_, values)) in column.iter_mut().zip(series) {
                design.sample(*j, k, values, rows);
            }
        }
    }
    out
}

/// The columns of an error of the robot's numbers that is far off on all rows of a design: the derivatives where it is.
pub(in crate::diagnosis) fn columns_there(
    context: &Context<'_>,
    design: &Design,
    (effect, place): (EffectKind, Place),
    error: &[f64],
    change: bool,
) -> Option<Vec<Vec<f64>>> {
    let (law, v) = (effect.form().sensitivity()?, place.variant()?);
    let silent = |k: usize| change && !context.signals[k].is_target;
    let columns = gathered(context, design, silent, |k| context.derivatives_there(k, law, v, error));
    Some(columns.iter().map(|c| dense(design, c)).collect())
}

/// The columns of an effect on all rows of the design, zero where a column does not act.
pub(in crate::diagnosis) fn dense_columns(
    context: &Context<'_>,
    design: &Design,
    effect: EffectKind,
    place: Place,
    shape: &[f64],
    change: bool,
) -> Vec<Vec<f64>> {
    columns(context, design, effect, place, shape, change).iter().map(|c| dense(design, c)).collect()
}

/// The columns of a law that is part of a model on all rows, one per amplitude, with the scales that it was made with.
pub(in crate::diagnosis) fn term_columns(
    context: &Context<'_>,
    design: &Design,
    term: &EffectTerm,
) -> Vec<Vec<f64>> {
    term_columns_in(context, design, term, |_| true)
}

/// The same on the rows of the motions that are wanted, zero on all others.
pub(super) fn term_columns_in(
    context: &Context<'_>,
    design: &Design,
    term: &EffectTerm,
    wanted: impl Fn(usize) -> bool,
) -> Vec<Vec<f64>> {
    let mut out = vec![vec![0.0; design.rows.len()]; term.amplitude.len()];
    for k in (0..context.signals.len()).filter(|&k| wanted(k)) {
        for (column, series) in out.iter_mut().zip(context.series_of_term(k, term)) {
            for (j, values) in series {
                for r in design.of_signal(j, k).into_iter().flat_map(|(range, _)| range) {
                    column[r] = design.smooth(k, &values, design.rows[r].centre);
                }
            }
        }
    }
    out
}

/// The skew of the torques behind the positions in the motions that are wanted: nothing where a single joint moves in them.
/// Viscous friction that comes later is that joint's inertia, and what is left of its skew is how its torque changes with the
/// jerk, as that of a spring or of a friction that no law has; only what all joints have in common is the recording's.
pub(in crate::diagnosis) fn delay_columns(
    context: &Context<'_>,
    design: &Design,
    wanted: impl Fn(usize) -> bool,
) -> Vec<Vec<f64>> {
    let moves = |j: &usize| design.rows[design.of_joint(*j)].iter().any(|r| wanted(r.signal));
    if (0..design.joints).filter(moves).count() < 2 {
        return vec![vec![0.0; design.rows.len()]];
    }
    let delay = |k| context.series(k, EffectKind::TimeDelay, Place::Variant(0), &[]);
    gathered(context, design, |k| !wanted(k), delay).iter().map(|column| dense(design, column)).collect()
}

/// A column on all rows.
pub(super) fn dense(design: &Design, column: &Sparse) -> Vec<f64> {
    let mut full = vec![0.0; design.rows.len()];
    for (j, values) in column {
        full[design.of_joint(*j)].copy_from_slice(values);
    }
    full
}

/// Columns of k that must have a part of their own. Of the ten columns of a body the standard model makes some, of the
/// three of a rotor at times its inertia: the others still count. A wave of which only the sine can be seen is none.
fn columns_needed(k: usize) -> usize {
    match k {
        0..3 => k,
        3..10 => k - 1,
        _ => 1,
    }
}

impl Trial {
    pub fn new(design: &Design, shape: Vec<f64>, columns: Vec<Sparse>) -> Self {
        let needed = columns_needed(columns.len());
        let mut trial = Self { shape, columns, products: Vec::new(), needed, own_fraction: OWN_FRACTION };
        trial.refresh(design);
        trial
    }

    /// Inner products with the design as it is now, whose own are up to date.
    pub fn refresh(&mut self, design: &Design) {
        self.refresh_from(design, 0);
    }

    /// The same where neither the trial's own columns nor the design's before `first` have changed.
    pub fn refresh_from(&mut self, design: &Design, first: usize) {
        let (p, k) = (design.columns.len(), self.columns.len());
        let old = std::mem::take(&mut self.products);
        self.products = (0..design.joints)
            .map(|j| {
                let mine = on_joint(&self.columns, j);
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
                        // Most columns act on few joints, and a change on few motions.
                        let acts: Vec<bool> = (0..k).map(|a| slice(a).iter().any(|x| *x != 0.0)).collect();
                        let gram = design.gram(j, g);
                        let with_column = |i: usize, a: usize| {
                            let seen = acts[a] && gram.squares(i) != 0.0;
                            if seen { dot(&design.columns[i][range.clone()], slice(a)) } else { 0.0 }
                        };
                        let before = old.get(j).and_then(|segments| segments.get(g));
                        let kept = before.map_or(0, |_| first);
                        Products {
                            with: DMatrix::from_fn(p, k, |i, a| match before {
                                Some(before) if i < kept => before.with[(i, a)],
                                _ => with_column(i, a),
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

    /// Values of each column on the rows of a joint; `None` where it does not act there.
    pub fn on_joint(&self, joint: usize) -> Vec<Option<&[f64]>> {
        on_joint(&self.columns, joint)
    }

    /// The trial's columns on all rows of the design.
    pub fn dense(&self, design: &Design) -> Vec<Vec<f64>> {
        self.columns.iter().map(|column| dense(design, column)).collect()
    }
}

fn on_joint(columns: &[Sparse], joint: usize) -> Vec<Option<&[f64]>> {
    let of = |c: &'_ Sparse| c.iter().position(|(j, _)| *j == joint);
    columns.iter().map(|c| of(c).map(|k| c[k].1.as_slice())).collect()
}

fn dot_or_zero(a: &[f64], b: &[f64]) -> f64 {
    if a.len() == b.len() { dot(a, b) } else { 0.0 }
}
