//! The tables of the concealment test.

use std::fmt::Write;

use dynid_runtime::effects::EffectKind;
use dynid_runtime::report::significant;

use crate::hide::Hidden;
use crate::hiding;
use crate::size::{SIZES, VISIBLE};
use crate::{Case, Options, Outcome, Score};

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
    confusion(&mut text, &all, &effects);
    what_is_hidden(&mut text, &effects);
    every_run(&mut text, &all);
    text
}

/// What was hidden, with its magnitude and how much of it can be seen.
pub fn hidden_in_words(hidden: &[Hidden]) -> String {
    let words = |h: &Hidden| {
        format!("{} {:.3} (visible {:.1})", at(h.effect.id(), &joints_of(h)), h.magnitude, h.visible)
    };
    if hidden.is_empty() {
        "nothing".to_owned()
    } else {
        hidden.iter().map(words).collect::<Vec<_>>().join(", ")
    }
}

/// A finished run in a line.
pub fn in_a_line(score: &Score) -> String {
    let hidden: Vec<String> = score
        .hidden
        .iter()
        .map(|(h, outcome)| {
            format!("{} (visible {:.1}) {}", at(h.effect.id(), &joints_of(h)), h.visible, outcome.word())
        })
        .collect();
    let mut line = hidden.join(", ");
    if let Some(reason) = &score.refused {
        let _ = write!(line, " refused: {reason}");
    }
    if !score.others.is_empty() {
        let _ = write!(line, " besides: {}", others(score));
    }
    let _ = write!(line, " ({:.1} s)", score.seconds);
    line
}

impl Outcome {
    fn word(self) -> &'static str {
        match self {
            Outcome { named: true, .. } => "named",
            Outcome { cannot_tell: true, .. } => "cannot tell",
            _ => "missed",
        }
    }
}

fn joints_of(hidden: &Hidden) -> Vec<usize> {
    hidden.joint.map(|j| j + 1).into_iter().collect()
}

fn at(effect: &str, joints: &[usize]) -> String {
    let on: Vec<String> = joints.iter().map(ToString::to_string).collect();
    if on.is_empty() { effect.to_owned() } else { format!("{effect}@{}", on.join("+")) }
}

fn others(score: &Score) -> String {
    score.others.iter().map(|(effect, joints)| at(effect, joints)).collect::<Vec<_>>().join(" ")
}

fn line(text: &mut String, words: &str) {
    text.push_str(words);
    text.push('\n');
}

/// What of every effect can be seen, robot by robot, and how much of it that takes.
pub fn what_can_be_seen(
    cases: &[Case],
    seen: &[Option<Vec<Hidden>>],
    options: &Options,
    minutes: f64,
) -> String {
    let mut text = String::from("# What can be seen of a hidden effect\n\n");
    let _ = writeln!(
        text,
        "Each effect of the catalogue in simulated robots, on random joints and motions: how much of it there must be to \
         be seen. No diagnosis takes part.\n\n```\n{} --visible{}\n```\n\n{} cases took {minutes:.1} minutes on {} threads.\n",
        command(options),
        options.out.as_ref().map_or_else(String::new, |path| format!(" --out {}", path.display())),
        cases.len(),
        options.threads
    );
    about_sizes(&mut text);
    line(
        &mut text,
        "In each cell the visible size, and the magnitude that it takes; medians over the seeds (of an even number of seeds the upper one).\n",
    );
    let columns: Vec<(&String, usize)> = options
        .robots
        .iter()
        .flat_map(|r| (0..SIZES.len()).map(move |s| (r, s)))
        .filter(|(_, s)| options.sizes.iter().any(|name| name == SIZES[*s]))
        .collect();
    let header: Vec<String> = columns.iter().map(|(r, s)| format!("{r}, {}", SIZES[*s])).collect();
    let _ = writeln!(text, "| effect | magnitude | {} |", header.join(" | "));
    line(&mut text, &format!("|---|---|{}", "---|".repeat(columns.len())));
    for effect in EffectKind::ALL {
        let cells: Vec<String> =
            columns.iter().map(|(robot, size)| seen_cell(cases, seen, effect, robot, *size)).collect();
        if cells.iter().any(|cell| cell != "-") {
            let _ = writeln!(
                text,
                "| {} | {} | {} |",
                effect.id(),
                hiding::of(effect).map_or("", |h| h.counts),
                cells.join(" | ")
            );
        }
    }
    text
}

/// Medians of what of an effect can be seen in the cases of a robot and size, and of the magnitude that it takes.
fn seen_cell(
    cases: &[Case],
    seen: &[Option<Vec<Hidden>>],
    effect: EffectKind,
    robot: &str,
    size: usize,
) -> String {
    let own: Vec<&Hidden> = (cases.iter().zip(seen))
        .filter(|(c, _)| c.robot == robot && c.size == size)
        .filter_map(|(_, hidden)| hidden.as_ref()?.iter().find(|h| h.effect == effect))
        .collect();
    if own.is_empty() {
        return "-".to_owned();
    }
    let visible = median(own.iter().map(|h| h.visible).collect());
    let magnitude = median(own.iter().map(|h| h.magnitude).collect());
    format!("{visible:.1} ({})", significant(magnitude, 2))
}

fn introduction(text: &mut String, all: &[Pair<'_>], options: &Options) {
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let how = if options.pairs { "two at a time" } else { "one at a time" };
    let motions = options.seconds.map_or_else(
        || "one to three random motions, 16 to 24 s together".to_owned(),
        |seconds| format!("one random motion of {seconds} s"),
    );
    let _ = writeln!(
        text,
        "Every effect of the catalogue is hidden in simulated robots, {how}, and diagnosed without being told. A run is \
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

fn about_sizes(text: &mut String) {
    let _ = writeln!(
        text,
        "The sizes are relative to what can be seen. *Visible* is the torque of the effect that no refit of the standard \
         parameters can take over, relative to the noise: sqrt(r² - r0²)/r0 of the residuals of the standard model \
         with and without the effect, on the same motion with the same noise, in a band of 25 Hz or 100 Hz, where it \
         shows more, on the joint where it shows most (a contact: while it lasts). `small` aims at {}, `medium` at {}, \
         `large` at {}; where no robot has that much of an effect, at the most that it may have, and the column says \
         what was seen.\n",
        VISIBLE[0], VISIBLE[1], VISIBLE[2]
    );
}

/// The command that makes a page, up to the file that it goes to.
fn command(options: &Options) -> String {
    let mut command = format!(
        "cargo run --release --example concealment -- --robots {} --sizes {} --seeds {}",
        options.robots.join(","),
        options.sizes.join(","),
        options.seeds
    );
    if options.first_seed != 1 {
        let _ = write!(command, " --first-seed {}", options.first_seed);
    }
    if !options.effects.is_empty() {
        let _ = write!(command, " --effects {}", options.effects.join(","));
    }
    if options.pairs {
        command.push_str(" --pairs");
    }
    if let Some(seconds) = options.seconds {
        let _ = write!(command, " --seconds {seconds}");
    }
    command
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or(0.0)
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
         among those that the diagnosis says the motion cannot tell apart. Others: findings beside it or instead of it. \
         Visible: median, and least to most.\n",
    );
    line(
        text,
        "| effect | size | visible | detected | named | named or cannot tell | runs with others | refused |",
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
                share(&runs, |r| r.3.named || r.3.cannot_tell),
                share(&runs, |r| !r.1.others.is_empty()),
                share(&runs, |r| r.1.refused.is_some())
            );
        }
    }
    text.push('\n');
}

fn by_visibility(text: &mut String, all: &[Pair<'_>]) {
    line(text, "## By what can be seen\n");
    line(text, "| visible | detected | named | named or cannot tell |");
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
            share(&runs, |r| r.3.named || r.3.cannot_tell)
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
