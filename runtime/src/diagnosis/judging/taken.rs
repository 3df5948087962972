//! What a model takes of the noise that it is fitted to.
//!
//! A model of many columns follows a part of the noise, and of noise that lasts more than of noise that does not: what it leaves
//! remembers less than the noise does, and an autoregression fitted to that makes laws certain that are none. With noise of
//! covariance Γ, least squares P y leave (I - P) Γ (I - P)' in the mean, and so take P Γ + Γ P' - P Γ P' away. Γ is first that of
//! what is left; what it was without the fit follows (a step of restricted maximum likelihood: Patterson and Thompson 1971).

use crate::diagnosis::judging::lag_products::LagProducts;
use crate::diagnosis::judging::projection::{Projection, inner_products};
use crate::diagnosis::judging::regressors::Regressors;
use crate::diagnosis::judging::units::Units;
use crate::diagnosis::judging::whitening::{Whitening, local_or_empty};
use crate::diagnosis::rules::HIGHEST_AR_ORDER;
use crate::parallel;
use nalgebra::DMatrix;

/// Orthonormal columns on the rows of a joint, each row as many times as sure as the joint's noise is small.
struct OfJoint {
    /// Of what is free in each motion, then of the model beside it.
    basis: DMatrix<f64>,
    /// These columns times Γ and the weight of a row.
    remembered: DMatrix<f64>,
}

/// Products of what least squares that leave `residual` took of the noise of each joint, whose memory is as `whitening` says;
/// nothing where they are not finite.
pub(super) fn by_fit(
    units: &Units,
    regressors: &Regressors<'_>,
    (residual, whitening): (&[f64], &[Whitening]),
    threads: usize,
) -> Vec<LagProducts> {
    let (joints, p) = (regressors.of_joint.len(), regressors.shared.len());
    let weights: Vec<f64> = regressors.of_joint.iter().map(|rows| weight(&residual[rows.clone()])).collect();
    let columns = parallel::map(threads, joints, |j| beside_free(units, regressors, j));
    let of_joint = |j: usize| {
        let columns: Vec<&[f64]> = columns[j].1.iter().map(Vec::as_slice).collect();
        weights[j] * inner_products(&columns, 0..regressors.of_joint[j].len())
    };
    let products = parallel::map(threads, joints, of_joint);
    let mut whole = products.iter().fold(DMatrix::zeros(p + 1, p + 1), |mut sum, part| {
        let mut model = sum.view_mut((0, 0), (p, p));
        model += part;
        sum
    });
    if let Some(prior) = regressors.prior {
        prior.add_to_products(&mut whole, p);
    }
    let Some(model) = Projection::of(&whole, p) else {
        return vec![LagProducts::zero(HIGHEST_AR_ORDER); joints];
    };
    let bases: Vec<OfJoint> = parallel::map(threads, joints, |j| {
        let (free, columns) = &columns[j];
        let rows = regressors.of_joint[j].len();
        let of_model = model.white(&DMatrix::from_fn(p, rows, |i, t| columns[i][t]), 0, rows);
        let f = free.len();
        let basis = DMatrix::from_fn(rows, f + p, |t, i| {
            if i < f { free[i][t] / weights[j].sqrt() } else { of_model[(i - f, t)] }
        });
        let Whitening { stretches, ar, .. } = &whitening[j];
        let mut remembered = DMatrix::zeros(rows, f + p);
        for (column, mut out) in basis.column_iter().zip(remembered.column_iter_mut()) {
            if column.iter().any(|x| *x != 0.0) {
                let values = ar.covariance_times(stretches, column.as_slice());
                out.iter_mut().zip(values).for_each(|(out, x)| *out = weights[j] * x);
            }
        }
        OfJoint { basis, remembered }
    });
    // Of the parameters, as the noise of all joints makes them.
    let between = |j: usize, of: &OfJoint| weights[j] * of.basis.tr_mul(&of.remembered);
    let own: Vec<DMatrix<f64>> = bases.iter().enumerate().map(|(j, of)| between(j, of)).collect();
    let of_model = own
        .iter()
        .zip(&columns)
        .fold(DMatrix::zeros(p, p), |sum, (own, (free, _))| sum + own.view((free.len(), free.len()), (p, p)));
    parallel::map(threads, joints, |j| {
        let mut covariance = own[j].clone();
        let f = columns[j].0.len();
        covariance.view_mut((f, f), (p, p)).copy_from(&of_model);
        of_one(&bases[j], &covariance, &whitening[j])
    })
}

/// One over the variance; 0 where there is none.
fn weight(residual: &[f64]) -> f64 {
    let squares: f64 = residual.iter().map(|x| x * x).sum();
    if squares > 0.0 { residual.len() as f64 / squares } else { 0.0 }
}

/// P Γ + Γ P' - P Γ P' on one joint: the sum of u w' + w u' over the columns u of its basis.
fn of_one(of: &OfJoint, covariance: &DMatrix<f64>, whitening: &Whitening) -> LagProducts {
    let mut taken = LagProducts::zero(HIGHEST_AR_ORDER);
    let other = &of.remembered - 0.5 * (&of.basis * covariance);
    for (u, w) in of.basis.column_iter().zip(other.column_iter()) {
        if u.iter().any(|x| *x != 0.0) {
            let [sum, difference] = [(u + w), (u - w)];
            taken.add(&whitening.stretches, sum.as_slice(), 0.5);
            taken.add(&whitening.stretches, difference.as_slice(), -0.5);
        }
    }
    taken
}

/// On the rows of a joint: what is free in each motion as orthonormal columns, and the model's columns without what those make
/// of them.
fn beside_free(units: &Units, regressors: &Regressors<'_>, j: usize) -> (Vec<Vec<f64>>, Vec<Vec<f64>>) {
    let range = &regressors.of_joint[j];
    let mut columns: Vec<Vec<f64>> = regressors.shared.iter().map(|c| c[range.clone()].to_vec()).collect();
    let (free, f) = (&regressors.free[j], regressors.free[j].len());
    let mut bases = Vec::new();
    if f == 0 {
        return (bases, columns);
    }
    for file in 0..units.files() {
        let of_file = (0..units.units.len()).filter(|&u| units.units[u].file == file);
        let rows: Vec<_> = of_file.map(|u| local_or_empty(&units.rows[j][u], range)).collect();
        let both: Vec<&[f64]> = free.iter().chain(&columns).map(Vec::as_slice).collect();
        let zero = DMatrix::zeros(both.len(), both.len());
        let products = rows.iter().fold(zero, |sum, rows| sum + inner_products(&both, rows.clone()));
        let Some(model) = Projection::of(&products, f) else { continue };
        let made = model.white(&products, f, columns.len());
        let mut basis = vec![vec![0.0; range.len()]; f];
        for t in rows.into_iter().flatten() {
            let row = model.white(&DMatrix::from_fn(f, 1, |i, _| free[i][t]), 0, 1);
            for (series, value) in basis.iter_mut().zip(row.iter()) {
                series[t] = *value;
            }
            for (column, made) in columns.iter_mut().zip(made.column_iter()) {
                column[t] -= made.dot(&row.column(0));
            }
        }
        bases.extend(basis);
    }
    (bases, columns)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::judging::testing::correlated;
    use crate::diagnosis::judging::units::Unit;
    use nalgebra::DVector;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    const ROWS: usize = 300;
    const RHO: f64 = 0.8;

    /// Means of the products of noise with itself a row later, as shares of its squares, and of these squares, as shares of their
    /// expectation: of what least squares leave, and of that with what they took. Columns of the model and of one that is free in
    /// each of two motions, of which the second is the recording, last as long as the noise.
    fn remembered(runs: usize) -> [[f64; 2]; 2] {
        let mut rng = Pcg64::seed_from_u64(6);
        let mut sums = [[0.0; 2]; 2];
        for _ in 0..runs {
            let all = 0..2 * ROWS;
            let mut column = || correlated(&mut rng, 2 * ROWS, RHO);
            let shared: Vec<Vec<f64>> = (0..20).map(|_| column()).collect();
            let free = vec![vec![column()]];
            let noise = column();
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
            let regressors = Regressors {
                shared: &shared,
                y: &noise,
                free: &free,
                companions: &[vec![]],
                prior: None,
                between_motions: &[],
                of_joint: std::slice::from_ref(&all),
            };
            let as_left = Whitening::of(&units, &regressors, 0, (&left, None));
            let taken = by_fit(&units, &regressors, (&left, &[as_left]), 1);
            let as_left = LagProducts::of(&units.stretches[0], &left, HIGHEST_AR_ORDER);
            let mut given_back = as_left.clone();
            given_back.add_products(&taken[0], 1.0);
            for (sum, products) in sums.iter_mut().zip([as_left, given_back]) {
                let squares = products.between(0, &[1.0], &[1.0]);
                sum[0] += products.between(1, &[1.0, 0.0], &[0.0, 1.0]) / squares;
                sum[1] += squares * (1.0 - RHO * RHO) / (2 * ROWS) as f64;
            }
        }
        sums.map(|sum| sum.map(|sum| sum / runs as f64))
    }

    #[test]
    fn noise_remembers_as_much_as_it_does_once_what_the_model_took_of_it_is_given_back() {
        let [as_left, given_back] = remembered(40);
        println!("{as_left:?} {given_back:?}");
        let [known, of_squares] = given_back;
        assert!(as_left[0] < RHO - 0.05 && as_left[1] < 0.87, "{as_left:?}");
        assert!((known - RHO).abs() < 0.04 && (of_squares - 1.0).abs() < 0.08, "{given_back:?}");
    }
}
