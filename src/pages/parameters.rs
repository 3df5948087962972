//! The base parameters of a model on its page.

use dynid_runtime::model::Robot;
use dynid_runtime::model_file::{Identified, NamedParameter};
use dynid_runtime::report::{Page, significant};

use crate::estimated::cells;

/// What was known of the base parameters beforehand.
#[derive(Debug, Clone, PartialEq)]
pub struct Prior {
    /// What it is, as a header of its column.
    pub name: &'static str,
    /// Value, and standard deviation where it is known, of each base parameter in the robot's order.
    pub values: Vec<Option<(f64, Option<f64>)>>,
}

impl Prior {
    /// The nominal values of a robot's table, where it has any.
    pub fn nominal(robot: &Robot) -> Option<Self> {
        let nominal = robot.nominal.as_ref().filter(|n| n.standard.len() == robot.standard.len())?;
        let values = robot.base_from_standard(&nominal.standard);
        Some(Self { name: "nominal", values: values.into_iter().map(|v| Some((v, None))).collect() })
    }

    /// The parameters of a saved model.
    pub fn saved(name: &'static str, model: &Identified, robot: &Robot) -> Self {
        let known = |base: &str| model.base_parameters.iter().find(|p| p.name == base);
        let values = robot.base.iter().map(|b| known(&b.name).map(|p| (p.value, p.sigma))).collect();
        Self { name, values }
    }
}

/// The whole table: values with what is known of them, and what was known beforehand.
pub(super) fn parameters(page: &mut Page, robot: &Robot, found: &[NamedParameter], prior: Option<&Prior>) {
    let has_white = found.iter().any(|p| p.sigma_white.is_some());
    let has_prior_sigma = prior.is_some_and(|p| p.values.iter().flatten().any(|(_, sigma)| sigma.is_some()));
    let mut header = vec!["parameter", "value", "sigma", "sigma %"];
    header.extend(has_white.then_some("sigma, white"));
    header.extend(prior.map(|p| p.name));
    header.extend(has_prior_sigma.then_some("its sigma"));
    header.push("<unit");
    let row = |p: &NamedParameter| {
        let at = robot.base.iter().position(|b| b.name == p.name);
        let known = prior.and_then(|prior| *prior.values.get(at?)?);
        // The unit, which is the last of the cells, goes to the end.
        let mut row = cells(p);
        let unit = row.pop().unwrap_or_default();
        if !has_white {
            row.pop();
        }
        let number = |value: Option<f64>, digits| value.map_or("-".to_owned(), |v| significant(v, digits));
        if prior.is_some() {
            row.push(number(known.map(|k| k.0), 4));
        }
        if has_prior_sigma {
            row.push(number(known.and_then(|k| k.1), 2));
        }
        row.push(unit);
        row
    };
    page.table(&header, &found.iter().map(row).collect::<Vec<_>>());
}

/// What is regrouped into the base parameters that are more than one standard parameter.
pub(super) fn relations(page: &mut Page, robot: &Robot) {
    let regrouped = robot.base.iter().filter(|p| p.relation != p.name);
    let rows: Vec<Vec<String>> =
        regrouped.map(|p| vec![p.name.to_string(), p.relation.to_string()]).collect();
    if rows.is_empty() {
        page.paragraph("Nothing is regrouped: every base parameter is a standard parameter.");
    } else {
        page.table(&["parameter", "<what is regrouped into it"], &rows);
    }
}
