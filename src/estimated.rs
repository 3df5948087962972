//! The parameters of a diagnosis, by name.

use dynid_runtime::diagnosis::Estimated;
use dynid_runtime::model::Robot;
use dynid_runtime::model_file::{NamedParameter, doubt};

/// Base parameters with their names and units, in the robot's order.
pub fn named(robot: &Robot, estimated: &Estimated) -> Vec<NamedParameter> {
    let of_base = robot.base.iter().zip(estimated.chi.iter().zip(&estimated.sigma));
    of_base
        .map(|(base, (&value, &sigma))| NamedParameter {
            name: base.name.to_string(),
            value,
            sigma: Some(sigma).filter(|s| s.is_finite() && *s > 0.0),
            relative_sigma_percent: Some(100.0 * sigma / value.abs()).filter(|r| r.is_finite()),
            sigma_white: None,
            correction: None,
            doubt: doubt(robot, &base.name, value, Some(sigma).filter(|s| s.is_finite())),
            sigma_blocks: None,
            unit: base.unit.to_string(),
        })
        .collect()
}
