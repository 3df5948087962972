//! A file that is the old one or the new one at every instant, never a part of it.
//!
//! The text goes to a temporary file in the same folder, is synced to the disk and renamed over its target. A full
//! disk, a kill and a reader at the same time meet a whole file. This is the only place that creates files.

use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use tempfile::NamedTempFile;

/// What fills a file.
pub type Fill<'a> = &'a mut dyn FnMut(&mut dyn Write) -> io::Result<()>;

/// A file that is complete, on the disk, and has another name than it will have.
pub(super) struct Complete(NamedTempFile);

impl Complete {
    /// Fills a temporary file in `folder` with what a new file there would be permitted; on failure it is removed.
    pub fn new(folder: &Path, fill: Fill<'_>) -> io::Result<Self> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".dynid-").suffix(".part");
        #[cfg(unix)]
        builder.permissions(<fs::Permissions as std::os::unix::fs::PermissionsExt>::from_mode(0o666));
        let file =
            builder.tempfile_in(if folder.as_os_str().is_empty() { Path::new(".") } else { folder })?;
        let mut buffered = BufWriter::with_capacity(1 << 16, file);
        fill(&mut buffered)?;
        let file = buffered.into_inner().map_err(io::IntoInnerError::into_error)?;
        file.as_file().sync_all()?;
        Ok(Self(file))
    }

    /// Gives it its name; what had the name before is gone.
    pub fn replace(self, path: &Path) -> io::Result<()> {
        if let Some(old) = permissions(path)? {
            self.0.as_file().set_permissions(old)?;
        }
        self.0.persist(path).map_err(|error| error.error)?;
        Ok(())
    }
}

/// Replaces the file at `path`, or makes it. A link stays and its target is replaced; a device or a pipe is written to.
pub(super) fn replace(path: &Path, fill: Fill<'_>) -> io::Result<()> {
    let Some(path) = target(path)? else { return into_device(path, fill) };
    let folder = folder(&path);
    Complete::new(folder, fill)?.replace(&path)?;
    sync_folder(folder);
    Ok(())
}

/// Whether [`replace`] finds a place for its file. Nothing is left there.
pub(super) fn can_replace(path: &Path) -> io::Result<()> {
    let Some(path) = target(path)? else { return Ok(()) };
    permissions(&path)?;
    Complete::new(folder(&path), &mut |_| Ok(())).map(drop)
}

/// The file that a path is, or will be; `None` for a device or a pipe.
fn target(path: &Path) -> io::Result<Option<PathBuf>> {
    Ok(match fs::metadata(path) {
        Ok(found) if found.is_dir() => return Err(io::ErrorKind::IsADirectory.into()),
        Ok(found) if !found.is_file() => None,
        Ok(_) => Some(fs::canonicalize(path)?),
        Err(_) => Some(path.to_path_buf()),
    })
}

fn folder(path: &Path) -> &Path {
    path.parent().unwrap_or(Path::new("."))
}

/// What the file that is there permits, which a person has not protected; `None` where there is none.
fn permissions(path: &Path) -> io::Result<Option<fs::Permissions>> {
    match fs::metadata(path).map(|old| old.permissions()) {
        Ok(old) if old.readonly() => Err(io::ErrorKind::PermissionDenied.into()),
        Ok(old) => Ok(Some(old)),
        Err(_) => Ok(None),
    }
}

/// A device or a pipe has no other state to keep.
fn into_device(path: &Path, fill: Fill<'_>) -> io::Result<()> {
    let mut device = BufWriter::new(File::options().write(true).open(path)?);
    fill(&mut device)?;
    device.flush()
}

/// Brings new names in a folder to the disk, where the system can; without it a file is whole all the same.
pub(super) fn sync_folder(folder: &Path) {
    let folder: PathBuf = if folder.as_os_str().is_empty() { ".".into() } else { folder.into() };
    let _ = File::open(folder).and_then(|folder| folder.sync_all());
}
