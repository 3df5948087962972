//! How good a candidate is on motion that it was not fitted to.

use super::candidate::{Candidate, Trial};
use super::design::{Design, dot};
use super::fit::Fit;
use super::held_back::cuts;
use nalgebra::{DMatrix, DVector};

/// Motion that is fitted and motion that is predicted.
pub(super) struct Fold {
    pub train: Vec<bool>,
    pub test: Vec<bool>,
    pub fit: Fit,
}

/// The verdict on a candidate.
#[derive(Debug, Clone)]
pub(super) struct Verdict {
    /// Index of the best shape over all motion.
    pub trial: usize,
    /// In sample, in units of the noise variance.
    pub gain: f64,
    /// Held out, in units of the noise variance, one value per fold.
    pub held_out: Vec<f64>,
    /// Held-out gain as a share of the held-out squares of its own joints.
    pub share: f64,
    /// In-sample gain as a share of the squares of its own joints.
    pub fitted_share: f64,
}

impl Verdict {
    /// Held-out gain of all folds.
    pub fn total(&self) -> f64 {
        self.held_out.iter().sum()
    }
}

/// How the recording is split: every motion once held back, or, for a single motion, every stretch of it.
pub(super) fn folds(design: &Design, sigma: &[f64]) -> Vec<Fold> {
    let fresh: Vec<usize> = (0..design.segments.len()).filter(|&g| design.segments[g].fresh).collect();
    fresh
        .iter()
        .map(|&held| {
            let test: Vec<bool> = (0..design.segments.len()).map(|g| g == held).collect();
            let train: Vec<bool> = test.iter().map(|t| !t).collect();
            let fit = Fit::new(design, sigma, |g| train[g]);
            Fold { train, test, fit }
        })
        .collect()
}

/// The candidate's part that the columns of the design cannot make: its squares and its product with the residual.
pub(super) struct Own {
    pub x: DMatrix<f64>,
    s: DMatrix<f64>,
    b: DVector<f64>,
}

/// What one more number must gain to be worth it, in units of the noise variance (Akaike 1974).
const NUMBER: f64 = 2.0;
/// Least part of a column that is its own: below it, the design makes the column itself.
const OWN_PART: f64 = 2e-4;

pub(super) fn own_part(
    design: &Design,
    fit: &Fit,
    sigma: &[f64],
    trial: &Trial,
    train: &[bool],
) -> Option<Own> {
    let (p, k) = (design.columns.len(), trial.columns.len());
    let (mut z, mut c, mut y) = (DMatrix::zeros(p, k), DMatrix::zeros(k, k), DVector::zeros(k));
    for (products, s) in trial.products.iter().zip(sigma) {
        let w = 1.0 / (s * s);
        for (g, product) in products.iter().enumerate() {
            if train[g] {
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
        x.set_column(a, &fit.solve(&z.column(a).into_owned()));
    }
    let mut s = &c - z.transpose() * &x;
    let mut b = y - z.transpose() * &fit.chi;
    let alive = (0..k).filter(|&a| c[(a, a)] > 0.0).count();
    let own: Vec<bool> = (0..k).map(|a| c[(a, a)] > 0.0 && s[(a, a)] > OWN_PART * c[(a, a)]).collect();
    for a in (0..k).filter(|&a| !own[a]) {
        s.row_mut(a).fill(0.0);
        s.column_mut(a).fill(0.0);
        b[a] = 0.0;
    }
    let determined = own.iter().filter(|own| **own).count();
    // Of the ten columns of a body the standard model makes some, of the three of a rotor at times its inertia:
    // the others still count. A wave of which only the sine can be seen is none.
    let needed = match k {
        0..3 => k,
        3..10 => k - 1,
        _ => 1,
    };
    (alive > 0 && determined >= needed).then_some(Own { x, s, b })
}

impl Own {
    /// The columns without what the design's columns make of them, on all rows.
    pub fn columns(&self, design: &Design, trial: &Trial) -> Vec<Vec<f64>> {
        let mut columns = trial.dense(design);
        for (k, column) in columns.iter_mut().enumerate() {
            for (made, &x) in design.columns.iter().zip(self.x.column(k).iter()).filter(|(_, x)| **x != 0.0) {
                column.iter_mut().zip(made).for_each(|(c, m)| *c -= x * m);
            }
        }
        columns
    }

    /// Columns that have a part of their own.
    pub fn determined(&self) -> Vec<usize> {
        (0..self.b.len()).filter(|&k| self.s[(k, k)] > 0.0).collect()
    }

    /// Amplitudes and in-sample gain.
    pub fn solve(&self, candidate: &Candidate) -> Option<(DVector<f64>, f64)> {
        if let Some(value) = candidate.fixed {
            let a = DVector::from_element(self.b.len(), value);
            let gain = 2.0 * a.dot(&self.b) - a.dot(&(&self.s * &a));
            return Some((a, gain));
        }
        let k = self.b.len();
        let scale =
            DVector::from_fn(k, |i, _| if self.s[(i, i)] > 0.0 { 1.0 / self.s[(i, i)].sqrt() } else { 0.0 });
        let m = DMatrix::from_fn(k, k, |i, j| {
            self.s[(i, j)] * scale[i] * scale[j] + if i == j { 1e-7 } else { 0.0 }
        });
        let a = m.cholesky()?.solve(&self.b.component_mul(&scale)).component_mul(&scale);
        if candidate.only_positive && a.iter().any(|x| *x < 0.0) {
            return None;
        }
        let gain = 2.0 * a.dot(&self.b) - a.dot(&(&self.s * &a));
        Some((a, gain))
    }
}

/// In-sample gain of a candidate's first shape over all motion; negative infinity where it has none.
pub(super) fn whole_gain(design: &Design, fit: &Fit, sigma: &[f64], candidate: &Candidate) -> f64 {
    let everything = vec![true; design.segments.len()];
    candidate
        .trials
        .first()
        .and_then(|t| own_part(design, fit, sigma, t, &everything))
        .and_then(|own| own.solve(candidate))
        .map_or(f64::NEG_INFINITY, |(_, gain)| gain)
}

/// Whether the motion determines a candidate beside the design's columns.
pub(super) fn is_shown(design: &Design, fit: &Fit, sigma: &[f64], candidate: &Candidate) -> bool {
    let everything = vec![true; design.segments.len()];
    candidate.trials.iter().any(|t| own_part(design, fit, sigma, t, &everything).is_some())
}

/// The shape with the largest in-sample gain over all motion, however small.
pub(super) fn best_trial(design: &Design, fit: &Fit, sigma: &[f64], candidate: &Candidate) -> Option<usize> {
    let everything = vec![true; design.segments.len()];
    let gains = candidate.trials.iter().map(|t| {
        own_part(design, fit, sigma, t, &everything)
            .and_then(|own| own.solve(candidate))
            .map_or(f64::NEG_INFINITY, |(_, gain)| gain)
    });
    gains.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
}

/// Judges a candidate: the best shape is chosen anew on each fold's own training motion.
pub(super) fn judge(
    design: &Design,
    whole: &Fit,
    folds: &[Fold],
    sigma: &[f64],
    candidate: &Candidate,
) -> Option<Verdict> {
    let everything = vec![true; design.segments.len()];
    let best = |fit: &Fit, train: &[bool]| {
        let mut best: Option<(f64, usize, DVector<f64>, Own)> = None;
        for (k, trial) in candidate.trials.iter().enumerate() {
            let Some(own) = own_part(design, fit, sigma, trial, train) else { continue };
            let Some((a, gain)) = own.solve(candidate) else { continue };
            let worth = |gain: f64, numbers: usize| gain - NUMBER * numbers as f64;
            if best.as_ref().is_none_or(|b| worth(gain, a.len()) > worth(b.0, b.2.len())) {
                best = Some((gain, k, a, own));
            }
        }
        best
    };
    let (gain, trial, _, whole_own) = best(whole, &everything)?;
    if gain <= 0.0 {
        return None;
    }
    let single = single_motion(design);
    let mut held_out = Vec::new();
    let (mut own_gain, mut before) = (0.0, 0.0);
    for fold in folds {
        // Where only one motion is there, refitting all standard parameters to a part of it would drown every
        // candidate in their extrapolation: the candidate's own part is then taken over the whole motion, and only
        // its amplitude is fitted to the rest.
        // A law without free amplitudes has nothing to fit but its shape, which needs all of the motion.
        let (k, a, x) = if candidate.fixed.is_some() && !single {
            let own = own_part(design, &fold.fit, sigma, &candidate.trials[trial], &fold.train)?;
            let (a, _) = own.solve(candidate)?;
            (trial, a, own.x)
        } else if single {
            let own = rest_of_motion(design, whole, sigma, &candidate.trials[trial], &whole_own, &fold.train);
            let (a, _) = own.solve(candidate)?;
            (trial, a, whole_own.x.clone())
        } else {
            let (_, k, a, own) = best(&fold.fit, &fold.train)?;
            (k, a, own.x)
        };
        let fit = if single { whole } else { &fold.fit };
        let d = -(&x * &a);
        let mut sum = 0.0;
        for (j, &s) in sigma.iter().enumerate() {
            let w = 1.0 / (s * s);
            for (g, _) in fold.test.iter().enumerate().filter(|(_, t)| **t) {
                let change = w * change(design, fit, &candidate.trials[k], &a, &d, j, g);
                sum += change;
                if candidate.own.contains(&j) {
                    own_gain += change;
                    before += w * fit.squares(design, j, g);
                }
            }
        }
        held_out.push(sum);
    }
    let share = held_out.iter().sum::<f64>().min(own_gain) / before.max(1e-300);
    // Nobody explains more than there is: the numbers of columns that the design nearly makes itself.
    if share > 1.0 {
        return None;
    }
    let squares = |j: usize| {
        let fresh = (0..design.segments.len()).filter(|&g| design.segments[g].fresh);
        fresh.map(|g| whole.squares(design, j, g)).sum::<f64>() / (sigma[j] * sigma[j])
    };
    let fitted_share = gain / candidate.own.iter().map(|&j| squares(j)).sum::<f64>().max(1e-300);
    Some(Verdict { trial, gain, held_out, share, fitted_share })
}

/// Whether all segments are stretches of one motion.
pub(super) fn single_motion(design: &Design) -> bool {
    design.segments.windows(2).all(|s| s[0].signal == s[1].signal)
}

/// Inner products of the candidate's own part (over all motion) on the training segments only.
pub(super) fn rest_of_motion(
    design: &Design,
    whole: &Fit,
    sigma: &[f64],
    trial: &Trial,
    own: &Own,
    train: &[bool],
) -> Own {
    let (p, k) = (design.columns.len(), trial.columns.len());
    let (mut s, mut b) = (DMatrix::zeros(k, k), DVector::zeros(k));
    for (j, sd) in sigma.iter().enumerate() {
        let w = 1.0 / (sd * sd);
        for g in (0..design.segments.len()).filter(|&g| train[g]) {
            let gram = &design.gram[j][g];
            for i in (0..p).filter(|i| gram[i * (p + 1) + i] > 0.0) {
                let row = &gram[i * (p + 1)..i * (p + 1) + p];
                let residual = gram[i * (p + 1) + p] - dot(row, whole.chi.as_slice());
                for c in 0..k {
                    let made = dot(row, &own.x.as_slice()[c * p..(c + 1) * p]);
                    for a in 0..k {
                        s[(a, c)] += w * own.x[(i, a)] * made;
                    }
                    b[c] -= w * own.x[(i, c)] * residual;
                }
            }
            if let Some(product) = trial.products.get(j).and_then(|g_| g_.get(g)) {
                let cross = product.with.transpose() * &own.x;
                s += w * (&product.own - &cross - cross.transpose());
                b += w * (DVector::from_column_slice(&product.y) - product.with.transpose() * &whole.chi);
            }
        }
    }
    Own { x: own.x.clone(), s, b }
}

/// Squares that are gone on one group when the candidate gets amplitude `a` and the parameters move by `d`.
fn change(
    design: &Design,
    fit: &Fit,
    trial: &Trial,
    a: &DVector<f64>,
    d: &DVector<f64>,
    joint: usize,
    segment: usize,
) -> f64 {
    let p = design.columns.len();
    let g = &design.gram[joint][segment];
    let (mut linear, mut square) = (0.0, 0.0);
    for i in 0..p {
        if d[i] == 0.0 {
            continue;
        }
        let row = &g[i * (p + 1)..(i + 1) * (p + 1)];
        let mut fitted = 0.0;
        let mut moved = 0.0;
        for k in 0..p {
            fitted += row[k] * fit.chi[k];
            moved += row[k] * d[k];
        }
        linear += d[i] * (row[p] - fitted);
        square += d[i] * moved;
    }
    if let Some(product) = trial.products.get(joint).and_then(|s| s.get(segment)) {
        for k in 0..a.len() {
            let column = product.with.column(k);
            linear += a[k] * (product.y[k] - column.dot(&fit.chi));
            square += 2.0 * a[k] * column.dot(d);
            for l in 0..a.len() {
                square += a[k] * a[l] * product.own[(k, l)];
            }
        }
    }
    2.0 * linear - square
}

/// Whether a candidate improves later time of a single motion when everything, standard parameters included, is fitted
/// to the time before, on its own joints. (The others see it only through parameters that they share, whose
/// extrapolation from a part of a motion is noise.)
pub(super) fn holds_forward(design: &Design, sigma: &[f64], candidate: &Candidate, trial: usize) -> bool {
    let segments = design.segments.len();
    let mut gain = 0.0;
    for cut in cuts(segments) {
        let train: Vec<bool> = (0..segments).map(|g| g < cut).collect();
        let fit = Fit::new(design, sigma, |g| train[g]);
        let trial = &candidate.trials[trial];
        let Some(part) = own_part(design, &fit, sigma, trial, &train) else { return false };
        let Some((a, _)) = part.solve(candidate) else { return false };
        let d = -(&part.x * &a);
        for &j in &candidate.own {
            let weight = 1.0 / (sigma[j] * sigma[j]);
            for g in cut..segments {
                gain += weight * change(design, &fit, trial, &a, &d, j, g);
            }
        }
    }
    gain > 0.0
}
