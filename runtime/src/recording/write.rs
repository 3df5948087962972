//! A recording as text: the rows of each motion, and the manifest that reads them back. Who calls this decides where
//! the text goes.

use std::fmt::Write as _;
use std::io::{self, Write};

use super::{Trajectory, formats};
use crate::model::{JointIndex, JointKind, Robot};

/// Writes the rows of a motion as CSV with the columns that [`manifest_text`] names. Numbers are written so that they
/// are read back exactly.
///
/// # Errors
/// What `out` says.
pub fn write_rows(trajectory: &Trajectory, out: &mut dyn Write) -> io::Result<()> {
    let n = trajectory.position.len();
    let names = |letter: &str| (1..=n).map(|j| format!(",{letter}{j}")).collect::<String>();
    let velocity = trajectory.velocity.as_ref();
    let velocity_names = velocity.map_or(String::new(), |_| names("dq"));
    writeln!(out, "t{}{velocity_names}{}", names("q"), names("tau"))?;
    let mut line = String::new();
    for (k, t) in trajectory.time.iter().enumerate() {
        line.clear();
        let channels =
            trajectory.position.iter().chain(velocity.into_iter().flatten()).chain(&trajectory.torque);
        // Writing to a String cannot fail.
        let _ = write!(line, "{t}");
        for channel in channels {
            let _ = write!(line, ",{}", channel[k]);
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
            Self::Parquet => formats::write_parquet(motion, out),
            Self::Mcap => formats::write_mcap(motion, joints, out),
        }
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
