//! Hides every effect of the catalogue in simulated robots, diagnoses without being told, and keeps score.
//!
//! `cargo run --release --example concealment -- --out docs/concealment.md`
//!
//! Every run is a closed-loop simulation of one to three random motions at 500 Hz, with the robot's nominal noise, on
//! a random joint. The diagnosis gets the recorded motions alone. Runs without any effect give the rate of false
//! alarms. With `--dump` the recordings are written as folders of a challenge, and nothing is diagnosed.

mod dump;
mod hide;
mod hiding;
mod journal;
mod motions;
mod page;
mod places;
mod put;
mod random;
mod secret;
mod seen;
mod size;
mod visible;
mod words;

use std::io::Write;
use std::path::PathBuf;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Instant;

use clap::Parser;
use dynid::models;
use dynid_runtime::diagnosis::{Diagnosis, Settings, Silent, diagnose};
use dynid_runtime::effects::EffectKind;
use serde::{Deserialize, Serialize};

use hide::{Hidden, draw, recordings};
use journal::Journal;
use random::Random;
use size::SIZES;

/// Anything that ends a run.
pub type Failure = Box<dyn std::error::Error + Send + Sync>;

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
    /// How many seeds; each has its own motions, joint, shape and noise
    #[arg(long, default_value_t = 5)]
    seeds: u64,
    /// The first seed
    #[arg(long, default_value_t = 1)]
    first_seed: u64,
    /// Hide two effects at once: each effect with another one of the list
    #[arg(long)]
    pairs: bool,
    /// One motion of this duration, s, instead of one to three of 16 to 24 s together
    #[arg(long)]
    seconds: Option<f64>,
    /// Threads; the result does not depend on them
    #[arg(long, default_value_t = 2)]
    threads: usize,
    /// Markdown file for the tables [default: standard output]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Write down every finished run here, and take those that are there as done: a stopped test goes on
    #[arg(long, conflicts_with_all = ["visible", "dump"])]
    journal: Option<PathBuf>,
    /// Simulate only, and write what can be seen of every effect
    #[arg(long, conflicts_with = "dump")]
    visible: bool,
    /// Write the cases to this folder as a challenge, instead of diagnosing them
    #[arg(long, conflicts_with = "out")]
    dump: Option<PathBuf>,
}

/// One simulation and one diagnosis.
#[derive(Debug, Clone)]
pub struct Case {
    /// Name of the robot.
    pub robot: String,
    /// What is hidden; empty for nothing.
    pub effects: Vec<EffectKind>,
    /// Index in [`SIZES`].
    pub size: usize,
    /// Seed.
    pub seed: u64,
    /// Duration of its one motion, s; `None` for one to three of the usual length.
    pub seconds: Option<f64>,
}

impl Case {
    /// What its folder is called.
    pub fn name(&self) -> String {
        let hidden: Vec<&str> = self.effects.iter().map(|e| e.id()).collect();
        let hidden = if hidden.is_empty() { "none".to_owned() } else { hidden.join("+") };
        let length = self.seconds.map_or_else(String::new, |s| format!("_{s}s"));
        format!("{}_{hidden}_{}_{}{length}", self.robot, self.size_name(), self.seed)
    }

    fn size_name(&self) -> &'static str {
        SIZES[self.size]
    }
}

/// How a case ended.
#[derive(Debug, Clone, Default, Serialize, Deserialize)]
pub struct Score {
    /// What was hidden, and whether it was found: something on its joint, itself on its joint, or among what cannot
    /// be told apart there.
    pub hidden: Vec<(Hidden, Outcome)>,
    /// Findings that are none of the hidden effects on its joint.
    pub others: Vec<(String, Vec<usize>)>,
    /// Effects found anywhere, each once.
    pub found: Vec<String>,
    /// Why there is no diagnosis.
    pub refused: Option<String>,
    /// Time of the diagnosis, s.
    pub seconds: f64,
    /// Time of simulation and diagnosis, s.
    pub whole: f64,
}

impl Score {
    fn not_simulated() -> Self {
        Self { refused: Some("it could not be simulated".to_owned()), ..Self::default() }
    }

    /// Whether everything hidden was named, and nothing else.
    pub fn solved(&self) -> bool {
        self.refused.is_none() && self.others.is_empty() && self.hidden.iter().all(|(_, o)| o.named)
    }
}

/// What became of a hidden effect.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Outcome {
    /// Something was found on the joint.
    pub detected: bool,
    /// The effect itself was found on its joint.
    pub named: bool,
    /// The effect is among those that the diagnosis says it cannot tell apart there.
    pub cannot_tell: bool,
}

fn main() -> Result<(), Failure> {
    let options = Options::parse();
    let cases = cases(&options)?;
    let start = Instant::now();
    if let Some(folder) = &options.dump {
        let failed = in_parallel(&cases, options.threads, |case| {
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
        let seen = in_parallel(&cases, options.threads, |case| {
            let model = models::find(&case.robot).ok_or("no such robot")?;
            let drawn = draw(model, case)?;
            Ok((words::hidden_in_words(&drawn.hidden), drawn.hidden))
        });
        let minutes = start.elapsed().as_secs_f64() / 60.0;
        return finish(&options, &seen::what_can_be_seen(&cases, &seen, &options, minutes));
    }
    let journal = options.journal.as_deref().map(Journal::open).transpose()?;
    let scores: Vec<Score> = in_parallel(&cases, options.threads, |case| {
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
        effects = EffectKind::ALL.into_iter().map(|e| vec![e]).chain([Vec::new()]).collect();
    }
    let mut cases = Vec::new();
    for seed in options.first_seed..options.first_seed + options.seeds {
        for robot in &options.robots {
            models::find(robot).ok_or_else(|| format!("--robots {robot}: robots/ has no such robot"))?;
            for hidden in &effects {
                for name in &options.sizes {
                    let size = SIZES
                        .iter()
                        .position(|s| s == name)
                        .ok_or_else(|| format!("--sizes {name}: one of {}", SIZES.join(", ")))?;
                    let mut hidden = hidden.clone();
                    if options.pairs {
                        let Some(&first) = hidden.first() else { continue };
                        hidden.extend(partner(first, &effects, robot, name, seed));
                    }
                    // Without an effect a size is only another run.
                    let seconds = options.seconds;
                    cases.push(Case { robot: robot.clone(), effects: hidden, size, seed, seconds });
                }
            }
        }
    }
    Ok(cases)
}

/// Another effect of the list that can be hidden with `first`: both are changes, or none is.
fn partner(
    first: EffectKind,
    effects: &[Vec<EffectKind>],
    robot: &str,
    size: &str,
    seed: u64,
) -> Option<EffectKind> {
    let possible: Vec<EffectKind> = effects
        .iter()
        .flatten()
        .copied()
        .filter(|&e| e != first && secret::is_change(e) == secret::is_change(first))
        .collect();
    let drawn = Random::of(&["partner", robot, size, first.id()], seed).below(possible.len());
    possible.get(drawn).copied()
}

/// Does something with every case, on several threads; the order of the results is that of the cases. Each is told on
/// standard error as it ends; one that fails gives `None`.
fn in_parallel<T: Send>(
    cases: &[Case],
    threads: usize,
    work: impl Fn(&Case) -> Result<(String, T), Failure> + Sync,
) -> Vec<Option<T>> {
    let next = AtomicUsize::new(0);
    let done = AtomicUsize::new(0);
    let results: Mutex<Vec<Option<T>>> = Mutex::new(cases.iter().map(|_| None).collect());
    std::thread::scope(|scope| {
        for _ in 0..threads.max(1) {
            scope.spawn(|| {
                while let Some((k, case)) =
                    Some(next.fetch_add(1, Ordering::Relaxed)).and_then(|k| Some((k, cases.get(k)?)))
                {
                    let (words, result) = match work(case) {
                        Ok((words, result)) => (words, Some(result)),
                        Err(error) => (error.to_string(), None),
                    };
                    let finished = done.fetch_add(1, Ordering::Relaxed) + 1;
                    eprintln!("{finished}/{} {}: {words}", cases.len(), case.name());
                    if let Ok(mut all) = results.lock() {
                        all[k] = result;
                    }
                }
            });
        }
    });
    results.into_inner().unwrap_or_default()
}

/// Simulates, diagnoses, and only then compares.
fn score(case: &Case) -> Result<Score, Failure> {
    let model = models::find(&case.robot).ok_or("no such robot")?;
    let whole = Instant::now();
    let recordings = recordings(model, case, false)?;
    let mut settings = Settings::default();
    settings.threads = 1;
    let start = Instant::now();
    let found = diagnose(model, &recordings.motions, &recordings.baseline, &settings, &Silent);
    let mut score = Score { seconds: start.elapsed().as_secs_f64(), ..Score::default() };
    match found {
        Ok(found) => compare(&found, recordings.hidden, &mut score),
        Err(refusal) => {
            score.hidden = recordings.hidden.into_iter().map(|h| (h, Outcome::default())).collect();
            score.refused = Some(refusal.to_string());
        }
    }
    score.whole = whole.elapsed().as_secs_f64();
    Ok(score)
}

fn compare(found: &Diagnosis, hidden: Vec<Hidden>, score: &mut Score) {
    let here = |hidden: &Hidden, joints: &[usize]| {
        joints.is_empty() || hidden.joint.is_none_or(|joint| joints.contains(&(joint + 1)))
    };
    for finding in &found.findings {
        if !score.found.contains(&finding.effect) {
            score.found.push(finding.effect.clone());
        }
        if !hidden.iter().any(|h| finding.effect == h.effect.id() && here(h, &finding.joints)) {
            score.others.push((finding.effect.clone(), finding.joints.clone()));
        }
    }
    score.hidden = hidden
        .into_iter()
        .map(|h| {
            let id = h.effect.id();
            let outcome = Outcome {
                detected: found.findings.iter().any(|f| here(&h, &f.joints)),
                named: found.findings.iter().any(|f| f.effect == id && here(&h, &f.joints)),
                cannot_tell: found
                    .cannot_tell
                    .iter()
                    .any(|c| here(&h, &c.joints) && c.between.iter().any(|effect| effect == id)),
            };
            (h, outcome)
        })
        .collect();
}
