//! `docs/fleet_alarms.md`: what the figures say.

use crate::arm::Arm;
use crate::score::{Found, Score};
use crate::story::{DAYS, Fault, ROBOTS, Story};
use dynid_fleet_watch::{Series, Watched};
use std::fmt::Write as _;

const INTRODUCTION: &str = include_str!("introduction.md");

pub fn one_fleet(arm: &Arm, story: &Story, series: &[Series], watched: &Watched, fleets: u64) -> String {
    let score = Score::of(story, arm, series, watched);
    let mut text = INTRODUCTION.replace("FLEETS", &fleets.to_string());
    let _ = write!(
        text,
        "## One fleet, every estimate an identification\n\n{ROBOTS} robots, {DAYS} days, {} series of {} base parameters. \
         {} alarms, {} false.\n\n| robot | fault | began on day | found after, days | first alarm |\n|---|---|---|---|---|\n",
        score.series,
        arm.names().len(),
        score.alarms,
        score.false_alarms.len()
    );
    for found in &score.found {
        let late = found.delay.map_or("not found".into(), |d| d.to_string());
        let sentence = found.first.as_ref().map_or("", |f| &f.1);
        let _ = writeln!(
            text,
            "| {} | {} | {} | {late} | {sentence} |",
            found.robot,
            told(found.fault),
            found.onset
        );
    }
    for sentence in &score.false_alarms {
        let _ = writeln!(text, "\nFalse: {sentence}");
    }
    text
}

fn told(fault: Fault) -> String {
    match fault {
        Fault::Wear { joint, rate } => format!("gear {joint} wears, {:.1} % a day", 100.0 * rate),
        Fault::LoosePayload { shift } => format!("payload slides by {:.0} mm", 1000.0 * shift),
        Fault::SwappedMotor => "motor of joint 2 swapped".into(),
    }
}

/// Faults of one kind and size.
type Kind<'a> = (&'a str, &'a dyn Fn(Fault) -> bool);

pub fn many_fleets(with: &[Score], without: &[Score]) -> String {
    let mut text = format!(
        "\n## {} fleets with faults, {} without\n\nErrors of the estimates are drawn from those of a thousand identifications.\n\n{}\n\
         | fault | number | found by day {DAYS} | days until then: 10 % | 50 % | 90 % | interval holds the beginning |\n|---|---|---|---|---|---|---|\n",
        with.len(),
        without.len(),
        proportions(with, without)
    );
    let wear = |low: f64, high: f64| move |f: Fault| matches!(f, Fault::Wear { rate, .. } if rate >= low && rate < high);
    let slide = |low: f64, high: f64| move |f: Fault| matches!(f, Fault::LoosePayload { shift } if shift >= low && shift < high);
    let kinds: [Kind<'_>; 6] = [
        ("gear wears, 0.6 to 1.0 % a day", &wear(0.0, 0.010)),
        ("gear wears, 1.0 to 1.5 % a day", &wear(0.010, 0.015)),
        ("gear wears, 1.5 to 2.0 % a day", &wear(0.015, 1.0)),
        ("payload slides by 20 to 35 mm", &slide(0.0, 0.035)),
        ("payload slides by 35 to 50 mm", &slide(0.035, 1.0)),
        ("motor swapped", &|f| f == Fault::SwappedMotor),
    ];
    for (name, is) in kinds {
        let of: Vec<&Found> = with.iter().flat_map(|s| &s.found).filter(|f| is(f.fault)).collect();
        let mut delays: Vec<i64> = of.iter().map(|f| f.delay.unwrap_or(i64::MAX)).collect();
        delays.sort_unstable();
        let at = |part: f64| match delays.get((part * delays.len() as f64) as usize) {
            Some(&d) if d < i64::MAX => d.to_string(),
            _ => "later".into(),
        };
        let found = of.iter().filter(|f| f.delay.is_some()).count();
        let held = of.iter().filter(|f| f.held).count();
        let _ = writeln!(
            text,
            "| {name} | {} | {:.0} % | {} | {} | {} | {:.0} % |",
            of.len(),
            100.0 * found as f64 / of.len().max(1) as f64,
            at(0.1),
            at(0.5),
            at(0.9),
            100.0 * held as f64 / found.max(1) as f64
        );
    }
    text
}

fn proportions(with: &[Score], without: &[Score]) -> String {
    let mean = with.iter().map(Score::proportion).sum::<f64>() / with.len().max(1) as f64;
    let alarms: usize = with.iter().map(|s| s.alarms).sum();
    let wrong: usize = with.iter().map(|s| s.false_alarms.len()).sum();
    let worst = with.iter().map(Score::proportion).fold(0.0, f64::max);
    let quiet = without.iter().filter(|s| s.alarms == 0).count();
    let raised: usize = without.iter().map(|s| s.alarms).sum();
    format!(
        "With faults: {wrong} of {alarms} alarms are false; false discovery proportion {:.1} % on average over fleets (5 % are allowed), \
         {:.0} % in the worst fleet. Without: {} of {} fleets have any alarm ({raised} alarms of {} series); where nothing has changed, \
         every alarm is a false discovery, so that at most 5 % of such fleets may have one.\n",
        100.0 * mean,
        100.0 * worst,
        without.len() - quiet,
        without.len(),
        without.iter().map(|s| s.series).sum::<usize>()
    )
}
