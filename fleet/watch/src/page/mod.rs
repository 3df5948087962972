//! `fleet.html`: what a service team reads first.

mod chart;
mod escape;
mod family;
mod robots;

use crate::calendar::date;
use crate::clean::{Clean, clean};
use crate::words::significant;
use crate::{Alarm, Kind, Series, Watched};
use chart::chart;
use escape::escape;
use family::{Band, bands};
use robots::{Robot, robots};
use std::collections::BTreeMap;
use std::fmt::Write as _;

const STYLE: &str = include_str!("page.css");
/// Most robots that are drawn; the others with alarms have their sentences.
const MOST_DRAWN: usize = 40;
/// Days of a series that are drawn, its last ones.
const DAYS_DRAWN: i64 = 365;
/// Robots without an alarm that are drawn: those with the most evidence.
const QUIET_DRAWN: usize = 3;
/// Least e-value of a robot without an alarm that is drawn.
const WORTH_A_LOOK: f64 = 20.0;

/// One self-contained page: the worst robot first, its parameters as small charts before the band of its siblings, its
/// alarms as sentences. It needs no script and nothing from elsewhere.
///
/// `series` are those that `watched` was made of, in any order; the page has no other numbers. `links` gives the address of
/// a robot's own report, where it has one.
///
/// ```
/// use dynid_fleet_watch::{Settings, page, watch};
///
/// let watched = watch(&[], &Settings::default());
/// let html = page(&[], &watched, &|robot| Some(format!("robots/{robot}.html")));
/// assert!(html.contains("No alarm"));
/// ```
pub fn page(series: &[Series], watched: &Watched, links: &dyn Fn(&str) -> Option<String>) -> String {
    let clean = clean(series);
    let bands = bands(&clean);
    let robots = robots(&clean, watched);
    let mut body = String::from("<h1>Fleet</h1>");
    verdict(&mut body, &clean, watched, &robots);
    let (alarmed, quiet): (Vec<&Robot<'_>>, Vec<&Robot<'_>>) =
        robots.iter().partition(|r| !r.alarms.is_empty());
    if !alarmed.is_empty() {
        body.push_str("<h2>Alarms, the worst robot first</h2>");
        legend(&mut body);
        alarmed.iter().enumerate().for_each(|(k, r)| card(&mut body, r, &bands, links, k < MOST_DRAWN));
    }
    let look: Vec<&&Robot<'_>> =
        quiet.iter().filter(|r| r.e_value >= WORTH_A_LOOK).take(QUIET_DRAWN).collect();
    if !look.is_empty() {
        body.push_str("<h2>No alarm yet, but the most evidence of the others</h2>");
        look.iter().for_each(|r| card(&mut body, r, &bands, links, true));
    }
    table(&mut body, &quiet, links);
    format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n<title>Fleet</title>\n\
         <style>\n{STYLE}</style>\n</head>\n<body>\n<main>{body}</main>\n</body>\n</html>\n"
    )
}

/// How many robots, how many alarms.
fn verdict(out: &mut String, clean: &[Clean<'_>], watched: &Watched, robots: &[Robot<'_>]) {
    let days = || clean.iter().flat_map(|c| &c.days).map(|d| d.day);
    let with = robots.iter().filter(|r| !r.alarms.is_empty()).count();
    let count = |n: usize, what: &str| if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") };
    let (class, what) = match watched.alarms.len() {
        0 => ("", format!("No alarm on {}", count(robots.len(), "robot"))),
        n => (" law", format!("{} on {with} of {}", count(n, "alarm"), count(robots.len(), "robot"))),
    };
    let span = match (days().min(), days().max()) {
        (Some(first), Some(last)) => format!(" from {} to {}", date(first), date(last)),
        _ => String::new(),
    };
    let _ = write!(
        out,
        "<p class=\"verdict{class}\">{what}; {} parameters of robots watched{span}.</p>",
        clean.len()
    );
    let waiting = clean.len().saturating_sub(watched.trends.len());
    if waiting > 0 {
        let _ = write!(out, "<p class=\"note\">{waiting} series have too few days to be watched.</p>");
    }
}

fn legend(out: &mut String) {
    out.push_str(
        "<p class=\"legend\"><span class=\"key law\">this robot, with an alarm</span><span class=\"key after\">without</span>\
         <span class=\"key band\">middle four fifths of its siblings</span><span class=\"key between\">when it began, nine \
         chances in ten</span> solid line: began; dashed line: alarm. Values of the last year \
         as identified, temperature and load not taken out.</p>",
    );
}

/// A robot: its alarms in words, its parameters in pictures, those with an alarm first.
fn card(
    out: &mut String,
    robot: &Robot<'_>,
    bands: &BTreeMap<(&str, &str), Band>,
    links: &dyn Fn(&str) -> Option<String>,
    draws: bool,
) {
    let _ = write!(
        out,
        "<section><h3>{} <span class=\"note\">{}</span></h3>",
        linked(robot.name, links),
        escape(&robot.tables())
    );
    for alarm in &robot.alarms {
        let _ = write!(
            out,
            "<p>{} <span class=\"note\">{}, alarm of {}.</span></p>",
            escape(&alarm.sentence),
            kind(alarm.kind),
            date(alarm.day)
        );
    }
    if draws {
        out.push_str("<div class=\"multiples\">");
        let empty = Band::default();
        for one in &robot.series {
            let alarm = robot.alarm_of(one);
            let from = one.days.last().map_or(0, |d| d.day - DAYS_DRAWN);
            let drawn = one.days.iter().filter(|d| d.day > from);
            let points: Vec<(i64, f64)> = drawn.map(|d| (d.day, d.value)).collect();
            out.push_str(&chart(one.source, &points, bands.get(&one.family()).unwrap_or(&empty), alarm));
        }
        out.push_str("</div>");
    }
    out.push_str("</section>");
}

fn kind(kind: Kind) -> &'static str {
    match kind {
        Kind::Drift => "Drift",
        Kind::Step => "Step",
        Kind::UnlikeSiblings => "Unlike its siblings",
    }
}

fn linked(robot: &str, links: &dyn Fn(&str) -> Option<String>) -> String {
    match links(robot) {
        Some(address) => format!("<a href=\"{}\">{}</a>", escape(&address), escape(robot)),
        None => escape(robot),
    }
}

/// Robots without an alarm: where each has the most evidence.
fn table(out: &mut String, quiet: &[&Robot<'_>], links: &dyn Fn(&str) -> Option<String>) {
    if quiet.is_empty() {
        return;
    }
    let _ = write!(
        out,
        "<details><summary>{} robots without an alarm</summary><div class=\"wide\"><table><thead><tr><th class=\"words\">robot</th>\
         <th class=\"words\">table</th><th>series</th><th class=\"words\">most evidence in</th><th>e-value</th></tr></thead><tbody>",
        quiet.len()
    );
    for robot in quiet {
        let _ = write!(
            out,
            "<tr><td class=\"words\">{}</td><td class=\"words\">{}</td><td>{}</td><td class=\"words\">{}</td><td>{}</td></tr>",
            linked(robot.name, links),
            escape(&robot.tables()),
            robot.series.len(),
            escape(robot.most_evidence_in),
            significant(robot.e_value, 2)
        );
    }
    out.push_str(
        "</tbody></table></div><p class=\"note\">An e-value is evidence against \u{201c}nothing has changed\u{201d}: 1 is none; a \
         healthy series ever reaches 20 with a probability of one in twenty at most.</p></details>",
    );
}

/// The strongest of some alarms.
fn strongest(alarms: &[&Alarm]) -> f64 {
    alarms.iter().map(|a| a.e_value).fold(0.0, f64::max)
}
