//! Wald's statistic of a law in a part of the motion, from inner products.

use crate::diagnosis::judging::projection::Projection;
use crate::diagnosis::rules::{LEAST_EIGENVALUE, OWN_FRACTION};
use nalgebra::{DMatrix, DVector};

/// A law in a part of the motion.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Wald {
    /// Squares that its columns take away there.
    pub squares: f64,
    /// How many of its numbers are determined.
    pub numbers: usize,
    /// Its amplitudes; 0 where they are not determined.
    pub amplitude: DVector<f64>,
    /// How much of each column before it, and of the law itself where that may be in all motion, makes its torque there.
    pub made: DVector<f64>,
    /// Inner products of its columns without what all others make of them.
    information: DMatrix<f64>,
}

impl Wald {
    /// Of `k` columns after the first `p`, which are fitted to all of the `whole`. The products are ordered `[p columns,
    /// law, y]`. Where `common`, the law may be there in all motion, and its change in the `part` is judged. `None` where none
    /// of its numbers is determined.
    pub fn of(
        whole: &DMatrix<f64>,
        part: &DMatrix<f64>,
        (p, k): (usize, usize),
        common: bool,
    ) -> Option<Self> {
        let m = if common { p + k } else { p };
        Self::beside(&Projection::of(whole, m)?, whole, part, (p, k))
    }

    /// The same beside columns of the `whole` that are factored: the first `p`, or, where the law may be there in all motion,
    /// `p + k`.
    pub fn beside(
        model: &Projection,
        whole: &DMatrix<f64>,
        part: &DMatrix<f64>,
        (p, k): (usize, usize),
    ) -> Option<Self> {
        let (law, y) = (p, p + k);
        let own = part.view((law, law), (k, k)).into_owned();
        let white = model.white(part, law, k);
        let information = &own - white.tr_mul(&white);
        let b = part.view((law, y), (k, 1)) - white.tr_mul(&model.white(whole, y, 1));
        let b = b.column(0).into_owned();
        // A number that is not determined has no scale, and by that no part in anything.
        let alive = |a: usize| own[(a, a)] > 0.0 && information[(a, a)] > OWN_FRACTION * own[(a, a)];
        let width = DVector::from_fn(k, |a, _| if alive(a) { 1.0 / information[(a, a)].sqrt() } else { 0.0 });
        let scaled = DMatrix::from_diagonal(&width) * &information * DMatrix::from_diagonal(&width);
        // Directions that the columns have only together by rounding carry no evidence.
        let eigen = scaled.symmetric_eigen();
        let projected = eigen.eigenvectors.transpose() * b.component_mul(&width);
        let (mut squares, mut numbers, mut amplitude) = (0.0, 0, DVector::zeros(k));
        for (i, value) in eigen.eigenvalues.iter().enumerate().filter(|(_, v)| **v > LEAST_EIGENVALUE) {
            squares += projected[i] * projected[i] / value;
            numbers += 1;
            amplitude += eigen.eigenvectors.column(i) * (projected[i] / value);
        }
        let amplitude = amplitude.component_mul(&width);
        let made = model.made(&white * &amplitude);
        (numbers > 0).then_some(Self { squares, numbers, amplitude, made, information })
    }

    /// The statistic for each of its numbers.
    pub fn mean(&self) -> f64 {
        self.squares / self.numbers as f64
    }

    /// Inner product of its torque and the torque that other amplitudes give, both without what all other columns make.
    pub fn product(&self, amplitude: &DVector<f64>) -> f64 {
        amplitude.dot(&(&self.information * &self.amplitude))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::normal;
    use approx::assert_relative_eq;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    #[test]
    fn the_statistic_is_what_a_regression_with_the_law_leaves_less() {
        let mut rng = Pcg64::seed_from_u64(5);
        let rows = 60;
        let mut columns = DMatrix::from_fn(rows, 6, |_, _| normal(&mut rng));
        // The law's third column is one of the model's.
        let first = columns.column(0).into_owned();
        columns.set_column(4, &first);
        let products = columns.tr_mul(&columns);
        let wald = Wald::of(&products, &products, (2, 3), false).expect("determined");
        assert_eq!(wald.numbers, 2);
        let left = |columns: &DMatrix<f64>, y: &DVector<f64>| {
            let x = columns.clone().svd(true, true).solve(y, 1e-12).expect("both sides");
            (y - columns * &x).norm_squared()
        };
        let y = columns.column(5).into_owned();
        let (without, with) = (columns.columns(0, 2).into_owned(), columns.columns(0, 4).into_owned());
        assert_relative_eq!(wald.squares, left(&without, &y) - left(&with, &y), max_relative = 1e-8);
        assert_relative_eq!(wald.product(&wald.amplitude), wald.squares, max_relative = 1e-8);
        assert_eq!(wald.amplitude[2], 0.0);
    }
}
