//! Which rows are used: standstill, joints that are fixed, windows of time.

use super::error::ObserveError;
use super::reversals::speed;
use super::settings::{Equations, ObserveSettings};
use super::standstill::Standstill;
use crate::model::{JointNumber, ParameterKind, Robot, StandardParameter};
use crate::signal::{Decimator, KeptRows, Motion, StandstillSpeeds};

/// How many rows of one equation of one motion were used.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct LeftOut {
    /// Index of the motion.
    pub trajectory: usize,
    /// Joint (0-based), or 0 for the power model.
    pub equation: usize,
    /// Number of the joint in the table; `None` for the power model.
    pub joint: Option<JointNumber>,
    /// Rows used.
    pub used: usize,
    /// Left out because the joint hardly moves.
    pub standstill: usize,
    /// Left out because the joint is fixed in this motion.
    pub fixed: usize,
    /// Left out because they reach outside of the windows.
    pub windows: usize,
    /// Rows that would lie within the reach of the filters from an end of the motion.
    pub edges: usize,
}

/// The rows of one equation that are used.
pub(super) struct Selection {
    pub used: Vec<bool>,
    pub left_out: LeftOut,
}

/// The rows that a motion can have at all, and by what some of them are left out.
pub(super) struct Candidates<'a> {
    /// Index of the motion.
    pub trajectory: usize,
    /// The motors, of which some have friction of their own.
    pub robot: &'a Robot,
    pub motion: &'a Motion,
    /// What brings a signal at the full rate to the rows.
    pub decimator: &'a Decimator,
    /// Where the rows lie.
    pub grid: KeptRows,
    /// Speeds of standstill as all motions show them.
    pub detected: &'a StandstillSpeeds,
    pub settings: &'a ObserveSettings,
}

/// Which rows of each equation are used.
pub(super) fn select(rows: &Candidates<'_>, equations: Equations) -> Result<Vec<Selection>, ObserveError> {
    let &Candidates { trajectory, robot, motion, decimator, grid, detected, settings } = rows;
    let n = motion.dq.len();
    let samples = motion.q.first().map_or(0, Vec::len);
    let possible = samples.div_ceil(grid.step);
    let support = decimator.support() as f64 / motion.rate;
    let time = |sample: usize| motion.start + sample as f64 / motion.rate;
    let in_window: Vec<bool> = grid
        .centres()
        .map(|c| {
            let t = time(c);
            settings.windows.is_empty()
                || settings.windows.iter().any(|w| t - support >= w[0] - 1e-9 && t + support <= w[1] + 1e-9)
        })
        .collect();
    let lobe = decimator.factor();
    let mut moving = rows_that_move(motion, grid, lobe, detected, settings)?;
    if matches!(settings.standstill, Standstill::Automatic | Standstill::Detected(_)) {
        leave_out_turning_combinations(robot, motion, grid, lobe, &mut moving);
        keep_short_strokes(&rows_that_move(motion, grid, lobe / 2, detected, settings)?, &mut moving);
    }
    let count = if equations == Equations::Torque { n } else { 1 };
    Ok((0..count)
        .map(|equation| {
            let mut left_out = LeftOut {
                trajectory,
                equation,
                edges: possible.saturating_sub(grid.count),
                ..LeftOut::default()
            };
            let torque = equations == Equations::Torque;
            let fixed = torque && motion.fixed.contains(&equation);
            let used = in_window
                .iter()
                .enumerate()
                .map(|(row, &in_window)| {
                    let slow = torque && !moving[equation][row];
                    let counter = match (in_window, fixed, slow) {
                        (false, _, _) => &mut left_out.windows,
                        (_, true, _) => &mut left_out.fixed,
                        (_, _, true) => &mut left_out.standstill,
                        _ => &mut left_out.used,
                    };
                    *counter += 1;
                    in_window && !fixed && !slow
                })
                .collect();
            Selection { used, left_out }
        })
        .collect())
}

/// A row that a joint turns round in has its sign mistimed, but where strokes are hardly longer than the main lobe,
/// nearly every row has: a joint that would lose more than half of the rows of its `slower` speeds keeps those.
fn keep_short_strokes(slower: &[Vec<bool>], moving: &mut [Vec<bool>]) {
    let count = |rows: &[bool]| rows.iter().filter(|used| **used).count();
    for (moving, slower) in moving.iter_mut().zip(slower) {
        if 2 * count(moving) < count(slower) {
            moving.clone_from(slower);
        }
    }
}

/// For each joint and row, whether the joint moves, and turns round nowhere within `reach` samples.
fn rows_that_move(
    motion: &Motion,
    grid: KeptRows,
    reach: usize,
    detected: &StandstillSpeeds,
    settings: &ObserveSettings,
) -> Result<Vec<Vec<bool>>, ObserveError> {
    let n = motion.dq.len();
    let speeds: Vec<f64> = match &settings.standstill {
        Standstill::Automatic => return Ok(detected.moving(motion, &grid, reach)),
        Standstill::Detected(before) if before.thresholds.len() == n => {
            return Ok(before.moving(motion, &grid, reach));
        }
        Standstill::Detected(before) => {
            return Err(ObserveError::StandstillSpeeds { found: before.thresholds.len(), expected: n });
        }
        Standstill::Keep => vec![0.0; n],
        Standstill::Below(speeds) if speeds.len() == n => speeds.clone(),
        Standstill::Below(speeds) => {
            return Err(ObserveError::StandstillSpeeds { found: speeds.len(), expected: n });
        }
        Standstill::BelowShare(share) => {
            let fastest = |dq: &Vec<f64>| dq.iter().fold(0.0_f64, |fastest, v| fastest.max(v.abs()));
            motion.dq.iter().map(|dq| share * fastest(dq)).collect()
        }
    };
    let faster = |(dq, speed): (&Vec<f64>, f64)| grid.centres().map(|c| dq[c].abs() >= speed).collect();
    Ok(motion.dq.iter().zip(speeds).map(faster).collect())
}

/// Leaves out the rows of the joints that a motor with friction of its own drives, or on which friction between links acts,
/// where that motor or combination of joints turns round within the main lobe of the row: its Coulomb friction is as sharp
/// there as a joint's.
fn leave_out_turning_combinations(
    robot: &Robot,
    motion: &Motion,
    grid: KeptRows,
    reach: usize,
    moving: &mut [Vec<bool>],
) {
    let combined = |p: &&StandardParameter| matches!(p.kind, ParameterKind::Fcm | ParameterKind::Fcc);
    for parameter in robot.standard.iter().filter(combined) {
        let form = robot.acts_on(parameter);
        let speed = speed(motion, &form);
        for (row, at) in grid.centres().enumerate() {
            let around = &speed[at.saturating_sub(reach)..(at + reach + 1).min(speed.len())];
            if around.iter().any(|v| v * speed[at] < 0.0) {
                form.iter().for_each(|&(j, _)| moving[j][row] = false);
            }
        }
    }
}

/// What is to blame when no row is left of motions.
pub(super) fn why_nothing<'a>(
    left_out: impl Iterator<Item = &'a LeftOut>,
    motions: &[Motion],
    band: f64,
) -> String {
    let mut total = LeftOut::default();
    for equation in left_out {
        total.standstill += equation.standstill;
        total.fixed += equation.fixed;
        total.windows += equation.windows;
        total.edges += equation.edges;
    }
    if motions.is_empty() {
        return "there is no motion".to_owned();
    }
    if total.windows > 0 {
        return "no row has its filter support within the time windows".to_owned();
    }
    if total.standstill + total.fixed > 0 {
        return "no joint moves".to_owned();
    }
    let duration = |m: &Motion| m.q.first().map_or(0, Vec::len) as f64 / m.rate;
    let longest = motions.iter().map(duration).fold(0.0, f64::max);
    format!(
        "the longest motion lasts {longest:.3} s, which is less than the filters need for rows of {band} Hz"
    )
}
