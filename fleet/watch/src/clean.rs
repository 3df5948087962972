//! Series in a fixed order, with only the numbers that can be reckoned with.

use crate::{Observation, Series};
use std::cmp::Ordering;

/// Larger magnitudes than this are no parameters of a robot; their squares stay finite.
const LARGEST: f64 = 1e100;
/// Days beyond 27 000 years from 1970 are mistakes; differences of days cannot overflow.
const FURTHEST_DAY: i64 = 10_000_000;

/// One day of a series.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Day {
    pub(crate) day: i64,
    pub(crate) value: f64,
    /// Zero where it is not known.
    pub(crate) sigma: f64,
    /// Temperature and load.
    pub(crate) covariates: [Option<f64>; 2],
}

/// A series whose days ascend and whose numbers are finite.
#[derive(Clone, Debug)]
pub(crate) struct Clean<'a> {
    pub(crate) source: &'a Series,
    pub(crate) days: Vec<Day>,
}

impl<'a> Clean<'a> {
    /// What robots of one table and parameter share.
    pub(crate) fn family(&self) -> (&'a str, &'a str) {
        (&self.source.table, &self.source.parameter)
    }
}

/// All series by table, parameter and robot, whatever order they came in.
pub(crate) fn clean(series: &[Series]) -> Vec<Clean<'_>> {
    let mut all: Vec<Clean<'_>> =
        series.iter().map(|source| Clean { source, days: days(&source.observations) }).collect();
    all.sort_by(|a, b| {
        let key =
            |c: &Clean<'_>| (c.source.table.clone(), c.source.parameter.clone(), c.source.robot.clone());
        key(a)
            .cmp(&key(b))
            .then_with(|| a.source.unit.cmp(&b.source.unit))
            .then_with(|| compare(&a.days, &b.days))
    });
    all
}

/// Days in ascending order. Of two estimates of one day the more certain one is kept.
fn days(observations: &[Observation]) -> Vec<Day> {
    let mut days: Vec<Day> = observations
        .iter()
        .filter(|o| o.value.abs() < LARGEST && o.day.unsigned_abs() <= FURTHEST_DAY.unsigned_abs())
        .map(|o| Day {
            day: o.day,
            value: o.value,
            sigma: if o.sigma > 0.0 && o.sigma < LARGEST { o.sigma } else { 0.0 },
            covariates: [o.temperature, o.load].map(|c| c.filter(|c| c.abs() < LARGEST)),
        })
        .collect();
    days.sort_by(|a, b| {
        let unknown = |d: &Day| d.sigma == 0.0;
        (a.day, unknown(a))
            .cmp(&(b.day, unknown(b)))
            .then(a.sigma.total_cmp(&b.sigma))
            .then(a.value.total_cmp(&b.value))
    });
    days.dedup_by_key(|d| d.day);
    days
}

fn compare(a: &[Day], b: &[Day]) -> Ordering {
    let numbers = |d: &Day| [d.day as f64, d.value, d.sigma];
    a.iter()
        .zip(b)
        .flat_map(|(x, y)| numbers(x).into_iter().zip(numbers(y)))
        .map(|(x, y)| x.total_cmp(&y))
        .find(|o| o.is_ne())
        .unwrap_or_else(|| a.len().cmp(&b.len()))
}
