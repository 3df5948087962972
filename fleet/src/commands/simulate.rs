//! `dynid-fleet simulate --out DIR`

use std::path::PathBuf;

use clap::Args;

use crate::error::Result;
use crate::simulated::{Plan, simulate};

/// What to simulate, and where to put it.
#[derive(Debug, Args)]
pub(super) struct Options {
    /// Folder for the recordings and fleet.yaml
    #[arg(long)]
    out: PathBuf,
    /// Robots; the gear of the last one wears
    #[arg(long, default_value_t = 4, value_parser = clap::value_parser!(u16).range(1..=1000))]
    robots: u16,
    /// Days, each with a recording of each robot
    #[arg(long, default_value_t = 30, value_parser = clap::value_parser!(u16).range(1..=1000))]
    days: u16,
    /// Motions of 8 s in a recording
    #[arg(long, default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=2000))]
    motions: u16,
    /// Rows a second, Hz
    #[arg(long, default_value_t = 100, value_parser = clap::value_parser!(u16).range(50..=5000))]
    rate: u16,
    /// Standard deviation of a robot's friction from day to day, as a part of it; real friction varies by some hundredths
    #[arg(long, default_value_t = 0.002, value_parser = a_part, value_name = "PART")]
    day_to_day: f64,
    /// The same seed gives the same fleet
    #[arg(long, default_value_t = 1)]
    seed: u64,
}

fn a_part(text: &str) -> std::result::Result<f64, String> {
    let part = text.parse().ok().filter(|part| (0.0..=0.2).contains(part));
    part.ok_or_else(|| "expected a number from 0 to 0.2".to_owned())
}

/// Simulates a fleet.
pub(super) fn run(options: &Options) -> Result<()> {
    let plan = Plan {
        robots: options.robots.into(),
        days: options.days.into(),
        motions: options.motions.into(),
        rate: options.rate.into(),
        day_to_day: options.day_to_day,
        seed: options.seed,
    };
    let fleet = simulate(&options.out, &plan)?;
    println!(
        "{} robots, {} days, a recording a robot and day; now: dynid-fleet run {}",
        plan.robots,
        plan.days,
        fleet.display()
    );
    Ok(())
}
