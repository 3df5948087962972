//! Cholesky factors of small symmetric matrices, with the size known to the compiler where it matters.

/// Factors a positive definite matrix in place: the lower triangle of `a` (row-major, n x n) becomes L with
/// A = L·Lᵀ, except that the diagonal holds 1 / L_ii. Returns false where A is not positive definite.
pub(crate) fn factor(n: usize, a: &mut [f64]) -> bool {
    match n {
        1 => factor_sized::<1>(a),
        2 => factor_sized::<2>(a),
        3 => factor_sized::<3>(a),
        4 => factor_sized::<4>(a),
        5 => factor_sized::<5>(a),
        6 => factor_sized::<6>(a),
        7 => factor_sized::<7>(a),
        8 => factor_sized::<8>(a),
        _ => factor_any(n, a),
    }
}

/// Solves L·Lᵀ·x = b for the factor of [`factor`], in place of b.
pub(crate) fn solve(n: usize, factor: &[f64], x: &mut [f64]) {
    match n {
        1 => solve_sized::<1>(factor, x),
        2 => solve_sized::<2>(factor, x),
        3 => solve_sized::<3>(factor, x),
        4 => solve_sized::<4>(factor, x),
        5 => solve_sized::<5>(factor, x),
        6 => solve_sized::<6>(factor, x),
        7 => solve_sized::<7>(factor, x),
        8 => solve_sized::<8>(factor, x),
        _ => solve_any(n, factor, x),
    }
}

#[inline]
fn factor_sized<const N: usize>(a: &mut [f64]) -> bool {
    let (rows, _) = a.as_chunks_mut::<N>();
    let mut l = [[0.0; N]; N];
    for (to, from) in l.iter_mut().zip(rows.iter()) {
        *to = *from;
    }
    for i in 0..N {
        for j in 0..i {
            let mut sum = l[i][j];
            for k in 0..j {
                sum -= l[i][k] * l[j][k];
            }
            l[i][j] = sum * l[j][j];
        }
        let mut pivot = l[i][i];
        for k in 0..i {
            pivot -= l[i][k] * l[i][k];
        }
        if !(pivot > 0.0 && pivot.is_finite()) {
            return false;
        }
        l[i][i] = 1.0 / pivot.sqrt();
    }
    for (to, from) in rows.iter_mut().zip(l.iter()) {
        *to = *from;
    }
    true
}

#[inline]
fn solve_sized<const N: usize>(factor: &[f64], x: &mut [f64]) {
    let (l, _) = factor.as_chunks::<N>();
    let Some(x) = x.first_chunk_mut::<N>() else { return };
    for i in 0..N {
        let mut sum = x[i];
        for k in 0..i {
            sum -= l[i][k] * x[k];
        }
        x[i] = sum * l[i][i];
    }
    for i in (0..N).rev() {
        let mut sum = x[i];
        for k in i + 1..N {
            sum -= l[k][i] * x[k];
        }
        x[i] = sum * l[i][i];
    }
}

fn factor_any(n: usize, a: &mut [f64]) -> bool {
    for i in 0..n {
        for j in 0..i {
            let mut sum = a[i * n + j];
            for k in 0..j {
                sum -= a[i * n + k] * a[j * n + k];
            }
            a[i * n + j] = sum * a[j * n + j];
        }
        let mut pivot = a[i * n + i];
        for k in 0..i {
            pivot -= a[i * n + k] * a[i * n + k];
        }
        if !(pivot > 0.0 && pivot.is_finite()) {
            return false;
        }
        a[i * n + i] = 1.0 / pivot.sqrt();
    }
    true
}

fn solve_any(n: usize, l: &[f64], x: &mut [f64]) {
    for i in 0..n {
        let mut sum = x[i];
        for k in 0..i {
            sum -= l[i * n + k] * x[k];
        }
        x[i] = sum * l[i * n + i];
    }
    for i in (0..n).rev() {
        let mut sum = x[i];
        for k in i + 1..n {
            sum -= l[k * n + i] * x[k];
        }
        x[i] = sum * l[i * n + i];
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};

    #[test]
    fn the_solution_of_every_size_satisfies_the_system() {
        let mut random = rand_pcg::Pcg64::seed_from_u64(1);
        for n in 1..=12 {
            let root: Vec<f64> = (0..n * n).map(|_| random.random_range(-1.0..1.0)).collect();
            let mut a = vec![0.0; n * n];
            for i in 0..n {
                for j in 0..n {
                    a[i * n + j] = (0..n).map(|k| root[i * n + k] * root[j * n + k]).sum::<f64>();
                }
                a[i * n + i] += 0.5;
            }
            let b: Vec<f64> = (0..n).map(|_| random.random_range(-1.0..1.0)).collect();
            let (mut l, mut x) = (a.clone(), b.clone());
            assert!(factor(n, &mut l));
            solve(n, &l, &mut x);
            for i in 0..n {
                let row: f64 = (0..n).map(|j| a[i * n + j] * x[j]).sum();
                assert!((row - b[i]).abs() < 1e-12, "size {n}, row {i}");
            }
        }
    }

    #[test]
    fn a_matrix_that_is_not_positive_definite_is_refused() {
        for n in 1..=10 {
            let mut a = vec![0.0; n * n];
            for i in 0..n {
                a[i * n + i] = 1.0;
            }
            a[n * n - 1] = -1e-9;
            assert!(!factor(n, &mut a.clone()), "size {n}");
            a[n * n - 1] = f64::NAN;
            assert!(!factor(n, &mut a), "size {n}");
        }
    }
}
