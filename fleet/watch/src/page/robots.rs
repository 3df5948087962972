//! Robots in the order in which they are told: the worst first.

use crate::clean::Clean;
use crate::{Alarm, Watched};
use std::collections::{BTreeMap, BTreeSet};

/// A robot with all its series.
pub(super) struct Robot<'a> {
    pub(super) name: &'a str,
    /// Places of its series among all of them, those with an alarm first.
    pub(super) series: Vec<usize>,
    /// The strongest first.
    pub(super) alarms: Vec<&'a Alarm>,
    /// Largest e-value on the last day.
    pub(super) e_value: f64,
    /// Parameter of which it is.
    pub(super) most_evidence_in: &'a str,
}

impl Robot<'_> {
    pub(super) fn alarm_of(&self, series: &Clean<'_>) -> Option<&Alarm> {
        let s = series.source;
        self.alarms.iter().copied().find(|a| a.table == s.table && a.parameter == s.parameter)
    }
}

/// All robots: with the strongest alarm first, then those without by their evidence, then by name.
pub(super) fn robots<'a>(clean: &[Clean<'a>], watched: &'a Watched) -> Vec<Robot<'a>> {
    let mut all: BTreeMap<&str, Robot<'_>> = BTreeMap::new();
    for (place, series) in clean.iter().enumerate() {
        let name = series.source.robot.as_str();
        let new = || Robot { name, series: vec![], alarms: vec![], e_value: 0.0, most_evidence_in: "" };
        all.entry(name).or_insert_with(new).series.push(place);
    }
    for alarm in &watched.alarms {
        if let Some(robot) = all.get_mut(alarm.robot.as_str()) {
            robot.alarms.push(alarm);
        }
    }
    for trend in &watched.trends {
        let Some((robot, e_value)) = all.get_mut(trend.robot.as_str()).zip(trend.e_value) else { continue };
        if e_value > robot.e_value {
            (robot.e_value, robot.most_evidence_in) = (e_value, &trend.parameter);
        }
    }
    let mut robots: Vec<Robot<'_>> = all.into_values().collect();
    for robot in &mut robots {
        robot.alarms.sort_by(|a, b| b.e_value.total_cmp(&a.e_value));
        let alarmed: BTreeSet<(&str, &str)> =
            robot.alarms.iter().map(|a| (a.table.as_str(), a.parameter.as_str())).collect();
        robot.series.sort_by_key(|&place| !alarmed.contains(&clean[place].family()));
    }
    robots.sort_by(|a, b| {
        strongest(&b.alarms).total_cmp(&strongest(&a.alarms)).then_with(|| b.e_value.total_cmp(&a.e_value))
    });
    robots
}

/// The strongest of some alarms.
fn strongest(alarms: &[&Alarm]) -> f64 {
    alarms.iter().map(|a| a.e_value).fold(0.0, f64::max)
}
