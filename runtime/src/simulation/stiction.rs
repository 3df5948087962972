//! Which friction elements hold at rest: an exact solution of the stick-slip decision.
//!
//! At rest, Coulomb friction takes any value between its limits and takes the one that keeps the joint at
//! rest if there is one (Moreau 1988; Glocker and Pfeiffer 1996). For the elements at zero slip velocity with
//! slip acceleration w = b - A·f (A = G·M⁻¹·Gᵀ, b the slip acceleration without their friction) that is the
//! bounded complementarity problem
//!   low < f < high and w = 0,  or  f = high and w >= 0,  or  f = low and w <= 0.

use crate::model::cholesky;

/// What an element at zero velocity does next.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Decision {
    /// It holds.
    Stick,
    /// It starts to slip in positive direction.
    Forward,
    /// It starts to slip in negative direction.
    Backward,
}

/// Caller-owned memory of [`decide`] for up to `capacity` elements.
#[derive(Debug, Clone)]
pub(crate) struct StictionScratch {
    block: Vec<f64>,
    right: Vec<f64>,
    free: Vec<usize>,
    force: Vec<f64>,
}

impl StictionScratch {
    pub(crate) fn new(capacity: usize) -> Self {
        Self {
            block: vec![0.0; capacity * capacity],
            right: vec![0.0; capacity],
            free: Vec::with_capacity(capacity),
            force: vec![0.0; capacity],
        }
    }
}

/// Share of the diagonal that is added to A. Elements can depend on each other (both joints and the motor that
/// drives them at rest together): how they share the holding torque is then indeterminate, and this picks one.
const REGULARISATION: f64 = 1e-10;

/// Decides for `count` elements at rest; `a` is symmetric, row-major with `count` columns and is regularised in
/// place, `limits[k]` is `[low, high]` of the friction torque with low <= 0 <= high.
///
/// Principal pivoting with the least-index rule (Murty 1974, for bounds Júdice and Pires 1994): finite for a
/// positive definite A.
pub(crate) fn decide(
    count: usize,
    a: &mut [f64],
    b: &[f64],
    limits: &[[f64; 2]],
    scratch: &mut StictionScratch,
    decisions: &mut [Decision],
) {
    for k in 0..count {
        a[k * count + k] *= 1.0 + REGULARISATION;
    }
    decisions[..count].fill(Decision::Stick);
    // Each pivot moves one element. The bound is far above what a positive definite A can need at these
    // sizes; when rounding makes the rule cycle between equivalent answers, the last one is as good.
    for _ in 0..64 * (count + 1) {
        solve_free(count, a, b, limits, scratch, decisions);
        let Some(k) = first_violation(count, a, b, limits, scratch, decisions) else { break };
        decisions[k] = match decisions[k] {
            Decision::Stick if scratch.force[k] > limits[k][1] => Decision::Forward,
            Decision::Stick => Decision::Backward,
            _ => Decision::Stick,
        };
    }
    // An element at its limit whose slip acceleration is zero, up to what the regularisation leaves of it, has
    // not started to move.
    for k in 0..count {
        let terms: f64 = (0..count).map(|l| (a[k * count + l] * scratch.force[l]).abs()).sum();
        let slip = slip_acceleration(count, a, b, &scratch.force, k);
        if slip.abs() <= 10.0 * REGULARISATION * (b[k].abs() + terms) {
            decisions[k] = Decision::Stick;
        }
    }
}

fn slip_acceleration(count: usize, a: &[f64], b: &[f64], force: &[f64], k: usize) -> f64 {
    b[k] - (0..count).map(|l| a[k * count + l] * force[l]).sum::<f64>()
}

/// Friction torques with every slipping element at its limit and zero acceleration of the sticking ones.
fn solve_free(
    count: usize,
    a: &[f64],
    b: &[f64],
    limits: &[[f64; 2]],
    scratch: &mut StictionScratch,
    decisions: &[Decision],
) {
    let StictionScratch { block, right, free, force } = scratch;
    free.clear();
    for k in 0..count {
        match decisions[k] {
            Decision::Stick => free.push(k),
            Decision::Forward => force[k] = limits[k][1],
            Decision::Backward => force[k] = limits[k][0],
        }
    }
    let m = free.len();
    for (row, &k) in free.iter().enumerate() {
        right[row] = b[k];
        for l in 0..count {
            if decisions[l] != Decision::Stick {
                right[row] -= a[k * count + l] * force[l];
            }
        }
        for (column, &l) in free.iter().enumerate() {
            block[row * m + column] = a[k * count + l];
        }
    }
    if m > 0 && cholesky::factor(m, &mut block[..m * m]) {
        cholesky::solve(m, &block[..m * m], &mut right[..m]);
    }
    for (row, &k) in free.iter().enumerate() {
        force[k] = right[row];
    }
}

fn first_violation(
    count: usize,
    a: &[f64],
    b: &[f64],
    limits: &[[f64; 2]],
    scratch: &StictionScratch,
    decisions: &[Decision],
) -> Option<usize> {
    (0..count).find(|&k| match decisions[k] {
        Decision::Stick => scratch.force[k] < limits[k][0] || scratch.force[k] > limits[k][1],
        Decision::Forward => slip_acceleration(count, a, b, &scratch.force, k) < 0.0,
        Decision::Backward => slip_acceleration(count, a, b, &scratch.force, k) > 0.0,
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    fn run(count: usize, a: &[f64], b: &[f64], limits: &[[f64; 2]]) -> (Vec<Decision>, Vec<f64>) {
        let mut scratch = StictionScratch::new(count);
        let mut decisions = vec![Decision::Stick; count];
        decide(count, &mut a.to_vec(), b, limits, &mut scratch, &mut decisions);
        (decisions, scratch.force)
    }

    #[test]
    fn one_element_holds_up_to_its_limit_and_slips_above_it() {
        assert_eq!(run(1, &[2.0], &[1.9], &[[-1.0, 1.0]]).0, [Decision::Stick]);
        assert_eq!(run(1, &[2.0], &[2.1], &[[-1.0, 1.0]]).0, [Decision::Forward]);
        assert_eq!(run(1, &[2.0], &[-2.1], &[[-1.0, 1.0]]).0, [Decision::Backward]);
        assert_eq!(run(1, &[2.0], &[-2.1], &[[-1.2, 1.0]]).0, [Decision::Stick]);
    }

    #[test]
    fn the_complementarity_conditions_hold_for_random_problems() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(7);
        for _ in 0..2000 {
            let count = random.random_range(1..=8usize);
            let root: Vec<f64> = (0..count * count).map(|_| random.random_range(-1.0..1.0)).collect();
            let mut a = vec![0.0; count * count];
            for i in 0..count {
                for j in 0..count {
                    a[i * count + j] = (0..count).map(|k| root[i * count + k] * root[j * count + k]).sum();
                }
                a[i * count + i] += 0.05;
            }
            let b: Vec<f64> = (0..count).map(|_| random.random_range(-3.0..3.0)).collect();
            let limits: Vec<[f64; 2]> =
                (0..count).map(|_| [-random.random_range(0.0..2.0), random.random_range(0.0..2.0)]).collect();
            let (decisions, force) = run(count, &a, &b, &limits);
            for k in 0..count {
                let w = slip_acceleration(count, &a, &b, &force, k);
                match decisions[k] {
                    Decision::Stick => {
                        assert!(w.abs() < 1e-6);
                        assert!(force[k] >= limits[k][0] - 1e-9 && force[k] <= limits[k][1] + 1e-9);
                    }
                    Decision::Forward => assert!(w > -1e-6 && force[k] == limits[k][1]),
                    Decision::Backward => assert!(w < 1e-6 && force[k] == limits[k][0]),
                }
            }
        }
    }

    /// Two joints and a motor driven by both: the holding torque can be shared in many ways, and all of the
    /// capacity counts.
    #[test]
    fn dependent_elements_use_their_joint_capacity() {
        let g = [[1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let a: Vec<f64> = (0..9).map(|k| g[k / 3][0] * g[k % 3][0] + g[k / 3][1] * g[k % 3][1]).collect();
        let limits = [[-1.0, 1.0]; 3];
        let slip = |load: [f64; 2]| {
            let b: Vec<f64> = g.iter().map(|row| row[0] * load[0] + row[1] * load[1]).collect();
            run(3, &a, &b, &limits).0
        };
        assert_eq!(slip([1.9, 1.9]), [Decision::Stick; 3]);
        assert_ne!(slip([1.9, -0.2]), [Decision::Stick; 3]);
        assert_ne!(slip([2.1, 1.0]), [Decision::Stick; 3]);
    }
}
