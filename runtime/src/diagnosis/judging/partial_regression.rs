//! Partial regression (Frisch and Waugh 1933, Lovell 1963): what a trial's columns add to the columns of a design.
//!
//! The amplitudes of a trial Z beside the columns W are those of a regression on M Z with M = I - W (Wᵀ W)⁻¹ Wᵀ: Z
//! without what W makes of it. M Z itself is never formed; Gram matrices are enough.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::candidates::trial::Trial;
use crate::diagnosis::judging::regression::Regression;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::fit::Fit;
use crate::diagnosis::rows::gram::dot;
use crate::diagnosis::rules::{AMPLITUDE_RIDGE, OWN_FRACTION};
use nalgebra::{DMatrix, DVector};

/// A trial with the columns of a design projected out.
pub(in crate::diagnosis) struct Residualised {
    /// (Wᵀ W)⁻¹ Wᵀ Z: what the design's columns make of each of the trial's.
    pub coefficients: DMatrix<f64>,
    /// Zᵀ M Z; zero rows and columns where the design makes a column itself.
    squares: DMatrix<f64>,
    /// Zᵀ M y.
    with_residual: DVector<f64>,
}

/// Columns of k that must have a part of their own. Of the ten columns of a body the standard model makes some, of the
/// three of a rotor at times its inertia: the others still count. A wave of which only the sine can be seen is none.
fn columns_needed(k: usize) -> usize {
    match k {
        0..3 => k,
        3..10 => k - 1,
        _ => 1,
    }
}

impl Fit {
    /// Projects the columns of the design out of a trial, on the segments of this fit with its weights. `None` where
    /// the design makes the trial's columns itself.
    pub fn project_out(&self, trial: &Trial) -> Option<Residualised> {
        let (p, k) = (self.chi.len(), trial.columns.len());
        let (mut z, mut c, mut y) = (DMatrix::zeros(p, k), DMatrix::zeros(k, k), DVector::zeros(k));
        for (products, s) in trial.products.iter().zip(&self.sigma) {
            let w = 1.0 / (s * s);
            for (g, product) in products.iter().enumerate() {
                if self.train[g] {
                    z += w * &product.with;
                    c += w * &product.own;
                    for a in 0..k {
                        y[a] += w * product.y[a];
                    }
                }
            }
        }
        let mut x = DMatrix::zeros(p, k);
        for a in 0..k {
            x.set_column(a, &self.solve(&z.column(a).into_owned()));
        }
        let mut s = &c - z.transpose() * &x;
        let mut b = y - z.transpose() * &self.chi;
        let alive = (0..k).filter(|&a| c[(a, a)] > 0.0).count();
        let own: Vec<bool> =
            (0..k).map(|a| c[(a, a)] > 0.0 && s[(a, a)] > OWN_FRACTION * c[(a, a)]).collect();
        for a in (0..k).filter(|&a| !own[a]) {
            s.row_mut(a).fill(0.0);
            s.column_mut(a).fill(0.0);
            b[a] = 0.0;
        }
        let determined = own.iter().filter(|own| **own).count();
        (alive > 0 && determined >= columns_needed(k)).then_some(Residualised {
            coefficients: x,
            squares: s,
            with_residual: b,
        })
    }
}

impl Residualised {
    /// M Z on all rows.
    pub fn columns(&self, design: &Design, trial: &Trial) -> Vec<Vec<f64>> {
        let mut columns = trial.dense(design);
        for (k, column) in columns.iter_mut().enumerate() {
            let coefficients = self.coefficients.column(k);
            for (made, &x) in design.columns.iter().zip(coefficients.iter()).filter(|(_, x)| **x != 0.0) {
                column.iter_mut().zip(made).for_each(|(c, m)| *c -= x * m);
            }
        }
        columns
    }

    /// Columns that have a part of their own.
    pub fn determined(&self) -> Vec<usize> {
        (0..self.with_residual.len()).filter(|&k| self.squares[(k, k)] > 0.0).collect()
    }

    /// Amplitudes and in-sample gain; `None` where an amplitude has a sign that the law does not have.
    pub fn solve(&self, candidate: &Candidate) -> Option<(DVector<f64>, f64)> {
        let (s, b) = (&self.squares, &self.with_residual);
        if let Some(value) = candidate.fixed {
            let a = DVector::from_element(b.len(), value);
            let gain = self.gain(&a);
            return Some((a, gain));
        }
        let k = b.len();
        let scale = DVector::from_fn(k, |i, _| if s[(i, i)] > 0.0 { 1.0 / s[(i, i)].sqrt() } else { 0.0 });
        let m = DMatrix::from_fn(k, k, |i, j| {
            s[(i, j)] * scale[i] * scale[j] + if i == j { AMPLITUDE_RIDGE } else { 0.0 }
        });
        let a = m.cholesky()?.solve(&b.component_mul(&scale)).component_mul(&scale);
        if candidate.only_positive && a.iter().any(|x| *x < 0.0) {
            return None;
        }
        let gain = self.gain(&a);
        Some((a, gain))
    }

    /// Squares of the residual that amplitudes take away.
    fn gain(&self, a: &DVector<f64>) -> f64 {
        2.0 * a.dot(&self.with_residual) - a.dot(&(&self.squares * a))
    }
}

impl Regression {
    /// In-sample gain of a trial of a candidate over all motion; negative infinity where it has none.
    fn gain_of(&self, candidate: &Candidate, trial: &Trial) -> f64 {
        self.fit
            .project_out(trial)
            .and_then(|part| part.solve(candidate))
            .map_or(f64::NEG_INFINITY, |(_, gain)| gain)
    }

    /// In-sample gain of a candidate's first shape over all motion; negative infinity where it has none.
    pub fn whole_gain(&self, candidate: &Candidate) -> f64 {
        candidate.trials.first().map_or(f64::NEG_INFINITY, |trial| self.gain_of(candidate, trial))
    }

    /// Whether the motion determines a candidate beside the design's columns.
    pub fn is_identifiable(&self, candidate: &Candidate) -> bool {
        candidate.trials.iter().any(|trial| self.fit.project_out(trial).is_some())
    }

    /// The shape with the largest in-sample gain over all motion, however small.
    pub fn best_trial(&self, candidate: &Candidate) -> Option<usize> {
        let gains = candidate.trials.iter().map(|trial| self.gain_of(candidate, trial));
        gains.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
    }

    /// A trial that was residualised over all motion, its inner products on some segments only.
    pub fn restricted(&self, whole: &Residualised, trial: &Trial, segments: &[bool]) -> Residualised {
        let (x, chi) = (&whole.coefficients, &self.fit.chi);
        let (p, k) = (self.design.columns.len(), trial.columns.len());
        let (mut s, mut b) = (DMatrix::zeros(k, k), DVector::zeros(k));
        for (j, sd) in self.sigma.iter().enumerate() {
            let w = 1.0 / (sd * sd);
            for g in (0..segments.len()).filter(|&g| segments[g]) {
                let gram = self.design.gram(j, g);
                for i in (0..p).filter(|&i| gram.squares(i) > 0.0) {
                    let row = gram.row(i);
                    let residual = gram.with_y(i) - dot(row, chi.as_slice());
                    for c in 0..k {
                        let made = dot(row, &x.as_slice()[c * p..(c + 1) * p]);
                        for a in 0..k {
                            s[(a, c)] += w * x[(i, a)] * made;
                        }
                        b[c] -= w * x[(i, c)] * residual;
                    }
                }
                if let Some(product) = trial.products.get(j).and_then(|of_joint| of_joint.get(g)) {
                    let cross = product.with.transpose() * x;
                    s += w * (&product.own - &cross - cross.transpose());
                    b += w * (DVector::from_column_slice(&product.y) - product.with.transpose() * chi);
                }
            }
        }
        Residualised { coefficients: x.clone(), squares: s, with_residual: b }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::judging::prediction::Prediction;
    use crate::effects::{EffectKind, Place};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    const JOINTS: usize = 2;
    const ROWS: usize = 30;
    const SEGMENTS: [(usize, bool); 3] = [(0, true), (1, true), (2, true)];
    const ALL: usize = JOINTS * SEGMENTS.len() * ROWS;

    /// A random regression with four columns, and a candidate with two more, both on both joints.
    fn random(seed: u64) -> (Regression, Candidate) {
        let mut rng = Pcg64::seed_from_u64(seed);
        let mut series =
            |scale: f64| -> Vec<f64> { (0..ALL).map(|_| scale * rng.random_range(-1.0..1.0)).collect() };
        let columns: Vec<Vec<f64>> = (0..4).map(|_| series(1.0)).collect();
        // What the candidate shares with the columns is what partial regression must take out.
        let own: Vec<Vec<f64>> = (0..2)
            .map(|k| series(0.7).iter().zip(&columns[k]).map(|(own, shared)| own + 1.5 * shared).collect())
            .collect();
        let mut y = series(0.3);
        for r in 0..ALL {
            y[r] += 2.0 * columns[0][r] - columns[3][r] + 0.8 * own[0][r] - 0.4 * own[1][r];
        }
        let design = Design::made_up(JOINTS, &SEGMENTS, ROWS, columns, y);
        let regression = Regression::new(design, Vec::new()).unwrap();
        let half = ALL / JOINTS;
        let sparse =
            own.iter().map(|c| (0..JOINTS).map(|j| (j, c[j * half..(j + 1) * half].to_vec())).collect());
        let trial = Trial::new(&regression.design, vec![1.0], sparse.collect());
        let candidate = Candidate {
            effect: EffectKind::Spring,
            place: Place::Joint(0),
            own: vec![0, 1],
            trials: vec![trial],
            shapes: 1,
            fixed: None,
            only_positive: false,
        };
        (regression, candidate)
    }

    /// Weighted least squares over the rows of some segments: the solution and its squares.
    fn explicit(
        regression: &Regression,
        columns: &[Vec<f64>],
        y: &[f64],
        segments: &[bool],
    ) -> (DVector<f64>, f64) {
        let design = &regression.design;
        let rows: Vec<(usize, f64)> = (0..JOINTS)
            .flat_map(|j| {
                let weight = 1.0 / regression.sigma[j];
                let ranges = (0..segments.len()).filter(|&g| segments[g]).map(move |g| (j, g));
                ranges
                    .flat_map(|(j, g)| design.ranges[j][g].clone())
                    .map(move |r| (r, weight))
                    .collect::<Vec<_>>()
            })
            .collect();
        let w = DMatrix::from_fn(rows.len(), columns.len(), |i, k| rows[i].1 * columns[k][rows[i].0]);
        let b = DVector::from_fn(rows.len(), |i, _| rows[i].1 * y[rows[i].0]);
        let x = w.clone().svd(true, true).solve(&b, 1e-14).unwrap();
        let left = (b - w * &x).norm_squared();
        (x, left)
    }

    #[test]
    fn amplitudes_and_gain_are_those_of_one_regression_on_all_columns() {
        for seed in 0..5 {
            let (regression, candidate) = random(seed);
            let (design, trial) = (&regression.design, &candidate.trials[0]);
            let everything = [true; 3];
            let mut columns = design.columns.clone();
            let (_, before) = explicit(&regression, &columns, &design.y, &everything);
            columns.extend(trial.dense(design));
            let (expected, after) = explicit(&regression, &columns, &design.y, &everything);

            let part = regression.fit.project_out(trial).unwrap();
            let (amplitude, gain) = part.solve(&candidate).unwrap();
            let shift = -(&part.coefficients * &amplitude);
            for k in 0..2 {
                assert!((amplitude[k] - expected[4 + k]).abs() < 1e-5, "{seed}: {amplitude} {expected}");
            }
            for k in 0..4 {
                assert!((regression.fit.chi[k] + shift[k] - expected[k]).abs() < 1e-5);
            }
            assert!((gain - (before - after)).abs() < 1e-4 * gain, "{seed}: {gain} {}", before - after);
        }
    }

    #[test]
    fn a_prediction_gains_what_the_squares_of_the_held_out_rows_fall_by() {
        let (regression, candidate) = random(7);
        let (design, trial) = (&regression.design, &candidate.trials[0]);
        let train = [true, true, false];
        let fit = Fit::new(design, &regression.sigma, train.to_vec()).unwrap();
        let part = fit.project_out(trial).unwrap();
        let (amplitude, _) = part.solve(&candidate).unwrap();
        let prediction = Prediction::new(&fit, trial, &part, amplitude);

        let mut columns = design.columns.clone();
        let (without, _) = explicit(&regression, &columns, &design.y, &train);
        columns.extend(trial.dense(design));
        let (with, _) = explicit(&regression, &columns, &design.y, &train);
        for j in 0..JOINTS {
            let left = |x: &DVector<f64>| -> f64 {
                let fitted = |r: usize| (0..x.len()).map(|k| x[k] * columns[k][r]).sum::<f64>();
                design.ranges[j][2].clone().map(|r| (design.y[r] - fitted(r)).powi(2)).sum()
            };
            let expected = left(&without) - left(&with);
            let gain = prediction.gain(design, j, 2);
            assert!((gain - expected).abs() < 1e-4 * expected.abs(), "{gain} {expected}");
        }
    }

    #[test]
    fn on_some_segments_only_the_amplitude_is_fitted() {
        let (regression, candidate) = random(8);
        let (design, trial) = (&regression.design, &candidate.trials[0]);
        let whole = regression.fit.project_out(trial).unwrap();
        let train = [true, false, true];
        let (amplitude, _) = regression.restricted(&whole, trial, &train).solve(&candidate).unwrap();
        let columns = whole.columns(design, trial);
        let (expected, _) = explicit(&regression, &columns, &regression.residual(), &train);
        assert!((amplitude - expected).norm() < 1e-5);
    }

    #[test]
    fn what_the_columns_make_themselves_is_not_identifiable() {
        let (regression, mut candidate) = random(9);
        let design = &regression.design;
        let half = ALL / JOINTS;
        let made: Vec<f64> = (0..ALL).map(|r| design.columns[0][r] - 3.0 * design.columns[2][r]).collect();
        let sparse = (0..JOINTS).map(|j| (j, made[j * half..(j + 1) * half].to_vec())).collect();
        candidate.trials = vec![Trial::new(design, vec![1.0], vec![sparse])];
        assert!(!regression.is_identifiable(&candidate));
        assert_eq!(regression.whole_gain(&candidate), f64::NEG_INFINITY);
        assert!(regression.judge(&candidate).is_none());
    }

    #[test]
    fn a_real_candidate_holds_on_held_out_motion() {
        let (regression, candidate) = random(10);
        let verdict = regression.judge(&candidate).unwrap();
        assert_eq!(verdict.held_out.len(), SEGMENTS.len());
        assert!(verdict.held_out.iter().all(|gain| *gain > 0.0), "{verdict:?}");
        assert!(verdict.explained_fraction > 0.3 && verdict.explained_fraction < 1.0, "{verdict:?}");
    }
}
