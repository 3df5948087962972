//! Base parameters are complete and exact: against a small numeric engine that shares nothing with the generator.
#![allow(clippy::unwrap_used)]

mod complete;
mod numeric;
mod random_robot;
mod rank;
mod regrouping;
#[path = "../shipped/mod.rs"]
mod shipped;
mod shipped_robots;

use dynid_codegen::base::BaseSet;
use dynid_codegen::robot::{RobotTable, parse};
use shipped::robots;

fn robot(name: &str) -> RobotTable {
    robots().into_iter().find(|robot| robot.name == name).unwrap()
}

fn names(set: &BaseSet) -> Vec<&str> {
    set.base.iter().map(|p| p.name.as_ref()).collect()
}

fn relation<'a>(set: &'a BaseSet, name: &str) -> &'a str {
    &set.base
        .iter()
        .find(|p| p.name == name)
        .unwrap_or_else(|| panic!("no {name} in {:?}", names(set)))
        .relation
}

/// A robot from rows of its table.
fn table_of(rows: &str, rest: &str) -> RobotTable {
    let text = format!("name: arm\nframes:\n{rows}{rest}\n");
    parse("arm.yaml", text.as_bytes()).unwrap_or_else(|m| panic!("{}", m[0]))
}
