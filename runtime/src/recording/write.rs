//! A recording as text: the rows of each motion, and the manifest that reads them back. Who calls this decides where
//! the text goes.

use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

use super::{Trajectory, formats};
use crate::model::{JointIndex, JointKind, Robot};

/// Named columns of equal length.
pub type Columns<'a> = Vec<(String, &'a [f64])>;

/// Writes the rows of a motion as CSV with the columns that [`manifest_text`] names. Numbers are written so that they
/// are read back exactly.
///
/// # Errors
/// What `out` says.
pub fn write_rows(trajectory: &Trajectory, out: &mut dyn Write) -> io::Result<()> {
    write_columns(&columns_of(trajectory), out)
}

/// The columns of a motion: t, q, dq where speeds were recorded, tau.
pub(super) fn columns_of(motion: &Trajectory) -> Columns<'_> {
    let velocity = motion.velocity.as_deref().unwrap_or_default();
    let mut columns: Columns<'_> = vec![("t".into(), &motion.time)];
    for (letter, channel) in [("q", &motion.position[..]), ("dq", velocity), ("tau", &motion.torque[..])] {
        columns.extend((1..).zip(channel).map(|(j, values)| (format!("{letter}{j}"), &values[..])));
    }
    columns
}

/// Writes columns as CSV.
fn write_columns(columns: &Columns<'_>, out: &mut dyn Write) -> io::Result<()> {
    let names: Vec<&str> = columns.iter().map(|(name, _)| name.as_str()).collect();
    writeln!(out, "{}", names.join(","))?;
    let mut line = String::new();
    for k in 0..columns.first().map_or(0, |(_, values)| values.len()) {
        line.clear();
        for (place, (_, values)) in columns.iter().enumerate() {
            if place > 0 {
                line.push(',');
            }
            // Writing to a String cannot fail.
            let _ = write!(line, "{}", values[k]);
        }
        writeln!(out, "{line}")?;
    }
    Ok(())
}

/// A format in which motions are written.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum DataFormat {
    /// Text, read back exactly.
    #[default]
    Csv,
    /// Doubles; the columns of the text.
    Parquet,
    /// `sensor_msgs/msg/JointState` on `/joint_states`; stamps are rounded to nanoseconds.
    Mcap,
}

impl DataFormat {
    /// How its files end.
    pub fn extension(self) -> &'static str {
        match self {
            Self::Csv => "csv",
            Self::Parquet => "parquet",
            Self::Mcap => "mcap",
        }
    }

    /// Writes the rows of a motion; `joints` are the names of its joints in a log.
    ///
    /// # Errors
    /// What `out` says; a format that this build does not have.
    pub fn write(self, motion: &Trajectory, joints: &[String], out: &mut dyn Write) -> io::Result<()> {
        match self {
            Self::Csv => write_rows(motion, out),
            Self::Parquet => formats::write_parquet(&columns_of(motion), out),
            Self::Mcap => {
                let none = Vec::new();
                let velocity = motion.velocity.as_ref().unwrap_or(&none);
                let states = vec![&motion.position[..], velocity, &motion.torque];
                let fields = JointFields::States(states);
                formats::write_mcap(&[JointLog::new("/joint_states", &motion.time, fields)], joints, out)
            }
        }
    }

    /// The format that the end of a file's name stands for.
    pub fn of_file(path: &Path) -> Option<Self> {
        [Self::Csv, Self::Parquet, Self::Mcap].into_iter().find(|f| formats::extension(path) == f.extension())
    }

    /// Writes columns as a table, or the same as messages in MCAP; `joints` are the names of the joints in a log.
    ///
    /// # Errors
    /// What `out` says; a format that this build does not have.
    pub fn write_table(
        self,
        columns: &Columns<'_>,
        logs: &[JointLog<'_>],
        joints: &[String],
        out: &mut dyn Write,
    ) -> io::Result<()> {
        match self {
            Self::Csv => write_columns(columns, out),
            Self::Parquet => formats::write_parquet(columns, out),
            Self::Mcap => formats::write_mcap(logs, joints, out),
        }
    }
}

/// Signals of all joints, `[j][t]`, as the messages of a log carry them.
#[derive(Debug, Clone)]
pub enum JointFields<'a> {
    /// Position, velocity and effort of a `sensor_msgs/msg/JointState`; what is empty is not told.
    States(Vec<&'a [Vec<f64>]>),
    /// Accelerations, for which there is no message: `dynid_msgs/msg/JointAcceleration`, which the file describes.
    Accelerations(&'a [Vec<f64>]),
}

/// One topic of a log.
#[derive(Debug, Clone)]
pub struct JointLog<'a> {
    /// Its name.
    pub topic: String,
    /// Times of the messages, s, from 0 on.
    pub time: &'a [f64],
    /// What they carry.
    pub fields: JointFields<'a>,
}

impl<'a> JointLog<'a> {
    /// A topic with a message at each time.
    pub fn new(topic: impl Into<String>, time: &'a [f64], fields: JointFields<'a>) -> Self {
        Self { topic: topic.into(), time, fields }
    }
}

/// [`manifest_text`] of motions that [`DataFormat::write`] wrote.
pub fn manifest_text_as(
    (format, joints): (DataFormat, &[String]),
    robot: &Robot,
    robot_reference: &str,
    title: &str,
    motions: &[(&str, &Trajectory)],
) -> String {
    let text = manifest_text(robot, robot_reference, title, motions);
    let keep = |line: &&str| !line.starts_with("layout:");
    match format {
        DataFormat::Csv => text,
        DataFormat::Parquet => text.lines().filter(keep).map(|line| format!("{line}\n")).collect(),
        DataFormat::Mcap => {
            let quoted: Vec<String> =
                joints.iter().map(|j| serde_json::Value::from(j.as_str()).to_string()).collect();
            let line = |line: &str| match line.split_once(':') {
                Some(("layout" | "position", _)) => String::new(),
                Some(("time", _)) => format!("joints: [{}]\n", quoted.join(", ")),
                // What stands before the unit are columns.
                Some((key @ ("velocity" | "torque"), rest)) => {
                    let unit = rest.find("unit:").map_or("", |at| &rest[at..]);
                    format!("{key}: {{{unit}\n")
                }
                _ => format!("{line}\n"),
            };
            text.lines().map(line).collect()
        }
    }
}

/// The manifest of motions that [`write_rows`] wrote, each given with the name of its file beside the manifest.
///
/// `robot_reference` is how the manifest names the robot: a name from `robots/` or a path.
pub fn manifest_text(
    robot: &Robot,
    robot_reference: &str,
    title: &str,
    motions: &[(&str, &Trajectory)],
) -> String {
    let kinds = robot.joint_kinds();
    let n = kinds.len();
    let columns = |letter: &str| (1..=n).map(|j| format!("{letter}{j}")).collect::<Vec<_>>().join(", ");
    let units = |of: fn(JointKind) -> &'static str| {
        format!("[{}]", kinds.iter().map(|kind| of(*kind)).collect::<Vec<_>>().join(", "))
    };
    // A JSON string is a YAML string.
    let quoted = |text: &str| serde_json::Value::from(text).to_string();
    let mut text = String::new();
    let _ = writeln!(text, "robot: {}", quoted(robot_reference));
    let _ = writeln!(text, "title: {}", quoted(title));
    let _ = writeln!(text, "side: joint");
    let _ = writeln!(text, "layout: {{header: true, delimiter: \",\"}}");
    let _ = writeln!(text, "time: {{column: t, unit: s}}");
    let _ = writeln!(
        text,
        "position: {{columns: [{}], unit: {}}}",
        columns("q"),
        units(JointKind::position_unit)
    );
    if motions.iter().any(|(_, t)| t.velocity.is_some()) {
        let _ = writeln!(
            text,
            "velocity: {{columns: [{}], unit: {}}}",
            columns("dq"),
            units(JointKind::speed_unit)
        );
    }
    let _ =
        writeln!(text, "torque: {{columns: [{}], unit: {}}}", columns("tau"), units(JointKind::torque_unit));
    let _ = writeln!(text, "trajectories:");
    for (file, trajectory) in motions {
        let fixed: Vec<String> = trajectory
            .fixed
            .iter()
            .filter(|&&j| j < n)
            .map(|&j| robot.joint_number(JointIndex(j)).to_string())
            .collect();
        let fixed = if fixed.is_empty() { String::new() } else { format!(", fixed: [{}]", fixed.join(", ")) };
        let _ = writeln!(text, "  - {{file: {}{fixed}}}", quoted(file));
    }
    text
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;
    use crate::model::{Drive, Frame, Limits};
    use crate::recording::{Manifest, load};

    #[test]
    fn what_is_written_is_read_back_exactly() {
        let frames =
            [JointKind::Fixed, JointKind::Revolute, JointKind::Prismatic].map(Frame::on_base).to_vec();
        let drive = Drive { gear: vec![50.0, 0.0, 0.0, 400.0].into(), coupled_friction: vec![].into() };
        let robot = Robot::with_standard_as_base("test_arm", [0.0; 3], frames, drive, Limits::default());
        let trajectory = |seed: f64, fixed: Vec<usize>| {
            let signal =
                |a: f64| (0..400).map(|k| (a * seed * k as f64 * 1e-3).sin() / 3.0).collect::<Vec<f64>>();
            Trajectory {
                name: String::new(),
                time: (0..400).map(|k| k as f64 * 2e-4).collect(),
                position: vec![signal(1.0), signal(2.0)],
                velocity: None,
                torque: vec![signal(3.0), signal(5.0)],
                fixed,
            }
        };
        let written = [trajectory(1.0, vec![]), trajectory(0.7, vec![1])];
        let folder = std::env::temp_dir().join(format!("dynid-write-{}", std::process::id()));
        fs::create_dir_all(&folder).expect("a folder");
        let named: Vec<(String, &Trajectory)> =
            written.iter().enumerate().map(|(k, t)| (format!("motion, {k}.csv"), t)).collect();
        for (name, motion) in &named {
            let mut file = fs::File::create(folder.join(name)).expect("a file");
            write_rows(motion, &mut file).expect("it is written");
        }
        let motions: Vec<(&str, &Trajectory)> = named.iter().map(|(name, t)| (name.as_str(), *t)).collect();
        let path = folder.join("recording.yaml");
        let text = manifest_text(&robot, "test_arm", "colons: and \"quotes\"", &motions);
        fs::write(&path, text).expect("a manifest");
        let manifest = Manifest::read(&path).expect("the manifest keeps to the contract");
        let read = load(&manifest, &robot).expect("it loads");
        let _ = fs::remove_dir_all(&folder);
        assert_eq!(manifest.title, "colons: and \"quotes\"");
        assert_eq!(read.rows.left_out, 0);
        for (read, written) in read.trajectories.iter().zip(&written) {
            assert_eq!(
                (&read.time, &read.position, &read.torque, &read.fixed),
                (&written.time, &written.position, &written.torque, &written.fixed)
            );
        }
    }
}
