//! What a service team reads: `fleet.html` first, then the page of a robot.

mod chart;
mod escape;
mod facts;
mod family;
mod fleet;
mod robot;
mod robots;

use crate::clean::{Clean, clean};
use crate::{Kind, Series, Watched};
use chart::chart;
use escape::escape;
pub use facts::{FindingFact, RecordingFact, RobotFacts};
use family::{Band, bands};
use robots::{Robot, robots};
use std::collections::{BTreeMap, BTreeSet};

const STYLE: &str = include_str!("page.css");
/// Days of a series that are drawn, its last ones.
const DAYS_DRAWN: i64 = 365;

/// Names and addresses on the pages.
#[derive(Clone, Copy)]
pub struct Labels<'a> {
    /// The address of a robot's page, seen from that of the fleet, where it has one.
    pub link: &'a dyn Fn(&str) -> Option<String>,
    /// What a person calls the robot table that series name.
    pub table: &'a dyn Fn(&str) -> String,
}

impl Labels<'_> {
    /// Robots have no pages; tables are called what series call them.
    pub fn plain() -> Self {
        Self { link: &|_| None, table: &str::to_owned }
    }
}

/// The pages of a fleet. Each is self-contained: it needs no script and nothing from elsewhere.
///
/// ```
/// use dynid_fleet_watch::{Labels, Pages, Settings, watch};
///
/// let watched = watch(&[], &Settings::default());
/// let facts = Default::default();
/// let pages = Pages::new(&[], &watched, &facts, Labels::plain());
/// assert!(pages.fleet().contains("No alarm"));
/// ```
pub struct Pages<'a> {
    clean: Vec<Clean<'a>>,
    bands: BTreeMap<(&'a str, &'a str), Band>,
    robots: Vec<Robot<'a>>,
    watched: &'a Watched,
    facts: &'a BTreeMap<String, RobotFacts>,
    labels: Labels<'a>,
}

impl<'a> Pages<'a> {
    /// Pages of the series that `watched` was made of, in any order, and of what else is known of robots, by their names.
    pub fn new(
        series: &'a [Series],
        watched: &'a Watched,
        facts: &'a BTreeMap<String, RobotFacts>,
        labels: Labels<'a>,
    ) -> Self {
        let clean = clean(series);
        let (bands, robots) = (bands(&clean), robots(&clean, watched));
        Self { clean, bands, robots, watched, facts, labels }
    }

    /// `fleet.html`: the worst robot first, its parameters as small charts before the band of its siblings, its alarms as
    /// sentences.
    pub fn fleet(&self) -> String {
        fleet::page(self)
    }

    /// A robot's own page, which lies in a folder beside `fleet.html`: its alarms and findings, all of its parameters, what
    /// became of its recordings. A robot that nothing is known of has an empty one.
    pub fn robot(&self, name: &str) -> String {
        robot::page(self, name)
    }

    /// Figures of a robot's parameters, those with an alarm first.
    fn multiples(&self, out: &mut String, robot: &Robot<'_>) {
        out.push_str("<div class=\"multiples\">");
        let empty = Band::default();
        for one in robot.series.iter().map(|&place| &self.clean[place]) {
            let from = one.days.last().map_or(0, |d| d.day - DAYS_DRAWN);
            let drawn = one.days.iter().filter(|d| d.day > from);
            let points: Vec<(i64, f64)> = drawn.map(|d| (d.day, d.value)).collect();
            let band = self.bands.get(&one.family()).unwrap_or(&empty);
            out.push_str(&chart(one.source, &points, band, robot.alarm_of(one)));
        }
        out.push_str("</div>");
    }

    /// What the tables of a robot are called.
    fn tables(&self, robot: &Robot<'_>) -> String {
        let tables: BTreeSet<&str> =
            robot.series.iter().map(|&place| self.clean[place].source.table.as_str()).collect();
        tables.into_iter().map(self.labels.table).collect::<Vec<_>>().join(", ")
    }
}

/// A whole page.
fn framed(title: &str, body: &str) -> String {
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>{}</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<main>{body}</main>\n</body>\n</html>\n",
        escape(title)
    )
}

/// What lines and areas of the figures are.
const LEGEND: &str = "<p class=\"legend\"><span class=\"key law\">this robot, with an alarm</span><span class=\"key after\">without</span>\
     <span class=\"key band\">middle four fifths of the robots with its table</span><span class=\"key between\">when it began, nine \
     chances in ten</span> dashed line through the band: their median; upright lines, solid: it began, dashed: alarm. Values of \
     the last year as identified, temperature and load not taken out.</p>";

/// `1 alarm`, `2 alarms`.
fn counted(n: usize, what: &str) -> String {
    if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") }
}

fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Drift => "Drift",
        Kind::Step => "Step",
        Kind::UnlikeSiblings => "Unlike its siblings",
    }
}
