//! What an alarm says.

use crate::calendar::date;
use crate::evidence::Began;
use crate::filter::Estimated;
use crate::meanwhile::Meanwhile;
use crate::words::{percent_of, plus_minus, rarity};
use crate::{Alarm, Kind, Series};

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
