//! Hides every effect of the catalogue in simulated robots, diagnoses without being told, and keeps score.
//!
//! `cargo run --release --example concealment -- --out docs/concealment.md`
//!
//! Every run is a closed-loop simulation of one to three random motions at 500 Hz, with the robot's nominal noise, on
//! a random joint. The diagnosis gets the recorded motions alone. Runs without any effect give the rate of false
//! alarms. With `--dump` the recordings are written as folders of a challenge, and nothing is diagnosed.

mod calibration;
mod case;
mod dump;
mod failure;
mod hide;
mod hiding;
mod hiding_table;
mod in_parallel;
mod journal;
mod motions;
mod options;
mod outside;
mod page;
mod places;
mod pushes;
mod put;
mod random;
mod recorder;
mod residual;
mod score;
mod secret;
mod seen;
mod size;
mod visible;
mod words;

use std::io::Write;
use std::time::Instant;

use clap::Parser;
use dynid::models;
use dynid_runtime::effects::{EffectKind, Sought};

use case::Case;
use failure::Failure;
use hide::{draw, recordings};
use in_parallel::in_parallel;
use journal::Journal;
use options::Options;
use random::Random;
use score::{Score, score};
use size::SIZES;

fn main() -> Result<(), Failure> {
    let options = Options::parse();
    let cases = cases(&options)?;
    let start = Instant::now();
    if let Some(folder) = &options.dump {
        let failed = in_parallel(&cases, options.threads, Case::name, |case| {
            let model = models::find(&case.robot).ok_or("no such robot")?;
            let recordings = recordings(model, case, true)?;
            dump::write(folder, model.robot(), case, &recordings)?;
            Ok((words::hidden_in_words(&recordings.hidden), ()))
        });
        let failed = failed.into_iter().filter(Option::is_none).count();
        let seconds = start.elapsed().as_secs_f64();
        println!("{} of {} cases written in {seconds:.0} s", cases.len() - failed, cases.len());
        return Ok(());
    }
    if options.visible {
        let seen = in_parallel(&cases, options.threads, Case::name, |case| {
            let model = models::find(&case.robot).ok_or("no such robot")?;
            let drawn = draw(model, case)?;
            Ok((words::hidden_in_words(&drawn.hidden), drawn.hidden))
        });
        let minutes = start.elapsed().as_secs_f64() / 60.0;
        return finish(&options, &seen::what_can_be_seen(&cases, &seen, &options, minutes));
    }
    let journal = options.journal.as_deref().map(Journal::open).transpose()?;
    let scores: Vec<Score> = in_parallel(&cases, options.threads, Case::name, |case| {
        if let Some(score) = journal.as_ref().and_then(|j| j.done(case)) {
            return Ok((words::in_a_line(&score), score));
        }
        let score = score(case)?;
        if let Some(journal) = &journal {
            journal.add(case, &score)?;
        }
        Ok((words::in_a_line(&score), score))
    })
    .into_iter()
    .map(|score| score.unwrap_or_else(Score::not_simulated))
    .collect();
    finish(&options, &page::markdown(&cases, &scores, &options))
}

/// What people wrote about the tables of a page starts here, and is kept when the page is made anew.
const DISCUSSION: &str = "\n## Discussion\n";

fn finish(options: &Options, text: &str) -> Result<(), Failure> {
    match &options.out {
        Some(path) => {
            let before = std::fs::read_to_string(path).unwrap_or_default();
            let discussion = before.find(DISCUSSION).map_or("", |at| &before[at..]);
            std::fs::write(path, format!("{text}{discussion}"))?;
        }
        None => std::io::stdout().write_all(text.as_bytes())?,
    }
    Ok(())
}

fn cases(options: &Options) -> Result<Vec<Case>, Failure> {
    let mut effects: Vec<Vec<EffectKind>> = Vec::new();
    for id in &options.effects {
        let known = EffectKind::from_id(id);
        if known.is_none() && id != "none" {
            return Err(format!("--effects {id}: the catalogue has no such effect").into());
        }
        effects.push(known.into_iter().collect());
    }
    if effects.is_empty() {
        // What is the same before and after is not hidden as a change.
        let is_hidden =
            |e: &EffectKind| !options.baseline || e.properties().sought != Sought::NeverAgainstBaseline;
        let all = EffectKind::ALL.into_iter().filter(is_hidden);
        effects = all.map(|e| vec![e]).chain([Vec::new()]).collect();
    }
    let push_seconds = match options.push_seconds[..] {
        [least, most] if 0.0 < least && least <= most => [least, most],
        _ => {
            return Err(
                "--push-seconds: two durations, the first positive and no longer than the second".into()
            );
        }
    };
    let mut cases = Vec::new();
    for (seed, &recorder) in
        (options.first_seed..options.first_seed + options.seeds).zip(options.recorders.iter().cycle())
    {
        for robot in &options.robots {
            models::find(robot).ok_or_else(|| format!("--robots {robot}: robots/ has no such robot"))?;
            for hidden in &effects {
                for name in &options.sizes {
                    let size = SIZES
                        .iter()
                        .position(|s| s == name)
                        .ok_or_else(|| format!("--sizes {name}: one of {}", SIZES.join(", ")))?;
                    let mut hidden = hidden.clone();
                    if options.together > 1 {
                        let Some(&first) = hidden.first() else { continue };
                        hidden.extend(partners(first, &effects, options.together - 1, (robot, name, seed)));
                    }
                    // Without an effect a size is only another run.
                    let seconds = options.seconds;
                    let robot = robot.clone();
                    let baseline = options.baseline;
                    let push = (options.push, push_seconds);
                    cases.push(Case {
                        robot,
                        effects: hidden,
                        size,
                        seed,
                        seconds,
                        baseline,
                        reference: options.reference,
                        recorder,
                        push,
                    });
                }
            }
        }
    }
    Ok(cases)
}

/// Other effects of the list that can be hidden with `first`, as many as there are up to `count`: all are changes, or
/// none is.
fn partners(
    first: EffectKind,
    effects: &[Vec<EffectKind>],
    count: u8,
    (robot, size, seed): (&str, &str, u64),
) -> Vec<EffectKind> {
    let mut possible: Vec<EffectKind> = effects
        .iter()
        .flatten()
        .copied()
        .filter(|&e| e != first && secret::is_change(e) == secret::is_change(first))
        .collect();
    let mut random = Random::of(&["partner", robot, size, first.id()], seed);
    let drawn = usize::from(count).min(possible.len());
    (0..drawn).map(|_| possible.swap_remove(random.below(possible.len()))).collect()
}
