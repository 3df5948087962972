//! What became of recordings, in numbers.

use super::folder::OutFolder;
use super::rows::{screening_schema, text};
use super::tables;
use crate::day::Day;
use crate::error::Result;
use crate::reduce::Outcome;

/// Numbers of recordings.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct Outcomes {
    /// Their motions are used.
    pub used: usize,
    /// Read, but no such robot can have made them, or they say nothing.
    pub refused: usize,
    /// They cannot be read.
    pub unreadable: usize,
    /// dynid failed on them.
    pub failed: usize,
}

impl Outcomes {
    /// Those of days that are done.
    ///
    /// # Errors
    /// A table that is none.
    pub(super) fn of(out: &OutFolder, days: impl Iterator<Item = Day>) -> Result<Self> {
        let mut outcomes = Self::default();
        for day in days {
            if let Some(rows) = tables::read(&out.of_day("screening", day), &screening_schema())? {
                (0..rows.num_rows()).filter_map(|k| text(&rows, "outcome", k)).for_each(|o| outcomes.add(o));
            }
        }
        Ok(outcomes)
    }

    fn add(&mut self, outcome: &str) {
        let places = [
            (Outcome::Used, &mut self.used),
            (Outcome::Refused, &mut self.refused),
            (Outcome::Unreadable, &mut self.unreadable),
            (Outcome::Failed, &mut self.failed),
        ];
        places.into_iter().filter(|(known, _)| known.name() == outcome).for_each(|(_, count)| *count += 1);
    }
}
