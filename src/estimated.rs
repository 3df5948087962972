//! Base parameters by name, and as cells of a table.

use dynid_runtime::diagnosis::Estimated;
use dynid_runtime::model::Robot;
use dynid_runtime::model_file::{NamedParameter, doubt};
use dynid_runtime::report::significant;

/// Base parameters with their names and units, in the robot's order.
pub fn named(robot: &Robot, estimated: &Estimated) -> Vec<NamedParameter> {
    let known = robot.fixed_base();
    let is_known = |name: &str| known.iter().any(|&(k, _)| robot.base[k].name == name);
    let of_base = robot.base.iter().zip(estimated.chi.iter().zip(&estimated.sigma));
    of_base
        .map(|(base, (&value, &sigma))| NamedParameter {
            name: base.name.to_string(),
            value,
            // What the table knows is certain; what nothing determines has no standard deviation.
            sigma: Some(sigma).filter(|s| is_known(&base.name) || s.is_finite() && *s > 0.0),
            relative_sigma_percent: Some(100.0 * sigma / value.abs()).filter(|r| r.is_finite()),
            sigma_white: None,
            correction: None,
            doubt: doubt(robot, &base.name, value, Some(sigma).filter(|s| s.is_finite())),
            sigma_blocks: None,
            unit: base.unit.to_string(),
        })
        .collect()
}

/// Name, value, sigma, relative sigma, sigma for white noise and unit as text.
pub fn cells(p: &NamedParameter) -> Vec<String> {
    let optional =
        |value: Option<f64>, digits| value.map_or_else(|| "-".to_owned(), |v| significant(v, digits));
    vec![
        p.name.clone(),
        value(p),
        optional(p.sigma, 2),
        optional(p.relative_sigma_percent, 2),
        optional(p.sigma_white, 2),
        p.unit.clone(),
    ]
}

/// A value, with a mark where no robot can have it.
pub fn value(p: &NamedParameter) -> String {
    format!("{}{}", significant(p.value, 4), if p.doubt.is_some() { " !" } else { "" })
}
