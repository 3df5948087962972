//! How the noise of joints goes together in windows of a length.
//!
//! Noise of one position is felt by every joint that its acceleration turns, and a controller that sees it drives them all.
//! What several joints do in one window then says less than each of them alone: what a joint does is compared with what those
//! that do more make expect of it. Correlations are those of the signs (quadrant correlation; of normal numbers r = sin(π m / 2),
//! m the mean product of the signs, Blomqvist 1950), which a few pushes hardly change.

use crate::diagnosis::contact::half_waves::HalfWaves;
use crate::diagnosis::rules::{SCAN_COMMON_WINDOWS, SCAN_STEPS};
use nalgebra::{Cholesky, DMatrix, DVector};
use std::f64::consts::FRAC_PI_2;

/// Correlations between joints, for each length of windows.
pub(super) struct Common {
    lengths: Vec<usize>,
    of_length: Vec<DMatrix<f64>>,
}

/// Motion and first place of windows, increasing, and the deviation of each.
type Deviations = Vec<([usize; 2], f64)>;

/// Sum of the products of signs of two joints, and number of windows that both have.
type Signs = (f64, f64);

impl Common {
    /// Of the windows of joints, `(motion, places)`, that are free. Few windows of a length say less than those of all lengths.
    pub fn of(
        joints: &[&HalfWaves],
        lengths: &[usize],
        is_free: impl Fn((usize, [usize; 2])) -> bool,
    ) -> Self {
        let n = joints.len();
        let free: Vec<Vec<Deviations>> = (0..lengths.len())
            .map(|length| joints.iter().map(|joint| joint.of_length(length, &is_free)).collect())
            .collect();
        let of_pair = |length: usize, [a, b]: [usize; 2]| signs(&free[length][a], &free[length][b]);
        let mut of_length = vec![DMatrix::identity(n, n); lengths.len()];
        for pair @ [a, b] in (0..n).flat_map(|a| (0..a).map(move |b| [a, b])) {
            let of_lengths: Vec<Signs> = (0..lengths.len())
                .map(|length| {
                    // Windows beside each other are mostly the same.
                    let alike = lengths[length].clamp(1, SCAN_STEPS) as f64;
                    let (sum, count) = of_pair(length, pair);
                    (sum / alike, count / alike)
                })
                .collect();
            let all = of_lengths.iter().fold((0.0, 0.0), |all, one| (all.0 + one.0, all.1 + one.1));
            let common = if all.1 > 0.0 { all.0 / all.1 } else { 0.0 };
            for (matrix, (sum, count)) in of_length.iter_mut().zip(&of_lengths) {
                let mean = (sum + SCAN_COMMON_WINDOWS * common) / (count + SCAN_COMMON_WINDOWS);
                let r = (FRAC_PI_2 * mean).sin();
                (matrix[(a, b)], matrix[(b, a)]) = (r, r);
            }
        }
        Self { lengths: lengths.to_vec(), of_length }
    }

    /// What joints do in a window of so many places beyond what those that do more make expect, each in its own standard
    /// deviation.
    pub fn alone(&self, places: usize, felt: &[Option<f64>]) -> Vec<Option<f64>> {
        let length = self.lengths.iter().rposition(|length| *length <= places).unwrap_or(0);
        let mut out = felt.to_vec();
        let Some(common) = self.of_length.get(length) else { return out };
        let mut order: Vec<usize> = (0..felt.len()).filter(|&j| felt[j].is_some()).collect();
        let size = |j: usize| felt[j].unwrap_or(0.0).abs();
        order.sort_by(|&a, &b| size(b).total_cmp(&size(a)).then(a.cmp(&b)));
        for k in 1..order.len() {
            let (before, j) = (&order[..k], order[k]);
            let known = DVector::from_iterator(k, before.iter().map(|&i| felt[i].unwrap_or(0.0)));
            let with = DVector::from_iterator(k, before.iter().map(|&i| common[(i, j)]));
            let among = DMatrix::from_fn(k, k, |a, b| common[(before[a], before[b])]);
            out[j] = Some(felt[j].map_or(0.0, |own| beyond(own, among, &with, &known)));
        }
        out
    }
}

/// What a joint does beyond what others that are known make expect. Never more than it does: correlations change with the posture,
/// and where two joints go against what they mostly do together that is no push.
fn beyond(own: f64, among: DMatrix<f64>, with: &DVector<f64>, known: &DVector<f64>) -> f64 {
    // Correlations that were found pair by pair need not fit together: what no numbers can do says nothing.
    let Some(solved) = Cholesky::new(among).map(|factor| factor.solve(with)) else { return 0.0 };
    let left = 1.0 - with.dot(&solved);
    if left <= LEAST_OWN {
        return 0.0;
    }
    let alone = (own - solved.dot(known)) / left.sqrt();
    if alone.abs() < own.abs() { alone } else { own }
}

/// With a smaller part of its variance of its own a joint says nothing that others have not said.
const LEAST_OWN: f64 = 0.05;

/// Products of the signs of two joints in the windows that both have, each in the order of motions and places.
fn signs(a: &[([usize; 2], f64)], b: &[([usize; 2], f64)]) -> Signs {
    let (mut sum, mut count, mut at) = (0.0, 0.0, 0);
    for (window, x) in a {
        while b.get(at).is_some_and(|(other, _)| other < window) {
            at += 1;
        }
        if let Some((_, y)) = b.get(at).filter(|(other, _)| other == window) {
            sum += x.signum() * y.signum();
            count += 1.0;
        }
    }
    (sum, count)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(common: DMatrix<f64>) -> Common {
        Common { lengths: vec![8], of_length: vec![common] }
    }

    #[test]
    fn what_joints_do_alike_counts_once() {
        let common = of(DMatrix::from_row_slice(3, 3, &[1.0, 0.8, 0.0, 0.8, 1.0, 0.0, 0.0, 0.0, 1.0]));
        let alone = common.alone(8, &[Some(4.0), Some(5.0), Some(-3.0)]);
        assert_eq!(alone[1], Some(5.0));
        assert_eq!(alone[2], Some(-3.0));
        assert!(alone[0].is_some_and(|x| x.abs() < 1e-12), "{alone:?}");
        assert_eq!(common.alone(8, &[Some(-4.0), Some(5.0), None]), [Some(-4.0), Some(5.0), None]);
    }

    #[test]
    fn joints_of_their_own_keep_what_they_do() {
        let felt = [Some(1.0), None, Some(-7.0), Some(2.0)];
        assert_eq!(of(DMatrix::identity(4, 4)).alone(3, &felt), felt);
    }

    #[test]
    fn only_windows_that_both_have_are_compared() {
        let a = [([0, 0], 1.0), ([0, 4], -2.0), ([1, 0], 3.0)];
        let b = [([0, 4], -1.0), ([0, 8], 1.0), ([1, 0], -1.0)];
        assert_eq!(signs(&a, &b), (0.0, 2.0));
        assert_eq!(signs(&a, &a), (3.0, 3.0));
    }
}
