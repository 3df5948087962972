//! How much the errors of each robot had risen on earlier days.

use std::collections::BTreeMap;

use datafusion::arrow::array::RecordBatch;

use super::folder::OutFolder;
use super::rows::{number, screening_schema, text};
use super::tables;
use crate::day::Day;
use crate::error::Result;

/// For each day and robot the largest ratio of errors.
#[derive(Debug, Default)]
pub struct History(BTreeMap<Day, BTreeMap<String, f64>>);

impl History {
    /// That of the days that are done.
    ///
    /// # Errors
    /// A table that is none.
    pub fn read(out: &OutFolder) -> Result<Self> {
        let mut history = Self::default();
        for day in out.days("screening") {
            if let Some(screening) = tables::read(&out.of_day("screening", day), &screening_schema())? {
                history.add(day, &screening);
            }
        }
        Ok(history)
    }

    /// Takes in a day.
    pub fn add(&mut self, day: Day, screening: &RecordBatch) {
        let mut largest = BTreeMap::new();
        for k in 0..screening.num_rows() {
            if let (Some(robot), Some(rise)) = (text(screening, "robot", k), number(screening, "rise", k)) {
                let own = largest.entry(robot.to_owned()).or_insert(rise);
                *own = rise.max(*own);
            }
        }
        self.0.insert(day, largest);
    }

    /// The largest ratio of a robot before a day, at least 1.
    pub fn before(&self, robot: &str, day: Day) -> f64 {
        self.0
            .range(..day)
            .filter_map(|(_, robots)| robots.get(robot))
            .fold(1.0, |largest, rise| rise.max(largest))
    }
}
