//! Recordings that commands write: a file a motion, and the manifest that reads them back.

use std::path::{Path, PathBuf};

use dynid_runtime::model::Robot;
use dynid_runtime::recording::{DataFormat, Trajectory, manifest_text_as};

use crate::failure::Failure;
use crate::output::Together;

/// How a recording names its robot.
#[derive(Debug, Clone, Copy)]
pub enum RobotReference<'a> {
    /// A generated model.
    Name(&'a str),
    /// The text of a robot YAML, which is written beside the recording.
    Yaml(&'a [u8]),
}

/// In which format motions are written, and the names of their joints in a log.
pub type Form<'a> = (DataFormat, &'a [String]);

/// Writes the motions of a robot to a folder with the manifest `manifest` (`recording.yaml`), which comes last; returns
/// its path. `stem` begins the names of the data, which are theirs alone in the folder.
///
/// # Errors
/// [`Failure::Input`] naming what could not be written. What the manifest was before is still there then.
pub fn write_recording(
    (folder, manifest, stem): (&Path, &str, &str),
    robot: &Robot,
    reference: RobotReference<'_>,
    (title, form): (&str, Form<'_>),
    motions: &[Trajectory],
) -> Result<PathBuf, Failure> {
    let mut files = Together::in_folder(folder)?;
    let mut named = Vec::new();
    for (k, motion) in motions.iter().enumerate() {
        let name = files.add(&format!("{stem}{}", k + 1), form.0.extension(), &mut |out| {
            form.0.write(motion, form.1, out)
        })?;
        named.push((name, motion));
    }
    let reference = match reference {
        RobotReference::Name(name) => name.to_owned(),
        RobotReference::Yaml(text) => {
            let name = files.add(&format!("{stem}-robot"), "yaml", &mut |out| out.write_all(text))?;
            format!("./{name}")
        }
    };
    let motions: Vec<(&str, &Trajectory)> = named.iter().map(|(name, t)| (name.as_str(), *t)).collect();
    files.commit(
        manifest,
        &manifest_text_as(form, robot, &reference, title, &motions),
        &[stem, &format!("{stem}-robot")],
    )
}
