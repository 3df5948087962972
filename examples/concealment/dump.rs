//! Cases as folders, in the form of a challenge: what the diagnosis reads, a motion for a test, and the truth.

use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use dynid_runtime::model::Robot;
use dynid_runtime::recording::{self, Trajectory};

use crate::case::Case;
use crate::failure::Failure;
use crate::hide::Recordings;
use crate::secret::is_change;

/// Writes a case to `folder/name`: `recording.yaml`, `test.yaml`, `baseline.yaml` where there is one, `truth.yaml`.
pub fn write(folder: &Path, robot: &Robot, case: &Case, recordings: &Recordings) -> Result<(), Failure> {
    let folder = folder.join(case.name());
    let title = "closed-loop motion, 500 Hz";
    recording::write(&folder, robot, &case.robot, title, &recordings.motions)?;
    beside(&folder, "test", robot, case, &recordings.test)?;
    if !recordings.baseline.is_empty() {
        beside(&folder, "baseline", robot, case, &recordings.baseline)?;
    }
    fs::write(folder.join("truth.yaml"), truth(case, recordings))?;
    Ok(())
}

/// Another recording in the same folder, with its own names.
fn beside(
    folder: &Path,
    name: &str,
    robot: &Robot,
    case: &Case,
    motions: &[Trajectory],
) -> Result<(), Failure> {
    let own = folder.join(name);
    let manifest = recording::write(&own, robot, &case.robot, "closed-loop motion, 500 Hz", motions)?;
    let text = fs::read_to_string(&manifest)?;
    for k in 1..=motions.len() {
        fs::rename(own.join(format!("traj{k}.csv")), folder.join(format!("{name}{k}.csv")))?;
    }
    fs::write(folder.join(format!("{name}.yaml")), text.replace("file: traj", &format!("file: {name}")))?;
    fs::remove_dir_all(own)?;
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
            let _ = writeln!(text, "  joint: {}", joint + 1);
        }
    }
    text
}
