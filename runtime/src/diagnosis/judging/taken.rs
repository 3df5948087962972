//! What a model takes of the noise that it is fitted to.
//!
//! A model of many columns follows a part of the noise, and of noise that lasts more than of noise that does not: what it leaves
//! remembers less than the noise does, and an autoregression fitted to that makes laws certain that are none. Generalised least
//! squares leave products e e' that are X C X' short of those of the noise, with X the columns and C the covariance of their
//! parameters: the expectation step of restricted maximum likelihood (Harville 1977; Dempster, Laird and Rubin 1977). No other
//! least squares take less (Aitken 1936), so that this much is given back at least.

use crate::diagnosis::judging::lag_products::LagProducts;
use crate::diagnosis::judging::projection::{Projection, inner_products};
use crate::diagnosis::judging::regressors::Regressors;
use crate::diagnosis::judging::units::Units;
use crate::diagnosis::judging::whitening::{Whitening, rows_of_motion};
use crate::diagnosis::rules::HIGHEST_AR_ORDER;
use nalgebra::DMatrix;

/// The products X C X' on the rows of a joint, given the model that all motion and what is known beforehand make of the white
/// columns, with those of a law after the model's own, and what made the joint white.
pub(super) fn by_fit(
    units: &Units,
    (regressors, law): (&Regressors<'_>, &[Vec<f64>]),
    j: usize,
    (model, whitening): (&Projection, &Whitening),
) -> LagProducts {
    let range = &regressors.of_joint[j];
    let mut taken = LagProducts::zero(HIGHEST_AR_ORDER);
    let mut columns: Vec<Vec<f64>> =
        regressors.shared.iter().chain(law).map(|c| c[range.clone()].to_vec()).collect();
    add_free(&mut taken, &mut columns, (units, regressors, j), whitening);
    let table = DMatrix::from_fn(columns.len(), range.len(), |i, t| columns[i][t]);
    taken.add_all(&whitening.stretches, &model.white(&table, 0, range.len()));
    taken
}

/// Adds what columns that are free in each motion take there, and takes out of the others what those make of them.
fn add_free(
    taken: &mut LagProducts,
    columns: &mut [Vec<f64>],
    (units, regressors, j): (&Units, &Regressors<'_>, usize),
    Whitening { stretches, ar, free: white_free }: &Whitening,
) {
    let (free, range) = (&regressors.free[j], &regressors.of_joint[j]);
    let f = free.len();
    if f == 0 {
        return;
    }
    let white: Vec<Vec<f64>> = columns.iter().map(|c| ar.whitened(stretches, c)).collect();
    let both: Vec<&[f64]> = white_free.iter().chain(&white).map(Vec::as_slice).collect();
    let mut of_free = DMatrix::zeros(f, range.len());
    for file in 0..units.files() {
        let rows: Vec<_> = rows_of_motion(units, j, file, range).collect();
        let zero = DMatrix::zeros(both.len(), both.len());
        let products = rows.iter().fold(zero, |sum, rows| sum + inner_products(&both, rows.clone()));
        let Some(model) = Projection::of(&products, f) else { continue };
        let made = model.white(&products, f, columns.len());
        let rows: Vec<usize> = rows.into_iter().flatten().collect();
        let of_rows = model.white(&DMatrix::from_fn(f, rows.len(), |i, k| free[i][rows[k]]), 0, rows.len());
        for (&t, row) in rows.iter().zip(of_rows.column_iter()) {
            of_free.set_column(t, &row);
        }
        for (column, made) in columns.iter_mut().zip(made.column_iter()) {
            for (&t, row) in rows.iter().zip(of_rows.column_iter()) {
                column[t] -= made.dot(&row);
            }
        }
    }
    taken.add_all(stretches, &of_free);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::judging::testing::correlated;
    use crate::diagnosis::judging::units::Unit;
    use crate::diagnosis::judging::white_products::of_joint;
    use nalgebra::DVector;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    const ROWS: usize = 300;
    /// Of the noise from row to row, and of the columns, which last longer.
    const RHO: f64 = 0.8;
    const SLOW: f64 = 0.98;

    /// Means of the products of noise with itself a row later, as shares of its squares, and of these squares, as shares of their
    /// expectation: of what least squares leave, and of that with what they took. Columns of the model, of a law and of one that
    /// is free in each of two motions, of which the second is the recording, last longer than the noise.
    fn remembered(runs: usize) -> [[f64; 2]; 2] {
        let mut rng = Pcg64::seed_from_u64(6);
        let mut sums = [[0.0; 2]; 2];
        for _ in 0..runs {
            let all = 0..2 * ROWS;
            let mut column = |rho| correlated(&mut rng, 2 * ROWS, rho);
            let shared: Vec<Vec<f64>> = (0..20).map(|_| column(SLOW)).collect();
            let free = vec![vec![column(SLOW)]];
            let noise = column(RHO);
            // Fitted: the shared columns, and the free one in each motion for itself.
            let of_motion = |f: usize| (0..2 * ROWS).map(move |t| if t / ROWS == f { 1.0 } else { 0.0 });
            let both = (0..2).map(|f| of_motion(f).zip(&free[0][0]).map(|(on, x)| on * x).collect());
            let columns: Vec<Vec<f64>> = shared.iter().cloned().chain(both).collect();
            let w = DMatrix::from_fn(2 * ROWS, columns.len(), |t, i| columns[i][t]);
            let y = DVector::from_column_slice(&noise);
            let chi = w.tr_mul(&w).lu().solve(&w.tr_mul(&y)).expect("regular");
            let left: Vec<f64> = (&y - &w * chi).iter().copied().collect();
            let motion = |f: usize| f * ROWS..(f + 1) * ROWS;
            let units = Units {
                units: (0..2).map(|file| Unit { file, target: file == 1 }).collect(),
                rows: vec![(0..2).map(motion).collect()],
                stretches: vec![(0..2).map(motion).collect()],
                duration: 6.0,
                target_duration: 6.0,
            };
            // The last column is a law's.
            let (model, law) = shared.split_at(shared.len() - 1);
            let regressors = Regressors {
                shared: model,
                y: &noise,
                free: &free,
                companions: &[vec![]],
                prior: None,
                between_motions: &[],
                of_joint: std::slice::from_ref(&all),
            };
            let as_left = LagProducts::of(&units.stretches[0], &left, HIGHEST_AR_ORDER);
            let mut given_back = as_left.clone();
            let whitening = Whitening::of(&units, &regressors, 0, (&left, None));
            let products = of_joint(&units, &regressors, 0, law, &[], &whitening);
            let m = regressors.shared.len() + law.len();
            let model = Projection::of(&products.whole(&units, &regressors, m), m).expect("finite");
            given_back.add_products(&by_fit(&units, (&regressors, law), 0, (&model, &whitening)));
            for (sum, products) in sums.iter_mut().zip([as_left, given_back]) {
                let squares = products.between(0, &[1.0], &[1.0]);
                sum[0] += products.between(1, &[1.0, 0.0], &[0.0, 1.0]) / squares;
                sum[1] += squares * (1.0 - RHO * RHO) / (2 * ROWS) as f64;
            }
        }
        sums.map(|sum| sum.map(|sum| sum / runs as f64))
    }

    #[test]
    fn a_good_part_of_what_a_fit_took_of_slow_noise_is_given_back_and_no_more_than_it_took() {
        let [as_left, given_back] = remembered(40);
        println!("{as_left:?} {given_back:?}");
        // A quarter of what is missing and more, and nothing that is not.
        for (k, truth) in [RHO, 1.0].into_iter().enumerate() {
            let [before, after] = [as_left, given_back].map(|means| truth - means[k]);
            assert!(before > 0.05 && after < 0.75 * before && after > 0.0, "{as_left:?} {given_back:?}");
        }
    }
}
