//! How soon a fleet's faults are found, and how many alarms are false: `docs/fleet_alarms.md`.
//!
//! `cargo run --release --example fleet_of_200 -- [FLEETS] [FILE] [PAGE]`
//!
//! One fleet of 200 robots over 60 days whose every estimate is a real identification of a simulated recording; then
//! FLEETS fleets with faults and as many without, whose estimates have errors drawn from those of such identifications.
#![allow(missing_docs, clippy::unwrap_used)]

mod arm;
mod score;
mod story;
mod words;

use arm::Arm;
use dynid_fleet_watch::{Labels, Pages, Settings, Watched, watch};
use score::Score;
use std::time::Instant;
use story::{Story, estimates_by_identification, simulated_estimates};

pub type Failure = Box<dyn std::error::Error + Send + Sync>;

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let fleets: u64 = arguments.next().map_or(Ok(100), |x| x.parse())?;
    let (file, picture) = (arguments.next(), arguments.next());
    let arm = Arm::new()?;
    let started = Instant::now();
    let story = Story::of(1, true);
    let series = estimates_by_identification(&arm, &story)?;
    eprintln!("identified in {:.0} s", started.elapsed().as_secs_f64());
    let started = Instant::now();
    let watched = watch(&series, &Settings::default());
    eprintln!("watched {} series in {:.1} s", series.len(), started.elapsed().as_secs_f64());
    if let Some(path) = picture {
        std::fs::write(path, Pages::new(&series, &watched, &Default::default(), Labels::plain()).fleet())?;
    }
    let mut text = words::one_fleet(&arm, &story, &series, &watched, fleets);
    let with = many(&arm, fleets, true);
    let without = many(&arm, fleets, false);
    text += &words::many_fleets(&with, &without);
    match file {
        Some(path) => std::fs::write(path, text)?,
        None => print!("{text}"),
    }
    Ok(())
}

/// Scores of fresh fleets, on two threads; each has its own seed, so that their number changes nothing.
fn many(arm: &Arm, fleets: u64, faults: bool) -> Vec<Score> {
    let one = |seed: u64| {
        let story = Story::of(seed, faults);
        let series = simulated_estimates(arm, &story);
        let watched: Watched = watch(&series, &Settings::default());
        Score::of(&story, arm, &series, &watched)
    };
    let first = if faults { 1000 } else { 5000 };
    std::thread::scope(|scope| {
        let half = |part: u64| {
            scope.spawn(move || {
                (0..fleets).filter(|k| k % 2 == part).map(|k| (k, one(first + k))).collect::<Vec<_>>()
            })
        };
        let threads = [half(0), half(1)];
        let mut all: Vec<(u64, Score)> = threads.into_iter().flat_map(|t| t.join().unwrap()).collect();
        all.sort_by_key(|s| s.0);
        all.into_iter().map(|s| s.1).collect()
    })
}
