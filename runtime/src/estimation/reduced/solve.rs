//! The parameters of weighted triangles.

use nalgebra::DMatrix;

use super::Reduced;
use crate::estimation::attenuation::given_back;
use crate::estimation::outcome::ParameterEstimate;
use crate::estimation::solve::inverse_gram;

/// What weighted triangles say of the parameters.
#[derive(Debug, Clone, PartialEq)]
pub struct ReducedEstimate {
    /// One for each parameter of the robot, zero and without a standard deviation where it is not determined.
    pub parameters: Vec<ParameterEstimate>,
    /// Covariance of all parameters: errors that go together as independent ones do, with the standard deviations of
    /// `parameters`. Rows of what is not determined are zero.
    pub covariance: DMatrix<f64>,
    /// ||Y - W chi|| of the rows divided by their standard deviations.
    pub residual_norm: f64,
    /// Rows less parameters.
    pub degrees_of_freedom: usize,
    /// Mean over the parameters of what errors that last multiply their variances by.
    pub inflation: f64,
}

impl ReducedEstimate {
    /// The parameters as a vector.
    pub fn chi(&self) -> Vec<f64> {
        self.parameters.iter().map(|p| p.value).collect()
    }
}

impl Reduced {
    /// The weighted least-squares parameters, corrected for noise in the columns where it is known and does not drown
    /// the motion, with standard deviations for errors that last.
    pub fn solve(&self) -> ReducedEstimate {
        let active = self.factor.solve().kept;
        let rows = self.factor.select(&active);
        let solution = rows.solve();
        let of_active = |noise: &DMatrix<f64>| noise.select_rows(&active).select_columns(&active);
        let corrected =
            self.noise.as_ref().and_then(|noise| given_back(of_active(noise), &rows, &solution.chi));
        let chi = corrected.as_ref().map_or(&solution.chi, |c| &c.chi);
        let residual_norm = rows.residual_norm(chi);
        let variance = residual_norm.powi(2) / solution.degrees_of_freedom.max(1) as f64;
        let mut parameters: Vec<ParameterEstimate> =
            self.parameters.iter().map(|(name, _)| ParameterEstimate::undetermined(name)).collect();
        for &(l, value) in &self.fixed {
            parameters[l] = ParameterEstimate::known(&self.parameters[l].0, value);
        }
        let mut inflations = Vec::new();
        for (place, &l) in active.iter().enumerate() {
            let inflation = self.inflation(l);
            inflations.push(inflation);
            let white = (variance * solution.variance[place]).sqrt();
            let correction = corrected.as_ref().map(|c| c.missing[place]);
            let of_correction = corrected.as_ref().map_or(0.0, |c| c.deviation[place]);
            let sigma = (white * inflation.sqrt()).hypot(of_correction);
            let value = chi[place];
            parameters[l] = ParameterEstimate {
                value,
                sigma: Some(sigma),
                sigma_white: Some(white),
                correction,
                relative_sigma_percent: Some(100.0 * sigma / value.abs()).filter(|r| r.is_finite()),
                ..ParameterEstimate::undetermined(&parameters[l].name)
            };
        }
        let covariance = covariance(&parameters, &active, &inverse_gram(&rows));
        let inflation = inflations.iter().sum::<f64>() / inflations.len().max(1) as f64;
        let degrees_of_freedom = solution.degrees_of_freedom;
        ReducedEstimate { parameters, covariance, residual_norm, degrees_of_freedom, inflation }
    }

    /// What errors that last multiply the variance of a parameter by, over the rows of which it is known.
    fn inflation(&self, l: usize) -> f64 {
        if self.known[l] > 0.0 { self.inflation[l] / self.known[l] } else { 1.0 }
    }
}

/// Errors that go together as `together`, each with the standard deviation that is told.
fn covariance(parameters: &[ParameterEstimate], active: &[usize], together: &DMatrix<f64>) -> DMatrix<f64> {
    let scale = |p: usize| {
        let own = together[(p, p)].sqrt();
        if own > 0.0 { parameters[active[p]].sigma.unwrap_or(0.0) / own } else { 0.0 }
    };
    let scale: Vec<f64> = (0..active.len()).map(scale).collect();
    let mut covariance = DMatrix::zeros(parameters.len(), parameters.len());
    for (a, &i) in active.iter().enumerate() {
        for (b, &l) in active.iter().enumerate() {
            covariance[(i, l)] = together[(a, b)] * scale[a] * scale[b];
        }
    }
    covariance
}
