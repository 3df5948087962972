//! The fit by a logarithmic barrier and Newton's method (Boyd and Vandenberghe 2004, chapter 11).

use nalgebra::{Cholesky, DMatrix, DVector, Matrix4};

use super::problem::{Combination, Problem};
use super::pseudo_inertia::{pseudo_inertia, unit_inertia};

/// Newton steps of the whole solution; one takes some thirty to eighty.
const MOST_STEPS: usize = 400;
/// Factor on the weight of the equations from one centre to the next.
const NEXT: f64 = 20.0;
/// The fit is this close to the best possible one, as a share of its squared error.
const GAP: f64 = 0.01;
/// Scale, SI, of the quadratic prior on every standard parameter: weak beside any data, it bounds what the recording
/// does not identify.
const PRIOR_SCALE: f64 = 1e3;

impl Problem {
    /// Squared error of the equations.
    fn error(&self, x: &DVector<f64>) -> f64 {
        (&self.g * x - &self.y).norm_squared()
    }

    /// Log barrier plus a weak quadratic prior that bounds what the data do not identify; `None` where infeasible.
    fn barrier(&self, x: &DVector<f64>) -> Option<f64> {
        let mut sum = 0.5 * x.norm_squared() / (PRIOR_SCALE * PRIOR_SCALE);
        for combination in &self.positive {
            let value = at(combination, x);
            if value <= 0.0 {
                return None;
            }
            sum -= value.ln();
        }
        for link in &self.links {
            let factor = Cholesky::new(pseudo_inertia(link, x))?;
            sum -= 2.0 * (0..4).map(|i| factor.l_dirty()[(i, i)].ln()).sum::<f64>();
        }
        sum.is_finite().then_some(sum)
    }

    /// Standard parameters within [`GAP`] of the best.
    pub fn solve(&self) -> Option<DVector<f64>> {
        let constraints = (4 * self.links.len() + self.positive.len()) as f64;
        let mut x = self.start.clone();
        let mut weight = constraints / self.error(&x).max(self.free);
        let mut steps = 0;
        loop {
            // To the centre of this weight.
            loop {
                steps += 1;
                if steps > MOST_STEPS {
                    return None;
                }
                let (step, decrement) = self.newton(&x, weight)?;
                if decrement < 1e-2 {
                    break;
                }
                x = self.descend(&x, &step, decrement, weight)?;
            }
            if constraints / weight < GAP * self.error(&x) {
                return Some(x);
            }
            weight *= NEXT;
        }
    }

    /// Newton's step and the squared decrement.
    fn newton(&self, x: &DVector<f64>, weight: f64) -> Option<(DVector<f64>, f64)> {
        let residual = &self.g * x - &self.y;
        let mut gradient = self.g.tr_mul(&residual) * (2.0 * weight) + x / (PRIOR_SCALE * PRIOR_SCALE);
        let mut hessian = &self.normal * (2.0 * weight);
        (0..x.len()).for_each(|k| hessian[(k, k)] += 1.0 / (PRIOR_SCALE * PRIOR_SCALE));
        for combination in &self.positive {
            let value = at(combination, x);
            for &(i, a) in combination {
                gradient[i] -= a / value;
                for &(j, b) in combination {
                    hessian[(i, j)] += a * b / (value * value);
                }
            }
        }
        let basis: [Matrix4<f64>; 10] = std::array::from_fn(unit_inertia);
        for link in &self.links {
            let inverse = pseudo_inertia(link, x).try_inverse()?;
            let products = basis.map(|b| inverse * b);
            for (a, &i) in products.iter().zip(link) {
                gradient[i] -= a.trace();
                for (b, &j) in products.iter().zip(link) {
                    hessian[(i, j)] += a.dot(&b.transpose());
                }
            }
        }
        // Units differ by orders of magnitude: what is factored has a diagonal of ones.
        let scale = hessian.diagonal().map(|d| 1.0 / d.sqrt());
        for i in 0..scale.len() {
            for j in 0..scale.len() {
                hessian[(i, j)] *= scale[i] * scale[j];
            }
        }
        let step = factored(hessian)?.solve(&gradient.component_mul(&scale)).component_mul(&scale);
        let decrement = gradient.dot(&step);
        decrement.is_finite().then_some((step, decrement))
    }

    /// Backs off along the step until the objective falls.
    fn descend(
        &self,
        x: &DVector<f64>,
        step: &DVector<f64>,
        decrement: f64,
        weight: f64,
    ) -> Option<DVector<f64>> {
        let before = weight * self.error(x) + self.barrier(x)?;
        let mut share = 1.0;
        while share > 1e-10 {
            let next = x - step * share;
            if let Some(barrier) = self.barrier(&next)
                && weight * self.error(&next) + barrier <= before - 0.1 * share * decrement
            {
                return Some(next);
            }
            share *= 0.5;
        }
        None
    }
}

/// The Cholesky factor of a matrix with a diagonal of ones. At the rim of what is possible rounding can take its
/// definiteness; a little on the diagonal gives it back, and the step still descends.
pub(super) fn factored(matrix: DMatrix<f64>) -> Option<Cholesky<f64, nalgebra::Dyn>> {
    [0.0, 1e-13, 1e-11, 1e-9].into_iter().find_map(|more| {
        let mut lifted = matrix.clone();
        (0..lifted.nrows()).for_each(|k| lifted[(k, k)] += more);
        Cholesky::new(lifted)
    })
}

fn at(combination: &Combination, x: &DVector<f64>) -> f64 {
    combination.iter().map(|&(k, coefficient)| coefficient * x[k]).sum()
}
