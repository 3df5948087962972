//! Gear matrix and coupled motors.

use super::document::{Node, Value};
use super::drive_table::{DriveTable, exact};
use super::magnitudes::within;
use super::reader::Reader;
use super::table::TableRow;
use crate::exact::determinant;
use dynid_description::JointKind;
use dynid_description::bounds::{FASTEST_GEAR, MOST_COUPLED};
use num_traits::Zero;

const KEYS: [&str; 2] = ["gear", "coupled_friction"];

/// Reads `drive`. What is wrong is reported and left as it is without the key.
pub(super) fn read_drive(
    reader: &mut Reader,
    node: &Node,
    frames: &[TableRow],
    constants: &[(String, f64)],
) -> DriveTable {
    let joints: Vec<usize> = frames.iter().filter(|f| f.kind != JointKind::Fixed).map(|f| f.j).collect();
    let mut drive = DriveTable::direct(joints.len());
    let Some(fields) = reader.fields(node, "drive", &KEYS) else { return drive };
    if let Some(gear) = fields.get("gear").and_then(|gear| read_gear(reader, gear, &joints, constants)) {
        drive.gear = gear;
    }
    if let Some(coupled) = fields.get("coupled_friction") {
        let items = reader.list(coupled, "coupled_friction as a list of joint numbers");
        for item in items.unwrap_or_default() {
            let Some(j) = reader.integer(item, "the number j of a joint") else { continue };
            match joints.iter().position(|&k| k == j) {
                None => reader.report(
                    item.place,
                    format!("coupled_friction names {j}, which is not a joint: expected one of {joints:?}"),
                ),
                Some(k) if drive.coupled_friction.contains(&k) => {
                    reader.report(item.place, format!("coupled_friction names motor {j} twice"));
                }
                Some(k) => drive.coupled_friction.push(k),
            }
        }
        drive.coupled_friction.sort_unstable();
    }
    drive
}

fn read_gear(
    reader: &mut Reader,
    node: &Node,
    joints: &[usize],
    constants: &[(String, f64)],
) -> Option<Vec<Vec<f64>>> {
    let n = joints.len();
    let items = reader.list(node, "gear as a list with one ratio per joint, or as a matrix")?;
    let is_row = |item: &Node| matches!(item.value, Value::Sequence(_));
    let gear: Option<Vec<Vec<f64>>> = if items.iter().any(is_row) {
        let rows: Vec<_> =
            items.iter().map(|row| reader.numbers(row, "a row of gear", n, constants)).collect();
        reader.length(node, "gear (one row per motor)", items.len(), n)?;
        rows.into_iter().collect()
    } else {
        let ratios = reader.numbers(node, "gear", n, constants)?;
        Some((0..n).map(|m| (0..n).map(|k| if k == m { ratios[m] } else { 0.0 }).collect()).collect())
    };
    let gear = gear?;
    for &ratio in gear.iter().flatten().filter(|ratio| **ratio != 0.0) {
        within(reader, node, "a ratio of gear", ratio, [1.0 / FASTEST_GEAR, FASTEST_GEAR]);
    }
    let coupled =
        (0..n).filter(|&m| (0..n).any(|k| k != m && (gear[m][k] != 0.0 || gear[k][m] != 0.0))).count();
    if coupled > MOST_COUPLED {
        reader.report(node.place, format!("gear couples {coupled} joints: expected at most {MOST_COUPLED}"));
        return None;
    }
    let mut right = true;
    for m in 0..n {
        if gear[m][m] == 0.0 {
            let place = match &items[m].value {
                Value::Sequence(entries) => entries[m].place,
                _ => items[m].place,
            };
            let j = joints[m];
            reader.report(place, format!("gear[{j}][{j}] is 0: motor {j} must turn with joint {j}"));
            right = false;
        }
    }
    if right && determinant(&exact(&gear)).is_zero() {
        reader.report(node.place, "gear is singular: its rows (motors) are linearly dependent");
        right = false;
    }
    right.then_some(gear)
}
