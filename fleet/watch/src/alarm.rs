//! What an alarm says.

use serde::Serialize;

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
    /// All of this in plain words.
    pub sentence: String,
}
