//! Cases as folders, in the form of a challenge: what the diagnosis reads, a motion for a test, and the truth.

use std::fmt::Write as _;
use std::path::Path;

use dynid::output;
use dynid::recording_files::{RobotReference, write_recording};
use dynid_runtime::model::Robot;
use dynid_runtime::recording::{DataFormat, Trajectory};

use crate::case::Case;
use crate::failure::Failure;
use crate::hide::Recordings;
use crate::secret::is_change;

/// Writes a case to `folder/name`: `recording.yaml`, `test.yaml`, `baseline.yaml` where there is one, `truth.yaml`.
pub fn write(folder: &Path, robot: &Robot, case: &Case, recordings: &Recordings) -> Result<(), Failure> {
    let folder = folder.join(case.name());
    let title = "closed-loop motion, 500 Hz";
    let write = |manifest: &str, stem: &str, motions: &[Trajectory]| {
        let reference = RobotReference::Name(&case.robot);
        write_recording((&folder, manifest, stem), robot, reference, (title, (DataFormat::Csv, &[])), motions)
    };
    write("recording.yaml", "traj", &recordings.motions)?;
    write("test.yaml", "test", &recordings.test)?;
    if !recordings.baseline.is_empty() {
        write("baseline.yaml", "baseline", &recordings.baseline)?;
    }
    output::write(&folder.join("truth.yaml"), &truth(case, recordings))?;
    Ok(())
}

fn truth(case: &Case, recordings: &Recordings) -> String {
    let change = case.effects.iter().any(|&e| is_change(e));
    let mut text = format!("case: {}\nrobot: {}\nbaseline: {change}\n", case.name(), case.robot);
    if recordings.hidden.is_empty() {
        text.push_str("effects: []\n");
        return text;
    }
    text.push_str("effects:\n");
    for hidden in &recordings.hidden {
        // Writing to a String cannot fail.
        let _ = writeln!(text, "- effect: {}", hidden.effect.id());
        for (name, value) in &hidden.numbers {
            let _ = writeln!(text, "  {name}: {value}");
        }
        let _ = writeln!(text, "  visible: {:.2}", hidden.visible);
        if let Some(joint) = hidden.joint {
            let _ = writeln!(text, "  joint: {joint}");
        }
    }
    text
}
