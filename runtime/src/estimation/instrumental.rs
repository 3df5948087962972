//! Instrumental variables: parameters that noise in the measured states does not bias.

use std::ops::Range;

use super::observe::{EquationFactor, Equations, ExtraColumns, Observation};
use super::residuals::{per_equation, relative_error};
use super::solve::RANK_TOLERANCE;
use super::uncertainty::{Solved, variances};
use super::weights::{spread, stack};
use super::{EquationError, Estimate, ParameterEstimate};
use crate::model::{Model, States};
use crate::signal::Motion;
use nalgebra::DMatrix;

/// Instruments for the inverse dynamic model: its columns along simulated, noise-free motions (Janot, Vandanjon and
/// Gautier 2014). Handed to the observation of the measured motions as extra columns.
pub struct Instruments<'a> {
    model: &'a dyn Model,
    simulated: &'a [Motion],
    names: Vec<String>,
    columns: Vec<Vec<usize>>,
    entries: usize,
}

impl<'a> Instruments<'a> {
    /// `simulated` has one motion for each measured one, on the same grid.
    pub fn new(model: &'a dyn Model, simulated: &'a [Motion]) -> Instruments<'a> {
        let pattern = model.pattern();
        let columns = pattern.rows.windows(2).map(|w| pattern.columns[w[0]..w[1]].to_vec()).collect();
        let names = model.robot().base.iter().map(|p| format!("instrument of {}", p.name)).collect();
        Instruments { model, simulated, names, columns, entries: pattern.columns.len() }
    }
}

impl ExtraColumns for Instruments<'_> {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn columns(&self, joint: usize) -> &[usize] {
        &self.columns[joint]
    }

    fn fill(
        &self,
        trajectory: usize,
        _: &Motion,
        range: Range<usize>,
        joint: usize,
        stride: usize,
        out: &mut [f64],
    ) {
        let motion = &self.simulated[trajectory];
        let [q, dq, ddq] = [&motion.q, &motion.dq, &motion.ddq]
            .map(|x| x.iter().map(|x| &x[range.clone()]).collect::<Vec<&[f64]>>());
        let mut entries = vec![0.0; self.entries * stride];
        self.model.idm_block(States { q: &q, dq: &dq, ddq: &ddq }, stride, &mut entries);
        let rows = &self.model.pattern().rows;
        out.copy_from_slice(&entries[rows[joint] * stride..rows[joint + 1] * stride]);
    }
}

/// Parameters with their standard deviations by instrumental variables.
#[derive(Debug, Clone, PartialEq)]
pub struct InstrumentalEstimate {
    /// The base parameters.
    pub chi: Vec<f64>,
    /// Their standard deviations: for errors that last where the observation has kept its rows, else for errors that are
    /// independent from row to row.
    pub sigma: Vec<f64>,
}

impl InstrumentalEstimate {
    /// The same with its errors on the `torques`, an observation without instruments; `weighted` is the estimate whose
    /// errors were the weights.
    pub fn described(&self, torques: &Observation, weighted: &Estimate) -> Estimate {
        let parameters = weighted.parameters.iter().zip(self.chi.iter().zip(&self.sigma));
        let parameters = parameters.map(|(p, (&value, &sigma))| ParameterEstimate {
            name: p.name.clone(),
            value,
            sigma: Some(sigma),
            sigma_white: None,
            sigma_blocks: None,
            correction: None,
            relative_sigma_percent: Some(100.0 * sigma / value.abs()).filter(|r| r.is_finite()),
        });
        let own = |e: &EquationError| {
            let alike = |g: &&EquationFactor| (g.trajectory, g.equation) == (e.trajectory, e.equation);
            let group = torques.groups.iter().find(alike).filter(|g| g.squares_measured() > 0.0);
            let relative_error = group.map(|g| (g.squares_left(&self.chi) / g.squares_measured()).sqrt());
            EquationError { relative_error, ..e.clone() }
        };
        Estimate {
            parameters: parameters.collect(),
            errors: weighted.errors.iter().map(own).collect(),
            relative_error: relative_error(torques, &self.chi),
            per_equation: per_equation(torques, &self.chi),
            warnings: Vec::new(),
            essential: None,
            ..weighted.clone()
        }
    }
}

/// Why there is no estimate by instrumental variables.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum InstrumentalError {
    /// Not the inverse dynamic model.
    #[error("instruments are those of the torque equations, and the observation is one of {found:?}")]
    Equations {
        /// What was observed.
        found: Equations,
    },
    /// The extra columns are not one instrument per base parameter.
    #[error(
        "the observation has {found} extra columns; {needed} instruments are needed, one per base parameter"
    )]
    Instruments {
        /// Extra columns of the observation.
        found: usize,
        /// Base parameters.
        needed: usize,
    },
    /// An instrument that is zero or a combination of others.
    #[error("the instrument of {parameter} is zero along the simulated motions, or a combination of others")]
    DependentInstrument {
        /// The base parameter.
        parameter: String,
    },
    /// No instrument has anything in common with the column of a parameter.
    #[error("no instrument is correlated with the column of {parameter}")]
    NoInstrument {
        /// The base parameter.
        parameter: String,
    },
    /// Several columns have the same part in the instruments.
    #[error("the instruments do not tell the parameters apart: their product with the columns is singular")]
    Singular,
}

/// Solves ZT W chi = ZT Y for an observation whose extra columns are [`Instruments`], with the error of each group of the
/// observation (as of a weighted estimate; all ones for no weights).
///
/// No product of matrices is made: with the triangle of [Z W Y], ZT W = RzzT Rzw and ZT Y = RzzT rzy, so that
/// Rzw chi = rzy.
///
/// # Errors
/// An observation of the power model or without instruments; instruments that do not determine the parameters.
pub fn instrumental_variables(
    observation: &Observation,
    errors: &[f64],
) -> Result<InstrumentalEstimate, InstrumentalError> {
    let k = observation.base;
    if observation.equations != Equations::Torque {
        return Err(InstrumentalError::Equations { found: observation.equations });
    }
    if observation.unknowns.len() != 2 * k {
        let found = observation.unknowns.len().saturating_sub(k);
        return Err(InstrumentalError::Instruments { found, needed: k });
    }
    let reduced = observation.without_fixed();
    let free = reduced.as_ref().unwrap_or(observation);
    let is_free = |l: &usize| observation.fixed.iter().all(|(known, _)| known != l);
    let parameters: Vec<usize> = (0..k).filter(is_free).collect();
    let (unknowns, base) = (|l: usize| &observation.unknowns[parameters[l]], k);
    let k = parameters.len();
    let instruments: Vec<usize> = parameters.iter().map(|l| base + l).collect();
    let order: Vec<usize> = instruments.iter().chain(&parameters).copied().collect();
    let factor = stack(free, errors).select(&order);
    let norms = factor.column_norms();
    // Where an instrument adds nothing to those before it, its row of R says nothing about the instruments.
    if let Some(l) = (0..k).find(|&l| factor.r(l, l).abs() <= RANK_TOLERANCE * norms[l]) {
        return Err(InstrumentalError::DependentInstrument { parameter: unknowns(l).clone() });
    }
    let cross = DMatrix::from_fn(k, k, |i, l| factor.r(i, k + l));
    let y = DMatrix::from_fn(k, 1, |i, _| factor.r(i, 2 * k));
    let scale: Vec<f64> = cross.column_iter().map(|c| c.norm()).collect();
    if let Some(l) = scale.iter().position(|&norm| norm == 0.0) {
        return Err(InstrumentalError::NoInstrument { parameter: unknowns(l).clone() });
    }
    let scaled = DMatrix::from_fn(k, k, |i, l| cross[(i, l)] / scale[l]);
    let lu = scaled.lu();
    let solved = lu.solve(&y).ok_or(InstrumentalError::Singular)?;
    let inverse = lu.try_inverse().ok_or(InstrumentalError::Singular)?;
    let chi: Vec<f64> = (0..k).map(|l| solved[l] / scale[l]).collect();
    // The residual of the equations themselves: the instruments' columns take no part in it.
    let all: Vec<f64> = std::iter::repeat_n(0.0, k).chain(chi.iter().copied()).collect();
    let freedom = factor.rows().saturating_sub(k).max(1) as f64;
    let noise = factor.residual_norm(&all) / freedom.sqrt();
    let solved = Solved {
        observation: free,
        unknowns: &parameters,
        instruments: &instruments,
        noise_of_columns: None,
        weights: errors,
        errors,
    };
    let sigma: Vec<f64> = match variances(&solved) {
        Some(variances) => variances.into_iter().map(f64::sqrt).collect(),
        None => (0..k).map(|l| noise * inverse.row(l).norm() / scale[l]).collect(),
    };
    let all = |values: &[f64]| spread(values, &parameters, base);
    Ok(InstrumentalEstimate { chi: observation.with_fixed(all(&chi)), sigma: all(&sigma) })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::observe::{ObserveSettings, Standstill, observe};
    use crate::estimation::{EstimateSettings, estimate};
    use crate::model::RecursiveModel;
    use crate::testing::vertical_axis;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    const TRUE: [f64; 3] = [2.0, 0.7, 1.5];

    /// One vertical axis: an inertia, viscous and Coulomb friction.
    fn model() -> RecursiveModel {
        vertical_axis(&["ZZ1", "Fv1", "Fc1"])
    }

    #[test]
    fn noise_in_the_states_biases_least_squares_but_not_instrumental_variables() {
        let (rate, n) = (200.0, 60_000);
        let mut rng = Pcg64::seed_from_u64(8);
        let signal = |order: i32| -> Vec<f64> {
            let wave = |t: f64, w: f64| {
                w.powi(order) * (w * t + f64::from(order) * std::f64::consts::FRAC_PI_2).sin()
            };
            (0..n).map(|t| wave(t as f64 / rate, 3.0) + 0.4 * wave(t as f64 / rate, 7.3)).collect()
        };
        let (q, dq, ddq) = (signal(0), signal(1), signal(2));
        let torque: Vec<f64> = (0..n)
            .map(|t| {
                let direction = if dq[t] > 0.0 { 1.0 } else { -1.0 };
                TRUE[0] * ddq[t] + TRUE[1] * dq[t] + TRUE[2] * direction + rng.random_range(-1.0..1.0)
            })
            .collect();
        let clean = Motion {
            name: "axis".into(),
            rate,
            start: 0.0,
            q: vec![q],
            dq: vec![dq],
            ddq: vec![ddq],
            torque: vec![torque],
            fixed: vec![],
            edge_samples: 0,
        };
        let mut measured = clean.clone();
        for a in &mut measured.ddq[0] {
            *a += rng.random_range(-40.0..40.0);
        }
        let model = model();
        let simulated = [clean];
        let instruments = Instruments::new(&model, &simulated);
        let settings = ObserveSettings { standstill: Standstill::Keep, ..ObserveSettings::default() };
        let see = |extra: Option<&dyn ExtraColumns>| {
            observe(&model, std::slice::from_ref(&measured), Equations::Torque, extra, &settings, None)
                .expect("rows")
        };
        let biased = estimate(&see(None), &EstimateSettings::default()).chi();
        assert!(biased[0] < 0.8 * TRUE[0], "{biased:?}");
        let unbiased = instrumental_variables(&see(Some(&instruments)), &[1.0]).expect("determined");
        for ((x, s), expected) in unbiased.chi.iter().zip(&unbiased.sigma).zip(TRUE) {
            assert!((x - expected).abs() < 3.0 * s, "{unbiased:?}");
        }
        assert!(unbiased.sigma[0] < 0.01 * TRUE[0]);
        assert_eq!(
            instrumental_variables(&see(None), &[1.0]),
            Err(InstrumentalError::Instruments { found: 0, needed: 3 })
        );
        let rest = Motion { dq: vec![vec![0.0; n]], ..simulated[0].clone() };
        let resting = [rest];
        let blind = instrumental_variables(&see(Some(&Instruments::new(&model, &resting))), &[1.0]);
        assert_eq!(blind, Err(InstrumentalError::DependentInstrument { parameter: "Fv1".into() }));
    }
}
