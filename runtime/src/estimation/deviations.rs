//! The standard deviations of an estimate, and its parameters with them. Equation numbers are those of Gautier and Briot.

use super::attenuation::Attenuation;
use super::observe::Observation;
use super::outcome::ParameterEstimate;
use super::uncertainty::{Solved, covariance};
use super::weights::{Weights, from_own_fits, iterate};
use nalgebra::DMatrix;

/// Standard deviations of the parameters that were solved for.
pub(super) struct Deviations {
    /// Whether they mean anything.
    pub known: bool,
    /// For noise that is independent from row to row.
    pub white: Vec<f64>,
    /// By leaving out blocks of time.
    pub blocks: Option<Vec<f64>>,
    /// For noise that lasts as the residuals show it.
    pub lasting: Option<Vec<f64>>,
    /// How the errors go together: a covariance, whatever its scale.
    pub together: DMatrix<f64>,
    /// What was added for noise in the columns.
    pub attenuation: Option<Attenuation>,
}

impl Deviations {
    /// The one that claims least about the noise: that of noise that lasts, by blocks where the rows were not kept; with
    /// that of the correction.
    fn headline(&self, place: usize) -> f64 {
        let of = |all: &Option<Vec<f64>>| all.as_ref().map(|all| all[place]);
        let noise = of(&self.lasting).or(of(&self.blocks)).unwrap_or(self.white[place]);
        noise.hypot(self.attenuation.as_ref().map_or(0.0, |a| a.deviation[place]))
    }

    /// By how much that is more than for noise that is independent from row to row.
    pub fn inflation(&self, place: usize) -> f64 {
        let ratio = self.headline(place) / self.white[place];
        if ratio.is_finite() && ratio > 0.0 { ratio } else { 1.0 }
    }
}

/// Upper triangle, row by row, of the covariance of so many unknowns, of which these are `active`: errors that go together
/// as they do, each with the standard deviation that is told.
pub(super) fn upper_covariance(
    unknowns: usize,
    active: &[usize],
    deviations: &Deviations,
) -> Option<Vec<f64>> {
    let of = &deviations.together;
    if !deviations.known || of.nrows() != active.len() {
        return None;
    }
    let factor: Vec<f64> = (0..active.len()).map(|p| deviations.headline(p) / of[(p, p)].sqrt()).collect();
    let place = |l: usize| active.binary_search(&l).ok();
    let entry = |i: usize, l: usize| match (place(i), place(l)) {
        (Some(a), Some(b)) => of[(a, b)] * factor[a] * factor[b],
        _ => 0.0,
    };
    let upper: Vec<f64> =
        (0..unknowns).flat_map(|i| (i..unknowns).map(move |l| entry(i, l)).collect::<Vec<_>>()).collect();
    upper.iter().all(|x| x.is_finite()).then_some(upper)
}

/// All unknowns of an observation; those that are not `active` are zero and without deviations, or
/// have their known value.
pub(super) fn described(
    observation: &Observation,
    active: &[usize],
    chi: &[f64],
    deviations: &Deviations,
) -> Vec<ParameterEstimate> {
    let undetermined = observation.unknowns.iter().map(|name| ParameterEstimate::undetermined(name));
    let mut parameters: Vec<ParameterEstimate> = undetermined.collect();
    for &(l, value) in &observation.fixed {
        parameters[l] = ParameterEstimate::known(&observation.unknowns[l], value);
    }
    for (place, &l) in active.iter().enumerate() {
        let parameter = &mut parameters[l];
        parameter.value = chi[place];
        parameter.correction = deviations.attenuation.as_ref().map(|a| a.missing[place]);
        if !deviations.known {
            continue;
        }
        let sigma = deviations.headline(place);
        parameter.sigma = Some(sigma);
        parameter.sigma_white = Some(deviations.white[place]);
        parameter.sigma_blocks = deviations.blocks.as_ref().map(|s| s[place]);
        parameter.relative_sigma_percent = Some(100.0 * sigma / chi[place].abs()).filter(|r| r.is_finite());
    }
    parameters
}

/// Covariance for noise that lasts as the residuals show it; `None` where the rows were not kept.
pub(super) fn lasting_deviations(
    counted: &Observation,
    active: &[usize],
    weights: &Weights,
    weighted: bool,
    attenuation: Option<&Attenuation>,
) -> Option<DMatrix<f64>> {
    counted.rows.as_ref()?;
    // Equal weights are not those of the noise.
    let own = (!weighted).then(|| iterate(counted, active, &from_own_fits(counted)));
    let solved = Solved {
        observation: counted,
        unknowns: active,
        instruments: active,
        noise_of_columns: attenuation.map(|a| &a.of_information),
        weights: &weights.sigma,
        errors: own.as_ref().map_or(&weights.sigma, |own| &own.sigma),
    };
    covariance(&solved).filter(|all| all.diagonal().iter().all(|v| v.is_finite() && *v >= 0.0))
}
