//! The recording that a saved model is from: written down with the model, and found again where it has not changed.
//!
//! A covariance says how well parameters are known, but not how much each law differs from one motion to the next while nothing
//! changes; the motions do.

use std::path::{Component, Path, PathBuf};

use dynid_runtime::estimation::PIECE;
use dynid_runtime::model_file::{Identified, RecordedFrom};
use dynid_runtime::recording::Trajectory;

use crate::arguments::Source;
use crate::failure::{Failure, file_failure};
use crate::provenance::Provenance;
use crate::recorded::{Measured, measure, of_the_same_robot};

/// What a model that is saved as `model` says of the recording that it is from.
///
/// # Errors
/// [`Failure::Input`] where a file of the recording can no longer be read.
pub fn recorded_from(source: &Source, model: &Path) -> Result<RecordedFrom, Failure> {
    Ok(RecordedFrom {
        path: seen_from(folder_of(model), &source.recording)?,
        sha256: digest(&source.recording, source.robot.as_deref())?,
        from: source.from,
        to: source.to,
    })
}

/// What became of the recording that a model is from; nothing where the model does not say which it is.
#[derive(Default)]
pub struct Origin {
    /// Its motions, where it is where it was, and as it was.
    pub motions: Vec<Trajectory>,
    /// The sentence that says why it cannot be taken for what it was.
    pub lost: Option<String>,
}

/// Looks for the recording that a model, read from `model`, is from; it must be of the robot that is diagnosed.
pub fn find(saved: &Identified, model: &Path, (source, measured): (&Source, &Measured)) -> Origin {
    let Some(from) = &saved.recording else { return Origin::default() };
    let path = folder_of(model).join(&from.path);
    let lost = |why: &str| {
        let only = "Of the model's motions only what its file holds was used";
        let lost = format!("{only}: the recording that it is from, {}, {why}.", path.display());
        Origin { lost: Some(lost), ..Origin::default() }
    };
    if !path.is_file() {
        return lost("is not there");
    }
    let robot = source.robot.as_deref();
    let same = |other: &Path| digest(other, robot).is_ok_and(|sha256| sha256 == from.sha256);
    if !same(&path) {
        return lost("has changed since");
    }
    if (source.from, source.to) == (from.from, from.to) && same(&source.recording) {
        return lost("is the one that is diagnosed");
    }
    if saved.samples > PIECE {
        return lost("is too long to be taken motion by motion");
    }
    let before = Source { from: from.from, to: from.to, ..source.other(&path) };
    match measure(&before).and_then(|motions| of_the_same_robot(motions, measured, &path)) {
        Ok(before) => Origin { motions: before.trajectories, lost: None },
        Err(why) => lost(&format!("cannot be read: {why}")),
    }
}

/// SHA-256 of the digests of all files of a recording, in the order in which its manifest names them.
fn digest(recording: &Path, robot: Option<&str>) -> Result<String, Failure> {
    let mut files = Provenance::default();
    files.recording(recording, robot)?;
    Ok(files.sha256())
}

/// The folder of a file.
fn folder_of(file: &Path) -> &Path {
    file.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// The path of a file as it is seen from a folder, with `/`: both may be moved together.
fn seen_from(folder: &Path, file: &Path) -> Result<String, Failure> {
    let absolute =
        |path: &Path| std::fs::canonicalize(path).map_err(|error| file_failure("find it", path, &error));
    let (folder, file) = (absolute(folder)?, absolute(file)?);
    let is_prefix = |c: &Component<'_>| matches!(c, Component::Prefix(_));
    let (from, to): (Vec<_>, Vec<_>) = (folder.components().collect(), file.components().collect());
    let common = from.iter().zip(&to).take_while(|(a, b)| a == b).count();
    // Of another drive there is no way but the whole one.
    let whole = from.iter().chain(&to).skip(common).any(is_prefix);
    let path: PathBuf = if whole {
        file
    } else {
        from[common..].iter().map(|_| Component::ParentDir).chain(to[common..].iter().copied()).collect()
    };
    let names: Vec<_> = path.iter().map(|name| name.to_string_lossy()).collect();
    Ok(if whole { path.display().to_string() } else { names.join("/") })
}
