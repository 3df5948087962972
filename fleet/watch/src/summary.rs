//! Series as a whole, when all days are there.

use crate::change::change;
use crate::fleet::{Entry, Fleet};
use crate::robust::median;
use crate::siblings::Levels;
use crate::trend::monotone;
use crate::types::{SiblingComparison, Trend};
use std::collections::BTreeMap;

/// Days at the end of a series whose median is its present level.
const PRESENT: usize = 7;
/// Largest e-value that is told.
const LARGEST: f64 = 1e300;

/// Trends of all series that were watched.
pub(crate) fn trends(fleet: &Fleet<'_>) -> Vec<Trend> {
    let corrected: Vec<Option<Vec<f64>>> = fleet.entries.iter().map(|e| corrected(fleet, e)).collect();
    let present = |values: &Vec<f64>| median(&values[values.len().saturating_sub(PRESENT)..]).unwrap_or(0.0);
    let mut levels: BTreeMap<_, Vec<f64>> = BTreeMap::new();
    let mut places = Vec::new();
    for (entry, values) in fleet.entries.iter().zip(&corrected) {
        let Some((key, values)) = entry.key().zip(values.as_ref()) else {
            places.push(0);
            continue;
        };
        let of_group = levels.entry(key).or_default();
        places.push(of_group.len());
        of_group.push(present(values));
    }
    let levels: BTreeMap<_, Levels> = levels.into_iter().map(|(key, l)| (key, Levels::new(l))).collect();
    let each = fleet.entries.iter().zip(&corrected).zip(places);
    each.filter_map(|((entry, values), place)| {
        let values = values.as_ref()?;
        let siblings = levels.get(&entry.key()?)?.compare(place, present(values), 0.0);
        trend(fleet, entry, values, siblings)
    })
    .collect()
}

fn corrected(fleet: &Fleet<'_>, entry: &Entry<'_>) -> Option<Vec<f64>> {
    let (_, group) = fleet.group_of(entry)?;
    let member = entry.member.as_ref()?;
    Some(entry.clean.days.iter().map(|d| member.corrected(d, group)).collect())
}

fn trend(
    fleet: &Fleet<'_>,
    entry: &Entry<'_>,
    values: &[f64],
    siblings: Option<SiblingComparison>,
) -> Option<Trend> {
    let (_, group) = fleet.group_of(entry)?;
    let member = entry.member.as_ref()?;
    let days: Vec<i64> = entry.clean.days.iter().map(|d| d.day).collect();
    let monotone = monotone(&days, values, group.dispersion.memory)?;
    let change = change(values, monotone.effective_fraction)?;
    let source = entry.clean.source;
    Some(Trend {
        robot: source.robot.clone(),
        table: source.table.clone(),
        parameter: source.parameter.clone(),
        unit: source.unit.clone(),
        days: days.len(),
        slope: monotone.slope,
        slope_interval: monotone.interval,
        monotone_p_value: monotone.p_value,
        change_day: days[change.first],
        change: change.size,
        change_sigma: change.sigma,
        change_p_value: change.p_value,
        per_degree: member.slope(0, group),
        per_load: member.slope(1, group),
        day_to_day: member.scale.sigma,
        day_to_day_correlation: group.dispersion.memory.at(1),
        siblings,
        e_value: Some(member.evidence.ln_e_value().exp().min(LARGEST)),
    })
}
