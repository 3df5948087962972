//! Essential parameters: the paper's elimination of what the data hardly determine, and the model of what is left.
//! Equation numbers are those of Gautier and Briot.

use super::Factor;
use super::attenuation::corrected;
use super::deviations::{Deviations, described};
use super::observe::Observation;
use super::outcome::{Essential, ParameterEstimate};
use super::residuals::relative_error;
use super::solve::back_substitute;
use super::weights::{Weights, iterate, spread, stack};
use nalgebra::DMatrix;

/// The unknowns that are left, and those that were cancelled in their order.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Elimination {
    pub kept: Vec<usize>,
    pub cancelled: Vec<usize>,
}

/// Largest relative standard deviation with which a parameter stays whatever the smallest is: one that data show to a tenth
/// is no guess. Where friction is known to a few parts in ten thousand, the ratio alone would cancel what is known to a
/// hundredth, and the simplified model would no longer make the torques.
const WELL_KNOWN: f64 = 0.1;

/// Cancels the parameter with the largest relative standard deviation and solves again, until the largest is less
/// than `r_sigma` times the smallest (the paper's V.B, after Gautier 1991 and Pham and Gautier 1991), or below
/// [`WELL_KNOWN`] with the noise that all of them leave.
///
/// `factor` has the unknowns `active`, whose columns are independent; `inflation` is by how much the standard deviation of
/// each is larger than (18) has it.
pub(super) fn eliminate(factor: &Factor, active: &[usize], r_sigma: f64, inflation: &[f64]) -> Elimination {
    let mut kept = active.to_vec();
    let mut cancelled = Vec::new();
    let mut inflation = inflation.to_vec();
    let mut reduced = factor.clone();
    let noise = {
        let (chi, _) = back_substitute(factor);
        factor.residual_norm(&chi) / (factor.rows().saturating_sub(chi.len()).max(1) as f64).sqrt()
    };
    while kept.len() > 1 {
        let (chi, variance) = back_substitute(&reduced);
        let relative: Vec<f64> = chi
            .iter()
            .zip(&variance)
            .zip(&inflation)
            .map(|((x, v), i)| if *x == 0.0 { f64::INFINITY } else { noise * i * v.sqrt() / x.abs() })
            .collect();
        let smallest = relative.iter().copied().fold(f64::INFINITY, f64::min);
        let Some((worst, largest)) = relative.iter().copied().enumerate().max_by(|a, b| a.1.total_cmp(&b.1))
        else {
            break;
        };
        if largest < r_sigma * smallest || largest < WELL_KNOWN {
            break;
        }
        cancelled.push(kept.remove(worst));
        inflation.remove(worst);
        let columns: Vec<usize> = (0..relative.len()).filter(|&l| l != worst).collect();
        reduced = reduced.select(&columns);
    }
    Elimination { kept, cancelled }
}

impl Essential {
    /// The simplified model of an observation with known unknowns, from that of the free ones.
    pub(super) fn with_fixed(mut self, observation: &Observation) -> Essential {
        let value_of =
            |name: &String| self.parameters.iter().find(|p| p.name == *name).map_or(0.0, |p| p.value);
        let chi = observation.with_fixed(observation.unknowns.iter().map(value_of).collect());
        self.relative_error = relative_error(observation, &chi);
        for &(unknown, value) in &observation.fixed {
            self.parameters.push(ParameterEstimate::known(&observation.unknowns[unknown], value));
        }
        let place = |p: &ParameterEstimate| observation.unknowns.iter().position(|name| *name == p.name);
        self.parameters.sort_by_key(place);
        self
    }
}

/// The simplified model; `inflation` is by how much the standard deviation of each active parameter is larger than (18)
/// has it.
pub(super) fn simplified(
    observation: &Observation,
    active: &[usize],
    weights: &Weights,
    r_sigma: f64,
    weighted: bool,
    inflation: &[f64],
) -> Essential {
    let stacked = stack(observation, &weights.sigma).select(active);
    let elimination = eliminate(&stacked, active, r_sigma, inflation);
    let kept = &elimination.kept;
    let weights = if weighted { iterate(observation, kept, weights) } else { weights.clone() };
    let reduced = stack(observation, &weights.sigma).select(kept);
    let (mut values, variance) = back_substitute(&reduced);
    let freedom = reduced.rows().saturating_sub(values.len()).max(1) as f64;
    let noise = reduced.residual_norm(&values).powi(2) / freedom;
    let attenuation = corrected(observation, kept, &weights.sigma, &reduced, &values);
    if let Some(attenuation) = &attenuation {
        values.clone_from(&attenuation.chi);
    }
    let chi = spread(&values, kept, observation.unknowns.len());
    let white: Vec<f64> = variance.iter().map(|v| (noise * v).sqrt()).collect();
    let inflation_of = |l: &usize| active.binary_search(l).map_or(1.0, |p| inflation[p]);
    let deviations = Deviations {
        known: inflation.iter().all(|i| i.is_finite()),
        lasting: Some(kept.iter().zip(&white).map(|(l, s)| s * inflation_of(l)).collect()),
        together: DMatrix::zeros(0, 0),
        white,
        blocks: None,
        attenuation,
    };
    let all = described(observation, kept, &values, &deviations);
    Essential {
        parameters: kept.iter().map(|&l| all[l].clone()).collect(),
        cancelled: elimination.cancelled.iter().map(|&l| observation.unknowns[l].clone()).collect(),
        relative_error: relative_error(observation, &chi),
    }
}
