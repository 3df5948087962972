//! A recording YAML to start from, of what was found in a data file.

use std::path::{Path, PathBuf};

use dynid_runtime::model::{JointKind, Robot};
use dynid_runtime::recording::{Channels, Contents, channels, is_log, nearest};
use dynid_urdf::ImportOptions;

use crate::failure::Failure;
use crate::robots::resolve;
use crate::urdf_files::{imported, is_urdf};

/// What is known of the robot.
#[derive(Debug, Clone, Default)]
pub struct Known {
    /// How the recording YAML names it.
    reference: Option<String>,
    /// Names of its joints, in the order of its table; empty where its table has none.
    joints: Vec<String>,
    kinds: Vec<JointKind>,
}

impl Known {
    /// The robot of an option; `out` is where the recording YAML will stand.
    ///
    /// # Errors
    /// What is wrong with its file.
    pub fn of(robot: Option<&str>, out: Option<&Path>) -> Result<Self, Failure> {
        let Some(name) = robot else { return Ok(Self::default()) };
        let dynamics = resolve(name, None)?;
        let joints = joint_names(name)?.unwrap_or_default();
        let path = Path::new(name);
        let reference = if path.is_file() { beside(path, out) } else { name.to_owned() };
        Ok(Self { reference: Some(reference), joints, kinds: dynamics.model().robot().joint_kinds() })
    }
}

impl Known {
    /// That there are as many gains as the robot has joints, where both are known.
    ///
    /// # Errors
    /// What is wrong.
    pub fn check_gains(&self, gains: &[f64]) -> Result<(), String> {
        match self.kinds.len() {
            0 => Ok(()),
            joints if gains.is_empty() || gains.len() == joints => Ok(()),
            joints => Err(format!("--gain has {} numbers, but the robot has {joints} joints", gains.len())),
        }
    }
}

/// Names that the joints of a robot have in its URDF; `None` for another robot.
///
/// # Errors
/// What is wrong with the URDF.
pub fn joint_names(robot: &str) -> Result<Option<Vec<String>>, Failure> {
    let path = Path::new(robot);
    if !is_urdf(path) {
        return Ok(None);
    }
    Ok(Some(imported(path, &ImportOptions::default())?.0.joints))
}

/// What joints are called where their robot has no names for them.
pub fn numbered(robot: &Robot) -> Vec<String> {
    (0..robot.joints()).map(|j| format!("joint{}", crate::words::joint_number(robot, j))).collect()
}

/// A path as a file in the folder of `out` names it: relative where it is below that folder, else absolute.
fn beside(path: &Path, out: Option<&Path>) -> String {
    let folder = match out.and_then(Path::parent) {
        Some(folder) if !folder.as_os_str().is_empty() => folder.to_path_buf(),
        _ => PathBuf::from("."),
    };
    let (Ok(whole), Ok(folder)) = (path.canonicalize(), folder.canonicalize()) else {
        return path.display().to_string();
    };
    match whole.strip_prefix(&folder) {
        Ok(below) => format!("./{}", below.display()),
        Err(_) => whole.display().to_string(),
    }
}

/// A recording YAML, what is still to be said in it, and what does not fit the robot.
#[derive(Debug, Clone, Default)]
pub struct Start {
    /// The text.
    pub text: String,
    /// What only a person knows.
    pub open: Vec<String>,
    /// What does not fit.
    pub wrong: Vec<String>,
}

/// A recording YAML for a data file, to be written to `place.1`, with what is known of the torques.
pub fn recording_yaml(
    contents: &Contents,
    known: &Known,
    given: Torques<'_>,
    place: (&Path, Option<&Path>),
) -> Start {
    let (data, out) = place;
    let mut start = Start::default();
    let mut lines = Vec::new();
    match &known.reference {
        Some(reference) => lines.push(format!("robot: {}", quoted(reference))),
        None => {
            lines.push(
                "robot: ./robot.yaml  # a name of `dynid robots`, or the path of a robot YAML or a URDF"
                    .into(),
            );
            start.open.push("`robot` is to be named (--robot)".into());
        }
    }
    let name = data.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned());
    lines.push(format!("title: {}", quoted(&name)));
    let names: Vec<String> = contents.signals.iter().map(|signal| signal.name.clone()).collect();
    let found = channels(&names);
    // Signals of messages that do not tell of joints are columns.
    let log = is_log(data) && !names.iter().any(|name| name.ends_with(']'));
    if log {
        lines.extend(of_log(contents, known, &found, &mut start));
    } else {
        lines.extend(of_table(contents, known, &found, &mut start));
    }
    let columns = if log { String::new() } else { columns(&in_order(&found.torque, known, &found)) };
    let given = Torques { unit: given.unit.or(found.current.then_some("A")), ..given };
    lines.push(torque(&columns, known, given, &mut start));
    lines.push("trajectories:".into());
    let topic = contents.topic.as_ref();
    let topic = topic.map_or_else(String::new, |topic| format!(", topic: {}", quoted(topic)));
    let reference = beside(data, out);
    let reference = reference.strip_prefix("./").unwrap_or(&reference);
    lines.push(format!("  - {{file: {}{topic}}}", quoted(reference)));
    start.text = lines.join("\n") + "\n";
    start
}

/// A JSON string is a YAML string; plain where it may be.
fn quoted(text: &str) -> String {
    let plain = |c: char| c.is_ascii_alphanumeric() || matches!(c, '_' | '-' | '.' | '/');
    let number = text.parse::<f64>().is_ok();
    let word = matches!(
        text.to_ascii_lowercase().as_str(),
        "" | "true" | "false" | "null" | "yes" | "no" | "on" | "off"
    );
    match text.chars().all(plain) && !text.starts_with('-') && !number && !word {
        true => text.to_owned(),
        false => serde_json::Value::from(text).to_string(),
    }
}

/// A column as a recording YAML names it.
fn column(name: &str) -> String {
    if name.parse::<usize>().is_ok() { name.to_owned() } else { quoted(name) }
}

fn columns(names: &[String]) -> String {
    format!("columns: [{}]", names.iter().map(|name| column(name)).collect::<Vec<_>>().join(", "))
}

/// Lines about the joints of a log.
fn of_log(contents: &Contents, known: &Known, found: &Channels, start: &mut Start) -> Vec<String> {
    let with = |field: &str| -> Vec<&str> {
        contents.signals.iter().filter_map(|s| s.name.strip_suffix(field)).collect()
    };
    let (positions, efforts) = (with(".position"), with(".effort"));
    let all: Vec<&str> = positions.iter().copied().filter(|joint| efforts.contains(joint)).collect();
    if efforts.is_empty() && !positions.is_empty() {
        start.wrong.push("no joint has an effort: torques must come from elsewhere".into());
    }
    let joints: Vec<String> = if known.joints.is_empty() {
        if !known.kinds.is_empty() && known.kinds.len() != all.len() {
            start.open.push(format!("`joints` names {}, but the robot has {}", all.len(), known.kinds.len()));
        }
        all.iter().map(|joint| (*joint).to_owned()).collect()
    } else {
        for joint in known.joints.iter().filter(|joint| !all.contains(&joint.as_str())) {
            let meant = nearest(joint, all.iter().copied());
            let meant = meant.map_or_else(String::new, |meant| format!("; is it `{meant}` in the log?"));
            start
                .wrong
                .push(format!("the log has no position and effort of the robot's joint `{joint}`{meant}"));
            start.open.push(format!("`joints` has `{joint}`, which the log does not name"));
        }
        known.joints.clone()
    };
    let mut lines = Vec::new();
    if contents.time.as_deref() == Some("log_time") {
        lines.push("time: {column: log_time}".into());
    }
    let order =
        if known.joints.is_empty() && found.keys.len() > 1 { "  # as in the robot's table?" } else { "" };
    let joints: Vec<String> = joints.iter().map(|joint| quoted(joint)).collect();
    lines.push(format!("joints: [{}]{order}", joints.join(", ")));
    lines
}

/// Lines about the columns of a table.
fn of_table(contents: &Contents, known: &Known, found: &Channels, start: &mut Start) -> Vec<String> {
    let mut lines = Vec::new();
    lines.extend(contents.layout.as_ref().map(|layout| layout.yaml()));
    lines.push(match &contents.time {
        Some(time) => {
            let unit = [("s", 1.0), ("ms", 1e-3), ("us", 1e-6), ("ns", 1e-9)];
            let unit = unit
                .into_iter()
                .find(|(_, factor)| *factor == contents.time_unit)
                .map_or("s", |(name, _)| name);
            format!("time: {{column: {}, unit: {unit}, from_first_row: true}}", column(time))
        }
        None => {
            start.open.push("`time` is to be said, as {rate: 1000} or a column".into());
            "time: {rate: 0}  # Hz, or {column: ..., unit: s}".into()
        }
    });
    for (key, names) in [("position", &found.position), ("torque", &found.torque)] {
        let wanted = known.kinds.len();
        if names.is_empty() {
            start.open.push(format!("`{key}` is to be said: no columns are called so"));
        } else if wanted > 0 && names.len() != wanted {
            start
                .open
                .push(format!("`{key}` has {} columns, but the robot has {wanted} joints", names.len()));
        }
    }
    let far = |name: &String| {
        contents.signals.iter().any(|s| s.name == *name && s.low.abs().max(s.high.abs()) > 7.0)
    };
    let positions = in_order(&found.position, known, found);
    let doubt = if positions.iter().any(far) { "  # in rad? else `unit: deg`" } else { "" };
    lines.push(format!("position: {{{}}}{doubt}", columns(&positions)));
    lines
}

/// Columns in the order of the robot's joints, where their names tell them.
fn in_order(names: &[String], known: &Known, found: &Channels) -> Vec<String> {
    let letters =
        |text: &str| text.chars().filter(|c| c.is_alphanumeric()).collect::<String>().to_lowercase();
    let place = |joint: &String| {
        let joint = letters(joint);
        found.keys.iter().position(|key| letters(key).contains(&joint) || joint == letters(key))
    };
    let places: Option<Vec<usize>> = known.joints.iter().map(place).collect();
    match places {
        Some(places) if !places.is_empty() => {
            places.into_iter().filter_map(|k| names.get(k).cloned()).collect()
        }
        _ => names.to_vec(),
    }
}

/// What is known of the torques: their unit, and the gains of units that need them.
#[derive(Debug, Clone, Copy, Default)]
pub struct Torques<'a> {
    /// Their unit.
    pub unit: Option<&'a str>,
    /// N.m, N, per unit of each joint; empty where it is not known.
    pub gain: &'a [f64],
}

fn torque(columns: &str, known: &Known, given: Torques<'_>, start: &mut Start) -> String {
    let separator = if columns.is_empty() { "" } else { ", " };
    let Some(unit) = given.unit else {
        start.open.push("`torque` has no unit: N.m, or A with a `gain` (--unit)".into());
        return format!("torque: {{{columns}}}  # unit: N.m, or unit: A and gain: [N.m per A of each joint]");
    };
    let raw = matches!(unit, "A" | "mA" | "V" | "%" | "count" | "1");
    if raw && !given.gain.is_empty() {
        let gain: Vec<String> = given.gain.iter().map(ToString::to_string).collect();
        return format!("torque: {{{columns}{separator}unit: {unit}, gain: [{}]}}", gain.join(", "));
    }
    if raw {
        start.open.push(format!("`torque` needs a `gain`: N.m per {unit} of each joint (--gain)"));
        return format!(
            "torque: {{{columns}{separator}unit: {unit}}}  # to be filled in: , gain: [N.m per {unit} of each joint]}}"
        );
    }
    let of = |kind: &JointKind| if *kind == JointKind::Prismatic { "N" } else { unit };
    let unit = match known.kinds.contains(&JointKind::Prismatic) {
        true => format!("[{}]", known.kinds.iter().map(of).collect::<Vec<_>>().join(", ")),
        false => unit.to_owned(),
    };
    format!("torque: {{{columns}{separator}unit: {unit}}}")
}
