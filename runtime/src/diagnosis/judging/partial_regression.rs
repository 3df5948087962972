//! Partial regression (Frisch and Waugh 1933, Lovell 1963): what a trial's columns add to the columns of a design.

use crate::diagnosis::candidates::candidate::Candidate;
use crate::diagnosis::candidates::trial::Trial;
use crate::diagnosis::rows::design::{Design, dot};
use crate::diagnosis::rows::fit::Fit;
use nalgebra::{DMatrix, DVector};

/// The candidate's part that the columns of the design cannot make: its squares and its product with the residual.
pub(in crate::diagnosis) struct Own {
    pub x: DMatrix<f64>,
    s: DMatrix<f64>,
    b: DVector<f64>,
}

/// Least part of a column that is its own: below it, the design makes the column itself.
const OWN_PART: f64 = 2e-4;

pub(in crate::diagnosis) fn own_part(
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
pub(in crate::diagnosis) fn whole_gain(
    design: &Design,
    fit: &Fit,
    sigma: &[f64],
    candidate: &Candidate,
) -> f64 {
    let everything = vec![true; design.segments.len()];
    candidate
        .trials
        .first()
        .and_then(|t| own_part(design, fit, sigma, t, &everything))
        .and_then(|own| own.solve(candidate))
        .map_or(f64::NEG_INFINITY, |(_, gain)| gain)
}

/// Whether the motion determines a candidate beside the design's columns.
pub(in crate::diagnosis) fn is_shown(
    design: &Design,
    fit: &Fit,
    sigma: &[f64],
    candidate: &Candidate,
) -> bool {
    let everything = vec![true; design.segments.len()];
    candidate.trials.iter().any(|t| own_part(design, fit, sigma, t, &everything).is_some())
}

/// The shape with the largest in-sample gain over all motion, however small.
pub(in crate::diagnosis) fn best_trial(
    design: &Design,
    fit: &Fit,
    sigma: &[f64],
    candidate: &Candidate,
) -> Option<usize> {
    let everything = vec![true; design.segments.len()];
    let gains = candidate.trials.iter().map(|t| {
        own_part(design, fit, sigma, t, &everything)
            .and_then(|own| own.solve(candidate))
            .map_or(f64::NEG_INFINITY, |(_, gain)| gain)
    });
    gains.enumerate().max_by(|a, b| a.1.total_cmp(&b.1)).map(|(k, _)| k)
}

/// Inner products of the candidate's own part (over all motion) on the training segments only.
pub(in crate::diagnosis) fn rest_of_motion(
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
pub(in crate::diagnosis) fn change(
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
