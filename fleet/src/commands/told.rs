//! What a person wants to know when a run ends.

use std::path::Path;

use dynid::output::on_one_line;
use dynid_fleet_watch::{plus_minus, signed, significant};

use crate::day;
use crate::run::alarms::AlarmRow;
use crate::run::{Outcomes, Summary};

/// Days, recordings and alarms, line by line.
pub(super) fn told(did: &Summary, out: &Path) -> String {
    let mut lines = vec![format!(
        "{} ({} worked out now), {} ({} reduced now{}): {}",
        counted(did.all_days, "day"),
        did.days,
        counted(did.recordings, "recording"),
        did.reduced,
        if did.replaced > 0 { format!(", {} of them replaced", did.replaced) } else { String::new() },
        outcomes(&did.outcomes)
    )];
    let new = did.alarms.iter().filter(|alarm| alarm.new).count();
    lines.push(match did.alarms.len() {
        0 => "no alarms".to_owned(),
        n => format!("{}, {new} of them new; the worst first:", counted(n, "alarm")),
    });
    lines.extend(did.alarms.iter().map(|alarm| on_one_line(&line(alarm))));
    lines.push(format!("look at {}", out.join("fleet.html").display()));
    lines.join("\n")
}

/// `1 day`, `2 days`.
fn counted(n: usize, what: &str) -> String {
    if n == 1 { format!("1 {what}") } else { format!("{n} {what}s") }
}

/// Those that are used always, the others where there are any.
fn outcomes(outcomes: &Outcomes) -> String {
    let others = [
        (outcomes.refused, "refused"),
        (outcomes.unreadable, "unreadable"),
        (outcomes.failed, "failed (please report it)"),
    ];
    let others = others.into_iter().filter(|(n, _)| *n > 0).map(|(n, what)| format!(", {n} {what}"));
    format!("{} used{}", outcomes.used, others.collect::<String>())
}

/// Robot, parameter, day, size with unit, and what siblings do.
fn line(alarm: &AlarmRow) -> String {
    let AlarmRow { robot, parameter, unit, change, change_sigma, .. } = alarm;
    let size = plus_minus(change.abs(), *change_sigma, unit);
    let sign = if *change < 0.0 { "\u{2212}" } else { "+" };
    let began = day::written(alarm.began);
    let how = match alarm.kind.as_str() {
        "drift" => format!("drifts since about {began}"),
        "step" => format!("jumped on about {began}"),
        "unlike_siblings" => format!("unlike its siblings since {began}"),
        _ => format!("changed on about {began}"),
    };
    format!(
        "{:4} {robot}  {parameter}  {}  {sign}{size}, {how}; {}",
        if alarm.new { "new" } else { "" },
        day::written(alarm.day),
        siblings(alarm)
    )
}

fn siblings(alarm: &AlarmRow) -> String {
    let (count, unit) = (alarm.siblings, &alarm.unit);
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    match alarm.siblings_change {
        _ if alarm.kind == "unlike_siblings" => {
            format!("siblings have {}{unit} (median of {count})", significant(alarm.before, 3))
        }
        Some(change) => {
            format!("siblings {}{unit} meanwhile (median of {count})", signed(change, alarm.change_sigma))
        }
        None => "no siblings to compare".to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn alarm() -> AlarmRow {
        AlarmRow {
            robot: "r004".into(),
            table: "6988".into(),
            parameter: "Fc2".into(),
            unit: "N.m".into(),
            day: 20_530,
            began: 20_520,
            kind: "drift".into(),
            change: 0.52,
            change_sigma: 0.09,
            before: 3.1,
            e_value: 1e5,
            siblings: 3,
            siblings_change: Some(-0.011),
            new: true,
        }
    }

    #[test]
    fn an_alarm_is_one_line_with_its_size_and_what_siblings_do() {
        assert_eq!(
            line(&alarm()),
            "new  r004  Fc2  2026-03-18  +0.52 ± 0.09 N.m, drifts since about 2026-03-08; siblings \u{2212}0.01 N.m meanwhile \
             (median of 3)"
        );
        let alone =
            AlarmRow { siblings: 0, siblings_change: None, new: false, kind: "step".into(), ..alarm() };
        assert!(line(&alone).starts_with("     r004") && line(&alone).ends_with("; no siblings to compare"));
        let unlike = AlarmRow { kind: "unlike_siblings".into(), siblings_change: None, ..alarm() };
        assert!(line(&unlike).ends_with("siblings have 3.10 N.m (median of 3)"), "{}", line(&unlike));
    }

    #[test]
    fn a_run_tells_days_recordings_and_alarms_and_that_there_are_none() {
        let outcomes = Outcomes { used: 5, unreadable: 1, ..Outcomes::default() };
        let (recordings, reduced, replaced, all_days, days) = (6, 2, 1, 3, 1);
        let did = Summary { recordings, reduced, replaced, all_days, days, outcomes, alarms: Vec::new() };
        assert_eq!(
            told(&did, Path::new("o")),
            "3 days (1 worked out now), 6 recordings (2 reduced now, 1 of them replaced): 5 used, 1 unreadable\nno alarms\nlook at o/fleet.html"
        );
        let forged = AlarmRow { robot: "r1\nno alarms\u{1b}[31m".into(), ..alarm() };
        let did = Summary { alarms: vec![forged], ..did };
        let told = told(&did, Path::new("o"));
        assert_eq!(told.lines().count(), 4, "{told}");
        assert!(told.contains("1 alarm, 1 of them new; the worst first:") && !told.contains('\u{1b}'));
    }
}
