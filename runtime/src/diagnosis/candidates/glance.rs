//! A first look at laws over any variables: what each predicts of a joint, on its own rows alone.

use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::free::values;
use crate::diagnosis::rules::CURVE_RIDGE;
use crate::effects::{Axis, FreeLaw, Seen};
use nalgebra::{DMatrix, DVector};
use std::ops::Range;

/// A column of which other columns leave less than this part is made by them.
const LEFT: f64 = 1e-6;

/// Laws at the middles of the rows of the joint, beside what the columns of the model make there.
pub(super) struct Glance {
    /// Variables with their directions at the rows, `[axis][row]`.
    seen: Vec<Vec<Seen>>,
    /// Orthonormal columns of the model, one a row.
    model: DMatrix<f64>,
    /// What the model leaves, without what its columns make on these rows alone.
    residual: DVector<f64>,
    /// Rows that are held out together.
    folds: Vec<Vec<Range<usize>>>,
}

impl Glance {
    pub fn new(context: &Context<'_>, regression: &Regression, joint: usize, axes: &[Axis]) -> Self {
        let design = &regression.design;
        let (mut rows, mut folds): (Vec<usize>, Vec<Vec<Range<usize>>>) = Default::default();
        for held in design.held_out_together() {
            let mut fold = Vec::new();
            for g in held {
                let first = rows.len();
                rows.extend(design.ranges[joint][g].clone());
                if design.is_told(joint, g) {
                    fold.push(first..rows.len());
                }
            }
            folds.push(fold);
        }
        let of_axis = |axis: &Axis| {
            let all: Vec<Vec<f64>> =
                (0..context.signals.len()).map(|k| values(context, k, axis.variable)).collect();
            let at = |&r: &usize| axis.seen_on(joint, all[design.rows[r].signal][design.rows[r].centre]);
            rows.iter().map(at).collect()
        };
        let live = design.columns.iter().filter(|c| rows.iter().any(|&r| c[r] != 0.0));
        let columns: Vec<DVector<f64>> =
            live.map(|c| DVector::from_iterator(rows.len(), rows.iter().map(|&r| c[r]))).collect();
        let left = regression.residual();
        let residual = DVector::from_iterator(rows.len(), rows.iter().map(|&r| left[r]));
        Self::of(axes.iter().map(of_axis).collect(), columns, residual, folds)
    }

    fn of(
        seen: Vec<Vec<Seen>>,
        mut columns: Vec<DVector<f64>>,
        mut residual: DVector<f64>,
        folds: Vec<Vec<Range<usize>>>,
    ) -> Self {
        let mut kept: Vec<DVector<f64>> = Vec::new();
        for column in &mut columns {
            let whole = column.norm();
            // Twice is enough (Giraud, Langou and Rozloznik 2005).
            for _ in 0..2 {
                take_out(&kept, column);
            }
            let left = column.norm();
            if left > LEFT * whole {
                kept.push(&*column / left);
            }
        }
        take_out(&kept, &mut residual);
        let model = DMatrix::from_fn(kept.len(), residual.len(), |k, r| kept[k][r]);
        Self { seen, model, residual, folds }
    }

    /// By what a law that is fitted to all other rows makes the squares of those that are held out smaller, over all of them; less
    /// than zero where it makes them larger. In sample a law of many numbers takes nearly all that lasts as long as a motion.
    pub fn gain(&self, law: &FreeLaw, axes: &[usize]) -> f64 {
        let (rows, k) = (self.residual.len(), law.amplitudes());
        let mut z = DMatrix::zeros(rows, k);
        let (mut at, mut out) = (Vec::with_capacity(axes.len()), Vec::with_capacity(k));
        for r in 0..rows {
            at.clear();
            at.extend(axes.iter().map(|&a| self.seen[a][r]));
            law.columns(&at, &mut out);
            out.iter().enumerate().for_each(|(c, x)| z[(r, c)] = *x);
        }
        // What the columns of the model do not make of the law; where they make all of a column, rounding is left.
        let whole: Vec<f64> = z.column_iter().map(|column| column.norm()).collect();
        let made = &self.model * &z;
        z.gemm_tr(-1.0, &self.model, &made, 1.0);
        for (mut column, whole) in z.column_iter_mut().zip(whole) {
            if column.norm() <= LEFT * whole {
                column.fill(0.0);
            }
        }
        let products = |ranges: &[Range<usize>]| {
            let (mut g, mut b) = (DMatrix::zeros(k, k), DVector::zeros(k));
            for range in ranges {
                let part = z.rows(range.start, range.len());
                g.gemm_tr(1.0, &part, &part, 1.0);
                b.gemv_tr(1.0, &part, &self.residual.rows(range.start, range.len()), 1.0);
            }
            (g, b)
        };
        let (all_g, all_b) = products(std::slice::from_ref(&(0..rows)));
        let ridge = CURVE_RIDGE * (0..k).map(|c| all_g[(c, c)]).fold(f64::MIN_POSITIVE, f64::max);
        let of_fold = |fold: &Vec<Range<usize>>| {
            let (held_g, held_b) = products(fold);
            let mut others = &all_g - &held_g;
            for c in 0..k {
                others[(c, c)] += ridge;
            }
            let amplitude = others.cholesky()?.solve(&(&all_b - &held_b));
            Some(2.0 * held_b.dot(&amplitude) - amplitude.dot(&(held_g * &amplitude)))
        };
        self.folds.iter().filter_map(of_fold).sum()
    }
}

/// Takes the parts along orthonormal vectors out of another.
fn take_out(orthonormal: &[DVector<f64>], vector: &mut DVector<f64>) {
    for q in orthonormal {
        let part = q.dot(vector);
        vector.axpy(-part, q, 1.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::judging::testing::correlated;
    use crate::effects::{Together, Variable};
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    const ROWS: usize = 240;
    const AXES: usize = 12;

    fn axis(joint: usize) -> Axis {
        Axis { variable: Variable::Position(joint), centre: 0.0, half: 3.0 }
    }

    /// A glance at variables that go their own ways, slowly, at a torque of them, and at noise that lasts as long as they do.
    fn glance(rng: &mut Pcg64, torque: impl Fn(&[f64]) -> f64) -> Glance {
        let variables: Vec<Vec<f64>> = (0..AXES).map(|_| correlated(rng, ROWS, 0.95)).collect();
        let noise = correlated(rng, ROWS, 0.95);
        let seen = |series: &Vec<f64>| series.iter().map(|&value| Seen { value, direction: 0.0 }).collect();
        let at = |r: usize| variables.iter().map(|v| v[r]).collect::<Vec<f64>>();
        let residual = DVector::from_fn(ROWS, |r, _| torque(&at(r)) + 0.7 * noise[r]);
        let folds = (0..8).map(|k| std::iter::once(k * ROWS / 8..(k + 1) * ROWS / 8).collect()).collect();
        let offset = DVector::from_element(ROWS, 1.0);
        Glance::of(variables.iter().map(seen).collect(), vec![offset], residual, folds)
    }

    fn products(glance: &Glance) -> Vec<([usize; 2], f64)> {
        let pairs = (0..AXES).flat_map(|a| (a + 1..AXES).map(move |b| [a, b]));
        let gain = |pair: [usize; 2]| {
            let law = FreeLaw::two(Together::Multiplied, pair.map(axis));
            (pair, glance.gain(&law, &pair))
        };
        pairs.map(gain).collect()
    }

    #[test]
    fn a_law_that_is_there_is_among_the_first_of_many_beside_noise_that_lasts() {
        let mut rng = Pcg64::seed_from_u64(3);
        let found = (0..20).filter(|_| {
            let gains = products(&glance(&mut rng, |x| 0.5 * x[2] * x[7]));
            let of = |pair: [usize; 2]| gains.iter().find(|(p, _)| *p == pair).map_or(0.0, |(_, gain)| *gain);
            gains.iter().filter(|(_, gain)| *gain > of([2, 7])).count() < 3
        });
        assert!(found.count() >= 17);
    }

    #[test]
    fn laws_that_are_not_there_predict_worse_than_none() {
        let mut rng = Pcg64::seed_from_u64(4);
        let gains: Vec<f64> =
            (0..5).flat_map(|_| products(&glance(&mut rng, |_| 0.0))).map(|(_, gain)| gain).collect();
        let positive = gains.iter().filter(|gain| **gain > 0.0).count();
        assert!(positive < gains.len() / 4, "{positive} of {}", gains.len());
    }

    #[test]
    fn what_the_model_makes_of_a_law_is_no_gain() {
        let mut rng = Pcg64::seed_from_u64(5);
        let x = correlated(&mut rng, ROWS, 0.95);
        let seen = x.iter().map(|&value| Seen { value, direction: 0.0 }).collect();
        let column = DVector::from_iterator(ROWS, x.iter().map(|x| (x / 3.0).clamp(-1.0, 1.0)));
        let residual = DVector::from_iterator(ROWS, correlated(&mut rng, ROWS, 0.5));
        let folds = vec![vec![0..ROWS / 2], vec![ROWS / 2..ROWS]];
        let glance = Glance::of(vec![seen], vec![2.0 * column], residual, folds);
        assert!(glance.gain(&FreeLaw::line(axis(0)), &[0]).abs() < 1e-9);
    }
}
