//! What an alarm says.

use crate::Series;
use crate::calendar::date;
use crate::evidence::Began;
use crate::filter::Estimated;
use crate::meanwhile::Meanwhile;
use crate::words::{percent_of, plus_minus, rarity};
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
    /// Siblings that had days before the change and after it; for [`Kind::UnlikeSiblings`] those compared with.
    pub siblings: usize,
    /// Median of the changes of these siblings from before `began` to the day of the alarm, as identified, in `unit`; `None`
    /// where there are none, and for [`Kind::UnlikeSiblings`].
    pub siblings_change: Option<f64>,
    /// What it is of, when and how much it changed, in plain words.
    pub sentence: String,
}

/// Largest e-value that is told.
const LARGEST: f64 = 1e300;

/// An alarm that is being raised.
pub(crate) struct Raised<'a> {
    pub(crate) source: &'a Series,
    pub(crate) day: i64,
    pub(crate) ln_e_value: f64,
}

impl Raised<'_> {
    /// For a change of a robot against itself.
    pub(crate) fn change(
        &self,
        began: &Began,
        (change, before): (Estimated, Estimated),
        meanwhile: Meanwhile,
    ) -> Alarm {
        let Series { robot, parameter, unit, .. } = self.source;
        let verb = match (began.kind, change.mean > 0.0) {
            (Kind::Drift, true) => "has been rising",
            (Kind::Drift, false) => "has been falling",
            (_, true) => "jumped up",
            (_, false) => "jumped down",
        };
        let when = if began.between.0 < began.between.1 {
            let (from, to) = (date(began.between.0), date(began.between.1));
            format!("{} (between {from} and {to})", date(began.start))
        } else {
            date(began.start)
        };
        let preposition = if began.kind == Kind::Drift { "since about" } else { "on about" };
        let sentence = format!(
            "{parameter} of {robot} {verb} {preposition} {when}: by {}{} up to {}. {}",
            plus_minus(change.mean.abs(), change.sigma, unit),
            percent_of(change, before),
            date(self.day),
            rarity(self.ln_e_value),
        );
        let alarm = self.alarm(began.kind, (began.start, began.between), change, before.mean, sentence);
        Alarm { siblings: meanwhile.siblings, siblings_change: meanwhile.change, ..alarm }
    }

    /// For a robot that has not been like its siblings since its first day.
    pub(crate) fn unlike_siblings(
        &self,
        first: i64,
        level: Estimated,
        (siblings, centre): (usize, f64),
    ) -> Alarm {
        let Series { robot, parameter, unit, .. } = self.source;
        let change = Estimated { mean: level.mean - centre, sigma: level.sigma };
        let side = if change.mean > 0.0 { "above" } else { "below" };
        let sentence = format!(
            "{parameter} of {robot} has been {side} what robots of the same table have since its first day: by {}{}. {}",
            plus_minus(change.mean.abs(), change.sigma, unit),
            percent_of(change, Estimated { mean: centre, sigma: level.sigma }),
            rarity(self.ln_e_value),
        );
        Alarm {
            siblings,
            ..self.alarm(Kind::UnlikeSiblings, (first, (first, first)), change, centre, sentence)
        }
    }

    fn alarm(
        &self,
        kind: Kind,
        (began, began_between): (i64, (i64, i64)),
        change: Estimated,
        before: f64,
        sentence: String,
    ) -> Alarm {
        Alarm {
            robot: self.source.robot.clone(),
            table: self.source.table.clone(),
            parameter: self.source.parameter.clone(),
            unit: self.source.unit.clone(),
            day: self.day,
            began,
            began_between,
            kind,
            change: change.mean,
            change_sigma: change.sigma,
            before,
            e_value: self.ln_e_value.exp().min(LARGEST),
            siblings: 0,
            siblings_change: None,
            sentence,
        }
    }
}
