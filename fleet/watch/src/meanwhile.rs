//! What the siblings of a robot did while it changed.

use crate::clean::Day;
use crate::robust::median;

/// Days before a change whose median is the level before it: as many as a calibration has.
const BEFORE: usize = 14;
/// Days up to the alarm whose median is the level then.
const NOW: usize = 7;
/// Fewest days before a change that tell a level.
const LEAST: usize = 3;

/// The siblings of one alarm: described, nothing is decided by it.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Meanwhile {
    /// Robots that had days before the change and after it.
    pub(crate) siblings: usize,
    /// Median of their changes, as identified.
    pub(crate) change: Option<f64>,
}

/// What siblings with these days, none later than the alarm, did from before day `began` to the alarm.
pub(crate) fn meanwhile<'a>(siblings: impl Iterator<Item = &'a [Day]>, began: i64) -> Meanwhile {
    let changes: Vec<f64> = siblings.filter_map(|days| change(days, began)).collect();
    Meanwhile { siblings: changes.len(), change: median(&changes) }
}

/// Median of the last days less that of the days before `began`, or of the first days where there are too few of them.
fn change(days: &[Day], began: i64) -> Option<f64> {
    let (before, since) = days.split_at_checked(days.partition_point(|d| d.day < began).max(LEAST))?;
    let level = |days: &[Day], most: usize| {
        let values: Vec<f64> = days.iter().rev().take(most).map(|d| d.value).collect();
        median(&values)
    };
    Some(level(since, NOW)? - level(before, BEFORE)?)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn days(values: &[f64]) -> Vec<Day> {
        let day = |(day, &value): (i64, &f64)| Day { day, value, sigma: 0.1, covariates: [None; 2] };
        (0..).zip(values).map(day).collect()
    }

    #[test]
    fn siblings_are_told_by_the_median_of_their_changes() {
        let fleet = [days(&[1.0, 1.0, 1.0, 4.0]), days(&[2.0, 2.0, 2.0, 2.5]), days(&[0.0, 0.0, 0.0, 0.25])];
        let told = meanwhile(fleet.iter().map(Vec::as_slice), 3);
        assert_eq!(told, Meanwhile { siblings: 3, change: Some(0.5) });
        // Of a change on the first day the first days are the level before it.
        assert_eq!(meanwhile(fleet.iter().map(Vec::as_slice), 0), told);
    }

    #[test]
    fn siblings_without_days_on_both_sides_of_the_change_tell_nothing() {
        let fleet = [days(&[1.0, 1.0, 1.0]), days(&[])];
        assert_eq!(meanwhile(fleet.iter().map(Vec::as_slice), 3), Meanwhile::default());
        assert_eq!(meanwhile(fleet.iter().map(Vec::as_slice), 2), Meanwhile::default());
    }
}
