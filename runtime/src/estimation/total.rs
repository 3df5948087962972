//! Total least squares: errors in the columns as well as in Y.

use super::Factor;
use nalgebra::DMatrix;

/// Least part of Y in the unit direction that is solved for.
const LEAST_PART_OF_Y: f64 = 1e-10;

/// The direction that the data determine least has no part in Y.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct NoGenericSolution;

/// Mixed total least squares from a factor whose columns are independent (Golub and Van Loan 1980; Van Huffel and
/// Vandewalle 1991, section 3.5; on robots Gautier, Vandanjon and Presse 1994).
///
/// The columns in `exact` have no errors; the others and Y have errors of the same size relative to their length.
///
/// # Errors
/// The smallest singular direction has no part in Y: no generic solution exists.
pub(super) fn total_least_squares(factor: &Factor, exact: &[bool]) -> Result<Vec<f64>, NoGenericSolution> {
    let k = factor.unknowns();
    let known: Vec<usize> = (0..k).filter(|&l| exact[l]).collect();
    let noisy: Vec<usize> = (0..k).filter(|&l| !exact[l]).collect();
    let order: Vec<usize> = known.iter().chain(&noisy).copied().collect();
    let ordered = factor.select(&order);
    let mut norms: Vec<f64> = ordered.column_norms();
    norms.push(ordered.norm_y());
    let first = known.len();
    let count = noisy.len();

    // What the exact columns leave of the others, each in units of its length.
    let below =
        DMatrix::from_fn(count + 1, count + 1, |i, l| ordered.r(first + i, first + l) / norms[first + l]);
    let svd = below.svd(false, true);
    // The decomposition was asked for them.
    let v = svd.v_t.ok_or(NoGenericSolution)?;
    let smallest = svd.singular_values.imin();
    let of_y = v[(smallest, count)];
    if of_y.abs() < LEAST_PART_OF_Y {
        return Err(NoGenericSolution);
    }
    let mut solved = vec![0.0; k];
    for l in 0..count {
        solved[first + l] = -v[(smallest, l)] / of_y * norms[k] / norms[first + l];
    }
    for i in (0..first).rev() {
        let others: f64 = (i + 1..k).map(|l| ordered.r(i, l) * solved[l]).sum();
        solved[i] = (ordered.r(i, k) - others) / ordered.r(i, i);
    }
    let mut chi = vec![0.0; k];
    for (&l, x) in order.iter().zip(solved) {
        chi[l] = x;
    }
    Ok(chi)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    fn factor(rows: &DMatrix<f64>) -> Factor {
        let mut factor = Factor::new(rows.ncols() - 1);
        let mut block: Vec<f64> = rows.as_slice().to_vec();
        factor.push(rows.nrows(), rows.nrows(), &mut block);
        factor
    }

    #[test]
    fn errors_in_a_column_no_longer_pull_its_parameter_towards_zero() {
        let (rows, size) = (40_000, 0.3);
        let mut rng = Pcg64::seed_from_u64(3);
        let mut data = DMatrix::zeros(rows, 4);
        for i in 0..rows {
            let x: f64 = rng.random_range(-1.0..1.0);
            let z: f64 = rng.random_range(-1.0..1.0);
            // Errors that are the same share of each column's length: Y is x + z, longer by the root of two.
            data[(i, 0)] = 1.0;
            data[(i, 1)] = x + size * rng.random_range(-1.0..1.0);
            data[(i, 2)] = z + size * rng.random_range(-1.0..1.0);
            data[(i, 3)] = 0.5 + x + z + size * 1.5_f64.sqrt() * rng.random_range(-1.0..1.0);
        }
        let factor = factor(&data);
        let ordinary = factor.solve().chi;
        // The classical attenuation: signal / (signal + noise).
        assert!((ordinary[1] - 1.0 / (1.0 + size * size)).abs() < 0.02, "{ordinary:?}");
        let total = total_least_squares(&factor, &[true, false, false]).expect("generic");
        for (x, expected) in total.iter().zip([0.5, 1.0, 1.0]) {
            assert!((x - expected).abs() < 0.03, "{total:?}");
        }
    }

    #[test]
    fn without_errors_it_is_least_squares() {
        let mut rng = Pcg64::seed_from_u64(5);
        let mut data = DMatrix::from_fn(60, 4, |_, _| rng.random_range(-1.0..1.0));
        let y = data.column(0) * 2.0 - data.column(1) + data.column(2) * 0.1;
        data.set_column(3, &y);
        let total = total_least_squares(&factor(&data), &[false; 3]).expect("generic");
        for (x, expected) in total.iter().zip([2.0, -1.0, 0.1]) {
            assert!((x - expected).abs() < 1e-10);
        }
    }
}
