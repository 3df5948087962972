//! Total least squares in which only the recorded torques have errors.

use nalgebra::{DMatrix, DVector};

use crate::estimation::Factor;

/// A column whose part that is independent of those before it is below this share of its length is not determined.
const INDEPENDENT: f64 = 1e-9;

/// A direction whose coefficient is not known to this, in units of the unit vector, can be any.
///
/// Two directions of nothing but noise have coefficients that are known to about a half by this measure.
const CERTAIN: f64 = 0.2;

/// The homogeneous solution, in the order of the columns.
#[derive(Debug, Clone)]
pub(super) struct Direction {
    /// Values, up to a common factor; zero where a column depends on others.
    pub x: Vec<f64>,
    /// How many further directions the rows do not tell from it.
    pub undecided: usize,
    /// Distance to the nearest other direction, in units of what noise makes of it.
    pub certainty: f64,
}

/// The x of A x = 0 of rows of which the first `exact` columns have no errors and the last ones errors that are independent
/// of each other, with `squares` of errors in all rows of each: the smallest |A x|² / Σ squares x² (generalised total least
/// squares; Van Huffel and Vandewalle 1991, section 10.2; for drives Gautier and Briot 2014).
///
/// The exact columns are eliminated by the orthogonal factor. What they leave of the others, in units of their errors, has
/// singular values of 1 in the directions that only noise keeps from zero. `None` where nothing has errors, or a number is
/// none.
pub(super) fn direction(rows: &Factor, exact: usize, squares: &[f64]) -> Option<Direction> {
    let noisy = squares.len();
    if noisy == 0 || squares.iter().any(|s| !(*s > 0.0 && s.is_finite())) {
        return None;
    }
    let kept = independent(rows, exact);
    let order: Vec<usize> = kept.iter().copied().chain(exact..exact + noisy).collect();
    let ordered = rows.select(&order);
    let first = kept.len();
    let scale: Vec<f64> = squares.iter().map(|s| 1.0 / s.sqrt()).collect();
    let below = DMatrix::from_fn(noisy, noisy, |i, l| ordered.r(first + i, first + l) * scale[l]);
    if below.iter().any(|x| !x.is_finite()) {
        return None;
    }
    let svd = below.svd(false, true);
    let v = svd.v_t?;
    let mut values: Vec<(f64, usize)> = svd.singular_values.iter().map(|s| s * s).zip(0..).collect();
    values.sort_by(|a, b| a.0.total_cmp(&b.0));
    let (smallest, place) = values[0];
    let count = squares.iter().sum::<f64>() / noisy as f64;
    let spread = |value: f64| {
        let gap = value - smallest;
        if gap > 0.0 { (value * smallest / (count * gap * gap)).sqrt() } else { f64::INFINITY }
    };
    let undecided = values[1..].iter().filter(|(value, _)| spread(*value) > CERTAIN).count();
    let certainty = values.get(1).map_or(f64::INFINITY, |(value, _)| 1.0 / spread(*value));
    let z = DVector::from_fn(noisy, |l, _| v[(place, l)] * scale[l]);
    let mut x = vec![0.0; exact + noisy];
    for l in 0..noisy {
        x[exact + l] = z[l];
    }
    for i in (0..first).rev() {
        let others: f64 = (i + 1..order.len()).map(|l| ordered.r(i, l) * x[order[l]]).sum();
        x[order[i]] = -others / ordered.r(i, i);
    }
    Some(Direction { x, undecided, certainty })
}

/// The exact columns that do not depend on others; the last one is only taken where the others do not make it up.
pub(super) fn independent(rows: &Factor, exact: usize) -> Vec<usize> {
    let Some(last) = exact.checked_sub(1) else { return Vec::new() };
    let others: Vec<usize> = (0..last).collect();
    let mut kept = rows.select(&others).solve().kept;
    let with: Vec<usize> = kept.iter().copied().chain([last]).collect();
    let factor = rows.select(&with);
    let length = factor.column_norms()[kept.len()];
    if length > 0.0 && factor.r(kept.len(), kept.len()).abs() > INDEPENDENT * length {
        kept.push(last);
    }
    kept
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::normal;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    /// Rows 3 a - 2 x + z = 0 of two noisy columns a, z and one exact x, which follow different signals.
    fn rows(noise: f64, alone: bool) -> (Factor, usize) {
        let count = 4000;
        let mut rng = Pcg64::seed_from_u64(4);
        let mut block = vec![0.0; 4 * count];
        for i in 0..count {
            let x = normal(&mut rng);
            let z = if alone { 0.0 } else { normal(&mut rng) };
            block[i] = x;
            block[count + i] = (2.0 * x - z) / 3.0 + noise * normal(&mut rng);
            block[2 * count + i] = z + noise * normal(&mut rng);
        }
        let mut factor = Factor::new(3);
        factor.push(count, count, &mut block);
        (factor, count)
    }

    #[test]
    fn errors_of_half_a_signal_do_not_pull_the_solution() {
        let (factor, count) = rows(0.3, false);
        let squares = [0.09 * count as f64; 2];
        let found = direction(&factor, 1, &squares).expect("there is one");
        assert_eq!(found.undecided, 0);
        assert!((found.x[1] / found.x[0] + 1.5).abs() < 0.05, "{found:?}");
        assert!((found.x[2] / found.x[0] + 0.5).abs() < 0.05, "{found:?}");
    }

    #[test]
    fn a_column_of_nothing_but_errors_is_told_to_be_any() {
        let (factor, count) = rows(0.3, true);
        let found = direction(&factor, 1, &[0.09 * count as f64; 2]).expect("there is one");
        assert_eq!(found.undecided, 1);
    }
}
