//! How fast an hour-scale recording is read in pieces, and in how much memory:
//! `cargo run --release -p dynid-runtime --example stream_recording -- [ROWS] [csv|npy]`
//!
//! Writes a synthetic recording of six axes to the temporary folder, reads it piece by piece,
//! prepares every piece, and removes it.

use std::io::Write;
use std::path::Path;
use std::sync::OnceLock;
use std::time::Instant;

use dynid_runtime::model::{Drive, Frame, JointKind, Limits, Robot};
use dynid_runtime::recording::{Loader, Manifest};
use dynid_runtime::signal::{Preparation, prepare};

const PIECE: usize = 100_000;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let rows: usize = arguments.next().map_or(Ok(1_000_000), |a| a.parse())?;
    let binary = arguments.next().is_some_and(|a| a == "npy");
    let folder = std::env::temp_dir().join(format!("dynid-stream-{}", std::process::id()));
    std::fs::create_dir_all(&folder)?;
    let result = measure(&folder, rows, binary);
    std::fs::remove_dir_all(&folder)?;
    result
}

fn measure(folder: &Path, rows: usize, binary: bool) -> Result<(), Box<dyn std::error::Error>> {
    let file = if binary { "data.npy" } else { "data.csv" };
    let header = if binary { "" } else { "layout: {header: false}\n" };
    let text = format!(
        "robot: arm6\n{header}time: {{column: 0}}\nposition: {{columns: [1, 2, 3, 4, 5, 6]}}\n\
         torque: {{columns: [7, 8, 9, 10, 11, 12]}}\ntrajectories: [{{file: {file}}}]\n"
    );
    let bytes = write_rows(&folder.join(file), rows, binary)?;
    let manifest = Manifest::parse(&folder.join("recording.yaml"), text.as_bytes())?;
    let robot = six_axes();

    let start = seconds();
    let mut loader = Loader::new(&manifest, &robot, PIECE)?;
    let mut read = 0;
    while let Some(trajectory) = loader.next_trajectory()? {
        read += trajectory.time.len();
    }
    let reading = seconds() - start;
    let megabytes = bytes as f64 / 1e6;
    println!(
        "read     {read} rows of {file}, {megabytes:.0} MB, in {reading:.2} CPU s: {:.0} MB/s",
        megabytes / reading
    );

    let start = seconds();
    let mut loader = Loader::new(&manifest, &robot, PIECE)?;
    let mut samples = 0;
    while let Some(trajectory) = loader.next_trajectory()? {
        samples += prepare(&trajectory, &Preparation::default())?.q[0].len();
    }
    let both = seconds() - start;
    let rate = samples as f64 / (both - reading).max(1e-9) / 1e6;
    println!("prepared {samples} samples: {rate:.1} million a second after reading");
    if let Ok(status) = std::fs::read_to_string("/proc/self/status") {
        for line in status.lines().filter(|l| l.starts_with("VmHWM")) {
            println!("{line}");
        }
    }
    Ok(())
}

/// CPU seconds of this process where the system tells them (in hundredths), else seconds on the wall.
fn seconds() -> f64 {
    static START: OnceLock<Instant> = OnceLock::new();
    let wall = START.get_or_init(Instant::now).elapsed().as_secs_f64();
    let stat = std::fs::read_to_string("/proc/self/stat").unwrap_or_default();
    let mut ticks = stat.rsplit(')').next().unwrap_or_default().split_whitespace().skip(11);
    match (ticks.next().map(str::parse::<f64>), ticks.next().map(str::parse::<f64>)) {
        (Some(Ok(user)), Some(Ok(system))) => (user + system) / 100.0,
        _ => wall,
    }
}

fn write_rows(path: &Path, rows: usize, binary: bool) -> std::io::Result<u64> {
    let mut out = std::io::BufWriter::with_capacity(1 << 20, std::fs::File::create(path)?);
    if binary {
        let mut dict = format!("{{'descr': '<f8', 'fortran_order': False, 'shape': ({rows}, 13), }}");
        dict.push_str(&" ".repeat(117 - dict.len()));
        dict.push('\n');
        out.write_all(b"\x93NUMPY\x01\x00\x76\x00")?;
        out.write_all(dict.as_bytes())?;
    }
    for k in 0..rows {
        let t = k as f64 * 5e-4;
        let mut values = [t; 13];
        for j in 1..=6 {
            values[j] = 1.5 * (0.7 * t * j as f64).sin();
            values[j + 6] = 20.0 * (0.9 * t * j as f64).cos();
        }
        if binary {
            for v in values {
                out.write_all(&v.to_le_bytes())?;
            }
        } else {
            write!(out, "{:.4}", values[0])?;
            for v in &values[1..7] {
                write!(out, ",{v:.6}")?;
            }
            for v in &values[7..] {
                write!(out, ",{v:.4}")?;
            }
            out.write_all(b"\n")?;
        }
    }
    out.flush()?;
    Ok(std::fs::metadata(path)?.len())
}

fn six_axes() -> Robot {
    let revolute = Frame::on_base(JointKind::Revolute);
    let gear: Vec<f64> = (0..36).map(|k| if k % 7 == 0 { 1.0 } else { 0.0 }).collect();
    Robot {
        name: "arm6".into(),
        description: "six axes for reading".into(),
        gravity: [0.0, 0.0, -9.81],
        frames: vec![revolute; 6].into(),
        dependent: Vec::new().into(),
        drive: Drive { gear: gear.into(), coupled_friction: Vec::new().into() },
        couplings: Vec::new().into(),
        known: Vec::new().into(),
        fixed: Vec::new().into(),
        ellipsoids: Vec::new().into(),
        limits: Limits::default(),
        standard: Vec::new().into(),
        base: Vec::new().into(),
        nominal: None,
    }
}
