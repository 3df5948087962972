//! Time and memory from trajectories to parameters: against samples, joints and threads.
//!
//! `cargo run --release --example scaling [FOLDER [SAMPLES]]` prints the tables and writes two plots to FOLDER
//! (default `docs`); SAMPLES is the longest recording (default 10,000,000). Making the recordings is not timed.

use std::error::Error;
use std::path::PathBuf;
use std::time::Instant;

use dynid::models;
use dynid::recorded::PIECE;
use dynid_runtime::estimation::observe::{Equations, ObserveSettings};
use dynid_runtime::estimation::{EstimateSettings, Method, Piecewise, estimate};
use dynid_runtime::model::{Model, States};
use dynid_runtime::recording::Trajectory;
use dynid_runtime::report::{Panel, Sheet};
use dynid_runtime::signal::Preparation;

/// Samples a second of the made-up recordings, Hz.
const RATE: f64 = 1000.0;
/// Torque noise, N.m or N.
const NOISE: f64 = 0.1;

struct Cost {
    seconds: f64,
    cpu: f64,
    /// Largest relative error of the parameters.
    worst: f64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().unwrap_or_else(|| "docs".to_owned()));
    let longest: usize = arguments.next().map_or(Ok(10_000_000), |text| text.parse())?;
    let tx40 = models::find("tx40").ok_or("there is no tx40 in robots/")?;
    println!(
        "| robot | joints | samples | threads | s | CPU s | million samples a CPU s | worst parameter | peak MB |"
    );
    println!("|---|--:|--:|--:|--:|--:|--:|--:|--:|");
    let mut curves = Vec::new();
    for threads in [1, 2] {
        let mut curve = Vec::new();
        for samples in [10_000, 100_000, 1_000_000, 10_000_000].into_iter().filter(|&s| s <= longest) {
            let cost = measure(tx40, samples, threads)?;
            report(tx40, samples, threads, &cost);
            curve.push(((samples as f64).log10(), cost.seconds.log10()));
        }
        curves.push(curve);
    }
    let mut joints = Vec::new();
    for &model in models::all() {
        let samples = 500_000.min(longest);
        let cost = measure(model, samples, 1)?;
        report(model, samples, 1, &cost);
        joints.push((model.robot().joints() as f64, cost.cpu / samples as f64 * 1e6));
    }
    joints.sort_by(|a: &(f64, f64), b| a.0.total_cmp(&b.0));
    let curves = curves.into_iter().zip(["1 thread", "2 threads"]);
    let samples: Vec<_> = curves.map(|(curve, label)| (label.to_owned(), curve)).collect();
    let robots = vec![("1 thread".to_owned(), joints)];
    std::fs::create_dir_all(&folder)?;
    let time = sheet("log10 of seconds against log10 of samples, TX-40", "log10 samples", samples);
    std::fs::write(folder.join("scaling_samples.svg"), time)?;
    let time = sheet("CPU microseconds a sample against joints, one robot a point", "joints", robots);
    std::fs::write(folder.join("scaling_joints.svg"), time)?;
    Ok(())
}

fn sheet(title: &str, x: &str, lines: Vec<(String, Vec<(f64, f64)>)>) -> String {
    let panels = vec![Panel { title: String::new(), lines }];
    Sheet { title: title.to_owned(), x: x.to_owned(), columns: 1, panel: [560.0, 300.0], panels }.to_svg()
}

fn report(model: &dyn Model, samples: usize, threads: usize, cost: &Cost) {
    let robot = model.robot();
    println!(
        "| {} | {} | {samples} | {threads} | {:.3} | {:.2} | {:.2} | {:.1e} | {} |",
        robot.name,
        robot.joints(),
        cost.seconds,
        cost.cpu,
        samples as f64 / cost.cpu.max(0.01) * 1e-6,
        cost.worst,
        peak_megabytes().map_or_else(|| "-".to_owned(), |mb| mb.to_string()),
    );
}

/// Prepares, observes and identifies a recording piece by piece.
fn measure(model: &dyn Model, samples: usize, threads: usize) -> Result<Cost, Box<dyn Error>> {
    let chi: Vec<f64> = (0..model.robot().base.len()).map(|k| 1.0 + 0.1 * k as f64).collect();
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
    let worst = result.chi().iter().zip(&chi).map(|(e, c)| (e / c - 1.0).abs()).fold(0.0, f64::max);
    Ok(Cost { seconds, cpu, worst })
}

/// Samples `first..first + count` of a smooth motion, and the torques of the model with noise.
fn trajectory(model: &dyn Model, chi: &[f64], first: usize, count: usize) -> Trajectory {
    let n = model.robot().joints();
    let mut signals = [vec![vec![0.0; count]; n], vec![vec![0.0; count]; n], vec![vec![0.0; count]; n]];
    let time: Vec<f64> = (first..first + count).map(|k| k as f64 / RATE).collect();
    let [q, dq, ddq] = &mut signals;
    for j in 0..n {
        for harmonic in 1..=4 {
            let w = (1.1 + 0.37 * j as f64) * harmonic as f64;
            let a = 1.2 / (harmonic * harmonic) as f64;
            for (k, t) in time.iter().enumerate() {
                let (s, c) = (w * t + harmonic as f64 * 0.7 * j as f64).sin_cos();
                q[j][k] += a * s;
                dq[j][k] += a * w * c;
                ddq[j][k] -= a * w * w * s;
            }
        }
    }
    let pattern = model.pattern();
    let (block, stride) = (64, 72);
    let mut out = vec![0.0; pattern.columns.len() * stride];
    let mut torque = vec![Vec::with_capacity(count); n];
    let mut random = first as u64 ^ 0x9e37_79b9_7f4a_7c15;
    for from in (0..count).step_by(block) {
        let to = (from + block).min(count);
        let slices = signals.each_ref().map(|s| s.iter().map(|x| &x[from..to]).collect::<Vec<_>>());
        model.idm_block(States { q: &slices[0], dq: &slices[1], ddq: &slices[2] }, stride, &mut out);
        for t in 0..to - from {
            for (j, torque) in torque.iter_mut().enumerate() {
                let entries = pattern.rows[j]..pattern.rows[j + 1];
                let exact: f64 = entries.map(|e| out[e * stride + t] * chi[pattern.columns[e]]).sum();
                random =
                    random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
                torque.push(exact + NOISE * ((random >> 11) as f64 / (1u64 << 53) as f64 - 0.5));
            }
        }
    }
    let [position, ..] = signals;
    Trajectory { name: "made up".into(), time, position, velocity: None, torque, fixed: Vec::new() }
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
