//! Small dense systems by elimination with row exchanges.

/// Factors with row exchanges in place; false where a pivot vanishes.
pub(super) fn lu_factor(n: usize, a: &mut [f64], pivots: &mut [usize]) -> bool {
    for c in 0..n {
        let largest = |&x: &usize, &y: &usize| a[x * n + c].abs().total_cmp(&a[y * n + c].abs());
        let pivot = (c..n).max_by(largest).unwrap_or(c);
        pivots[c] = pivot;
        if !(a[pivot * n + c].abs() > 0.0 && a[pivot * n + c].is_finite()) {
            return false;
        }
        if pivot != c {
            for k in 0..n {
                a.swap(pivot * n + k, c * n + k);
            }
        }
        for r in c + 1..n {
            a[r * n + c] /= a[c * n + c];
            for k in c + 1..n {
                a[r * n + k] -= a[r * n + c] * a[c * n + k];
            }
        }
    }
    true
}

/// Solves with the factors of [`lu_factor`], in place of `x`.
pub(super) fn lu_solve(n: usize, a: &[f64], pivots: &[usize], x: &mut [f64]) {
    for c in 0..n {
        x.swap(c, pivots[c]);
    }
    for r in 0..n {
        for k in 0..r {
            x[r] -= a[r * n + k] * x[k];
        }
    }
    for r in (0..n).rev() {
        for k in r + 1..n {
            x[r] -= a[r * n + k] * x[k];
        }
        x[r] /= a[r * n + r];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn a_factored_matrix_solves_its_system() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(2);
        for n in 1..=9 {
            let a: Vec<f64> = (0..n * n).map(|_| random.random_range(-1.0..1.0)).collect();
            let x: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..1.0)).collect();
            let mut b: Vec<f64> = (0..n).map(|r| (0..n).map(|c| a[r * n + c] * x[c]).sum()).collect();
            let (mut lu, mut pivots) = (a.clone(), vec![0; n]);
            assert!(lu_factor(n, &mut lu, &mut pivots));
            lu_solve(n, &lu, &pivots, &mut b);
            assert!(b.iter().zip(&x).all(|(b, x)| (b - x).abs() < 1e-9), "{n}: {b:?} {x:?}");
        }
        assert!(!lu_factor(2, &mut [1.0, 2.0, 2.0, 4.0], &mut [0, 0]));
    }
}
