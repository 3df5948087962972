//! Time and memory from trajectories to parameters: against samples, joints and threads.
//!
//! `cargo run --release --example scaling [FOLDER [SAMPLES]]` prints the tables and writes two plots to FOLDER
//! (default `docs`); SAMPLES is the longest recording (default 10,000,000). Making the recordings is not timed.
//! Rows of up to a million samples are the fastest of 3 runs, of up to 100,000 samples the fastest of 30 or 40.

mod limits;
mod made_up;

use std::error::Error;
use std::path::{Path, PathBuf};
use std::time::Instant;

use dynid::models;
use dynid::robots;
use dynid_runtime::estimation::PIECE;
use dynid_runtime::estimation::observe::{Equations, ObserveSettings};
use dynid_runtime::estimation::{EstimateSettings, Method, Piecewise, estimate};
use dynid_runtime::model::{Model, RecursiveModel};
use dynid_runtime::report::{Panel, Sheet};
use dynid_runtime::signal::Preparation;

use made_up::trajectory;

struct Cost {
    seconds: f64,
    cpu: f64,
    /// Largest relative error of the parameters.
    worst: f64,
    /// The parameters.
    chi: Vec<f64>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().unwrap_or_else(|| "docs".to_owned()));
    let longest: usize = arguments.next().map_or(Ok(10_000_000), |text| text.parse())?;
    std::fs::create_dir_all(&folder)?;
    let tx40 = models::find("tx40").ok_or("there is no tx40 in robots/")?;
    println!(
        "| robot | engine | joints | samples | threads | s | CPU s | million samples a CPU s | worst parameter | peak MB |"
    );
    println!("|---|---|--:|--:|--:|--:|--:|--:|--:|--:|");
    let mut curves = [Vec::new(), Vec::new(), Vec::new()];
    let (mut longest_cost, mut speed_ups) = (None, Vec::new());
    for samples in [10_000, 100_000, 1_000_000, 10_000_000].into_iter().filter(|&s| s <= longest) {
        let [one, two] = [1, 2].map(|threads| fastest(tx40, samples, threads));
        let (one, two) = (one?, two?);
        for (threads, cost) in [(1, &one), (2, &two)] {
            report(tx40, "generated", samples, threads, cost);
            curves[threads - 1].push(((samples as f64).log10(), cost.seconds.log10()));
        }
        curves[2].push(((samples as f64).log10(), one.cpu.log10()));
        let same = one.chi.iter().zip(&two.chi).all(|(a, b)| a.to_bits() == b.to_bits());
        if !same {
            return Err("one and two threads do not give the same digits".into());
        }
        speed_ups.push(format!("{:.2} ({samples} samples)", one.seconds / two.seconds));
        longest_cost = Some((samples, one.cpu));
    }
    let samples = 500_000.min(longest);
    let mut generated = Vec::new();
    for &model in models::all() {
        let cost = fastest(model, samples, 1)?;
        report(model, "generated", samples, 1, &cost);
        generated.push((model.robot().joints() as f64, cost.cpu / samples as f64 * 1e6));
    }
    generated.sort_by(|a: &(f64, f64), b| a.0.total_cmp(&b.0));
    let mut recursive = Vec::new();
    for joints in 2..=8 {
        let model = chain(joints, &folder)?;
        let cost = fastest(&model, samples, 1)?;
        report(&model, "recursive", samples, 1, &cost);
        recursive.push((joints as f64, cost.cpu / samples as f64 * 1e6));
    }
    if let Some((samples, cpu)) = longest_cost {
        println!("\nTwo threads give the same digits, all 64 bits of every parameter.");
        println!("Times as fast on two threads: {}.", speed_ups.join(", "));
        println!("{}", limits::compare(tx40, cpu / samples as f64));
    }
    let labels = ["1 thread", "2 threads", "1 thread, CPU"].map(str::to_owned);
    let samples = labels.into_iter().zip(curves).collect();
    let robots = vec![("generated".to_owned(), generated), ("recursive, chains".to_owned(), recursive)];
    let time = sheet("log10 of seconds against log10 of samples, TX-40", "log10 samples", samples);
    std::fs::write(folder.join("scaling_samples.svg"), time)?;
    let time = sheet("CPU microseconds a sample against joints, one robot a point", "joints", robots);
    std::fs::write(folder.join("scaling_joints.svg"), time)?;
    Ok(())
}

/// A chain of revolute axes at right angles with friction and rotors, which no robot of `robots/` has: through the
/// recursive engine, as any table given by path.
fn chain(joints: usize, folder: &Path) -> Result<RecursiveModel, Box<dyn Error>> {
    let turns = ["0", "-pi/2", "pi/2", "pi/2", "-pi/2", "-pi/2", "pi/2", "pi/2"];
    let frames: String = (1..=joints)
        .map(|j| {
            let (alpha, r) = (turns[(j - 1) % turns.len()], if j % 2 == 1 { 0.3 } else { 0.0 });
            format!("  - {{j: {j}, sigma: 0, alpha: {alpha}, d: 0, theta: q{j}, r: {r}}}\n")
        })
        .collect();
    let gear = vec!["100"; joints].join(", ");
    let text = format!(
        "name: chain{joints}\ndescription: made up\ngravity: [0, 0, -9.81]\nframes:\n{frames}drive: {{gear: [{gear}]}}\n"
    );
    let path = folder.join(format!("chain{joints}.yaml"));
    std::fs::write(&path, text)?;
    let robot = robots::read(&path).map_err(|failure| failure.to_string());
    std::fs::remove_file(&path)?;
    Ok(RecursiveModel::new(robot?)?)
}

fn sheet(title: &str, x: &str, lines: Vec<(String, Vec<(f64, f64)>)>) -> String {
    let panels = vec![Panel { title: String::new(), lines }];
    Sheet { title: title.to_owned(), x: x.to_owned(), columns: 1, panel: [560.0, 300.0], panels }.to_svg()
}

fn report(model: &dyn Model, engine: &str, samples: usize, threads: usize, cost: &Cost) {
    let robot = model.robot();
    println!(
        "| {} | {engine} | {} | {samples} | {threads} | {:.3} | {:.3} | {:.2} | {:.1e} | {} |",
        robot.name,
        robot.joints(),
        cost.seconds,
        cost.cpu,
        samples as f64 / cost.cpu * 1e-6,
        cost.worst,
        peak_megabytes().map_or_else(|| "-".to_owned(), |mb| mb.to_string()),
    );
}

/// The fastest of several runs where they are short: another load on the machine hurts some of them only. CPU
/// seconds, which count ticks, are their mean.
fn fastest(model: &dyn Model, samples: usize, threads: usize) -> Result<Cost, Box<dyn Error>> {
    let mut best = measure(model, samples, threads)?;
    for _ in 1..runs(samples) {
        let again = measure(model, samples, threads)?;
        best.seconds = best.seconds.min(again.seconds);
        best.cpu += again.cpu;
    }
    best.cpu /= runs(samples) as f64;
    Ok(best)
}

fn runs(samples: usize) -> usize {
    (3_000_000 / samples).clamp(1, 40)
}

/// Prepares, observes and identifies a recording piece by piece.
fn measure(model: &dyn Model, samples: usize, threads: usize) -> Result<Cost, Box<dyn Error>> {
    let chi = parameters(model);
    let settings = ObserveSettings { threads, ..ObserveSettings::default() };
    let equations = [Equations::Torque];
    let (mut seconds, mut cpu) = (0.0, 0.0);
    let mut timed = |start: (Instant, f64)| {
        seconds += start.0.elapsed().as_secs_f64();
        cpu += cpu_seconds() - start.1;
    };
    let mut all: Option<Piecewise<'_>> = None;
    for first in (0..samples).step_by(PIECE) {
        let piece = trajectory(model, &chi, first, PIECE.min(samples - first));
        let start = (Instant::now(), cpu_seconds());
        match &mut all {
            Some(all) => all.add(&piece)?,
            None => {
                let settings = settings.clone();
                all =
                    Some(Piecewise::new(model, &equations, vec![piece], Preparation::default(), settings)?.0);
            }
        }
        timed(start);
    }
    let start = (Instant::now(), cpu_seconds());
    let (observations, _) = all.ok_or("there is no sample")?.finish()?;
    let observation = observations.first().ok_or("nothing was observed")?;
    let result = estimate(observation, &EstimateSettings::for_method(Method::IdimWls));
    timed(start);
    let found = result.chi();
    let worst = found.iter().zip(&chi).map(|(e, c)| (e / c - 1.0).abs()).fold(0.0, f64::max);
    Ok(Cost { seconds, cpu, worst, chi: found })
}

/// User and system time of this process, s, where the system tells; ticks of 10 ms.
fn cpu_seconds() -> f64 {
    let text = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let after_name = text.rsplit(')').next().unwrap_or_default();
    after_name.split_whitespace().skip(11).take(2).filter_map(|t| t.parse::<f64>().ok()).sum::<f64>() / 100.0
}

/// Largest memory that this process ever had, MB, where the system tells.
fn peak_megabytes() -> Option<u64> {
    let text = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = text.lines().find(|line| line.starts_with("VmHWM"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok().map(|kb| kb / 1024)
}

/// Base parameters, all different and none of them zero.
fn parameters(model: &dyn Model) -> Vec<f64> {
    (0..model.robot().base.len()).map(|k| 1.0 + 0.1 * k as f64).collect()
}
