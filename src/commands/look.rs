//! `dynid look FILE`: what is in a recording, and a recording YAML to start from.

use std::path::{Path, PathBuf};

use clap::Args;
use dynid_runtime::recording::{Contents, Series, Unit, look};
use dynid_runtime::report::significant;
use serde::Serialize;

use crate::arguments::Source;
use crate::failure::Failure;
use crate::output::{print, table, warn, write, write_json};
use crate::ranges;
use crate::recorded::{heading, left_out_words, measure, recording_failure};
use crate::start::{Known, Start, Torques, recording_yaml};

/// What to look at.
#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// A bag (MCAP file or rosbag2 folder), Parquet, CSV or NPY file, or a recording YAML
    file: PathBuf,
    /// The robot that was recorded: a name, or the path of a robot YAML or a URDF, whose joints are looked for by name
    #[arg(long)]
    robot: Option<String>,
    /// The topic of a log in which several tell of joints
    #[arg(long)]
    topic: Option<String>,
    /// Unit of the torques: N.m, or A for currents (files do not say it)
    #[arg(long)]
    unit: Option<String>,
    /// Of torques in a drive's own unit: N.m, or N, per unit of each joint, with commas
    #[arg(
        long,
        value_delimiter = ',',
        requires = "unit",
        allow_negative_numbers = true,
        value_parser = ranges::gain,
        value_name = ranges::GAIN,
    )]
    gain: Vec<f64>,
    /// Where a recording YAML to start from is written; `-` is standard output
    #[arg(long)]
    out: Option<PathBuf>,
    /// Write what was found for other programs; `-` is standard output
    #[arg(long)]
    json: Option<PathBuf>,
}

#[derive(Serialize)]
struct Found<'a> {
    #[serde(flatten)]
    contents: &'a Contents,
    /// The recording YAML to start from, and what of it is still to be said.
    recording: &'a str,
    open: &'a [String],
}

/// Looks, prints, writes.
pub(super) fn run(arguments: &Arguments) -> Result<(), Failure> {
    let yaml = arguments.file.extension().is_some_and(|e| e == "yaml" || e == "yml");
    if yaml {
        return recording(arguments);
    }
    if let Some(unit) = arguments.unit.as_deref().filter(|unit| Unit::named(unit).is_none()) {
        return Err(Failure::Input(format!("--unit {unit} is no unit; N.m and A are")));
    }
    let shown = arguments.file.display().to_string();
    let contents = look(&arguments.file, &shown, arguments.topic.as_deref()).map_err(recording_failure)?;
    let known = Known::of(arguments.robot.as_deref(), arguments.out.as_deref())?;
    let place = (arguments.file.as_path(), arguments.out.as_deref());
    known.check_gains(&arguments.gain).map_err(Failure::Input)?;
    let given = Torques { unit: arguments.unit.as_deref(), gain: &arguments.gain };
    let Start { text, open, wrong } = recording_yaml(&contents, &known, given, place);
    if let Some(path) = &arguments.json {
        write_json(path, &Found { contents: &contents, recording: &text, open: &open })?;
    }
    let to_pipe = |path: &Option<PathBuf>| path.as_deref() == Some(Path::new("-"));
    if !to_pipe(&arguments.json) && !to_pipe(&arguments.out) {
        print(&page(&contents, &wrong));
    }
    match &arguments.out {
        Some(path) => {
            write(path, &text)?;
            open.iter().for_each(|what| warn(&format!("{}: {what}", path.display())));
        }
        None if !to_pipe(&arguments.json) => {
            print("\n`--out recording.yaml` writes a recording YAML to start from.");
            open.iter().for_each(|what| print(&format!("In it {what}")));
        }
        None => {}
    }
    Ok(())
}

fn page(contents: &Contents, wrong: &[String]) -> String {
    let mut parts = vec![format!("{}: {}, {} rows", contents.file, contents.format, contents.rows)];
    if !contents.topics.is_empty() {
        let rows = contents.topics.iter();
        let rows =
            rows.map(|t| vec![t.name.clone(), t.kind.clone(), t.encoding.clone(), t.count.to_string()]);
        parts.push(table(&["<topic", "<type", "<encoding", "messages"], rows.collect()));
    }
    if !contents.signals.is_empty() {
        let title = contents.topic.as_ref().map_or_else(String::new, |topic| format!("{topic}\n"));
        let header = ["<signal", "values", "s", "Hz", "from", "to", "still"];
        parts.push(title + &table(&header, contents.signals.iter().map(cells).collect()));
    }
    let all: Vec<String> = contents.wrong.iter().chain(wrong).map(|what| format!("  {what}")).collect();
    if !all.is_empty() {
        parts.push(format!("To know:\n{}", all.join("\n")));
    }
    parts.join("\n\n")
}

fn cells(signal: &Series) -> Vec<String> {
    let number = |x: f64| significant(x, 4);
    vec![
        signal.name.clone(),
        signal.count.to_string(),
        if signal.rate.is_some() { number(signal.duration) } else { String::new() },
        signal.rate.map_or_else(String::new, number),
        number(signal.low),
        number(signal.high),
        signal.standstill.map_or_else(String::new, |share| format!("{:.0} %", 100.0 * share)),
    ]
}

#[derive(Serialize)]
struct Motion {
    name: String,
    rows: usize,
    from: f64,
    to: f64,
    position: Vec<[f64; 2]>,
    torque: Vec<[f64; 2]>,
}

/// A recording YAML is read as the other commands do.
fn recording(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.out.is_some() || arguments.unit.is_some() || arguments.topic.is_some() {
        let name = arguments.file.display();
        return Err(Failure::Input(format!(
            "{name} is a recording YAML already: --out, --unit and --topic are for data"
        )));
    }
    let source = Source { robot: arguments.robot.clone(), ..Source::whole(arguments.file.clone()) };
    let measured = measure(&source)?;
    let range = |values: &Vec<f64>| {
        values.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], x| [low.min(*x), high.max(*x)])
    };
    let motions: Vec<Motion> = measured
        .trajectories
        .iter()
        .map(|t| Motion {
            name: t.name.clone(),
            rows: t.time.len(),
            from: t.time.first().copied().unwrap_or(0.0),
            to: t.time.last().copied().unwrap_or(0.0),
            position: t.position.iter().map(range).collect(),
            torque: t.torque.iter().map(range).collect(),
        })
        .collect();
    if let Some(path) = &arguments.json {
        write_json(path, &motions)?;
        if path == Path::new("-") {
            return Ok(());
        }
    }
    let robot = measured.dynamics.model().robot();
    let row = |motion: &Motion, j: usize| {
        let [q, u] = [motion.position[j], motion.torque[j]].map(|range| range.map(|x| significant(x, 4)));
        let name = if j == 0 { motion.name.clone() } else { String::new() };
        let when = format!("{} to {}", significant(motion.from, 4), significant(motion.to, 4));
        let when = if j == 0 { [when, motion.rows.to_string()] } else { [String::new(), String::new()] };
        let number = crate::words::joint_number(robot, j);
        let [when, rows] = when;
        vec![name, when, rows, number, format!("{} to {}", q[0], q[1]), format!("{} to {}", u[0], u[1])]
    };
    let rows = motions.iter().flat_map(|m| (0..m.position.len()).map(move |j| row(m, j))).collect();
    let header = ["<motion", "s", "rows", "joint", "position", "torque"];
    print(&format!("{}\n{}", heading(robot, &measured.title), table(&header, rows)));
    left_out_words(&measured.rows).iter().for_each(|words| print(words));
    Ok(())
}
