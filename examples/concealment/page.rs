//! The tables of the concealment test.

use std::fmt::Write;

use dynid_runtime::effects::EffectKind;

use crate::{Case, Options, SIZES, Score, hide};

/// One row of input to the tables.
type Pair<'a> = (&'a Case, &'a Score);

/// The whole page.
pub fn markdown(cases: &[Case], scores: &[Score], options: &Options, minutes: f64) -> String {
    let all: Vec<Pair<'_>> = cases.iter().zip(scores).collect();
    let effects: Vec<EffectKind> =
        EffectKind::ALL.into_iter().filter(|&e| cases.iter().any(|c| c.effect == Some(e))).collect();
    let mut text = String::from("# Concealment test\n\n");
    introduction(&mut text, &all, options, minutes);
    rates(&mut text, &all, &effects);
    robots(&mut text, &all, options);
    confusion(&mut text, &all, &effects);
    what_is_hidden(&mut text, &effects);
    every_run(&mut text, &all);
    text
}

fn line(text: &mut String, words: &str) {
    text.push_str(words);
    text.push('\n');
}

fn introduction(text: &mut String, all: &[Pair<'_>], options: &Options, minutes: f64) {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    line(
        text,
        "Every effect of the catalogue is hidden in simulated robots, one at a time, and diagnosed without being told. \
         A run is three random Fourier motions of 8 s at 500 Hz in closed loop, with the nominal noise of the robot. \
         Only after the diagnosis is it compared with what was hidden.\n",
    );
    let mut command = format!(
        "cargo run --release --example concealment -- --robots {} --sizes {} --seeds {}",
        options.robots.join(","),
        options.sizes.join(","),
        options.seeds
    );
    if !options.effects.is_empty() {
        let _ = write!(command, " --effects {}", options.effects.join(","));
    }
    if let Some(path) = &options.out {
        let _ = write!(command, " --out {}", path.display());
    }
    let _ = writeln!(text, "```\n{command}\n```\n");
    let full = 3 * 5 * SIZES.len() * (EffectKind::ALL.len() + 1);
    let each = minutes / all.len().max(1) as f64;
    let _ = writeln!(
        text,
        "{} runs took {minutes:.1} minutes on {} threads of a machine with {cores} cores. The full test (three robots, \
         three sizes, five seeds: {full} runs) would take {:.0} minutes at this pace.\n",
        all.len(),
        options.threads,
        each * full as f64
    );
    let plain: Vec<&Pair<'_>> =
        all.iter().filter(|(c, s)| c.effect.is_none() && s.refused.is_none()).collect();
    if !plain.is_empty() {
        let alarms = plain.iter().filter(|(_, s)| !s.others.is_empty()).count();
        let _ = writeln!(
            text,
            "Runs without any effect: {}; with a finding, that is a false alarm: {alarms}.\n",
            plain.len()
        );
    }
}

/// In how many of the runs something holds.
fn share(runs: &[Pair<'_>], holds: impl Fn(&Score) -> bool) -> String {
    if runs.is_empty() {
        return "-".to_owned();
    }
    let count = runs.iter().filter(|(_, s)| holds(s)).count();
    format!("{count}/{}", runs.len())
}

fn rates(text: &mut String, all: &[Pair<'_>], effects: &[EffectKind]) {
    line(text, "## Detected and named\n");
    line(
        text,
        "Detected: something was found on the joint. Named: the effect itself, on its joint. Cannot tell: the effect is \
         among those that the diagnosis says the motion cannot tell apart. Others: findings beside it or instead of it.\n",
    );
    line(text, "| effect | size | detected | named | named or cannot tell | runs with others | refused |");
    line(text, "|---|---|---|---|---|---|---|");
    let mut row = |name: &str, size: &str, runs: &[Pair<'_>]| {
        let _ = writeln!(
            text,
            "| {name} | {size} | {} | {} | {} | {} | {} |",
            share(runs, |s| s.detected),
            share(runs, |s| s.named),
            share(runs, |s| s.named || s.cannot_tell),
            share(runs, |s| !s.others.is_empty()),
            share(runs, |s| s.refused.is_some())
        );
    };
    for &effect in effects {
        for (size, name) in SIZES.iter().enumerate() {
            let runs: Vec<Pair<'_>> =
                all.iter().filter(|(c, _)| c.effect == Some(effect) && c.size == size).copied().collect();
            if !runs.is_empty() {
                row(effect.id(), name, &runs);
            }
        }
    }
    for (size, name) in SIZES.iter().enumerate() {
        let runs: Vec<Pair<'_>> =
            all.iter().filter(|(c, _)| c.effect.is_some() && c.size == size).copied().collect();
        if !runs.is_empty() {
            row("all", name, &runs);
        }
    }
    text.push('\n');
}

fn robots(text: &mut String, all: &[Pair<'_>], options: &Options) {
    line(text, "## By robot\n");
    line(text, "| robot | detected | named | runs with others | false alarms without effect |");
    line(text, "|---|---|---|---|---|");
    for robot in &options.robots {
        let of = |hidden: bool| -> Vec<Pair<'_>> {
            all.iter().filter(|(c, _)| c.robot == *robot && c.effect.is_some() == hidden).copied().collect()
        };
        let (runs, plain) = (of(true), of(false));
        let _ = writeln!(
            text,
            "| {robot} | {} | {} | {} | {} |",
            share(&runs, |s| s.detected),
            share(&runs, |s| s.named),
            share(&runs, |s| !s.others.is_empty()),
            share(&plain, |s| !s.others.is_empty())
        );
    }
    text.push('\n');
}

fn confusion(text: &mut String, all: &[Pair<'_>], effects: &[EffectKind]) {
    line(text, "## Confusion matrix\n");
    line(
        text,
        "Rows: what was hidden. Columns: in how many runs each effect was found, on any joint; a run with two findings \
         counts twice. The columns are numbered as the rows; the last one counts runs with no finding.\n",
    );
    let mut header = String::from("| hidden |");
    for k in 1..=EffectKind::ALL.len() {
        let _ = write!(header, " {k} |");
    }
    line(text, &format!("{header} nothing |"));
    line(text, &format!("|---|{}", "---|".repeat(EffectKind::ALL.len() + 1)));
    let rows =
        effects.iter().map(|&e| Some(e)).chain(all.iter().any(|(c, _)| c.effect.is_none()).then_some(None));
    for hidden in rows {
        let runs: Vec<Pair<'_>> =
            all.iter().filter(|(c, s)| c.effect == hidden && s.refused.is_none()).copied().collect();
        match hidden {
            Some(effect) => {
                let number = EffectKind::ALL.iter().position(|&e| e == effect).map_or(0, |k| k + 1);
                let _ = write!(text, "| {number} {} |", effect.id());
            }
            None => text.push_str("| none |"),
        }
        for effect in EffectKind::ALL {
            let count = runs.iter().filter(|(_, s)| s.found.iter().any(|f| f == effect.id())).count();
            let shown = if count == 0 { String::new() } else { count.to_string() };
            let shown = if Some(effect) == hidden && count > 0 { format!("**{shown}**") } else { shown };
            let _ = write!(text, " {shown} |");
        }
        let nothing = runs.iter().filter(|(_, s)| s.found.is_empty()).count();
        let _ = writeln!(text, " {nothing} |");
    }
    text.push('\n');
}

fn what_is_hidden(text: &mut String, effects: &[EffectKind]) {
    line(text, "## What is hidden\n");
    line(text, "| effect | small | medium | large | of |");
    line(text, "|---|---|---|---|---|");
    for &effect in effects {
        let ([small, medium, large], of) = hide::sizes(effect);
        let _ = writeln!(text, "| {} | {small} | {medium} | {large} | {of} |", effect.id());
    }
    text.push('\n');
}

fn every_run(text: &mut String, all: &[Pair<'_>]) {
    line(text, "## Runs in which the effect was not named, or more was\n");
    line(text, "| robot | hidden | joint | size | seed | outcome | found besides |");
    line(text, "|---|---|---|---|---|---|---|");
    for (case, score) in all {
        if score.refused.is_none() && score.others.is_empty() && (score.named || case.effect.is_none()) {
            continue;
        }
        let outcome = match (&score.refused, score.named, score.cannot_tell) {
            (Some(reason), ..) => format!("refused: {reason}"),
            (_, true, _) => "named".to_owned(),
            (_, _, true) => "cannot tell".to_owned(),
            _ if case.effect.is_none() => "false alarm".to_owned(),
            _ => "missed".to_owned(),
        };
        let others: Vec<String> = score
            .others
            .iter()
            .map(|(effect, joints)| {
                let on: Vec<String> = joints.iter().map(ToString::to_string).collect();
                if on.is_empty() { effect.clone() } else { format!("{effect}@{}", on.join("+")) }
            })
            .collect();
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {} | {outcome} | {} |",
            case.robot,
            case.effect.map_or("nothing", EffectKind::id),
            score.joint.map_or_else(|| "-".to_owned(), |j| j.to_string()),
            SIZES[case.size],
            case.seed,
            others.join(" ")
        );
    }
}
