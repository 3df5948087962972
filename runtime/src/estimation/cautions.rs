//! When an estimate is warned of: what the observation and the solution say against it.

use super::observe::Observation;
use super::solve::Solution;
use super::warning::Warning;
use super::weights::by_equation;
use crate::model::JointNumber;

/// The equations with motions that have fewer rows than parameters.
pub(super) fn few_rows(observation: &Observation) -> Vec<Warning> {
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
pub(super) fn not_explained(observation: &Observation, per_equation: &[Option<f64>]) -> Vec<Warning> {
    let known = per_equation.iter().enumerate().filter_map(|(equation, error)| Some((equation, (*error)?)));
    let worse = known.filter(|(_, error)| *error > 1.0);
    worse
        .map(|(equation, relative_error)| Warning::NotExplained {
            joint: joint_of(observation, equation),
            relative_error,
        })
        .collect()
}

/// A warning for each unknown that the solution of all of them leaves out.
pub(super) fn describe_dependence(
    observation: &Observation,
    everything: &Solution,
    warnings: &mut Vec<Warning>,
) {
    for group in &everything.dependent {
        let Some((&parameter, others)) = group.split_first() else { continue };
        if observation.fixed.iter().any(|&(known, _)| known == parameter) {
            continue;
        }
        warnings.push(Warning::NotDetermined {
            parameter: observation.unknowns[parameter].clone(),
            from: others.iter().map(|&l| observation.unknowns[l].clone()).collect(),
        });
    }
}

/// Names of the parameters with the largest shares of a direction, the strongest first.
pub(super) fn strongest(observation: &Observation, direction: &[f64], active: &[usize]) -> Vec<String> {
    let largest = direction.iter().fold(0.0_f64, |m, x| m.max(x.abs()));
    let mut shares: Vec<(f64, usize)> = direction.iter().zip(active).map(|(x, &l)| (x.abs(), l)).collect();
    shares.retain(|&(share, _)| share > 0.3 * largest);
    shares.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    shares.into_iter().map(|(_, l)| observation.unknowns[l].clone()).collect()
}

/// The joint whose torque an equation gives; `None` for the power model.
pub(super) fn joint_of(observation: &Observation, equation: usize) -> Option<JointNumber> {
    observation.left_out.iter().find(|rows| rows.equation == equation).and_then(|rows| rows.joint)
}
