//! The estimators: IDIM and PIM, ordinary and weighted least squares.
//! Equation numbers are those of Gautier and Briot.

use super::Factor;
use super::attenuation::{Attenuation, Drowned, UNCERTAINTY, corrected};
use super::blocks::block_sigmas;
use super::essential::eliminate;
use super::observe::{Equations, Observation};
use super::outcome::{Essential, Estimate, Method, ParameterEstimate, Solver, Warning};
use super::residuals::{errors_of, per_equation, relative_error};
use super::robust::reweight;
use super::solve::{Solution, back_substitute};
use super::total::{NoGenericSolution, total_least_squares};
use super::uncertainty::{Solved, variances};
use super::weights::{Weights, by_equation, equal, from_own_fits, iterate, solve_active, stack};
use crate::model::JointNumber;

/// How parameters are estimated from an observation.
#[derive(Debug, Clone, PartialEq)]
pub struct EstimateSettings {
    /// Whether equations are weighted by their errors, per joint and trajectory.
    pub weighted: bool,
    /// How the equations are solved.
    pub solver: Solver,
    /// The paper's r_sigma for the essential parameters (10 to 30); `None`: they are not looked for.
    pub r_sigma: Option<f64>,
    /// Condition number of the scaled W above which a warning names the parameters concerned.
    pub worst_condition: f64,
    /// Whether standard deviations by blocks of time are worked out.
    pub block_sigmas: bool,
    /// Whether standard deviations for noise that lasts are worked out, where the observation has kept its rows.
    pub lasting_noise: bool,
}

impl Default for EstimateSettings {
    fn default() -> Self {
        EstimateSettings {
            weighted: true,
            solver: Solver::LeastSquares,
            r_sigma: Some(20.0),
            worst_condition: 1000.0,
            block_sigmas: true,
            lasting_noise: true,
        }
    }
}

impl EstimateSettings {
    /// The defaults for a method.
    pub fn for_method(method: Method) -> EstimateSettings {
        EstimateSettings {
            weighted: method.is_weighted(),
            solver: method.solver(),
            ..EstimateSettings::default()
        }
    }
}

/// Estimates the parameters of an observation (15), weighted or not, with standard deviations (16) to (19).
///
/// What the data do not determine is named in the warnings and set to zero, never inverted. Total least squares has no
/// standard deviations: those that it could state rest on errors of the columns that are independent and of one size,
/// which those of one filtered position signal are not.
pub fn estimate(observation: &Observation, settings: &EstimateSettings) -> Estimate {
    let mut warnings = Vec::new();
    // Which columns are independent does not depend on the weights.
    let first = if settings.weighted { from_own_fits(observation) } else { equal(observation) };
    let everything = stack(observation, &first.sigma).solve();
    let active = everything.kept.clone();
    let robust = (settings.solver == Solver::Robust).then(|| reweight(observation, &active));
    if let Some(robust) = robust.as_ref().filter(|r| !r.converged) {
        warnings.push(Warning::NotConverged { iterations: robust.iterations });
    }
    // What is solved; errors are always those of the observation as it is.
    let counted = robust.as_ref().map_or(observation, |r| &r.observation);
    let first = if robust.is_some() { from_own_fits(counted) } else { first };
    let weights =
        if settings.weighted { choose_weights(counted, &active, first, &mut warnings) } else { first };
    let stacked = stack(counted, &weights.sigma).select(&active);
    let mut solution = stacked.solve();
    if settings.solver == Solver::Total
        && solve_total(observation, &active, &stacked, &mut solution) == Err(NoGenericSolution)
    {
        warnings.push(Warning::NoTotalSolution);
    }

    let mut attenuation = None;
    if settings.solver != Solver::Total {
        match corrected(counted, &active, &weights.sigma, &stacked, &solution.chi) {
            Ok(found) => attenuation = found,
            Err(Drowned) => warnings.push(Warning::NoisyColumns),
        }
    }
    if settings.solver == Solver::Total {
        warnings.push(Warning::NoDeviations);
    }
    if let Some(attenuation) = &attenuation {
        solution.chi.clone_from(&attenuation.chi);
        solution.residual_norm = stacked.residual_norm(&attenuation.chi);
    }
    let chi = spread(&solution.chi, &active, observation.unknowns.len());
    let noise = solution.residual_norm.powi(2) / (solution.degrees_of_freedom.max(1)) as f64;
    let by_blocks =
        if settings.block_sigmas { block_sigmas(counted, &active, &weights.sigma, &chi) } else { None };
    let known = settings.solver != Solver::Total;
    let lasting = if known && settings.lasting_noise {
        lasting_deviations(counted, &active, &weights, settings.weighted, attenuation.as_ref())
    } else {
        None
    };
    let deviations = Deviations {
        known,
        white: solution.variance.iter().map(|v| (noise * v).sqrt()).collect(),
        blocks: by_blocks,
        lasting,
        corrections: attenuation.map(|a| a.missing),
    };
    let parameters = described(observation, &active, &solution.chi, &deviations);
    describe_dependence(observation, &everything, &mut warnings);
    if solution.condition > settings.worst_condition {
        warnings.push(Warning::BadlyConditioned {
            condition: solution.condition,
            parameters: strongest(observation, &solution.weakest, &active),
        });
    }
    if settings.weighted {
        warnings.extend(few_rows(observation));
    }
    let errors = errors_of(observation, &chi, &weights.sigma, settings.weighted);
    let per_equation = per_equation(observation, &chi);
    warnings.extend(not_explained(observation, &per_equation));
    let essential = settings.r_sigma.map(|r_sigma| {
        let inflation: Vec<f64> = (0..active.len()).map(|p| deviations.inflation(p)).collect();
        simplified(counted, &active, &weights, r_sigma, settings.weighted, &inflation)
    });
    Estimate {
        method: method_of(observation, settings),
        parameters,
        errors,
        relative_error: relative_error(observation, &chi),
        per_equation,
        rows: stacked.rows(),
        degrees_of_freedom: solution.degrees_of_freedom,
        condition: solution.condition,
        iterations: weights.iterations,
        low_blocks: robust.map_or_else(Vec::new, |r| r.low),
        warnings,
        essential,
    }
}

/// Standard deviations for noise that lasts as the residuals show it; `None` where the rows were not kept.
fn lasting_deviations(
    counted: &Observation,
    active: &[usize],
    weights: &Weights,
    weighted: bool,
    attenuation: Option<&Attenuation>,
) -> Option<Vec<f64>> {
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
    variances(&solved).map(|all| all.iter().map(|v| v.sqrt()).collect())
}

/// Replaces the values of a least-squares solution by those of total least squares.
fn solve_total(
    observation: &Observation,
    active: &[usize],
    stacked: &Factor,
    solution: &mut Solution,
) -> Result<(), NoGenericSolution> {
    let exact: Vec<bool> = active.iter().map(|&l| observation.exact[l]).collect();
    let chi = total_least_squares(stacked, &exact)?;
    solution.residual_norm = stacked.residual_norm(&chi);
    solution.chi = chi;
    Ok(())
}

/// The equations with motions that have fewer rows than parameters.
fn few_rows(observation: &Observation) -> Vec<Warning> {
    let of_equation = |own: Vec<usize>| {
        let short = |g: &&usize| {
            let group = &observation.groups[**g];
            group.factor.rows() <= group.columns.len()
        };
        let motions = own.iter().filter(short).count();
        let equation = own.first().map_or(0, |&g| observation.groups[g].equation);
        let joint = joint_of(observation, equation);
        (motions > 0).then_some(Warning::FewRows { joint, motions, of: own.len() })
    };
    by_equation(observation).into_iter().filter_map(of_equation).collect()
}

/// The equations of which the model explains less than no model at all.
fn not_explained(observation: &Observation, per_equation: &[f64]) -> Vec<Warning> {
    let worse = per_equation.iter().enumerate().filter(|(_, error)| **error > 1.0);
    worse
        .map(|(equation, &relative_error)| Warning::NotExplained {
            joint: joint_of(observation, equation),
            relative_error,
        })
        .collect()
}

fn method_of(observation: &Observation, settings: &EstimateSettings) -> Method {
    let power = observation.equations != Equations::Torque;
    match (settings.solver, settings.weighted, power) {
        (Solver::Robust, _, false) => Method::IdimIrls,
        (Solver::Robust, _, true) => Method::PimIrls,
        (Solver::Total, _, false) => Method::IdimTls,
        (Solver::Total, _, true) => Method::PimTls,
        (_, false, false) => Method::IdimOls,
        (_, true, false) => Method::IdimWls,
        (_, false, true) => Method::PimOls,
        (_, true, true) => Method::PimWls,
    }
}

/// Iterated weights, or those of the equations' own fits where the iteration gives up on an equation.
fn choose_weights(
    observation: &Observation,
    active: &[usize],
    own: Weights,
    warnings: &mut Vec<Warning>,
) -> Weights {
    let iterated = iterate(observation, active, &own);
    let before = per_equation(observation, &solve_active(observation, active, &own.sigma));
    let after = per_equation(observation, &solve_active(observation, active, &iterated.sigma));
    let mut collapsed = false;
    for (equation, (&before, &after)) in before.iter().zip(&after).enumerate() {
        if after > 1.0 && before < after {
            collapsed = true;
            let joint = joint_of(observation, equation);
            warnings.push(Warning::WeightCollapsed { joint, relative_error: after });
        }
    }
    if collapsed {
        return own;
    }
    if !iterated.converged {
        warnings.push(Warning::NotConverged { iterations: iterated.iterations });
    }
    iterated
}

/// The joint whose torque an equation gives; `None` for the power model.
fn joint_of(observation: &Observation, equation: usize) -> Option<JointNumber> {
    observation.left_out.iter().find(|rows| rows.equation == equation).and_then(|rows| rows.joint)
}

fn spread(values: &[f64], active: &[usize], unknowns: usize) -> Vec<f64> {
    let mut chi = vec![0.0; unknowns];
    for (&l, &x) in active.iter().zip(values) {
        chi[l] = x;
    }
    chi
}

/// Standard deviations of the parameters that were solved for.
struct Deviations {
    /// Whether they mean anything.
    known: bool,
    /// For noise that is independent from row to row.
    white: Vec<f64>,
    /// By leaving out blocks of time.
    blocks: Option<Vec<f64>>,
    /// For noise that lasts as the residuals show it.
    lasting: Option<Vec<f64>>,
    /// What was added for noise in the columns.
    corrections: Option<Vec<f64>>,
}

impl Deviations {
    /// The one that claims least about the noise: that of noise that lasts, by blocks where the rows were not kept; with
    /// that of the correction.
    fn headline(&self, place: usize) -> f64 {
        let of = |all: &Option<Vec<f64>>| all.as_ref().map(|all| all[place]);
        let noise = of(&self.lasting).or(of(&self.blocks)).unwrap_or(self.white[place]);
        noise.hypot(UNCERTAINTY * of(&self.corrections).unwrap_or(0.0))
    }

    /// By how much that is more than for noise that is independent from row to row.
    fn inflation(&self, place: usize) -> f64 {
        let ratio = self.headline(place) / self.white[place];
        if ratio.is_finite() && ratio > 0.0 { ratio } else { 1.0 }
    }
}

fn described(
    observation: &Observation,
    active: &[usize],
    chi: &[f64],
    deviations: &Deviations,
) -> Vec<ParameterEstimate> {
    let mut parameters: Vec<ParameterEstimate> = observation
        .unknowns
        .iter()
        .map(|name| ParameterEstimate {
            name: name.clone(),
            value: 0.0,
            sigma: None,
            sigma_white: None,
            sigma_blocks: None,
            correction: None,
            relative_sigma_percent: None,
        })
        .collect();
    for (place, &l) in active.iter().enumerate() {
        let parameter = &mut parameters[l];
        parameter.value = chi[place];
        parameter.correction = deviations.corrections.as_ref().map(|c| c[place]);
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

fn describe_dependence(observation: &Observation, everything: &Solution, warnings: &mut Vec<Warning>) {
    for group in &everything.dependent {
        let Some((&parameter, others)) = group.split_first() else { continue };
        warnings.push(Warning::NotDetermined {
            parameter: observation.unknowns[parameter].clone(),
            from: others.iter().map(|&l| observation.unknowns[l].clone()).collect(),
        });
    }
}

/// Names of the parameters with the largest shares of a direction, the strongest first.
fn strongest(observation: &Observation, direction: &[f64], active: &[usize]) -> Vec<String> {
    let largest = direction.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let mut shares: Vec<(f64, usize)> = direction.iter().zip(active).map(|(x, &l)| (x.abs(), l)).collect();
    shares.retain(|&(share, _)| share > 0.3 * largest);
    shares.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    shares.into_iter().map(|(_, l)| observation.unknowns[l].clone()).collect()
}

/// The simplified model; `inflation` is by how much the standard deviation of each active parameter is larger than (18)
/// has it.
fn simplified(
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
    let attenuation = corrected(observation, kept, &weights.sigma, &reduced, &values).ok().flatten();
    if let Some(attenuation) = &attenuation {
        values.clone_from(&attenuation.chi);
    }
    let chi = spread(&values, kept, observation.unknowns.len());
    let white: Vec<f64> = variance.iter().map(|v| (noise * v).sqrt()).collect();
    let inflation_of = |l: &usize| active.binary_search(l).map_or(1.0, |p| inflation[p]);
    let deviations = Deviations {
        known: inflation.iter().all(|i| i.is_finite()),
        lasting: Some(kept.iter().zip(&white).map(|(l, s)| s * inflation_of(l)).collect()),
        white,
        blocks: None,
        corrections: attenuation.map(|a| a.missing),
    };
    let all = described(observation, kept, &values, &deviations);
    Essential {
        parameters: kept.iter().map(|&l| all[l].clone()).collect(),
        cancelled: elimination.cancelled.iter().map(|&l| observation.unknowns[l].clone()).collect(),
        relative_error: relative_error(observation, &chi),
    }
}

#[cfg(test)]
#[path = "estimate_tests.rs"]
mod tests;
