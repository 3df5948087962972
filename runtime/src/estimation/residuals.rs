//! What parameters leave of the measured torques: relative errors per equation and overall.

use super::observe::Observation;
use super::outcome::EquationError;

/// The errors of each equation in each trajectory; `sigma` are those of the weights, one per group.
pub(super) fn errors_of(
    observation: &Observation,
    chi: &[f64],
    sigma: &[f64],
    weighted: bool,
) -> Vec<EquationError> {
    observation
        .groups
        .iter()
        .zip(sigma)
        .filter(|(g, _)| g.factor.rows() > 0)
        .map(|(g, &sigma)| {
            let residual = g.squares_left(chi).sqrt();
            let (rows, norm_y) = (g.factor.rows(), g.squares_measured().sqrt());
            let sigma = if weighted { sigma } else { residual / (rows as f64).sqrt() };
            EquationError {
                trajectory: g.trajectory,
                equation: g.equation,
                sigma: (residual > 0.0 || norm_y > 0.0).then_some(sigma),
                relative_error: ratio(residual, norm_y),
                rows,
            }
        })
        .collect()
}

/// ||Y - W chi|| / ||Y|| of each equation over all trajectories, for any parameters; `None` where Y is zero.
pub fn per_equation(observation: &Observation, chi: &[f64]) -> Vec<Option<f64>> {
    let equations = observation.groups.iter().map(|g| g.equation + 1).max().unwrap_or(0);
    (0..equations)
        .map(|equation| {
            let own = observation.groups.iter().filter(|g| g.equation == equation);
            let (e, y) =
                own.fold((0.0, 0.0), |(e, y), g| (e + g.squares_left(chi), y + g.squares_measured()));
            ratio(e.sqrt(), y.sqrt())
        })
        .collect()
}

/// ||Y - W chi|| / ||Y|| over all equations and trajectories, for any parameters; `None` where Y is zero.
pub fn relative_error(observation: &Observation, chi: &[f64]) -> Option<f64> {
    let (e, y) = observation
        .groups
        .iter()
        .fold((0.0, 0.0), |(e, y), g| (e + g.squares_left(chi), y + g.squares_measured()));
    ratio(e.sqrt(), y.sqrt())
}

fn ratio(e: f64, y: f64) -> Option<f64> {
    (y > 0.0).then(|| e / y)
}
