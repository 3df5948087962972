//! Base parameters: the closed-form regrouping rules, and what they do not reach.

//!
//! A base parameter is a combination of standard parameters that the dynamics can show; a column of the standard
//! regressor that depends on others is left out and its parameter regrouped into those (Gautier and Khalil 1990,
//! Khalil and Dombre 2002, for trees Khalil and Bennis 1995). The closed-form rules are what moving a body from a link
//! to its parent gives, so they come out in symbols of the table; where gravity, parallel axes, prismatic joints or a
//! special geometry leave more unseen, the spaces of attainable velocities and energies tell, in exact arithmetic.

mod attainable;
mod friction;
mod placement;
mod regroup;

pub use crate::robot::{ParameterKind, StandardParameter};

use crate::exact::Form;
use crate::robot::{Robot, standard_parameters};
use regroup::Regrouping;

/// A base parameter: the standard parameter whose column is kept, and what was regrouped into it.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameter {
    /// Standard name, with an R when something was regrouped into it.
    pub name: String,
    /// Index of the kept parameter in `BaseSet::standard`.
    pub standard: usize,
    /// chi = sum of coefficient * `chi_st[index]`, ascending index, the kept one with coefficient 1.
    pub combination: Vec<(usize, f64)>,
    /// The same in symbols of the table: `ZZ1 + Ia1 + d3^2*M3`.
    pub relation: String,
    /// SI unit.
    pub unit: String,
}

/// The standard parameters of a robot in the order of chi_st, and its base parameters in the order of chi.
///
/// chi_st: for each frame XX XY XZ YY YZ ZZ MX MY MZ M; where the frame is a joint, Ia Fv Fc off follow, then
/// Fvm Fcm where its motor has coupled friction. Base parameters keep that order.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseSet {
    /// Every standard parameter.
    pub standard: Vec<StandardParameter>,
    /// Every base parameter.
    pub base: Vec<BaseParameter>,
}

/// The base parameters of a robot.
pub fn base_set(robot: &Robot) -> BaseSet {
    let standard = standard_parameters(&robot.frames, &robot.drive);
    let mut regrouping = regroup::regroup(robot, &standard);
    friction::regroup_friction(robot, &standard, &mut regrouping);
    let kept = (0..standard.len()).filter(|column| !regrouping.contains_key(column));
    let base = kept.map(|column| base_parameter(robot, &standard, &regrouping, column)).collect();
    BaseSet { standard, base }
}

fn base_parameter(
    robot: &Robot,
    standard: &[StandardParameter],
    regrouping: &Regrouping,
    kept: usize,
) -> BaseParameter {
    let regrouped: Vec<(usize, &Form)> = regrouping
        .iter()
        .filter_map(|(&column, taken)| {
            taken.iter().find(|(k, _)| *k == kept).map(|(_, factor)| (column, factor))
        })
        .collect();
    let parameter = &standard[kept];
    let mut relation = parameter.name.clone();
    let mut combination = vec![(kept, 1.0)];
    for &(column, factor) in &regrouped {
        let (sign, product) = factor.signed_product(&standard[column].name);
        relation.push_str(&format!(" {sign} {product}"));
        combination.push((column, factor.value().real()));
    }
    combination.sort_by_key(|&(column, _)| column);
    BaseParameter {
        name: format!("{}{}", parameter.name, if regrouped.is_empty() { "" } else { "R" }),
        standard: kept,
        combination,
        relation,
        unit: parameter.kind.unit(robot.frames[parameter.frame].kind).to_owned(),
    }
}
