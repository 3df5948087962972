#![allow(clippy::unwrap_used)]
use super::*;
use nalgebra::{DMatrix, DVector};
use proptest::prelude::*;
use rand::{RngExt, SeedableRng};

fn random(rows: usize, columns: usize, seed: u64) -> DMatrix<f64> {
    let mut rng = rand_pcg::Pcg64::seed_from_u64(seed);
    DMatrix::from_fn(rows, columns, |_, _| rng.random_range(-1.0..1.0))
}

/// The factor of the rows of [W Y], pushed in blocks of the given sizes.
fn factor_of(rows: &DMatrix<f64>, sizes: &[usize]) -> Factor {
    let mut factor = Factor::new(rows.ncols() - 1);
    let mut at = 0;
    for &size in sizes.iter().cycle() {
        let size = size.min(rows.nrows() - at);
        if size == 0 {
            break;
        }
        let stride = size.next_multiple_of(4) + 4;
        let mut block = vec![f64::NAN; rows.ncols() * stride];
        for l in 0..rows.ncols() {
            for i in 0..size {
                block[l * stride + i] = rows[(at + i, l)];
            }
        }
        factor.push(size, stride, &mut block);
        at += size;
    }
    factor
}

fn matrix(factor: &Factor) -> DMatrix<f64> {
    let c = factor.unknowns() + 1;
    DMatrix::from_fn(c, c, |i, l| factor.r(i, l))
}

#[test]
fn the_triangle_is_that_of_a_dense_qr_up_to_signs() {
    for columns in [1, 2, 4, 5, 9, 24] {
        let rows = random(333, columns, columns as u64);
        let ours = matrix(&factor_of(&rows, &[64, 17, 128]));
        let theirs = rows.clone().qr().r();
        for i in 0..columns {
            let sign = ours[(i, i)].signum() * theirs[(i, i)].signum();
            for l in 0..columns {
                assert!((ours[(i, l)] - sign * theirs[(i, l)]).abs() < 1e-12);
            }
        }
    }
}

#[test]
fn the_solution_keeps_the_digits_that_normal_equations_lose() {
    // Laeuchli's matrix: its Gram matrix is singular in double precision.
    let small = 1e-8;
    let mut rows = DMatrix::zeros(4, 4);
    for l in 0..3 {
        rows[(0, l)] = 1.0;
        rows[(l + 1, l)] = small;
    }
    let chi = DVector::from_column_slice(&[1.0, 2.0, 3.0]);
    let y = rows.columns(0, 3) * &chi;
    rows.set_column(3, &y);
    let factor = factor_of(&rows, &[4]);
    let r = matrix(&factor);
    let solved = r.view((0, 0), (3, 3)).solve_upper_triangular(&r.view((0, 3), (3, 1))).unwrap();
    assert!((solved - chi).norm() < 1e-6);
}

#[test]
fn solution_and_variance_are_those_of_the_textbook() {
    let rows = random(200, 8, 3);
    let factor = factor_of(&rows, &[50]);
    let (w, y) = (rows.columns(0, 7).into_owned(), rows.column(7).into_owned());
    let gram = (w.transpose() * &w).try_inverse().unwrap();
    let chi = &gram * w.transpose() * &y;
    let solution = factor.solve();
    for l in 0..7 {
        assert!((solution.chi[l] - chi[l]).abs() < 1e-12);
        assert!((solution.variance[l] / gram[(l, l)] - 1.0).abs() < 1e-10);
    }
    assert!((solution.residual_norm - (&y - &w * &chi).norm()).abs() < 1e-11);
    assert_eq!(solution.degrees_of_freedom, 193);
    let mut scaled = w.clone();
    for mut column in scaled.column_iter_mut() {
        column.normalize_mut();
    }
    let values = scaled.svd(false, false).singular_values;
    assert!((solution.condition / (values.max() / values.min()) - 1.0).abs() < 1e-9);
    assert!((factor.norm_y() - y.norm()).abs() < 1e-11);
    let any = vec![0.3; 7];
    let e = &y - &w * DVector::from_column_slice(&any);
    assert!((factor.residual_norm(&any) - e.norm()).abs() < 1e-11);
    assert!((DVector::from_vec(factor.score(&any)) - w.transpose() * e).norm() < 1e-10);
}

#[test]
fn what_columns_leave_of_the_others_is_their_residual_on_them() {
    let rows = random(60, 6, 4);
    let left = factor_of(&rows, &[60]).beyond(2);
    let known = rows.columns(0, 2).into_owned();
    let hat = &known * (known.transpose() * &known).try_inverse().unwrap() * known.transpose();
    let others = rows.columns(2, 4).into_owned();
    let residual = factor_of(&(&others - hat * &others), &[60]);
    assert_eq!((left.unknowns(), left.rows()), (3, 58));
    for l in 0..=3 {
        for i in 0..=l {
            assert!((left.r(i, l).abs() - residual.r(i, l).abs()).abs() < 1e-11);
        }
    }
}

#[test]
fn columns_that_cannot_be_told_apart_are_named_and_not_inverted() {
    let mut rows = random(100, 7, 5);
    let sum = rows.column(1) * 2.0 - rows.column(4);
    rows.set_column(3, &sum);
    rows.column_mut(2).fill(0.0);
    let solution = factor_of(&rows, &[100]).solve();
    assert_eq!(solution.kept.len(), 4);
    assert!(solution.dependent.contains(&vec![2]));
    let group = solution.dependent.iter().find(|g| g.len() > 1).unwrap();
    let mut group = group.clone();
    group.sort_unstable();
    assert_eq!(group, [1, 3, 4]);
    assert!(solution.variance[2].is_infinite() && solution.chi[2] == 0.0);
    assert!(solution.chi.iter().all(|x| x.is_finite()));
}

#[test]
fn held_parameters_leave_the_same_problem_as_moving_them_to_the_left() {
    let rows = random(60, 5, 9);
    let held = factor_of(&rows, &[60]).hold(&[(1, 0.7), (3, -2.0)]);
    let mut moved = random(60, 3, 0);
    moved.set_column(0, &rows.column(0));
    moved.set_column(1, &rows.column(2));
    moved.set_column(2, &(rows.column(4) - rows.column(1) * 0.7 + rows.column(3) * 2.0));
    let direct = factor_of(&moved, &[60]).solve();
    for (a, b) in held.solve().chi.iter().zip(&direct.chi) {
        assert!((a - b).abs() < 1e-12);
    }
}

#[test]
fn other_columns_of_the_same_rows_have_the_factor_of_those_columns() {
    let rows = random(70, 5, 11);
    let change = random(5, 3, 12);
    let times = factor_of(&rows, &[32]).times(&change);
    let direct = factor_of(&(rows * change), &[32]);
    assert_eq!((times.rows(), times.unknowns()), (70, 2));
    let gram = |f: &Factor| matrix(f).transpose() * matrix(f);
    assert!((gram(&times) - gram(&direct)).norm() < 1e-12 * gram(&direct).norm());
}

proptest! {
    #[test]
    fn merging_weighting_and_selecting_are_what_they_are_on_rows(
        seed in 0u64..1000, first in 1usize..90, second in 0usize..90, weight in 0.1..10.0,
    ) {
        let a = random(first, 6, seed);
        let b = random(second, 4, seed + 5000);
        let mut merged = factor_of(&a, &[40]);
        merged.merge_weighted(&factor_of(&b, &[33]), &[4, 0, 2], weight);
        let mut all = DMatrix::zeros(first + second, 6);
        all.rows_mut(0, first).copy_from(&a);
        for i in 0..second {
            for (l, to) in [4, 0, 2, 5].into_iter().enumerate() {
                all[(first + i, to)] = weight * b[(i, l)];
            }
        }
        prop_assert_eq!(merged.rows(), first + second);
        let gram = |m: &DMatrix<f64>| m.transpose() * m;
        prop_assert!((gram(&matrix(&merged)) - gram(&all)).norm() < 1e-11 * (1.0 + gram(&all).norm()));
        let selected = merged.select(&[3, 1]);
        let some = DMatrix::from_columns(&[all.column(3), all.column(1), all.column(5)]);
        prop_assert!((gram(&matrix(&selected)) - gram(&some)).norm() < 1e-11 * (1.0 + gram(&some).norm()));
    }
}

#[test]
fn a_factor_that_was_written_down_is_read_back_exactly_and_nothing_else_is() {
    let mut factor = Factor::new(2);
    let mut block = vec![0.0; 3 * 8];
    block.iter_mut().enumerate().for_each(|(k, x)| *x = (1.7 * k as f64).sin());
    factor.push(5, 8, &mut block);
    let upper = factor.upper();
    assert_eq!(Factor::from_upper(2, 5, &upper), Some(factor));
    assert_eq!(Factor::from_upper(3, 5, &upper), None);
    assert_eq!(Factor::from_upper(usize::MAX, 5, &[]), None);
    assert_eq!(Factor::from_upper(2, 5, &[1.0, 2.0, 3.0, f64::NAN, 5.0, 6.0]), None);
}
