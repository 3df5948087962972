//! How often an interval of 95 % contains the truth, over simulated recordings: `docs/coverage.md`.
//!
//! ```text
//! cargo test --release --test coverage -- --ignored --nocapture
//! ```
//!
//! Environment: `COVERAGE_SEEDS` (40), how many, from `COVERAGE_FIRST_SEED` (1) on; lists separated by commas of which
//! every part must be a part of the names: `COVERAGE_ROBOTS`, `COVERAGE_SHAPES`, `COVERAGE_NOISE`, `COVERAGE_METHODS`;
//! `COVERAGE_BAND`, Hz; `COVERAGE_PAGE`, the page that is written.
#![allow(clippy::unwrap_used, reason = "a measurement that cannot set itself up has failed")]

#[path = "coverage/cases.rs"]
mod cases;
#[path = "coverage/methods.rs"]
mod methods;
#[path = "coverage/table.rs"]
mod table;

use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

use cases::{Case, Noise, ROBOTS, SHAPES, USUAL_SHAPES};
use table::Tally;

/// A list in the environment, or what is usual.
fn listed(name: &str, usual: &[&str]) -> Vec<String> {
    match std::env::var(name) {
        Ok(text) => text.split(',').map(str::to_owned).collect(),
        Err(_) => usual.iter().map(|&s| s.to_owned()).collect(),
    }
}

fn number<T: std::str::FromStr>(name: &str) -> Option<T> {
    std::env::var(name).ok().and_then(|text| text.parse().ok())
}

#[test]
#[ignore = "a measurement of minutes to hours: its command is above"]
fn intervals_contain_the_truth_as_often_as_they_say() {
    let seeds: u64 = number("COVERAGE_SEEDS").unwrap_or(40);
    let first: u64 = number("COVERAGE_FIRST_SEED").unwrap_or(1);
    let band: Option<f64> = number("COVERAGE_BAND");
    let wanted = (
        listed("COVERAGE_ROBOTS", &ROBOTS),
        listed("COVERAGE_SHAPES", &USUAL_SHAPES),
        listed("COVERAGE_NOISE", &Noise::USUAL),
        listed("COVERAGE_METHODS", &methods::NAMES),
    );
    let mut page = table::Page::new(seeds);
    for robot in &wanted.0 {
        for shape in SHAPES.iter().filter(|s| wanted.1.iter().any(|w| w == s.name)) {
            let case = Case::new(robot, shape);
            let noises: Vec<Noise> =
                Noise::ALL.into_iter().filter(|n| wanted.2.iter().any(|w| w == n.name())).collect();
            let tallies: Vec<Mutex<Tally>> =
                noises.iter().map(|_| Mutex::new(Tally::new(case.truth()))).collect();
            let next = AtomicU64::new(first);
            let threads = std::thread::available_parallelism().map_or(1, usize::from);
            std::thread::scope(|scope| {
                for _ in 0..threads {
                    scope.spawn(|| {
                        loop {
                            let seed = next.fetch_add(1, Ordering::Relaxed);
                            if seed >= first + seeds {
                                break;
                            }
                            for (noise, tally) in noises.iter().zip(&tallies) {
                                let recording = case.record(*noise, seed);
                                let outcomes = methods::all(&case, &recording, band, &wanted.3);
                                tally.lock().unwrap().add(seed, outcomes);
                            }
                        }
                    });
                }
            });
            for (noise, tally) in noises.iter().zip(tallies) {
                page.add(robot, shape.name, noise.name(), tally.into_inner().unwrap());
            }
        }
    }
    page.finish(std::env::var("COVERAGE_PAGE").ok());
}
