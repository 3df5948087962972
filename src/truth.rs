//! Reading what was hidden in a recording: `truth.yaml`.

use std::path::Path;

use dynid_runtime::diagnosis::scoring::Hidden;
use dynid_runtime::effects::EffectKind;
use dynid_runtime::model::{JointNumber, Robot};
use dynid_runtime::regular_file;
use serde::Deserialize;

use crate::failure::{Failure, file_failure};

/// What of `truth.yaml` counts; its other numbers are for a person.
#[derive(Debug, Deserialize)]
struct TruthFile {
    #[serde(default)]
    effects: Vec<TrueEffect>,
}

#[derive(Debug, Deserialize)]
struct TrueEffect {
    effect: String,
    joint: Option<usize>,
    #[serde(default)]
    joints: Vec<usize>,
}

/// Longest truth that is read, bytes.
const LONGEST: u64 = 1 << 20;

/// Reads what was hidden.
///
/// # Errors
/// [`Failure::Input`] with the file, and the line where there is one.
pub fn read_truth(path: &Path, robot: &Robot) -> Result<Vec<Hidden>, Failure> {
    let text = regular_file::read_text(path, LONGEST)
        .map_err(|error| file_failure("read the truth", path, &error))?;
    let wrong = |what: String| Failure::Input(format!("{}: {what}", path.display()));
    let truth: TruthFile = serde_yaml::from_str(&text).map_err(|error| wrong(error.to_string()))?;
    truth
        .effects
        .into_iter()
        .map(|hidden| {
            let effect = EffectKind::from_id(&hidden.effect).ok_or_else(|| {
                wrong(format!("effect {}: the catalogue has no such effect", hidden.effect))
            })?;
            let joints: Vec<usize> = hidden.joint.into_iter().chain(hidden.joints).collect();
            match joints.iter().find(|&&j| robot.joint_index(JointNumber(j)).is_none()) {
                Some(none) => Err(wrong(format!("{}: {} has no joint {none}", hidden.effect, robot.name))),
                None => Ok(Hidden { effect, joints }),
            }
        })
        .collect()
}
