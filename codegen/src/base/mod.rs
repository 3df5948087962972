//! Base parameters: the closed-form regrouping rules, and what they do not reach.
//!
//! A base parameter is a combination of standard parameters that the dynamics can show; a column of the standard
//! regressor that depends on others is left out and its parameter regrouped into those (Gautier and Khalil 1990,
//! Khalil and Dombre 2002, for trees Khalil and Bennis 1995). The closed-form rules are what moving a body from a link
//! to its parent gives, so they come out in symbols of the table; where gravity, parallel axes, prismatic joints or a
//! special geometry leave more undetermined, the spaces of attainable velocities and energies tell, in exact arithmetic.
//!
//! Parameters that are known to have a value other than 0 are the last to be kept: one that torques can tell from the rest is
//! a base parameter of which only known ones are part, others are part of base parameters of the rest.
//!
//! ```
//! use dynid_codegen::{base::base_set, robot::parse};
//!
//! let yaml = b"
//! name: planar
//! gravity: [0, -9.81, 0]
//! constants: {d2: 0.5}
//! frames:
//!   - {j: 1, sigma: 0, alpha: 0, d: 0,  theta: q1, r: 0}
//!   - {j: 2, sigma: 0, alpha: 0, d: d2, theta: q2, r: 0}
//! ";
//! let set = base_set(&parse("planar.yaml", yaml).expect("a table without mistakes"));
//! assert_eq!(set.standard.len(), 28);
//! assert_eq!(set.base.len(), 13);
//! assert_eq!(set.base[0].name, "ZZ1R");
//! assert_eq!(set.base[0].relation, "ZZ1 + Ia1 + d2^2*M2");
//! ```

mod attainable;
mod combination;
mod dependent;
mod friction;
mod placement;
mod random_states;
mod regroup;
mod relation;
mod springs;

use crate::exact::Form;
use crate::robot::RobotTable;
use dynid_description::{BaseParameter, StandardParameter};
use regroup::Regrouping;

/// The standard parameters of a robot in the order of chi_st, and its base parameters in the order of chi.
///
/// chi_st: for each frame XX XY XZ YY YZ ZZ MX MY MZ M; where the frame is a joint, Ia Fv Fc off follow, then
/// Fvm Fcm where its motor has coupled friction. Behind all frames those of friction between links and of springs. Base
/// parameters keep that order.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseSet {
    /// Every standard parameter.
    pub standard: Vec<StandardParameter>,
    /// Every base parameter.
    pub base: Vec<BaseParameter>,
}

/// The base parameters of a robot.
pub fn base_set(robot: &RobotTable) -> BaseSet {
    let standard = robot.standard_parameters();
    let plain = robot.dependent.is_empty()
        && robot.fixed.is_empty()
        && robot.couplings.iter().all(|c| c.law.between().is_none());
    let mut regrouping = if plain && springs::have_offsets(robot, &standard) {
        let mut regrouping = regroup::regroup(robot, &standard);
        springs::regroup_into_offsets(robot, &standard, &mut regrouping);
        regrouping
    } else {
        dependent::regroup_dependent(robot, &standard)
    };
    friction::regroup_friction(robot, &standard, &mut regrouping);
    // What is 0 is in no combination.
    regrouping.extend(robot.known.iter().map(|&column| (column, Vec::new())));
    let kept = (0..standard.len()).filter(|column| !regrouping.contains_key(column));
    let base = kept.map(|column| base_parameter(robot, &standard, &regrouping, column)).collect();
    BaseSet { standard, base }
}

fn base_parameter(
    robot: &RobotTable,
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
    let named: Vec<(&str, &Form)> = regrouped.iter().map(|&(k, f)| (standard[k].name.as_ref(), f)).collect();
    let mut combination = vec![(kept, 1.0)];
    combination.extend(regrouped.iter().map(|&(column, factor)| (column, factor.value().real())));
    combination.sort_by_key(|&(column, _)| column);
    BaseParameter {
        name: format!("{}{}", parameter.name, if regrouped.is_empty() { "" } else { "R" }).into(),
        standard: kept,
        combination: combination.into(),
        relation: relation::relation(&parameter.name, &named).into(),
        unit: parameter.unit(robot.frames[parameter.frame].kind, &robot.couplings).into(),
    }
}
