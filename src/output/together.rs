//! Files that mean something together: data, and a manifest that names them.

use std::collections::HashSet;
use std::fs::{self, File};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use super::file::{Complete, Fill, replace, sync_folder};
use super::make_folder;
use crate::failure::{Failure, file_failure};

/// Files of one run, whose manifest decides what belongs to it.
///
/// A file is named after its content (`traj1-0f3a9c21.csv`), so it is never the file of another run, and the
/// same content has the same name. The manifest comes last and is replaced as a whole: until then the folder holds the
/// run from before, from then on this one, whoever else writes to it or is killed. Data that neither this manifest nor
/// the one before names are removed then; those of the one before stay for who reads them just now.
pub struct Together {
    folder: PathBuf,
    complete: Vec<(String, Complete)>,
}

impl Together {
    /// Files in a folder, which is made where it is not there.
    ///
    /// # Errors
    /// [`Failure::Input`] naming the folder.
    pub fn in_folder(folder: &Path) -> Result<Self, Failure> {
        make_folder(folder)?;
        Ok(Self { folder: folder.to_path_buf(), complete: Vec::new() })
    }

    /// Adds a file `stem-<content>.extension`; returns its name. It is there when [`Together::commit`] has returned.
    ///
    /// # Errors
    /// [`Failure::Input`] naming what could not be written.
    pub fn add(&mut self, stem: &str, extension: &str, fill: Fill<'_>) -> Result<String, Failure> {
        let mut fingerprint = Fingerprint::default();
        let complete = Complete::new(&self.folder, &mut |out: &mut dyn Write| {
            fill(&mut Watched { out, fingerprint: &mut fingerprint })
        })
        .map_err(|error| self.failure(&format!("{stem}.{extension}"), &error))?;
        let name = format!("{stem}-{}.{extension}", fingerprint.digits());
        self.complete.push((name.clone(), complete));
        Ok(name)
    }

    /// Gives the files their names, and then replaces the manifest; returns its path. `own` are the beginnings of the
    /// names that a run's data have.
    ///
    /// # Errors
    /// [`Failure::Input`] naming what could not be written; the run from before is still there then.
    pub fn commit(self, manifest: &str, text: &str, own: &[&str]) -> Result<PathBuf, Failure> {
        let path = self.folder.join(manifest);
        // Held until the end of the function: another run's names come before or after. Where a folder cannot be locked,
        // nothing is removed, and names are apart by content anyway.
        let lock = File::open(&self.folder).and_then(|folder| folder.lock().map(|()| folder));
        let before = fs::read_to_string(&path).unwrap_or_default();
        let Self { folder, complete } = self;
        let mut names = HashSet::new();
        for (name, complete) in complete {
            let target = folder.join(&name);
            complete.replace(&target).map_err(|error| file_failure("write it", &target, &error))?;
            names.insert(name);
        }
        sync_folder(&folder);
        replace(&path, &mut |out: &mut dyn Write| out.write_all(text.as_bytes()))
            .map_err(|error| file_failure("write it", &path, &error))?;
        if lock.is_ok() {
            for name in left_over(&folder, own) {
                if !names.contains(&name) && !before.contains(&name) {
                    // What cannot be removed is in nobody's way.
                    let _ = fs::remove_file(folder.join(&name));
                }
            }
        }
        Ok(path)
    }

    fn failure(&self, name: &str, error: &io::Error) -> Failure {
        file_failure("write it", &self.folder.join(name), error)
    }
}

/// The files of a folder that are called like data of a run: a known beginning,
/// perhaps a number, `-` and a fingerprint.
fn left_over(folder: &Path, own: &[&str]) -> Vec<String> {
    let named = |name: &String| {
        let stem = name.rsplit_once('.').map_or(name.as_str(), |(stem, _)| stem);
        stem.rsplit_once('-').is_some_and(|(start, print)| {
            let one_of = |own: &str| {
                start.strip_prefix(own).is_some_and(|number| number.bytes().all(|b| b.is_ascii_digit()))
            };
            let is_print = print.len() == 8 && print.bytes().all(|b| b.is_ascii_hexdigit());
            is_print && own.iter().any(|own| one_of(own))
        })
    };
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter_map(|entry| entry.file_name().into_string().ok()).filter(named).collect()
}

/// FNV-1a of 64 bits (Fowler, Noll and Vo).
struct Fingerprint(u64);

impl Default for Fingerprint {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Fingerprint {
    /// Both halves in one: short enough for a name, and files of one name in one folder are few.
    fn digits(&self) -> String {
        format!("{:08x}", (self.0 >> 32) ^ (self.0 & 0xffff_ffff))
    }
}

/// Passes everything on and takes its fingerprint.
struct Watched<'a> {
    out: &'a mut dyn Write,
    fingerprint: &'a mut Fingerprint,
}

impl Write for Watched<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let taken = self.out.write(bytes)?;
        for byte in &bytes[..taken] {
            self.fingerprint.0 = (self.fingerprint.0 ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
        Ok(taken)
    }

    fn flush(&mut self) -> io::Result<()> {
        self.out.flush()
    }
}
