//! Which alarms are right, and how late.

use crate::arm::Arm;
use crate::story::{FIRST_DAY, Fault, Story};
use dynid_fleet_watch::{Series, Watched};

/// A fault and what became of it.
#[derive(Clone, Debug)]
pub struct Found {
    pub robot: String,
    pub fault: Fault,
    pub onset: usize,
    /// Days from the onset to the first right alarm of the robot.
    pub delay: Option<i64>,
    /// Parameter and sentence of this alarm.
    pub first: Option<(String, String)>,
    /// Whether the interval of its beginning holds the onset.
    pub held: bool,
}

/// One fleet.
#[derive(Clone, Debug)]
pub struct Score {
    pub series: usize,
    pub alarms: usize,
    /// Alarms of series that have not changed on their day.
    pub false_alarms: Vec<String>,
    pub found: Vec<Found>,
}

impl Score {
    pub fn of(story: &Story, arm: &Arm, series: &[Series], watched: &Watched) -> Self {
        let names = arm.names();
        let mut false_alarms = Vec::new();
        let mut found = Vec::new();
        let mut right = Vec::new();
        for alarm in &watched.alarms {
            let robot = story.robots.iter().find(|r| r.name == alarm.robot).unwrap();
            let parameter = names.iter().position(|n| *n == alarm.parameter).unwrap();
            let onset = robot.fault.map_or(i64::MAX, |f| FIRST_DAY + f.1 as i64);
            if alarm.day >= onset && robot.is_changed(arm, parameter) {
                right.push(alarm);
            } else {
                false_alarms.push(format!("{} ({:?})", alarm.sentence, alarm.kind));
            }
        }
        for robot in &story.robots {
            let Some((fault, onset)) = robot.fault else { continue };
            let began = FIRST_DAY + onset as i64;
            let first = right.iter().find(|a| a.robot == robot.name);
            found.push(Found {
                robot: robot.name.clone(),
                fault,
                onset,
                delay: first.map(|a| a.day - began),
                first: first.map(|a| (a.parameter.clone(), a.sentence.clone())),
                held: first.is_some_and(|a| a.began_between.0 <= began && began <= a.began_between.1),
            });
        }
        Self { series: series.len(), alarms: watched.alarms.len(), false_alarms, found }
    }

    /// False alarms over alarms.
    pub fn proportion(&self) -> f64 {
        self.false_alarms.len() as f64 / self.alarms.max(1) as f64
    }
}
