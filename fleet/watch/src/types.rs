//! What goes in and what comes out.

use serde::Serialize;

/// One parameter of one robot, estimated from the recordings of one day.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Observation {
    /// Days since 1970-01-01.
    pub day: i64,
    /// The estimate, in the series' unit.
    pub value: f64,
    /// Standard deviation of the estimate as the identification states it, in the series' unit. What varies from day to
    /// day beyond it is estimated.
    pub sigma: f64,
    /// Of the joint or the robot, degrees Celsius.
    pub temperature: Option<f64>,
    /// Any measure of how hard the robot worked, in one unit for all days.
    pub load: Option<f64>,
}

/// One parameter of one robot over the days.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Name of the robot.
    pub robot: String,
    /// Name of the robot table; robots with the same one are siblings.
    pub table: String,
    /// Name of the parameter.
    pub parameter: String,
    /// Unit of values and sigmas.
    pub unit: String,
    /// In ascending order of days. Values that are no finite numbers are passed over.
    pub observations: Vec<Observation>,
}

/// What `watch` found.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Watched {
    /// One for each series that has enough days, ordered by table, parameter and robot.
    pub trends: Vec<Trend>,
    /// In the order in which they were raised; of one day the strongest first.
    pub alarms: Vec<Alarm>,
}

/// A series from its first to its last day, with what temperature, load and the siblings' common variation explain taken
/// out. It describes; decisions are alarms.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Trend {
    /// Name of the robot.
    pub robot: String,
    /// Name of the robot table.
    pub table: String,
    /// Name of the parameter.
    pub parameter: String,
    /// Unit of the parameter.
    pub unit: String,
    /// Days with an estimate.
    pub days: usize,
    /// Theil-Sen slope, unit a day.
    pub slope: f64,
    /// Its 95 % interval.
    pub slope_interval: (f64, f64),
    /// Two-sided p-value of Mann and Kendall's test, with the variance of Hamed and Rao (1998).
    pub monotone_p_value: f64,
    /// First day after the most likely change of level (Pettitt 1979).
    pub change_day: i64,
    /// Median after it less median before it.
    pub change: f64,
    /// Standard deviation of `change`, for dependent days.
    pub change_sigma: f64,
    /// p-value of Pettitt's test for the number of days that are worth as much as independent ones.
    pub change_p_value: f64,
    /// Change of the value with a degree Celsius, and its standard deviation, where temperatures are known.
    pub per_degree: Option<(f64, f64)>,
    /// Change of the value with a unit of load, and its standard deviation, where loads are known.
    pub per_load: Option<(f64, f64)>,
    /// Standard deviation of the day-to-day variation, the estimates' own included.
    pub day_to_day: f64,
    /// Its correlation from one day to the next.
    pub day_to_day_correlation: f64,
    /// Where the last days stand among those of the siblings.
    pub siblings: Option<SiblingComparison>,
    /// Evidence against "nothing has changed" on the last day: 1 is none, 20 is as rare as one in 20. `None` while the
    /// series calibrates.
    pub e_value: Option<f64>,
}

/// A robot among those with the same table.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct SiblingComparison {
    /// Robots compared with, this one not counted.
    pub siblings: usize,
    /// Median of the siblings.
    pub centre: f64,
    /// Robust standard deviation of the siblings (Qn of Rousseeuw and Croux 1993).
    pub spread: f64,
    /// How many of them this robot is off.
    pub deviations: f64,
}

/// How a series changed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Kind {
    /// The value moves a little every day.
    Drift,
    /// The value jumped and stays.
    Step,
    /// The value is not what robots with the same table have, since the first day.
    UnlikeSiblings,
}

/// A change that somebody should look at. At most one is raised for a series.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Alarm {
    /// Name of the robot.
    pub robot: String,
    /// Name of the robot table.
    pub table: String,
    /// Name of the parameter.
    pub parameter: String,
    /// Unit of the parameter.
    pub unit: String,
    /// Day on which it was raised, days since 1970-01-01.
    pub day: i64,
    /// Most likely day on which it began.
    pub began: i64,
    /// Days between which it began with a probability of nine tenths.
    pub began_between: (i64, i64),
    /// How it changed.
    pub kind: Kind,
    /// By how much, up to the day of the alarm, in `unit`. For [`Kind::UnlikeSiblings`] the difference from their median.
    pub change: f64,
    /// Standard deviation of `change`.
    pub change_sigma: f64,
    /// Level before the change; the siblings' median for [`Kind::UnlikeSiblings`].
    pub before: f64,
    /// Evidence against "nothing has changed" on the day of the alarm, at most 1e300.
    pub e_value: f64,
    /// Siblings that had days before the change and after it; for [`Kind::UnlikeSiblings`] those compared with.
    pub siblings: usize,
    /// Median of the changes of these siblings from before `began` to the day of the alarm, as identified, in `unit`; `None`
    /// where there are none, and for [`Kind::UnlikeSiblings`].
    pub siblings_change: Option<f64>,
    /// What it is of, when and how much it changed, in plain words.
    pub sentence: String,
}
