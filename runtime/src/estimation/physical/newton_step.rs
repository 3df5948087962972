//! Newton's step where some linear functions of the unknowns may not fall below zero.
//!
//! min ½ dᵀ H d + gᵀ d over d with A d + s >= 0, s the functions where they are. They are few, and no unknown is in two of
//! them: the dual, min ½ λᵀ (A H⁻¹ Aᵀ) λ + (s - A H⁻¹ g)ᵀ λ over λ >= 0, is solved exactly by an active set (Lawson and Hanson
//! 1974, chapter 23, in the form of Bro and de Jong 1997). Where nothing holds the step back it is Newton's own, so that bounds
//! that are far away change nothing.

use nalgebra::{Cholesky, DMatrix, DVector};

use super::interior_point::factored;
use super::problem::Combination;

/// How far below zero, relative to its scale, a multiplier or a function may be by rounding.
const ROUNDING: f64 = 1e-10;

/// A step and what it meets.
pub(super) struct Step {
    /// d.
    pub step: DVector<f64>,
    /// Multiplier of each function, 0 where it does not hold the step back.
    pub multipliers: DVector<f64>,
    factor: Factored,
    /// H⁻¹ Aᵀ.
    pulled: DMatrix<f64>,
    /// A H⁻¹ Aᵀ.
    dual: DMatrix<f64>,
}

/// The Cholesky factor of a matrix in units in which its diagonal is 1: units of unknowns differ by orders of magnitude.
struct Factored {
    scale: DVector<f64>,
    factor: Cholesky<f64, nalgebra::Dyn>,
}

impl Factored {
    fn new(mut matrix: DMatrix<f64>) -> Option<Self> {
        let scale = matrix.diagonal().map(|d| 1.0 / d.sqrt());
        for i in 0..scale.len() {
            for j in 0..scale.len() {
                matrix[(i, j)] *= scale[i] * scale[j];
            }
        }
        Some(Self { factor: factored(matrix)?, scale })
    }

    fn solve(&self, right: &DMatrix<f64>) -> DMatrix<f64> {
        let scaled =
            |m: &DMatrix<f64>| DMatrix::from_fn(m.nrows(), m.ncols(), |i, j| m[(i, j)] * self.scale[i]);
        scaled(&self.factor.solve(&scaled(right)))
    }
}

impl Step {
    /// The step where the objective has this gradient and hessian and the `functions`, as far as they change, have these
    /// `values`. `None` where the hessian is not positive definite.
    pub fn new(
        hessian: DMatrix<f64>,
        gradient: &DVector<f64>,
        functions: &[Combination],
        values: &DVector<f64>,
    ) -> Option<Step> {
        let factor = Factored::new(hessian)?;
        let right = DMatrix::from_column_slice(gradient.len(), 1, (-gradient).as_slice());
        let mut step = factor.solve(&right).column(0).into_owned();
        let mut rows = DMatrix::zeros(functions.len(), gradient.len());
        for (k, function) in functions.iter().enumerate() {
            function.iter().for_each(|&(i, a)| rows[(k, i)] += a);
        }
        let pulled = factor.solve(&rows.transpose());
        let dual = &rows * &pulled;
        let multipliers = nonnegative(&dual, values, &(&rows * &step))?;
        if multipliers.iter().any(|m| *m > 0.0) {
            step += &pulled * &multipliers;
        }
        step.iter().all(|d| d.is_finite()).then_some(Step { step, multipliers, factor, pulled, dual })
    }

    /// The part of each unknown that a term of the hessian decides: the diagonal of P N, with P the inverse of the hessian
    /// within the functions that hold the step, and N that term.
    pub fn part_of(&self, term: &DMatrix<f64>) -> Option<DVector<f64>> {
        let mut part = self.factor.solve(term);
        let held: Vec<usize> = (0..self.multipliers.len()).filter(|&k| self.multipliers[k] > 0.0).collect();
        if !held.is_empty() {
            let pulled = self.pulled.select_columns(&held);
            let dual = self.dual.select_columns(&held).select_rows(&held);
            part -= &pulled * Factored::new(dual)?.solve(&(pulled.transpose() * term));
        }
        Some(part.diagonal())
    }
}

/// Multipliers λ >= 0 with w = values + change + dual λ >= 0 and λᵀ w = 0: `values` is what the functions are, `change` what a
/// free step changes. `None` where rounding keeps the active set from settling.
fn nonnegative(dual: &DMatrix<f64>, values: &DVector<f64>, change: &DVector<f64>) -> Option<DVector<f64>> {
    let n = values.len();
    let free = values + change;
    let scale: Vec<f64> = (0..n).map(|k| values[k].abs() + change[k].abs()).collect();
    let mut multipliers = DVector::<f64>::zeros(n);
    let mut held = vec![false; n];
    for _ in 0..=4 * n {
        let reached = &free + dual * &multipliers;
        let worst = (0..n)
            .filter(|&k| !held[k] && reached[k] < -ROUNDING * scale[k])
            .min_by(|&a, &b| (reached[a] / scale[a]).total_cmp(&(reached[b] / scale[b])));
        let Some(worst) = worst else { return Some(multipliers) };
        held[worst] = true;
        // To the solution of the functions that are held at 0; those whose multiplier would turn are let go on the way.
        loop {
            let which: Vec<usize> = (0..n).filter(|&k| held[k]).collect();
            let own = dual.select_columns(&which).select_rows(&which);
            let right = DMatrix::from_fn(which.len(), 1, |i, _| -free[which[i]]);
            let found = Factored::new(own)?.solve(&right);
            let turned = |i: &usize| found[*i] <= 0.0;
            let share = |i: usize| {
                let from = multipliers[which[i]];
                if from > 0.0 { from / (from - found[i]) } else { 0.0 }
            };
            let first = (0..which.len()).filter(turned).min_by(|&a, &b| share(a).total_cmp(&share(b)));
            let reach = first.map_or(1.0, share);
            which
                .iter()
                .enumerate()
                .for_each(|(i, &k)| multipliers[k] += reach * (found[i] - multipliers[k]));
            let Some(first) = first else { break };
            multipliers[which[first]] = 0.0;
            held[which[first]] = false;
        }
        // One that does not stay was below zero by rounding only.
        if !held[worst] {
            return Some(multipliers);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]
    use super::*;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn the_step_obeys_the_conditions_of_karush_kuhn_and_tucker_on_random_problems() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(11);
        let mut held = 0;
        for _ in 0..300 {
            let (n, m) = (12, 4);
            let root = DMatrix::from_fn(n, n, |_, _| random.random::<f64>() - 0.5);
            let hessian = &root * root.transpose() + DMatrix::identity(n, n) * 1e-3;
            let gradient = DVector::from_fn(n, |_, _| 2.0 * (random.random::<f64>() - 0.5));
            let functions: Vec<Combination> =
                (0..m).map(|k| (0..3).map(|i| (3 * k + i, random.random::<f64>() - 0.5)).collect()).collect();
            let value = |f: &Combination, x: &DVector<f64>| f.iter().map(|&(i, a)| a * x[i]).sum::<f64>();
            // A point that is allowed, some of it at a bound.
            let mut x = DVector::from_fn(n, |_, _| random.random::<f64>() - 0.5);
            for (k, function) in functions.iter().enumerate() {
                let (v, wanted) = (value(function, &x), if k == 0 { 0.0 } else { random.random::<f64>() });
                x[function[0].0] += (wanted - v) / function[0].1;
            }
            let values = DVector::from_iterator(m, functions.iter().map(|f| value(f, &x)));
            let found = Step::new(hessian.clone(), &gradient, &functions, &values).unwrap();
            let mut rest = &hessian * &found.step + &gradient;
            for (function, &multiplier) in functions.iter().zip(found.multipliers.iter()) {
                function.iter().for_each(|&(i, a)| rest[i] -= a * multiplier);
                let reached = value(function, &(&x + &found.step));
                assert!(multiplier >= 0.0 && reached > -1e-9, "{multiplier} {reached}");
                assert!(multiplier == 0.0 || reached.abs() < 1e-7, "{multiplier} {reached}");
                held += usize::from(multiplier > 0.0);
            }
            assert!(rest.norm() < 1e-7 * (1.0 + gradient.norm()), "{rest}");
        }
        assert!(held > 200, "{held} functions held a step back");
    }

    #[test]
    fn a_function_that_is_far_away_changes_nothing() {
        let hessian = DMatrix::from_diagonal(&DVector::from_vec(vec![1.0, 1e6]));
        let gradient = DVector::from_vec(vec![1.0, -3.0]);
        let free = Step::new(hessian.clone(), &gradient, &[], &DVector::zeros(0)).unwrap();
        let far = DVector::from_element(1, 100.0);
        let bounded = Step::new(hessian.clone(), &gradient, &[vec![(0, 1.0)]], &far).unwrap();
        assert_eq!(free.step, bounded.step);
        assert_eq!(bounded.part_of(&hessian), free.part_of(&hessian));
    }

    #[test]
    fn what_a_bound_holds_is_decided_by_no_term() {
        let hessian = DMatrix::from_diagonal(&DVector::from_vec(vec![2.0, 2.0]));
        let gradient = DVector::from_vec(vec![4.0, 4.0]);
        let found = Step::new(hessian.clone(), &gradient, &[vec![(0, 1.0)]], &DVector::zeros(1)).unwrap();
        assert!(found.step[0].abs() < 1e-12 && (found.step[1] + 2.0).abs() < 1e-12, "{}", found.step);
        assert!((found.multipliers[0] - 4.0).abs() < 1e-12);
        let part = found.part_of(&hessian).unwrap();
        assert!(part[0].abs() < 1e-15 && (part[1] - 1.0).abs() < 1e-15, "{part}");
    }
}
