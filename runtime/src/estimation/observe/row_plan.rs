//! Which rows a motion has, without the columns: for what is compared on the rows of an observation.

use super::error::ObserveError;
use super::select::{self, Candidates, LeftOut, Selection, select};
use super::settings::{Equations, ObserveSettings};
use super::source::check_shape;
use crate::model::{JointIndex, Robot};
use crate::signal::{Decimator, KeptRows, Motion, StandstillSpeeds};

/// The rows of the torque equations of one motion.
pub(crate) struct RowPlan {
    /// What brings a signal at the full rate to the rows.
    pub decimator: Decimator,
    /// Where the rows lie.
    pub grid: KeptRows,
    /// For each joint and row, whether it is used.
    pub used: Vec<Vec<bool>>,
    /// For each joint, what is used and what is not.
    pub left_out: Vec<LeftOut>,
    /// Band of the rows, Hz.
    pub band: f64,
}

/// The rows that [`super::observe`] uses of motions of a robot.
///
/// # Errors
/// As of [`super::observe`], but for motions without any usable row.
pub(crate) fn row_plans(
    robot: &Robot,
    motions: &[Motion],
    settings: &ObserveSettings,
) -> Result<Vec<RowPlan>, ObserveError> {
    motions.iter().try_for_each(|motion| check_shape(robot, motion))?;
    let rows = motion_rows(robot, motions, settings, Equations::Torque)?;
    let plan = |(MotionRows { decimator, grid, selection }, motion): (MotionRows, &Motion)| {
        let number = |Selection { used, left_out }| {
            let joint = Some(robot.joint_number(JointIndex(left_out.equation)));
            (used, LeftOut { joint, ..left_out })
        };
        let (used, left_out) = selection.into_iter().map(number).unzip();
        let band = band_of(&decimator, motion.rate);
        RowPlan { decimator, grid, used, left_out, band }
    };
    Ok(rows.into_iter().zip(motions).map(plan).collect())
}

/// Where the rows of one motion lie, and which are used.
pub(super) struct MotionRows {
    /// What brings a signal at the full rate to the rows.
    pub decimator: Decimator,
    /// Where the rows lie.
    pub grid: KeptRows,
    /// For each equation, what is used and what is not.
    pub selection: Vec<Selection>,
}

/// The rows of motions of the right shape.
///
/// # Errors
/// A band or rate that is not positive, or speeds of standstill of another number of joints.
pub(super) fn motion_rows(
    robot: &Robot,
    motions: &[Motion],
    settings: &ObserveSettings,
    equations: Equations,
) -> Result<Vec<MotionRows>, ObserveError> {
    check_frequencies(settings)?;
    let detected = StandstillSpeeds::of(motions);
    let of_motion = |(trajectory, motion): (usize, &Motion)| {
        let decimator = Decimator::for_rows(motion.rate, settings.band, settings.rate)?;
        let grid = decimator.kept_rows(valid_samples(motion));
        let candidates = Candidates {
            trajectory,
            robot,
            motion,
            decimator: &decimator,
            grid,
            detected: &detected,
            settings,
        };
        let selection = select(&candidates, equations)?;
        Ok(MotionRows { decimator, grid, selection })
    };
    motions.iter().enumerate().map(of_motion).collect()
}

/// What is to blame when no row of the plans is used.
pub(crate) fn why_nothing(plans: &[RowPlan], motions: &[Motion], settings: &ObserveSettings) -> String {
    select::why_nothing(plans.iter().flat_map(|p| &p.left_out), motions, settings.band)
}

/// The samples between the edge effects of the filters.
fn valid_samples(motion: &Motion) -> std::ops::Range<usize> {
    let samples = motion.q.first().map_or(0, Vec::len);
    motion.edge_samples..samples.saturating_sub(motion.edge_samples).max(motion.edge_samples)
}

fn check_frequencies(settings: &ObserveSettings) -> Result<(), ObserveError> {
    for (what, value) in [("band", settings.band), ("rate", settings.rate.unwrap_or(1.0))] {
        if !(value > 0.0 && value.is_finite()) {
            return Err(ObserveError::Frequency { what, value });
        }
    }
    Ok(())
}

/// The band that a filter lets through, Hz.
pub(super) fn band_of(decimator: &Decimator, rate: f64) -> f64 {
    let taps = decimator.taps().len();
    let half_rate = 0.5 * rate;
    if taps == 1 { half_rate } else { half_rate * 20.0 / (taps - 1) as f64 }
}
