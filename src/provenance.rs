//! Where a result comes from: the program, its command line, the files that it read, and when these were recorded.

use std::fs::File;
use std::io::{self, Read};
use std::path::Path;

use dynid_runtime::recording::Manifest;
use sha2::{Digest, Sha256};

use crate::failure::{Failure, file_failure};
use crate::recorded::recording_failure;
use crate::robots::path_of;

/// A file that was read.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct InputFile {
    /// Its path, from that of the command line.
    pub name: String,
    /// Bytes.
    pub size: u64,
    /// SHA-256, hexadecimal.
    pub sha256: String,
}

/// Where a result comes from. Nothing of it is of the machine or of the hour.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Provenance {
    /// The words of the command line after `dynid`; empty where there was none.
    pub words: Vec<String>,
    /// What was read.
    pub files: Vec<InputFile>,
    /// When each recording began, by the header stamps of its log: its path and UTC.
    pub recorded: Vec<(String, String)>,
}

impl Provenance {
    /// Of a command; files are added.
    pub fn of(words: &[String]) -> Self {
        Self { words: words.to_vec(), ..Self::default() }
    }

    /// Adds a file.
    ///
    /// # Errors
    /// [`Failure::Input`] where it cannot be read.
    pub fn file(&mut self, path: &Path) -> Result<(), Failure> {
        let name = path.display().to_string();
        if self.files.iter().any(|known| known.name == name) {
            return Ok(());
        }
        let (size, sha256) = digest(path).map_err(|error| file_failure("read it", path, &error))?;
        self.files.push(InputFile { name, size, sha256 });
        Ok(())
    }

    /// Adds a recording: its manifest, the robot where that is a file, and its data. `robot` is the one that is taken
    /// instead of the manifest's.
    ///
    /// # Errors
    /// As of [`Provenance::file`].
    pub fn recording(&mut self, path: &Path, robot: Option<&str>) -> Result<(), Failure> {
        self.file(path)?;
        let manifest = Manifest::read(path).map_err(recording_failure)?;
        let robot = match robot {
            Some(name) => path_of(name, None),
            None => path_of(&manifest.robot, Some(&manifest.folder)),
        };
        if robot.is_file() {
            self.file(&robot)?;
        }
        for (_, data) in manifest.data_files() {
            self.file(&data)?;
        }
        let begun = manifest.begun().map(|seconds| (path.display().to_string(), utc(seconds)));
        self.recorded.extend(begun);
        Ok(())
    }

    /// SHA-256 of what was read: of the digests of the files, one after the other.
    pub fn sha256(&self) -> String {
        let mut hash = Sha256::new();
        self.files.iter().for_each(|file| hash.update(&file.sha256));
        hexadecimal(&hash.finalize())
    }

    /// The command line, with quotation marks where a shell needs them; `None` where there was none.
    pub fn command(&self) -> Option<String> {
        let plain = |c: char| c.is_alphanumeric() || "_-./:=,@%+".contains(c);
        let quoted = |word: &String| match !word.is_empty() && word.chars().all(plain) {
            true => word.clone(),
            false => format!("'{}'", word.replace('\'', "'\\''")),
        };
        let words: Vec<String> = self.words.iter().map(quoted).collect();
        (!words.is_empty()).then(|| format!("dynid {}", words.join(" ")))
    }
}

/// Size and SHA-256 of a file.
fn digest(path: &Path) -> io::Result<(u64, String)> {
    let mut file = File::open(path)?;
    let (mut hash, mut size, mut block) = (Sha256::new(), 0, vec![0; 1 << 16]);
    loop {
        let count = file.read(&mut block)?;
        if count == 0 {
            break;
        }
        hash.update(&block[..count]);
        size += count as u64;
    }
    Ok((size, hexadecimal(&hash.finalize())))
}

fn hexadecimal(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}

/// An instant, s since 1970, as ISO 8601 in UTC; days by Hinnant's `civil_from_days`.
fn utc(seconds: i64) -> String {
    let (days, of_day) = (seconds.div_euclid(86_400) + 719_468, seconds.rem_euclid(86_400));
    let (era, day) = (days.div_euclid(146_097), days.rem_euclid(146_097));
    let year_of_era = (day - day / 1460 + day / 36_524 - day / 146_096) / 365;
    let day_of_year = day - (365 * year_of_era + year_of_era / 4 - year_of_era / 100);
    let shifted = (5 * day_of_year + 2) / 153;
    let month = if shifted < 10 { shifted + 3 } else { shifted - 9 };
    let year = year_of_era + 400 * era + i64::from(month <= 2);
    let (hour, minute, second) = (of_day / 3600, of_day / 60 % 60, of_day % 60);
    let day = day_of_year - (153 * shifted + 2) / 5 + 1;
    format!("{year:04}-{month:02}-{day:02} {hour:02}:{minute:02}:{second:02} UTC")
}

#[cfg(test)]
#[allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]
mod tests {
    use super::*;

    #[test]
    fn instants_are_those_of_the_calendar() {
        assert_eq!(utc(0), "1970-01-01 00:00:00 UTC");
        assert_eq!(utc(951_782_400 + 86_399), "2000-02-29 23:59:59 UTC");
        assert_eq!(utc(1_767_225_599), "2025-12-31 23:59:59 UTC");
        assert_eq!(utc(4_107_542_400), "2100-03-01 00:00:00 UTC");
    }

    #[test]
    fn a_command_line_is_told_as_a_shell_takes_it() {
        let words = ["identify", "my log.yaml", "--to", "7", "it's"].map(str::to_owned);
        let told = Provenance::of(&words).command();
        assert_eq!(told.as_deref(), Some("dynid identify 'my log.yaml' --to 7 'it'\\''s'"));
        assert_eq!(Provenance::default().command(), None);
    }

    #[test]
    fn the_fingerprint_is_sha_256() {
        let path = std::env::temp_dir().join(format!("dynid-digest-{}", std::process::id()));
        std::fs::write(&path, "abc").unwrap();
        let found = digest(&path);
        std::fs::remove_file(&path).unwrap();
        let known = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(found.unwrap(), (3, known.to_owned()));
    }
}
