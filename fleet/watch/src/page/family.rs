//! What the robots of one table have in one parameter, day by day.

use crate::clean::Clean;
use std::collections::BTreeMap;

/// The middle four fifths of the siblings on one day.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct BandDay {
    pub(super) day: i64,
    pub(super) low: f64,
    pub(super) middle: f64,
    pub(super) high: f64,
}

/// The siblings over the days; empty where they are fewer than three on each.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Band {
    pub(super) days: Vec<BandDay>,
}

/// The bands of all tables and parameters, by both.
pub(super) fn bands<'a>(series: &[Clean<'a>]) -> BTreeMap<(&'a str, &'a str), Band> {
    let mut values: BTreeMap<(&str, &str), BTreeMap<i64, Vec<f64>>> = BTreeMap::new();
    for one in series {
        let days = values.entry(one.family()).or_default();
        one.days.iter().for_each(|d| days.entry(d.day).or_default().push(d.value));
    }
    values
        .into_iter()
        .map(|(family, days)| (family, Band { days: days.into_iter().filter_map(day).collect() }))
        .collect()
}

fn day((day, mut values): (i64, Vec<f64>)) -> Option<BandDay> {
    values.sort_by(f64::total_cmp);
    let at = |part: f64| values[(part * (values.len() - 1) as f64).round() as usize];
    (values.len() >= 3).then(|| BandDay { day, low: at(0.1), middle: at(0.5), high: at(0.9) })
}
