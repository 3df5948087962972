//! Steps of Gauss and Newton to the numbers with which least is left of the torques of all joints.

use super::WORSENS;
use super::instants::Instants;
use nalgebra::{DMatrix, DVector};

/// Most steps, the longest of them, rad or m, and the last. Numerics.
const STEPS: usize = 20;
const LONGEST: f64 = 0.5;
const LAST: f64 = 1e-4;
/// Way over which a slope is taken, rad or m. Numerics.
const WAY: f64 = 1e-3;
/// Damping at first, and how it changes (Marquardt 1963). Numerics.
const DAMPING: f64 = 1e-3;
const MORE: f64 = 10.0;

/// What is left of each joint's squares, relative to what the robot as it is described leaves of it.
pub(crate) struct Descent<'a> {
    instants: &'a Instants,
    plain: Vec<f64>,
}

/// What is left in units of the joints' sigma, for numbers that are so far off; `None` where there is no fit.
pub(crate) type Residual<'f> = dyn Fn(&[f64]) -> Option<DVector<f64>> + Sync + 'f;

impl<'a> Descent<'a> {
    /// `plain` is the residual of the robot as it is described.
    pub fn new(instants: &'a Instants, plain: &DVector<f64>) -> Self {
        Self { instants, plain: instants.mean_squares(plain) }
    }

    /// Sum over the joints of the logarithms of the part of their squares that is left.
    pub fn sum(&self, residual: &DVector<f64>) -> f64 {
        self.parts(residual).map(|part| part.max(f64::MIN_POSITIVE).ln()).sum()
    }

    /// Whether no joint is left with more.
    pub fn worsens_none(&self, residual: &DVector<f64>) -> bool {
        self.parts(residual).all(|part| part < WORSENS)
    }

    /// Joints of which the robot leaves nothing have no part.
    fn parts(&self, residual: &DVector<f64>) -> impl Iterator<Item = f64> {
        let both = self.instants.mean_squares(residual).into_iter().zip(&self.plain);
        both.filter(|(_, plain)| **plain > 0.0).map(|(left, plain)| left / plain)
    }

    /// Where steps lead from `start` (Levenberg and Marquardt's), and the sum that is left there, infinite where there is no fit.
    /// Rows of a joint count by what is left of it at each step.
    pub fn settled(&self, start: Vec<f64>, residual: &Residual<'_>) -> (Vec<f64>, f64) {
        let mut here = start;
        let Some(mut left) = residual(&here) else { return (here, f64::INFINITY) };
        let (mut sum, mut damping) = (self.sum(&left), DAMPING);
        for _ in 0..STEPS {
            let Some(step) = self.step((&here, &left), residual, damping) else { break };
            let there: Vec<f64> = here.iter().zip(step.iter()).map(|(x, s)| x + s).collect();
            match residual(&there).map(|left| (self.sum(&left), left)) {
                Some((less, at)) if less < sum => {
                    (here, sum, left, damping) = (there, less, at, damping / MORE);
                }
                _ => damping *= MORE,
            }
            if step.amax() < LAST {
                break;
            }
        }
        (here, sum)
    }

    fn step(
        &self,
        (here, left): (&[f64], &DVector<f64>),
        residual: &Residual<'_>,
        damping: f64,
    ) -> Option<DVector<f64>> {
        let squares = self.instants.mean_squares(left);
        let weights = self.instants.joint_of_rows().map(|j| 1.0 / squares[j].max(f64::MIN_POSITIVE).sqrt());
        let weights = DVector::from_iterator(left.len(), weights);
        let mut slopes = DMatrix::zeros(left.len(), here.len());
        for k in 0..here.len() {
            let mut moved = here.to_vec();
            moved[k] += WAY;
            slopes.set_column(k, &((residual(&moved)? - left) / WAY).component_mul(&weights));
        }
        let mut squares = slopes.tr_mul(&slopes);
        for k in 0..here.len() {
            squares[(k, k)] += damping * squares[(k, k)] + f64::MIN_POSITIVE;
        }
        let step = -squares.cholesky()?.solve(&slopes.tr_mul(&left.component_mul(&weights)));
        let longest = step.amax();
        Some(if longest > LONGEST { step * (LONGEST / longest) } else { step })
    }
}
