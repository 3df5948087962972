//! The tables of the concealment test.

use std::fmt::Write;

use dynid_runtime::effects::EffectKind;

use crate::calibration::calibration;
use crate::case::Case;
use crate::hide::Hidden;
use crate::hiding;
use crate::options::Options;
use crate::score::{Outcome, Score};
use crate::size::SIZES;
use crate::words::{about_sizes, command, hidden_in_words, line, median, others};

/// One row of input to the tables.
type Pair<'a> = (&'a Case, &'a Score);

/// The whole page.
pub fn markdown(cases: &[Case], scores: &[Score], options: &Options) -> String {
    let all: Vec<Pair<'_>> = cases.iter().zip(scores).collect();
    let effects: Vec<EffectKind> =
        EffectKind::ALL.into_iter().filter(|e| cases.iter().any(|c| c.effects.contains(e))).collect();
    let mut text = String::from("# Concealment test\n\n");
    introduction(&mut text, &all, options);
    rates(&mut text, &all, &effects);
    by_visibility(&mut text, &all);
    robots(&mut text, &all, options);
    calibration(&mut text, scores);
    confusion(&mut text, &all, &effects);
    what_is_hidden(&mut text, &effects);
    every_run(&mut text, &all);
    text
}

fn introduction(text: &mut String, all: &[Pair<'_>], options: &Options) {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let how = ["one", "two", "three", "four"][usize::from(options.together - 1).min(3)];
    let motions = options.seconds.map_or_else(
        || "one to three random motions, 16 to 24 s together".to_owned(),
        |seconds| format!("one random motion of {seconds} s"),
    );
    let _ = writeln!(
        text,
        "Every effect of the catalogue is hidden in simulated robots, {how} at a time, and diagnosed without being told. A run is \
         {motions} (Fourier series of 4 to 12 harmonics, or points joined by a \
         profile), at 500 Hz in closed loop, with the nominal noise of the robot. Joint, shape and motions are drawn \
         for each run. Only after the diagnosis is it compared with what was hidden.\n"
    );
    let mut command = command(options);
    if let Some(path) = &options.out {
        let _ = write!(command, " --out {}", path.display());
    }
    let _ = writeln!(text, "```\n{command}\n```\n");
    let minutes = all.iter().map(|(_, s)| s.whole).sum::<f64>() / 60.0 / options.threads.max(1) as f64;
    let _ = writeln!(
        text,
        "{} runs took {minutes:.1} minutes on {} threads of a machine with {cores} cores; the median diagnosis took \
         {:.1} s on one thread.\n",
        all.len(),
        options.threads,
        median(all.iter().map(|(_, s)| s.seconds).collect())
    );
    let plain: Vec<&Pair<'_>> =
        all.iter().filter(|(c, s)| c.effects.is_empty() && s.refused.is_none()).collect();
    if !plain.is_empty() {
        let alarms = plain.iter().filter(|(_, s)| !s.others.is_empty()).count();
        let _ = writeln!(
            text,
            "Runs without any effect: {}; with a finding, that is a false alarm: {alarms}.\n",
            plain.len()
        );
    }
    about_sizes(text);
}

/// In how many of the runs something holds.
fn share<T>(runs: &[T], holds: impl Fn(&T) -> bool) -> String {
    if runs.is_empty() {
        return "-".to_owned();
    }
    format!("{}/{}", runs.iter().filter(|run| holds(run)).count(), runs.len())
}

/// Every hidden effect with its run.
fn hidden_of<'a>(all: &[Pair<'a>]) -> Vec<(&'a Case, &'a Score, &'a Hidden, Outcome)> {
    all.iter().flat_map(|&(c, s)| s.hidden.iter().map(move |(h, o)| (c, s, h, *o))).collect()
}

fn rates(text: &mut String, all: &[Pair<'_>], effects: &[EffectKind]) {
    line(text, "## Detected and named\n");
    line(
        text,
        "Detected: something was found on the joint. Named: the effect itself, on its joint. Cannot tell: the effect is \
         among those that the diagnosis says the motion cannot tell apart. Small: it says that the effect is there and too \
         small to be named. Others: findings beside it or instead of it. \
         Visible: median, and least to most.\n",
    );
    line(
        text,
        "| effect | size | visible | detected | named | named, cannot tell or small | runs with others | refused |",
    );
    line(text, "|---|---|---|---|---|---|---|---|");
    let every = hidden_of(all);
    let kinds = effects.iter().map(|&e| Some(e)).chain([None]);
    for kind in kinds {
        for (size, name) in SIZES.iter().enumerate() {
            let runs: Vec<_> =
                every.iter().filter(|r| kind.is_none_or(|k| r.2.effect == k) && r.0.size == size).collect();
            if runs.is_empty() {
                continue;
            }
            let visible: Vec<f64> = runs.iter().map(|r| r.2.visible).collect();
            let (least, most) =
                visible.iter().fold((f64::INFINITY, 0.0_f64), |(a, b), &x| (a.min(x), b.max(x)));
            let _ = writeln!(
                text,
                "| {} | {name} | {:.1} ({least:.1} to {most:.1}) | {} | {} | {} | {} | {} |",
                kind.map_or("all", EffectKind::id),
                median(visible),
                share(&runs, |r| r.3.detected),
                share(&runs, |r| r.3.named),
                share(&runs, |r| r.3.named || r.3.cannot_tell || r.3.small),
                share(&runs, |r| !r.1.others.is_empty()),
                share(&runs, |r| r.1.refused.is_some())
            );
        }
    }
    text.push('\n');
}

fn by_visibility(text: &mut String, all: &[Pair<'_>]) {
    line(text, "## By what can be seen\n");
    line(text, "| visible | detected | named | named, cannot tell or small |");
    line(text, "|---|---|---|---|");
    let every = hidden_of(all);
    let edges = [0.0, 0.5, 1.5, 4.0, f64::INFINITY];
    for edge in edges.windows(2) {
        let runs: Vec<_> = every.iter().filter(|r| (edge[0]..edge[1]).contains(&r.2.visible)).collect();
        let words = if edge[1].is_finite() {
            format!("{} to {}", edge[0], edge[1])
        } else {
            format!("{} and more", edge[0])
        };
        let _ = writeln!(
            text,
            "| {words} | {} | {} | {} |",
            share(&runs, |r| r.3.detected),
            share(&runs, |r| r.3.named),
            share(&runs, |r| r.3.named || r.3.cannot_tell || r.3.small)
        );
    }
    text.push('\n');
}

fn robots(text: &mut String, all: &[Pair<'_>], options: &Options) {
    line(text, "## By robot\n");
    line(
        text,
        "| robot | detected | named | runs with all named and nothing else | false alarms without effect |",
    );
    line(text, "|---|---|---|---|---|");
    for robot in &options.robots {
        let of = |hidden: bool| -> Vec<Pair<'_>> {
            all.iter().filter(|(c, _)| c.robot == *robot && c.effects.is_empty() != hidden).copied().collect()
        };
        let (runs, plain) = (of(true), of(false));
        let hidden = hidden_of(&runs);
        let _ = writeln!(
            text,
            "| {robot} | {} | {} | {} | {} |",
            share(&hidden, |r| r.3.detected),
            share(&hidden, |r| r.3.named),
            share(&runs, |(_, s)| s.solved()),
            share(&plain, |(_, s)| !s.others.is_empty())
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
    let plain = all.iter().any(|(c, _)| c.effects.is_empty());
    for hidden in effects.iter().map(|&e| Some(e)).chain(plain.then_some(None)) {
        let here = |c: &Case| hidden.map_or(c.effects.is_empty(), |e| c.effects.contains(&e));
        let runs: Vec<Pair<'_>> =
            all.iter().filter(|(c, s)| here(c) && s.refused.is_none()).copied().collect();
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
    line(text, "| effect | magnitude | most |");
    line(text, "|---|---|---|");
    for &effect in effects {
        let Some(hiding) = hiding::of(effect) else { continue };
        let (what, most) = (hiding.counts, hiding.most);
        let _ = writeln!(text, "| {} | {what} | {most} |", effect.id());
    }
    text.push('\n');
}

fn every_run(text: &mut String, all: &[Pair<'_>]) {
    line(text, "## Runs in which an effect was not named, or more was\n");
    line(text, "| robot | size | seed | hidden, with magnitude | outcome | found besides |");
    line(text, "|---|---|---|---|---|---|");
    for (case, score) in all {
        if score.solved() {
            continue;
        }
        let hidden: Vec<Hidden> = score.hidden.iter().map(|(h, _)| h.clone()).collect();
        let outcomes: Vec<&str> = score.hidden.iter().map(|(_, o)| o.word()).collect();
        let outcome = match &score.refused {
            Some(reason) => format!("refused: {reason}"),
            None if outcomes.is_empty() => "false alarm".to_owned(),
            None => outcomes.join(", "),
        };
        let _ = writeln!(
            text,
            "| {} | {} | {} | {} | {outcome} | {} |",
            case.robot,
            SIZES[case.size],
            case.seed,
            hidden_in_words(&hidden),
            others(score)
        );
    }
}
