//! Hides every effect of the catalogue in simulated robots, diagnoses without being told, and keeps score.
//!
//! `cargo run --release --example concealment -- --out docs/concealment.md`
//!
//! Every run is a closed-loop simulation of three random motions of 8 s at 500 Hz, with the robot's nominal noise. The
//! diagnosis gets the recorded motions alone. Runs without any effect give the rate of false alarms.

mod hide;
mod page;
mod torques;

use std::io::{IsTerminal, Write};
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use clap::Parser;
use dynid::models;
use dynid_runtime::diagnosis::{Settings, Silent, diagnose};
use dynid_runtime::effects::EffectKind;

/// Anything that ends a run.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

/// Sizes: barely visible, clear, obvious.
pub const SIZES: [&str; 3] = ["small", "medium", "large"];

/// What to hide, and where the table goes.
#[derive(Debug, Parser)]
pub struct Options {
    /// Robots
    #[arg(long, value_delimiter = ',', default_value = "tx40,cobot6,scara4")]
    robots: Vec<String>,
    /// Effects; `none` is a run without any [default: all of the catalogue, and none]
    #[arg(long, value_delimiter = ',')]
    effects: Vec<String>,
    /// Sizes
    #[arg(long, value_delimiter = ',', default_value = "small,medium,large")]
    sizes: Vec<String>,
    /// How many seeds; each has its own motions, joint, phases and noise
    #[arg(long, default_value_t = 5)]
    seeds: u64,
    /// Threads; the result does not depend on them
    #[arg(long, default_value_t = 2)]
    threads: usize,
    /// Markdown file for the tables [default: standard output]
    #[arg(long)]
    out: Option<PathBuf>,
}

/// One simulation and one diagnosis.
#[derive(Debug, Clone)]
pub struct Case {
    /// Name of the robot.
    pub robot: String,
    /// What is hidden; `None` for nothing.
    pub effect: Option<EffectKind>,
    /// Index in [`SIZES`].
    pub size: usize,
    /// Seed.
    pub seed: u64,
}

/// How a case ended.
#[derive(Debug, Clone, Default)]
pub struct Score {
    /// Number of the joint that hid the effect, where it has one.
    pub joint: Option<usize>,
    /// Something was found on the joint.
    pub detected: bool,
    /// The effect itself was found on its joint.
    pub named: bool,
    /// The effect is among those that the diagnosis says it cannot tell apart there.
    pub cannot_tell: bool,
    /// Findings that are not the hidden effect on its joint.
    pub others: Vec<(String, Vec<usize>)>,
    /// Effects found anywhere, each once.
    pub found: Vec<String>,
    /// Why there is no diagnosis.
    pub refused: Option<String>,
}

fn main() -> Result<(), Failure> {
    let options = Options::parse();
    let cases = cases(&options)?;
    let start = Instant::now();
    let scores = run(&cases, options.threads);
    let minutes = start.elapsed().as_secs_f64() / 60.0;
    let text = page::markdown(&cases, &scores, &options, minutes);
    match &options.out {
        Some(path) => std::fs::write(path, text)?,
        None => std::io::stdout().write_all(text.as_bytes())?,
    }
    Ok(())
}

fn cases(options: &Options) -> Result<Vec<Case>, Failure> {
    let mut effects: Vec<Option<EffectKind>> = Vec::new();
    for id in &options.effects {
        let known = EffectKind::from_id(id);
        if known.is_none() && id != "none" {
            return Err(format!("--effects {id}: the catalogue has no such effect").into());
        }
        effects.push(known);
    }
    if effects.is_empty() {
        effects = EffectKind::ALL.into_iter().map(Some).chain([None]).collect();
    }
    let mut cases = Vec::new();
    for seed in 1..=options.seeds {
        for robot in &options.robots {
            models::find(robot).ok_or_else(|| format!("--robots {robot}: robots/ has no such robot"))?;
            for &effect in &effects {
                for name in &options.sizes {
                    let size = SIZES
                        .iter()
                        .position(|s| s == name)
                        .ok_or_else(|| format!("--sizes {name}: one of {}", SIZES.join(", ")))?;
                    // Without an effect a size is only another run.
                    cases.push(Case { robot: robot.clone(), effect, size, seed });
                }
            }
        }
    }
    Ok(cases)
}

/// Runs the cases on several threads; the order of the result is that of the cases.
fn run(cases: &[Case], threads: usize) -> Vec<Score> {
    let next = AtomicUsize::new(0);
    let scores: Mutex<Vec<Score>> = Mutex::new(vec![Score::default(); cases.len()]);
    let done = AtomicUsize::new(0);
    let watched = std::io::stderr().is_terminal();
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1) {
            scope.spawn(|| {
                while let Some((k, case)) =
                    Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|k| Some((k, cases.get(k)?)))
                {
                    let score = score(case).unwrap_or_else(|error| Score {
                        refused: Some(error.to_string()),
                        ..Score::default()
                    });
                    let finished = done.fetch_add(1, Ordering::Relaxed) + 1;
                    if watched {
                        eprint!("\r{finished} of {} runs", cases.len());
                    }
                    if let Ok(mut all) = scores.lock() {
                        all[k] = score;
                    }
                }
            });
        }
    });
    if watched {
        eprintln!();
    }
    scores.into_inner().unwrap_or_default()
}

/// Simulates, diagnoses, and only then compares.
fn score(case: &Case) -> Result<Score, Failure> {
    let model = models::find(&case.robot).ok_or("no such robot")?;
    let hidden = hide::recorded(model, case)?;
    let settings = Settings { threads: 1, ..Settings::default() };
    let found = match diagnose(model, &hidden.motions, &hidden.baseline, &settings, &Silent) {
        Ok(found) => found,
        Err(refusal) => {
            return Ok(Score { joint: hidden.joint, refused: Some(refusal.to_string()), ..Score::default() });
        }
    };
    let here =
        |joints: &[usize]| joints.is_empty() || hidden.joint.is_none_or(|joint| joints.contains(&joint));
    let id = case.effect.map(EffectKind::id);
    let right = |effect: &str, joints: &[usize]| Some(effect) == id && here(joints);
    let mut score = Score { joint: hidden.joint, ..Score::default() };
    for finding in &found.findings {
        if !score.found.contains(&finding.effect) {
            score.found.push(finding.effect.clone());
        }
        if right(&finding.effect, &finding.joints) {
            score.named = true;
        } else {
            score.others.push((finding.effect.clone(), finding.joints.clone()));
        }
        score.detected |= case.effect.is_some() && here(&finding.joints);
    }
    score.cannot_tell = found
        .cannot_tell
        .iter()
        .any(|c| here(&c.joints) && c.between.iter().any(|effect| Some(effect.as_str()) == id));
    Ok(score)
}
