//! Gear matrix and coupled motors.

use super::document::{Node, Value};
use super::reader::Reader;
use super::{Drive, Frame, JointKind};
use crate::exact::{decimal, determinant, inverse};
use num_rational::BigRational;
use num_traits::Zero;

const KEYS: [&str; 2] = ["gear", "coupled_friction"];

/// Reads `drive`. What is wrong is reported and left as it is without the key.
pub(super) fn read_drive(
    reader: &mut Reader,
    node: &Node,
    frames: &[Frame],
    constants: &[(String, f64)],
) -> Drive {
    let joints: Vec<usize> = frames.iter().filter(|f| f.kind != JointKind::Fixed).map(|f| f.j).collect();
    let mut drive = Drive::direct(joints.len());
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

fn exact(gear: &[Vec<f64>]) -> Vec<Vec<BigRational>> {
    gear.iter().map(|row| row.iter().map(|&x| decimal(x)).collect()).collect()
}

impl Drive {
    /// Every motor drives its own joint one to one.
    pub fn direct(joints: usize) -> Drive {
        let gear = (0..joints).map(|m| (0..joints).map(|k| f64::from(u8::from(k == m))).collect()).collect();
        Drive { gear, coupled_friction: Vec::new() }
    }

    /// For each joint j the symmetric n x n matrix A_j of its rotor inertia: Ia_j contributes Ia_j * A_j * ddq to the
    /// joint torques and Ia_j * dqT A_j dq / 2 to the energy.
    ///
    /// Rotor m has the inertia Ja_m and the speed N_m dq (row m of the gear). As in (26), Ia_j = sum_m N_mj^2 Ja_m, so
    /// A_j = sum_m `(inverse of (N o N)^T)[m][j]` N_m^T N_m. Where N o N is singular (a differential), Ia_m stands
    /// for N_mm^2 Ja_m alone and A_m = N_m^T N_m / N_mm^2.
    pub fn rotor_matrices(&self) -> Vec<Vec<Vec<BigRational>>> {
        let gear = exact(&self.gear);
        let n = gear.len();
        let squares: Vec<Vec<_>> =
            (0..n).map(|j| (0..n).map(|m| &gear[m][j] * &gear[m][j]).collect()).collect();
        let share = inverse(&squares).unwrap_or_else(|| {
            let alone = |m: usize, j: usize| if m == j { squares[m][m].recip() } else { BigRational::zero() };
            (0..n).map(|m| (0..n).map(|j| alone(m, j)).collect()).collect()
        });
        let entry = |j: usize, i: usize, k: usize| {
            (0..n)
                .filter(|&m| !share[m][j].is_zero())
                .map(|m| &share[m][j] * &gear[m][i] * &gear[m][k])
                .fold(BigRational::zero(), |sum, x| sum + x)
        };
        (0..n).map(|j| (0..n).map(|i| (0..n).map(|k| entry(j, i, k)).collect()).collect()).collect()
    }
}
