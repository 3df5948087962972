//! Brings a recording to this machine: nothing where it is there already, else its files, one after the other, into a folder
//! that is removed again.

use std::path::{Component, Path, PathBuf};

use dynid::robots::{Dynamics, resolve};
use dynid_runtime::recording::Manifest;
use tempfile::TempDir;

use crate::error::{FleetError, Result};
use crate::place::Folder;
use crate::stamp::Stamps;

/// A recording whose files are on this machine.
pub struct Fetched {
    /// Its manifest.
    pub manifest: Manifest,
    /// Its robot.
    pub dynamics: Dynamics,
    /// Where it is, for messages.
    pub path: PathBuf,
    /// Files that go with it.
    _copies: Option<TempDir>,
}

/// Brings the recording at an address or a path here, and finds its robot: `table`, or the one that it names. The files that
/// are read for it are added to `stamps`, also where one of them cannot be read.
///
/// # Errors
/// What cannot be read, with its place.
pub fn fetch(recording: &str, table: Option<&str>, stamps: &mut Stamps) -> Result<Fetched> {
    if let Some(table) = table.filter(|table| is_path(table)) {
        stamps.add_local(Path::new(table));
    }
    if !recording.contains("://") || recording.starts_with("file://") {
        let path = PathBuf::from(recording.strip_prefix("file://").unwrap_or(recording));
        stamps.add_local(&path);
        let fetched = opened(&path, table, None)?;
        let robot = Some(&fetched.manifest.robot).filter(|robot| table.is_none() && is_path(robot));
        robot.into_iter().for_each(|robot| stamps.add_local(&fetched.manifest.folder.join(robot)));
        fetched.manifest.data_files().iter().for_each(|(_, file)| stamps.add_local(file));
        return Ok(fetched);
    }
    // A function of a query has no runtime of its own, and may not wait on that of the query.
    std::thread::scope(|scope| {
        let fetched = scope.spawn(|| {
            let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build();
            let runtime = runtime.map_err(|error| FleetError::Engine(error.to_string()))?;
            runtime.block_on(fetch_remote(recording, table, stamps))
        });
        fetched.join().unwrap_or_else(|_| Err(FleetError::Engine(format!("{recording}: reading it failed"))))
    })
}

async fn fetch_remote(recording: &str, table: Option<&str>, stamps: &mut Stamps) -> Result<Fetched> {
    let (folder, name) = recording.rsplit_once('/').unwrap_or((recording, ""));
    let remote = Folder::of(folder)?;
    let copies = tempfile::Builder::new().prefix("dynid-fleet-").tempdir();
    let copies = copies.map_err(|error| FleetError::io(&std::env::temp_dir(), "make a folder", &error))?;
    let manifest_path = copies.path().join(name);
    download(&remote, name, &manifest_path, stamps).await?;
    let manifest = Manifest::read(&manifest_path).map_err(|error| told(recording, &manifest_path, &error))?;
    let files = manifest.data_files().into_iter().map(|(name, _)| name);
    let own = Some(&manifest.robot).filter(|robot| table.is_none() && is_path(robot)).cloned();
    for name in files.chain(own) {
        let to = inside(copies.path(), &name).ok_or_else(|| FleetError::Store {
            url: recording.to_owned(),
            message: format!("it names {name}, which is outside of its folder: put it beside the recording"),
        })?;
        if let Some(parent) = to.parent() {
            std::fs::create_dir_all(parent).map_err(|e| FleetError::io(parent, "make the folder", &e))?;
        }
        download(&remote, name.trim_start_matches("./"), &to, stamps).await?;
    }
    opened(&manifest_path, table, Some(copies))
}

async fn download(remote: &Folder, name: &str, to: &Path, stamps: &mut Stamps) -> Result<()> {
    let answer = remote.download(name, to).await;
    stamps.add_remote(&remote.at(name), answer.as_ref().ok().and_then(Option::as_ref));
    answer.map(|_| ())
}

fn opened(path: &Path, table: Option<&str>, copies: Option<TempDir>) -> Result<Fetched> {
    let manifest = Manifest::read(path).map_err(|error| FleetError::Engine(error.to_string()))?;
    let dynamics = match table {
        Some(table) => resolve(table, None)?,
        None => resolve(&manifest.robot, Some(&manifest.folder))?,
    };
    Ok(Fetched { manifest, dynamics, path: path.to_path_buf(), _copies: copies })
}

/// An error of a copy, as one of what it is a copy of.
fn told(recording: &str, copy: &Path, error: &dyn std::error::Error) -> FleetError {
    FleetError::Engine(error.to_string().replace(&copy.display().to_string(), recording))
}

fn is_path(robot: &str) -> bool {
    [".yaml", ".yml", ".urdf"].iter().any(|end| robot.ends_with(end)) || robot.contains('/')
}

/// A path within a folder; `None` where it leads out of it.
fn inside(folder: &Path, name: &str) -> Option<PathBuf> {
    let name = Path::new(name);
    let stays = name.components().all(|part| matches!(part, Component::Normal(_) | Component::CurDir));
    stays.then(|| folder.join(name))
}
