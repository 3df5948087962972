//! Adds the torque of a law to real recordings, diagnoses them without being told, and keeps score.
//!
//! `cargo run --release --example injection -- REC.yaml --baseline BEFORE.yaml --seconds 12`
//!
//! What a recording can show depends on its motion and on how well its torques repeat, which no simulation knows. Each
//! run cuts a random window out of the recording, adds a law of the catalogue on a random joint with a random shape, so
//! large that it is seen beside what the standard model leaves there anyway, and diagnoses the window. What is named in
//! the window without the law is not held against the diagnosis; `none` in the list of effects gives it.

mod draw;
#[path = "../concealment/failure.rs"]
mod failure;
mod fit;
#[path = "../concealment/in_parallel.rs"]
mod in_parallel;
mod options;
#[path = "../concealment/random.rs"]
mod random;
#[path = "../concealment/residual.rs"]
mod residual;
mod run;

use std::collections::BTreeMap;

use clap::Parser;
use dynid::arguments::Source;
use dynid::recorded::measure;

use failure::Failure;
use in_parallel::in_parallel;
use options::Options;
use run::{Case, Outcome, Recordings};

fn main() -> Result<(), Failure> {
    let options = Options::parse();
    let read = |path| measure(&Source::whole(path)).map_err(|error| Failure::from(format!("{error:?}")));
    let recording = read(options.recording.clone())?;
    let baseline = match &options.baseline {
        Some(path) => read(path.clone())?.trajectories,
        None => Vec::new(),
    };
    let model = recording.dynamics.model();
    let recordings = Recordings { model, motions: &recording.trajectories, baseline: &baseline };
    let cases = Case::all(&options)?;
    let outcomes: Vec<Option<Outcome>> = in_parallel(&cases, options.threads, Case::name, |case| {
        let outcome = run::run(&recordings, case, &options)?;
        Ok((outcome.to_string(), outcome))
    });
    println!("| effect | size | runs | named | told apart not | something on its joint | something false |");
    println!("|---|---|---|---|---|---|---|");
    let mut rows: BTreeMap<(String, String), [usize; 5]> = BTreeMap::new();
    for (case, outcome) in cases.iter().zip(&outcomes) {
        let Some(outcome) = outcome else { continue };
        for key in [(case.effect_id(), case.size_in_words()), ("all".into(), case.size_in_words())] {
            let row = rows.entry(key).or_default();
            let counted = [
                true,
                outcome.named,
                outcome.cannot_tell && !outcome.named,
                outcome.detected,
                !outcome.others.is_empty(),
            ];
            row.iter_mut().zip(counted).for_each(|(n, yes)| *n += usize::from(yes));
        }
    }
    for ((effect, size), [runs, named, tied, detected, wrong]) in rows {
        println!("| {effect} | {size} | {runs} | {named} | {tied} | {detected} | {wrong} |");
    }
    Ok(())
}
