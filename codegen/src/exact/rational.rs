//! Rational numbers from decimals, and small rational matrices.

use num_bigint::BigInt;
use num_rational::BigRational;
use num_traits::{One, Zero};

/// The decimal number that a finite `f64` stands for: the shortest one that reads back as it, so that 0.1 is 1/10.
///
/// Zero for a number that is not finite.
pub fn decimal(value: f64) -> BigRational {
    let text = format!("{value:e}");
    let parts = text.split_once('e').and_then(|(mantissa, exponent)| {
        let (whole, fraction) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let digits: BigInt = format!("{whole}{fraction}").parse().ok()?;
        let exponent: i64 = exponent.parse().ok()?;
        Some((digits, exponent - fraction.len() as i64))
    });
    let Some((digits, exponent)) = parts else { return BigRational::zero() };
    let power = BigInt::from(10).pow(exponent.unsigned_abs() as u32);
    if exponent < 0 { BigRational::new(digits, power) } else { BigRational::from_integer(digits * power) }
}

/// The determinant of a square matrix.
pub fn determinant(matrix: &[Vec<BigRational>]) -> BigRational {
    let mut rows = matrix.to_vec();
    let mut product = BigRational::one();
    for k in 0..rows.len() {
        let Some(pivot) = (k..rows.len()).find(|&i| !rows[i][k].is_zero()) else {
            return BigRational::zero();
        };
        if pivot != k {
            rows.swap(pivot, k);
            product = -product;
        }
        product *= &rows[k][k];
        let (done, below) = rows.split_at_mut(k + 1);
        subtract_pivot_row(&done[k], below, k);
    }
    product
}

/// The inverse of a square matrix; `None` where it is singular.
pub fn inverse(matrix: &[Vec<BigRational>]) -> Option<Vec<Vec<BigRational>>> {
    let n = matrix.len();
    let unit = |i: usize, j: usize| if i == j { BigRational::one() } else { BigRational::zero() };
    let mut rows: Vec<Vec<BigRational>> = matrix.to_vec();
    for (i, row) in rows.iter_mut().enumerate() {
        row.extend((0..n).map(|j| unit(i, j)));
    }
    for k in 0..n {
        let pivot = (k..n).find(|&i| !rows[i][k].is_zero())?;
        rows.swap(pivot, k);
        let scale = rows[k][k].recip();
        rows[k].iter_mut().for_each(|x| *x *= &scale);
        let (above, rest) = rows.split_at_mut(k);
        let (row, below) = rest.split_at_mut(1);
        subtract_pivot_row(&row[0], above, k);
        subtract_pivot_row(&row[0], below, k);
    }
    Some(rows.into_iter().map(|mut row| row.split_off(n)).collect())
}

/// Makes column `k` of `others` zero with multiples of `row`.
fn subtract_pivot_row(row: &[BigRational], others: &mut [Vec<BigRational>], k: usize) {
    for other in others {
        if other[k].is_zero() {
            continue;
        }
        let factor = &other[k] / &row[k];
        for (x, y) in other.iter_mut().zip(row) {
            if !y.is_zero() {
                *x -= &factor * y;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_decimal_is_what_was_written() {
        assert_eq!(decimal(0.1), BigRational::new(1.into(), 10.into()));
        assert_eq!(decimal(-9.81), BigRational::new((-981).into(), 100.into()));
        assert_eq!(decimal(4e3), BigRational::from_integer(4000.into()));
        assert_eq!(decimal(1.25e-7), BigRational::new(1.into(), 8_000_000.into()));
        assert_eq!(decimal(f64::NAN), BigRational::zero());
    }

    #[test]
    fn the_inverse_times_the_matrix_is_the_unit_matrix() {
        let matrix: Vec<Vec<_>> = [[0.0, 0.5, 3.0], [32.0, 32.0, 0.1], [0.0, -2.0, 45.0]]
            .map(|row| row.map(decimal).to_vec())
            .to_vec();
        let inverse = inverse(&matrix).expect("it is regular");
        let product =
            |i: usize, j: usize| (0..3).map(|k| &inverse[i][k] * &matrix[k][j]).sum::<BigRational>();
        for (i, j) in (0..3).flat_map(|i| (0..3).map(move |j| (i, j))) {
            assert_eq!(product(i, j), BigRational::from_integer(i32::from(i == j).into()));
        }
        assert_eq!(determinant(&matrix), decimal(-32.0 * (0.5 * 45.0 + 2.0 * 3.0)));
    }

    #[test]
    fn a_singular_matrix_has_no_inverse_however_close_its_decimals_are() {
        let singular = [[0.1, 0.2], [0.3, 0.6]].map(|row| row.map(decimal).to_vec());
        assert_eq!(inverse(&singular), None);
        assert!(determinant(&singular).is_zero());
    }
}
