//! Standard deviations of parameters under noise that lasts.

use super::between::{MotionPart, factors};
use super::noise::{Noise, inverse};
use super::series::Series;
use crate::estimation::observe::{Equations, Observation};
use nalgebra::{DMatrix, DVector};

/// Innovations from before a motion that still matter in it, at most.
const LONGEST_MEMORY: usize = 400;

/// What was solved, and with which errors of the groups.
pub(in crate::estimation) struct Solved<'a> {
    /// The rows, kept.
    pub observation: &'a Observation,
    /// The unknowns that were solved for.
    pub unknowns: &'a [usize],
    /// For each of them the unknown whose column stands in for its own in the equations of the estimate: itself for
    /// least squares, its instrument for instrumental variables.
    pub instruments: &'a [usize],
    /// What noise in the columns added to the weighted WT W, which was taken away.
    pub noise_of_columns: Option<&'a DMatrix<f64>>,
    /// Error of each group of the observation, whose inverse was the weight.
    pub weights: &'a [f64],
    /// The same as the noise has it: another one where the weights were not those of the noise.
    pub errors: &'a [f64],
}

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
/// are correlated between equations ([`Noise`]). The innovations of a power have each their own variance. ZT V C V Z is never formed from C: each column of Z is turned into what
/// each innovation weighs in it.
///
/// Where motions differ by more than that noise, the variances are as much larger ([`factors`]).
///
/// `None` where the rows were not kept, or do not determine the unknowns.
pub(in crate::estimation) fn covariance(solved: &Solved<'_>) -> Option<DMatrix<f64>> {
    let k = solved.unknowns.len();
    let series = Series::of(solved.observation, solved.unknowns, solved.errors)?;
    let noise = Noise::of(&series, k)?;
    let same = solved.unknowns == solved.instruments;
    let others =
        if same { None } else { Some(Series::of(solved.observation, solved.instruments, solved.errors)?) };
    let scores = others.as_ref().unwrap_or(&series);
    let trajectories = series.iter().map(|s| s.trajectory + 1).max().unwrap_or(0);
    let parts: Vec<MotionPart> = (0..trajectories)
        .filter_map(|t| {
            let rows: Vec<_> = series.iter().zip(scores).filter(|(s, _)| s.trajectory == t).collect();
            (!rows.is_empty()).then(|| of_motion(&rows, solved, &noise))
        })
        .collect();
    let factors = factors(&parts, k);
    let zero = || DMatrix::<f64>::zeros(k, k);
    let mut information = parts.iter().fold(zero(), |sum, part| sum + &part.information);
    let spread = parts.iter().fold(zero(), |sum, part| sum + &part.spread);
    if let Some(noise) = solved.noise_of_columns {
        information -= noise;
    }
    let inverse = if same { inverse(&information)? } else { information.try_inverse()? };
    let all = &inverse * spread * inverse.transpose();
    Some(DMatrix::from_fn(k, k, |i, l| (factors[i] * factors[l]).sqrt() * all[(i, l)]))
}

/// What one motion adds to the information and to the spread of the scores; `rows` are the series of its equations, each
/// with that of the instruments.
fn of_motion(rows: &[(&Series, &Series)], solved: &Solved<'_>, noise: &Noise) -> MotionPart {
    let k = solved.unknowns.len();
    let mut part = MotionPart {
        information: DMatrix::zeros(k, k),
        spread: DMatrix::zeros(k, k),
        right: DVector::zeros(k),
    };
    let mut innovations = Vec::with_capacity(rows.len());
    for &(w, z) in rows {
        let weight = (solved.errors[w.group] / solved.weights[w.group]).powi(2);
        add(&mut part.information, &z.places, &w.places, &(weight * (z.w.transpose() * &w.w)));
        for (column, &place) in z.w.column_iter().zip(&z.places) {
            part.right[place] += weight * column.iter().zip(&w.y).map(|(z, y)| z * y).sum::<f64>();
        }
        innovations.push(Innovations::of(w, z, weight, solved, noise));
    }
    for (l, x) in innovations.iter().enumerate() {
        for (m, y) in innovations[..=l].iter().enumerate() {
            let correlation = noise.correlation[(x.equation, y.equation)];
            if correlation == 0.0 {
                continue;
            }
            // They end at the same time.
            let last = x.weights.nrows().min(y.weights.nrows());
            let end = |i: &Innovations<'_>| i.weights.rows(i.weights.nrows() - last, last).into_owned();
            let product = correlation * (end(x).transpose() * end(y));
            add(&mut part.spread, x.places, y.places, &product);
            if m != l {
                add(&mut part.spread, y.places, x.places, &product.transpose());
            }
        }
    }
    part
}

/// What each innovation of an equation's noise weighs in its scores.
struct Innovations<'a> {
    equation: usize,
    /// The unknowns of the columns of `weights`.
    places: &'a [usize],
    weights: DMatrix<f64>,
}

impl<'a> Innovations<'a> {
    fn of(w: &Series, z: &'a Series, weight: f64, solved: &Solved<'_>, noise: &Noise) -> Self {
        let model = &noise.equations[w.equation];
        let before = model.memory(LONGEST_MEMORY);
        let mut weights = DMatrix::zeros(z.w.nrows() + before, z.places.len());
        for (column, mut out) in z.w.column_iter().zip(weights.column_iter_mut()) {
            let column: Vec<f64> = column.iter().map(|x| weight * x).collect();
            out.copy_from(&DVector::from_vec(model.weights_of_innovations(&column, before)));
        }
        // The noise of a power is that of the torques times the speeds.
        if solved.observation.equations != Equations::Torque {
            for (t, square) in noise.own_squares(w).into_iter().enumerate() {
                weights.row_mut(before + t).scale_mut(square.sqrt());
            }
        }
        Self { equation: w.equation, places: &z.places, weights }
    }
}

fn add(to: &mut DMatrix<f64>, rows: &[usize], columns: &[usize], part: &DMatrix<f64>) {
    for (a, &i) in rows.iter().enumerate() {
        for (b, &j) in columns.iter().enumerate() {
            to[(i, j)] += part[(a, b)];
        }
    }
}
