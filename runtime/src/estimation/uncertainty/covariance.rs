//! Standard deviations of parameters under noise that lasts.

use super::between::{MotionPart, factors};
use super::freedom::Known;
use super::innovations::Innovations;
use super::noise::{Noise, inverse};
use super::series::Series;
use super::solved::Solved;
use super::variance_function;
use crate::estimation::observe::Equations;
use nalgebra::{DMatrix, DVector};

/// Variance of each unknown that was solved for: the diagonal of [`covariance`].
pub(in crate::estimation) fn variances(solved: &Solved<'_>) -> Option<Vec<f64>> {
    let all = covariance(solved)?;
    let variances: Vec<f64> = all.diagonal().iter().copied().collect();
    variances.iter().all(|v| v.is_finite() && *v >= 0.0).then_some(variances)
}

/// Covariance of the unknowns that were solved for.
///
/// The estimate solves ZT V W chi = ZT V Y with weights V, so that its error is (ZT V W)^-1 ZT V e with the covariance
/// (ZT V W)^-1 ZT V C V Z (WT V Z)^-1, C that of the noise: an autoregression for each equation, with innovations that
/// are correlated between equations ([`Noise`]). The noise of a power is as large as the [`variance_function`] has it, and its
/// innovations have each their own variance. ZT V C V Z is never formed from C: each column of Z is turned into what
/// each innovation weighs in it.
///
/// Where motions differ by more than that noise, the variances are as much larger ([`factors`]). C is estimated, from few rows
/// perhaps: the variances are those that make 1.96 standard deviations half an interval of 95 % ([`Known::student`]).
///
/// `None` where the rows were not kept, or do not determine the unknowns.
pub(in crate::estimation) fn covariance(solved: &Solved<'_>) -> Option<DMatrix<f64>> {
    let k = solved.unknowns.len();
    let series = Series::of(solved.observation, solved.unknowns, solved.errors)?;
    // The noise of a power is that of the torques times the speeds.
    let deviations = match solved.observation.equations {
        Equations::Torque => None,
        Equations::Power { .. } => Some(variance_function::deviations(&series, k)?),
    };
    let even: Option<Vec<Series>> =
        deviations.as_ref().map(|all| series.iter().zip(all).map(|(s, d)| s.divided_by(d)).collect());
    let even = even.as_ref().unwrap_or(&series);
    let noise = Noise::of(even, k)?;
    let same = solved.unknowns == solved.instruments;
    let others =
        if same { None } else { Some(Series::of(solved.observation, solved.instruments, solved.errors)?) };
    let scores = others.as_ref().unwrap_or(&series);
    let trajectories = series.iter().map(|s| s.trajectory + 1).max().unwrap_or(0);
    let motions: Vec<Vec<Innovations<'_>>> = (0..trajectories)
        .map(|t| {
            let of_motion = |p: &usize| series[*p].trajectory == t;
            let of_series = |p: usize| {
                let own = deviations.as_ref().map(|all| (&even[p], all[p].as_slice()));
                Innovations::of(&series[p], &scores[p], own, solved, &noise)
            };
            (0..series.len()).filter(of_motion).map(of_series).collect()
        })
        .filter(|motion: &Vec<_>| !motion.is_empty())
        .collect();
    let parts: Vec<MotionPart> = motions.iter().map(|motion| of_motion(motion, k, &noise)).collect();
    let between = factors(&parts, k);
    let zero = || DMatrix::<f64>::zeros(k, k);
    let mut information = parts.iter().fold(zero(), |sum, part| sum + &part.information);
    let spread = parts.iter().fold(zero(), |sum, part| sum + &part.spread);
    if let Some(noise) = solved.noise_of_columns {
        information -= noise;
    }
    let inverse = if same { inverse(&information)? } else { information.try_inverse()? };
    let all = &inverse * spread * inverse.transpose();
    let mut known = Known::new(&noise, k);
    motions.iter().for_each(|motion| known.add(motion, &inverse, &noise));
    let student = known.student(&noise);
    let factor = |i: usize| student[i] * between[i].sqrt();
    Some(DMatrix::from_fn(k, k, |i, l| factor(i) * factor(l) * all[(i, l)]))
}

/// What one motion adds to the information and to the spread of the scores.
fn of_motion(equations: &[Innovations<'_>], unknowns: usize, noise: &Noise) -> MotionPart {
    let zero = || DMatrix::zeros(unknowns, unknowns);
    let mut part = MotionPart { information: zero(), spread: zero(), right: DVector::zeros(unknowns) };
    for Innovations { w, z, weight, .. } in equations {
        add(&mut part.information, &z.places, &w.places, &(*weight * (z.w.transpose() * &w.w)));
        for (column, &place) in z.w.column_iter().zip(&z.places) {
            part.right[place] += weight * column.iter().zip(&w.y).map(|(z, y)| z * y).sum::<f64>();
        }
    }
    let scaled: Vec<_> = equations.iter().map(Innovations::scaled).collect();
    for (l, (x, of_x)) in equations.iter().zip(&scaled).enumerate() {
        for (m, (y, of_y)) in equations[..=l].iter().zip(&scaled).enumerate() {
            let correlation = noise.correlation[(x.equation, y.equation)];
            if correlation == 0.0 {
                continue;
            }
            // They end at the same time.
            let last = of_x.nrows().min(of_y.nrows());
            let end = |i: &DMatrix<f64>| i.rows(i.nrows() - last, last).into_owned();
            let product = correlation * (end(of_x).transpose() * end(of_y));
            add(&mut part.spread, &x.z.places, &y.z.places, &product);
            if m != l {
                add(&mut part.spread, &y.z.places, &x.z.places, &product.transpose());
            }
        }
    }
    part
}

fn add(to: &mut DMatrix<f64>, rows: &[usize], columns: &[usize], part: &DMatrix<f64>) {
    for (a, &i) in rows.iter().enumerate() {
        for (b, &j) in columns.iter().enumerate() {
            to[(i, j)] += part[(a, b)];
        }
    }
}
