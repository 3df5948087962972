//! A residual that single instants cannot pull, and its squares per instant.

use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::gram::dot;
use crate::diagnosis::rules::{
    JOINT_PUSHED, LEAST_ROBUST_SIGMA, LEAST_SIGMA, ROBUST_RIDGE, ROBUST_ROUNDS, ROBUST_SCALE, SIGMA_PER_MAD,
};
use nalgebra::{DMatrix, DVector};
use std::collections::BTreeMap;

/// Residual of every row, and its standard deviation per joint.
pub(in crate::diagnosis) struct RobustResidual {
    pub residual: Vec<f64>,
    pub sigma: Vec<f64>,
}

/// Squares of an instant.
#[derive(Debug, Clone, Copy, Default)]
pub(in crate::diagnosis) struct Energy {
    /// In units of the noise, all joints.
    pub squares: f64,
    /// Rows of the instant.
    pub rows: usize,
    /// Joints beyond [`JOINT_PUSHED`].
    pub pushed: usize,
}

impl Energy {
    /// Mean square in units of the noise variance.
    pub fn mean(&self) -> f64 {
        self.squares / self.rows as f64
    }
}

/// Energy per signal and centre.
pub(in crate::diagnosis) type Energies = BTreeMap<(usize, usize), Energy>;

/// Energy of every instant of a residual.
pub(in crate::diagnosis) fn energies(design: &Design, residual: &[f64], sigma: &[f64]) -> Energies {
    let mut energies = Energies::new();
    for (j, s) in sigma.iter().enumerate() {
        for r in design.of_joint(j) {
            let e = (residual[r] / s).powi(2);
            let at = energies.entry((design.rows[r].signal, design.rows[r].centre)).or_default();
            at.squares += e;
            at.rows += 1;
            at.pushed += usize::from(e > JOINT_PUSHED * JOINT_PUSHED);
        }
    }
    energies
}

impl RobustResidual {
    /// Of iterated fits with weights of Cauchy's kind, shared by all joints at an instant, and standard deviations from
    /// the median absolute deviation.
    pub fn of(design: &Design) -> Self {
        let mut weight = vec![1.0; design.rows.len()];
        let mut out = Self { residual: design.y.clone(), sigma: vec![1.0; design.joints] };
        let scales: Vec<f64> = design
            .columns
            .iter()
            .map(|c| 1.0 / c.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-300))
            .collect();
        for round in 0..ROBUST_ROUNDS {
            let Some(chi) = out.fit(design, &scales, &weight) else { break };
            out.residual.copy_from_slice(&design.y);
            for (k, column) in design.columns.iter().enumerate() {
                let x = chi[k] * scales[k];
                for (r, c) in out.residual.iter_mut().zip(column) {
                    *r -= c * x;
                }
            }
            out.update_sigma(design);
            if round + 1 < ROBUST_ROUNDS {
                let energies = energies(design, &out.residual, &out.sigma);
                for (weight, at) in weight.iter_mut().zip(&design.rows) {
                    let energy = energies.get(&(at.signal, at.centre)).copied().unwrap_or_default();
                    *weight = 1.0 / (1.0 + energy.mean() / ROBUST_SCALE);
                }
            }
        }
        out
    }

    /// Weighted least squares over the scaled columns.
    fn fit(&self, design: &Design, scales: &[f64], weight: &[f64]) -> Option<DVector<f64>> {
        let p = design.columns.len();
        let mut rows: Vec<f64> = weight.to_vec();
        for j in 0..design.joints {
            for r in design.of_joint(j) {
                rows[r] /= self.sigma[j] * self.sigma[j];
            }
        }
        let weighted: Vec<Vec<f64>> = design
            .columns
            .iter()
            .zip(scales)
            .map(|(c, s)| c.iter().zip(&rows).map(|(x, w)| x * s * w).collect())
            .collect();
        let mut g = DMatrix::<f64>::zeros(p, p);
        let mut b = DVector::<f64>::zeros(p);
        for j in 0..design.joints {
            let range = design.of_joint(j);
            let column = |k: usize| &design.columns[k][range.clone()];
            let live: Vec<usize> = (0..p).filter(|&k| column(k).iter().any(|&x| x != 0.0)).collect();
            for &i in &live {
                let own = &weighted[i][range.clone()];
                b[i] += dot(own, &design.y[range.clone()]);
                for &k in live.iter().take_while(|&&k| k <= i) {
                    let v = scales[k] * dot(own, column(k));
                    g[(i, k)] += v;
                    if i != k {
                        g[(k, i)] += v;
                    }
                }
            }
        }
        let trace = g.trace().max(1e-300) / p.max(1) as f64;
        for k in 0..p {
            g[(k, k)] += ROBUST_RIDGE * trace + if g[(k, k)] == 0.0 { 1.0 } else { 0.0 };
        }
        Some(g.cholesky()?.solve(&b))
    }

    fn update_sigma(&mut self, design: &Design) {
        for j in 0..design.joints {
            let range = design.of_joint(j);
            let mut absolute: Vec<f64> = self.residual[range.clone()].iter().map(|x| x.abs()).collect();
            absolute.sort_by(f64::total_cmp);
            let largest = range.map(|r| design.torque(r).abs()).fold(0.0_f64, f64::max);
            let mad = SIGMA_PER_MAD * absolute.get(absolute.len() / 2).copied().unwrap_or(1.0);
            self.sigma[j] = mad.max(LEAST_ROBUST_SIGMA * largest).max(LEAST_SIGMA);
        }
    }
}
