//! From a manifest to trajectories on the joint side, in SI.

use std::collections::VecDeque;

use super::channel::Conversions;
use super::window::{BLOCK, Open};
use super::{Manifest, Reach, RecordingError, RowReport, Trajectory};
use crate::model::Robot;

/// A recording in memory.
#[derive(Debug, Clone, PartialEq)]
pub struct Recording {
    /// Its motions, in the order of the manifest.
    pub trajectories: Vec<Trajectory>,
    /// The rows that were left out.
    pub rows: RowReport,
}

/// Reads all trajectories of a recording of `robot`.
///
/// # Errors
/// Whatever does not fit the contract, the files or the robot, with its place; a trajectory of which more
/// than `MOST_LEFT_OUT` percent of the rows cannot be right, or none is left.
pub fn load(manifest: &Manifest, robot: &Robot) -> Result<Recording, RecordingError> {
    let mut loader = Loader::new(manifest, robot, usize::MAX)?;
    let mut trajectories = Vec::new();
    while let Some(trajectory) = loader.next_trajectory()? {
        trajectories.push(trajectory);
    }
    Ok(Recording { trajectories, rows: loader.into_report() })
}

/// Reads a recording motion after motion, each in pieces of bounded length.
///
/// For a recording longer than memory, pieces of some 100,000 rows go one by one through the preparation and into
/// the accumulated factors; what is lost is what the filters spoil at the ends of a piece.
pub struct Loader<'a> {
    manifest: &'a Manifest,
    robot: &'a Robot,
    conversions: Conversions,
    reach: Reach,
    most_rows: usize,
    report: RowReport,
    window: usize,
    open: Option<Open>,
    ready: VecDeque<Trajectory>,
}

impl<'a> Loader<'a> {
    /// Checks the manifest against the robot. A trajectory of more than `most_rows` rows comes in pieces.
    ///
    /// # Errors
    /// Channels that do not fit the robot's joints: their number, units, gains; a gear that has no inverse.
    pub fn new(manifest: &'a Manifest, robot: &'a Robot, most_rows: usize) -> Result<Self, RecordingError> {
        let conversions = Conversions::new(manifest, robot)?;
        let most_rows = most_rows.max(BLOCK);
        Ok(Self {
            manifest,
            robot,
            conversions,
            reach: Reach::of(robot),
            most_rows,
            report: RowReport::default(),
            window: 0,
            open: None,
            ready: VecDeque::new(),
        })
    }

    /// The next motion; `None` when all have been read.
    ///
    /// # Errors
    /// A file that cannot be read or lacks a column, files of unequal length, a window without rows, or one of which
    /// more than [`super::MOST_LEFT_OUT`] percent of the rows cannot be right.
    pub fn next_trajectory(&mut self) -> Result<Option<Trajectory>, RecordingError> {
        loop {
            if let Some(trajectory) = self.ready.pop_front() {
                return Ok(Some(trajectory));
            }
            let mut open = match self.open.take() {
                Some(open) => open,
                None => match self.manifest.trajectories.get(self.window) {
                    Some(window) => {
                        self.window += 1;
                        Open::new(self.manifest, self.robot, window)?
                    }
                    None => return Ok(None),
                },
            };
            let (piece, at_end) = open.read_piece(&self.conversions, self.robot.joints(), self.most_rows)?;
            self.ready.extend(open.motions_of(piece, &self.reach, !self.robot.limits.velocity.is_empty()));
            if at_end {
                open.finish(&mut self.report)?;
            } else {
                self.open = Some(open);
            }
        }
    }

    /// Index in the manifest of the trajectory that the last motion came from.
    pub fn window(&self) -> usize {
        self.window.saturating_sub(1)
    }

    /// The rows left out so far, of the trajectories that have been read to their end.
    pub fn into_report(self) -> RowReport {
        self.report
    }
}

#[cfg(test)]
#[path = "load_tests.rs"]
mod tests;
