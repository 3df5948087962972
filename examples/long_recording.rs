//! Writes an hour-scale recording to a folder, as text or as binary columns:
//! `cargo run --release --example long_recording -- FOLDER [SAMPLES] [csv|npy]`.
//!
//! The motion is that of the `scaling` example, 1 kHz, TX-40. Then, for time and memory:
//! `/usr/bin/time -v target/release/dynid identify FOLDER/recording.yaml`.

#[path = "scaling/made_up.rs"]
mod made_up;

use std::error::Error;
use std::fmt::Write as _;
use std::fs::File;
use std::io::{BufWriter, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

use dynid::models;
use dynid_runtime::model::Model;
use dynid_runtime::recording::Trajectory;
use made_up::{RATE, trajectory};

const ROBOT: &str = "tx40";
/// Rows that are made at a time.
const PIECE: usize = 100_000;

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let folder = PathBuf::from(arguments.next().ok_or("where to? FOLDER [SAMPLES] [csv|npy]")?);
    let samples: usize = arguments.next().map_or(Ok(10_000_000), |text| text.parse())?;
    let binary = match arguments.next().as_deref() {
        None | Some("csv") => false,
        Some("npy") => true,
        Some(other) => return Err(format!("{other}: csv or npy").into()),
    };
    std::fs::create_dir_all(&folder)?;
    let model = models::find(ROBOT).ok_or("there is no tx40 in robots/")?;
    let (n, chi) = (model.robot().joints(), nominal(model));
    let name = if binary { "data.npy" } else { "data.csv" };
    let path = folder.join(name);
    let pieces =
        (0..samples).step_by(PIECE).map(|first| trajectory(model, &chi, first, PIECE.min(samples - first)));
    if binary {
        write_columns(&path, samples, n, pieces)?
    } else {
        write_rows(&path, n, pieces)?
    }
    std::fs::write(folder.join("recording.yaml"), manifest(name, n))?;
    println!("{}: {} MB", path.display(), std::fs::metadata(&path)?.len() / 1_000_000);
    Ok(())
}

/// The base parameters of the robot's nominal ones: torques that its drives can give.
fn nominal(model: &dyn Model) -> Vec<f64> {
    let robot = model.robot();
    let standard = |k: usize| robot.nominal.as_ref().map_or(0.0, |nominal| nominal.standard[k]);
    robot.base.iter().map(|p| p.combination.iter().map(|&(k, c)| c * standard(k)).sum()).collect()
}

fn manifest(file: &str, n: usize) -> String {
    let layout = if file.ends_with("csv") { "layout: {header: true}\n" } else { "" };
    let columns = |first: usize| (first..first + n).map(|c| c.to_string()).collect::<Vec<_>>().join(", ");
    format!(
        "robot: {ROBOT}\ntitle: made up\nside: joint\n{layout}time: {{rate: {RATE}}}\n\
         position: {{columns: [{}], unit: rad}}\ntorque: {{columns: [{}], unit: N.m}}\n\
         trajectories: [{{file: {file}}}]\n",
        columns(0),
        columns(n),
    )
}

/// One line a sample: angles with eight decimals, torques with four.
fn write_rows(path: &Path, n: usize, pieces: impl Iterator<Item = Trajectory>) -> Result<(), Box<dyn Error>> {
    let mut file = BufWriter::with_capacity(1 << 20, File::create(path)?);
    let names = |letter: &str| (1..=n).map(|j| format!("{letter}{j}")).collect::<Vec<_>>().join(",");
    writeln!(file, "{},{}", names("q"), names("tau"))?;
    let mut line = String::new();
    for piece in pieces {
        for k in 0..piece.time.len() {
            line.clear();
            for (j, q) in piece.position.iter().enumerate() {
                write!(line, "{}{:.8}", if j > 0 { "," } else { "" }, q[k])?;
            }
            for torque in &piece.torque {
                write!(line, ",{:.4}", torque[k])?;
            }
            writeln!(file, "{line}")?;
        }
    }
    Ok(file.flush()?)
}

/// NumPy's format, version 1.0, in Fortran order: channel behind channel.
fn write_columns(
    path: &Path,
    samples: usize,
    n: usize,
    pieces: impl Iterator<Item = Trajectory>,
) -> Result<(), Box<dyn Error>> {
    let mut file = File::create(path)?;
    let text = format!("{{'descr': '<f8', 'fortran_order': True, 'shape': ({samples}, {}), }}", 2 * n);
    let header = format!("{text:<117}\n");
    file.write_all(b"\x93NUMPY\x01\x00")?;
    file.write_all(&(header.len() as u16).to_le_bytes())?;
    file.write_all(header.as_bytes())?;
    let start = 10 + header.len();
    let mut done = 0;
    for piece in pieces {
        for (c, channel) in piece.position.iter().chain(&piece.torque).enumerate() {
            let bytes: Vec<u8> = channel.iter().flat_map(|x| x.to_le_bytes()).collect();
            file.seek(SeekFrom::Start((start + 8 * (c * samples + done)) as u64))?;
            file.write_all(&bytes)?;
        }
        done += piece.time.len();
    }
    Ok(())
}
