//! The page of one robot.

use super::fleet::outcomes;
use super::{FindingFact, LEGEND, Pages, RecordingFact, Robot, counted, escape, framed, kind};
use crate::calendar::date;
use crate::clean::Clean;
use crate::words::{plus_minus, signed, significant};
use crate::{Alarm, Kind, Trend};
use std::fmt::Write as _;

/// Most recordings, and most findings, that are listed: the latest.
const MOST_LISTED: usize = 400;
/// Findings that are seen at once: the latest.
const FINDINGS_SHOWN: usize = 3;

pub(super) fn page(pages: &Pages<'_>, name: &str) -> String {
    let robot = pages.robots.iter().find(|r| r.name == name);
    let mut body = format!("<p class=\"note\"><a href=\"../fleet.html\">Fleet</a></p><h1>{}", escape(name));
    if let Some(robot) = robot {
        let _ = write!(body, " <span class=\"note\">{}</span>", escape(&pages.tables(robot)));
    }
    body.push_str("</h1>");
    verdict(&mut body, pages, name, robot);
    if let Some(robot) = robot.filter(|r| !r.alarms.is_empty()) {
        body.push_str("<h2>Alarms</h2>");
        robot.alarms.iter().for_each(|a| alarm(&mut body, a));
    }
    if let Some(facts) = pages.facts.get(name) {
        findings(&mut body, &facts.findings);
    }
    if let Some(robot) = robot {
        body.push_str("<h2>Parameters, day by day</h2>");
        body.push_str(LEGEND);
        pages.multiples(&mut body, robot);
        parameters(&mut body, pages, robot);
    }
    if let Some(facts) = pages.facts.get(name) {
        recordings(&mut body, &facts.recordings);
    }
    framed(name, &body)
}

/// Alarms, days and recordings in numbers.
fn verdict(out: &mut String, pages: &Pages<'_>, name: &str, robot: Option<&Robot<'_>>) {
    let alarms = robot.map_or(0, |r| r.alarms.len());
    let (class, what) =
        if alarms == 0 { ("", "No alarm".to_owned()) } else { (" law", counted(alarms, "alarm")) };
    let series = || robot.into_iter().flat_map(|r| &r.series).map(|&place| &pages.clean[place]);
    let days = || series().flat_map(|s| &s.days).map(|d| d.day);
    let span = match (days().min(), days().max()) {
        (Some(first), Some(last)) => {
            format!("; {} from {} to {}", counted(series().count(), "parameter"), date(first), date(last))
        }
        _ => "; no recording gave parameters".to_owned(),
    };
    let recordings = outcomes(pages.facts.get(name).into_iter());
    let recordings =
        if recordings.is_empty() { String::new() } else { format!(" Recordings: {recordings}.") };
    let _ = write!(out, "<p class=\"verdict{class}\">{what}{span}.{}</p>", escape(&recordings));
}

fn alarm(out: &mut String, alarm: &Alarm) {
    let _ = write!(
        out,
        "<p>{} <span class=\"note\">{}, alarm of {}. {}</span></p>",
        escape(&alarm.sentence),
        kind(alarm.kind),
        date(alarm.day),
        escape(&of_siblings(alarm))
    );
}

/// What robots with the same table did.
fn of_siblings(alarm: &Alarm) -> String {
    let siblings = counted(alarm.siblings, "robot");
    let unit = if alarm.unit.is_empty() { String::new() } else { format!(" {}", alarm.unit) };
    match (alarm.kind, alarm.siblings_change) {
        (Kind::UnlikeSiblings, _) => {
            format!("Median of {siblings} with the same table: {}{unit}.", significant(alarm.before, 3))
        }
        (_, Some(change)) => {
            format!(
                "Meanwhile {siblings} with the same table: {}{unit} (median).",
                signed(change, alarm.change_sigma)
            )
        }
        _ => "No other robot with the same table was recorded meanwhile.".to_owned(),
    }
}

/// What diagnoses found, the latest first: a gear that wears is found every few days anew.
fn findings(out: &mut String, findings: &[FindingFact]) {
    if findings.is_empty() {
        return;
    }
    out.push_str(
        "<h2>Findings</h2><p class=\"note\">Recordings whose errors had risen were diagnosed against the robot's \
         reference: the fleet file's model of it, or its first day.</p>",
    );
    let named: Vec<&FindingFact> = findings.iter().filter(|f| !f.effect.is_empty()).collect();
    if named.is_empty() {
        out.push_str("<p>Nothing was named.</p>");
    }
    let shown = named.len().min(FINDINGS_SHOWN);
    named.iter().rev().take(shown).for_each(|f| finding(out, f));
    if findings.len() > shown {
        let _ = write!(out, "<details><summary>All diagnoses ({})</summary>", findings.len());
        findings.iter().rev().take(MOST_LISTED).for_each(|f| finding(out, f));
        earlier(out, findings.len());
        out.push_str("</details>");
    }
}

fn finding(out: &mut String, finding: &FindingFact) {
    let confidence = finding.confidence.map_or_else(String::new, |c| format!("; confidence {c:.3}"));
    let _ = write!(
        out,
        "<p><strong>{}</strong> {} <span class=\"note\">{}{confidence}</span></p>",
        date(finding.day),
        escape(&finding.sentence),
        escape(&finding.recording)
    );
}

fn percent(part: f64) -> String {
    format!("{} %", significant(100.0 * part, 2))
}

fn earlier(out: &mut String, all: usize) {
    if all > MOST_LISTED {
        let _ = write!(out, "<p class=\"note\">and {} earlier ones.</p>", all - MOST_LISTED);
    }
}

/// The last value of each parameter, its trend and where the siblings are.
fn parameters(out: &mut String, pages: &Pages<'_>, robot: &Robot<'_>) {
    out.push_str(
        "<details><summary>Parameters as numbers</summary><div class=\"wide\"><table><thead><tr><th class=\"words\">parameter</th>\
         <th class=\"words\">last day</th><th>value</th><th>siblings' median</th><th>deviations off</th><th>change in 30 days</th>\
         <th>e-value</th></tr></thead><tbody>",
    );
    for one in robot.series.iter().map(|&place| &pages.clean[place]) {
        let Some(last) = one.days.last() else { continue };
        let source = one.source;
        let trend = trend_of(pages, one);
        let number = |value: Option<f64>, digits| value.map_or_else(String::new, |v| significant(v, digits));
        let siblings = trend.and_then(|t| t.siblings);
        let slope = trend.map_or_else(String::new, |t| {
            let [low, high] = [t.slope_interval.0, t.slope_interval.1].map(|s| significant(30.0 * s, 2));
            format!("{} ({low} to {high})", significant(30.0 * t.slope, 2))
        });
        let _ = write!(
            out,
            "<tr><td class=\"words\">{}</td><td class=\"words\">{}</td><td>{}</td><td>{}</td><td>{}</td><td>{slope}</td><td>{}</td></tr>",
            escape(&source.parameter),
            date(last.day),
            escape(&plus_minus(last.value, last.sigma, &source.unit)),
            number(siblings.map(|s| s.centre), 3),
            number(siblings.map(|s| s.deviations), 2),
            number(trend.and_then(|t| t.e_value), 2),
        );
    }
    out.push_str(
        "</tbody></table></div><p class=\"note\">Behind ±: the standard deviation that the recording states. Siblings are robots \
         with the same table; deviations are theirs (robust), of the median of the last seven days. The change in 30 days is the \
         Theil-Sen slope with its 95 % interval; temperature, load and what all siblings share on a day are taken out of both. An \
         e-value is evidence against \u{201c}nothing has changed\u{201d}: 1 is none; a healthy series ever reaches 20 with a \
         probability of one in twenty at most. Empty: too few days.</p></details>",
    );
}

/// The trend of a series; trends are in the order of table, parameter and robot.
fn trend_of<'a>(pages: &Pages<'a>, series: &Clean<'_>) -> Option<&'a Trend> {
    let s = series.source;
    let key = (&s.table, &s.parameter, &s.robot);
    let place = pages.watched.trends.binary_search_by(|t| (&t.table, &t.parameter, &t.robot).cmp(&key));
    pages.watched.trends.get(place.ok()?)
}

/// What became of the recordings: those that are not used, then all; the latest first.
fn recordings(out: &mut String, recordings: &[RecordingFact]) {
    if recordings.is_empty() {
        return;
    }
    out.push_str("<h2>Recordings</h2>");
    let unused: Vec<&RecordingFact> = recordings.iter().filter(|r| !r.is_used()).collect();
    if unused.is_empty() {
        out.push_str("<p>All recordings are used.</p>");
    } else {
        out.push_str("<p>Not used:</p>");
        listed(out, &unused);
    }
    let _ = write!(out, "<details><summary>All recordings ({})</summary>", recordings.len());
    listed(out, &recordings.iter().collect::<Vec<_>>());
    out.push_str(
        "<p class=\"note\">Error: of the torques, what the recording's own parameters leave. Against reference: the error with \
         the parameters of the robot's reference over that.</p></details>",
    );
}

fn listed(out: &mut String, recordings: &[&RecordingFact]) {
    out.push_str(
        "<div class=\"wide\"><table><thead><tr><th class=\"words\">day</th><th class=\"words\">outcome</th><th>error</th>\
         <th>against reference</th><th class=\"words\">recording</th><th class=\"words\">what to know</th></tr></thead><tbody>",
    );
    for recording in recordings.iter().rev().take(MOST_LISTED) {
        let rise = recording.rise.map_or_else(String::new, |rise| format!("\u{d7} {rise:.2}"));
        let _ = write!(
            out,
            "<tr><td class=\"words\">{}</td><td class=\"words\">{}</td><td>{}</td><td>{rise}</td><td class=\"words\">{}</td>\
             <td class=\"words\">{}</td></tr>",
            date(recording.day),
            escape(&recording.outcome),
            recording.relative_error.map_or_else(String::new, percent),
            escape(&recording.recording),
            escape(&recording.message),
        );
    }
    out.push_str("</tbody></table></div>");
    earlier(out, recordings.len());
}
