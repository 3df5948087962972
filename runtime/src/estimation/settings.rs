//! How parameters are estimated from an observation.

use super::method::{Method, Solver};

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
