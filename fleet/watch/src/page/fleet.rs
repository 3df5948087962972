//! `fleet.html`: all robots, the worst first.

use super::{LEGEND, Pages, Robot, RobotFacts, counted, escape, framed, kind};
use crate::calendar::date;
use crate::words::significant;
use std::collections::BTreeMap;
use std::fmt::Write as _;

/// Most robots that are drawn; the others with alarms have their sentences.
const MOST_DRAWN: usize = 40;
/// Robots without an alarm that are drawn: those with the most evidence.
const QUIET_DRAWN: usize = 3;
/// Least e-value of a robot without an alarm that is drawn.
const WORTH_A_LOOK: f64 = 20.0;

pub(super) fn page(pages: &Pages<'_>) -> String {
    let mut body = String::from("<h1>Fleet</h1>");
    verdict(&mut body, pages);
    let (alarmed, quiet): (Vec<&Robot<'_>>, Vec<&Robot<'_>>) =
        pages.robots.iter().partition(|r| !r.alarms.is_empty());
    if !alarmed.is_empty() {
        body.push_str("<h2>Alarms, the worst robot first</h2>");
        body.push_str(LEGEND);
        alarmed.iter().enumerate().for_each(|(k, r)| card(&mut body, pages, r, k < MOST_DRAWN));
    }
    let look: Vec<&&Robot<'_>> =
        quiet.iter().filter(|r| r.e_value >= WORTH_A_LOOK).take(QUIET_DRAWN).collect();
    if !look.is_empty() {
        body.push_str("<h2>No alarm yet, but the most evidence of the others</h2>");
        look.iter().for_each(|r| card(&mut body, pages, r, true));
    }
    table(&mut body, pages, &quiet);
    without_parameters(&mut body, pages);
    framed("Fleet", &body)
}

/// How many robots, how many alarms, and what became of the recordings.
fn verdict(out: &mut String, pages: &Pages<'_>) {
    let (clean, watched, robots) = (&pages.clean, pages.watched, &pages.robots);
    let days = || clean.iter().flat_map(|c| &c.days).map(|d| d.day);
    let with = robots.iter().filter(|r| !r.alarms.is_empty()).count();
    let (class, what) = match watched.alarms.len() {
        0 => ("", format!("No alarm on {}", counted(robots.len(), "robot"))),
        n => (" law", format!("{} on {with} of {}", counted(n, "alarm"), counted(robots.len(), "robot"))),
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
    let recordings = outcomes(pages.facts.values());
    if !recordings.is_empty() {
        let _ = write!(out, "<p class=\"note\">Recordings: {}.</p>", escape(&recordings));
    }
}

/// `118 used, 1 refused`; those that are used first, then by name.
pub(super) fn outcomes<'a>(facts: impl Iterator<Item = &'a RobotFacts>) -> String {
    let mut counts: BTreeMap<(bool, &str), usize> = BTreeMap::new();
    for recording in facts.flat_map(|f| &f.recordings) {
        *counts.entry((!recording.is_used(), &recording.outcome)).or_default() += 1;
    }
    let words: Vec<String> =
        counts.iter().map(|((_, outcome), count)| format!("{count} {outcome}")).collect();
    words.join(", ")
}

/// A robot: its alarms in words, its parameters in pictures, those with an alarm first.
fn card(out: &mut String, pages: &Pages<'_>, robot: &Robot<'_>, draws: bool) {
    let _ = write!(
        out,
        "<section><h3>{} <span class=\"note\">{}</span></h3>",
        linked(pages, robot.name),
        escape(&pages.tables(robot))
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
        pages.multiples(out, robot);
    }
    out.push_str("</section>");
}

fn linked(pages: &Pages<'_>, robot: &str) -> String {
    match (pages.labels.link)(robot) {
        Some(address) => format!("<a href=\"{}\">{}</a>", escape(&address), escape(robot)),
        None => escape(robot),
    }
}

/// Robots without an alarm: where each has the most evidence.
fn table(out: &mut String, pages: &Pages<'_>, quiet: &[&Robot<'_>]) {
    if quiet.is_empty() {
        return;
    }
    let _ = write!(
        out,
        "<details><summary>{} without an alarm</summary><div class=\"wide\"><table><thead><tr><th class=\"words\">robot</th>\
         <th class=\"words\">table</th><th>series</th><th class=\"words\">most evidence in</th><th>e-value</th></tr></thead><tbody>",
        counted(quiet.len(), "robot")
    );
    for robot in quiet {
        let _ = write!(
            out,
            "<tr><td class=\"words\">{}</td><td class=\"words\">{}</td><td>{}</td><td class=\"words\">{}</td><td>{}</td></tr>",
            linked(pages, robot.name),
            escape(&pages.tables(robot)),
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

/// Robots of which no recording gave parameters: nothing watches them.
fn without_parameters(out: &mut String, pages: &Pages<'_>) {
    let known = |name: &str| pages.robots.iter().any(|r| r.name == name);
    let names: Vec<&String> = pages.facts.keys().filter(|name| !known(name)).collect();
    if names.is_empty() {
        return;
    }
    out.push_str("<h2>Not watched: no recording gave parameters</h2><ul>");
    for name in names {
        let what = outcomes(pages.facts.get(name).into_iter());
        let _ = write!(out, "<li>{} <span class=\"note\">{}</span></li>", linked(pages, name), escape(&what));
    }
    out.push_str("</ul>");
}
