//! `fleet.html` and a page for each robot.

use std::collections::{BTreeMap, BTreeSet};

use datafusion::arrow::array::RecordBatch;
use dynid::output::{make_folder, write as write_file};
use dynid::words::effect_words;
use dynid_fleet_watch::{FindingFact, Labels, Pages, RecordingFact, RobotFacts, Series, Watched};
use sha2::{Digest, Sha256};

use super::folder::OutFolder;
use super::rows::{findings_schema, number, screening_schema, text};
use super::tables;
use crate::error::Result;

/// Folder of the robots' pages, beside `fleet.html`.
const FOLDER: &str = "robots";

/// Longest name of a robot's page, escaped, bytes: file systems take 255.
const LONGEST: usize = 120;

/// Writes the pages.
///
/// # Errors
/// A table that is none, or what the file system says.
pub fn write(out: &OutFolder, series: &[Series], watched: &Watched, names: &TableNames) -> Result<()> {
    let facts = facts(out)?;
    let robots: BTreeSet<&str> =
        facts.keys().map(String::as_str).chain(series.iter().map(|s| s.robot.as_str())).collect();
    let link = |robot: &str| Some(format!("{FOLDER}/{}", file_name(robot)));
    let table = |fingerprint: &str| names.label(fingerprint);
    let pages = Pages::new(series, watched, &facts, Labels { link: &link, table: &table });
    let folder = out.file(FOLDER);
    make_folder(&folder)?;
    for robot in robots {
        write_file(&folder.join(file_name(robot)), &pages.robot(robot))?;
    }
    // Last: it leads to the others.
    write_file(&out.file("fleet.html"), &pages.fleet())?;
    Ok(())
}

/// Whether there are pages: an interrupted run leaves none, or older ones, and so does a dynid-fleet that knew no robots' pages.
pub fn are_there(out: &OutFolder) -> bool {
    ["alarms.parquet", "fleet.html", FOLDER].iter().all(|name| out.file(name).exists())
}

/// The names of robot tables.
#[derive(Debug, Default)]
pub struct TableNames(BTreeMap<String, String>);

impl TableNames {
    /// Takes in the name of the table with a fingerprint; the first one counts.
    pub fn add(&mut self, fingerprint: Option<&str>, name: Option<&str>) {
        let Some((fingerprint, name)) = fingerprint.zip(name.filter(|name| !name.is_empty())) else { return };
        if !self.0.contains_key(fingerprint) {
            self.0.insert(fingerprint.to_owned(), name.to_owned());
        }
    }

    /// What a person calls a table: its name, and its fingerprint where two tables have this name.
    fn label(&self, fingerprint: &str) -> String {
        let Some(name) = self.0.get(fingerprint) else { return fingerprint.to_owned() };
        let same = self.0.values().filter(|other| *other == name).count();
        if same > 1 { format!("{name} ({fingerprint})") } else { name.clone() }
    }
}

/// What is known of each robot from its recordings.
fn facts(out: &OutFolder) -> Result<BTreeMap<String, RobotFacts>> {
    let mut facts: BTreeMap<String, RobotFacts> = BTreeMap::new();
    for day in out.days("screening") {
        if let Some(rows) = tables::read(&out.of_day("screening", day), &screening_schema())? {
            for k in 0..rows.num_rows() {
                let robot = text(&rows, "robot", k).unwrap_or_default();
                facts.entry(robot.to_owned()).or_default().recordings.push(recording(&rows, k, day.into()));
            }
        }
        if let Some(rows) = tables::read(&out.of_day("findings", day), &findings_schema())? {
            for k in 0..rows.num_rows() {
                let robot = text(&rows, "robot", k).unwrap_or_default();
                facts.entry(robot.to_owned()).or_default().findings.push(finding(&rows, k, day.into()));
            }
        }
    }
    Ok(facts)
}

fn recording(rows: &RecordBatch, k: usize, day: i64) -> RecordingFact {
    let words = |column: &str| text(rows, column, k).unwrap_or_default().to_owned();
    RecordingFact {
        day,
        recording: words("recording"),
        outcome: words("outcome"),
        message: words("message"),
        relative_error: number(rows, "relative_error", k),
        rise: number(rows, "rise", k),
    }
}

fn finding(rows: &RecordBatch, k: usize, day: i64) -> FindingFact {
    let words = |column: &str| text(rows, column, k).unwrap_or_default().to_owned();
    FindingFact {
        day,
        recording: words("recording"),
        effect: text(rows, "effect", k).map(effect_words).unwrap_or_default(),
        sentence: words("sentence"),
        confidence: number(rows, "confidence", k),
    }
}

/// The name of the file of a robot's page. Letters and digits of ASCII, `-` and `_` stand for themselves, every other byte is
/// `~` and two hexadecimal digits: names that differ stay different, and none leads out of the folder. Of a name that is too
/// long for a file the beginning stays, with the digest of all of it.
pub fn file_name(robot: &str) -> String {
    let mut name = String::with_capacity(robot.len() + 5);
    for byte in robot.bytes() {
        if byte.is_ascii_alphanumeric() || matches!(byte, b'-' | b'_') {
            name.push(char::from(byte));
        } else {
            name.push_str(&format!("~{byte:02X}"));
        }
    }
    if name.is_empty() || name.len() > LONGEST {
        // Two of `~` come from no name.
        let digest = Sha256::digest(robot.as_bytes());
        name.truncate(LONGEST);
        name.push_str("~~");
        digest.iter().take(12).for_each(|byte| name.push_str(&format!("{byte:02x}")));
    }
    name + ".html"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_pages_stay_in_their_folder_and_apart() {
        let names =
            ["r1", "r/1", "r\\1", "r~2F1", "..", ".", "", "../../x", "a b", "a\0b", "con:", "ä", "ae"];
        let long = ["x".repeat(300), "x".repeat(301), "ä".repeat(200)];
        let names = names.into_iter().chain(long.iter().map(String::as_str));
        let files: BTreeSet<String> = names.map(file_name).collect();
        assert_eq!(files.len(), 16, "{files:?}");
        for file in &files {
            assert!(
                file.len() < 200 && !file.starts_with('.') && !file.contains(['/', '\\', ':', '\0']),
                "{file}"
            );
            assert_eq!(file.matches('.').count(), 1, "{file}");
        }
        assert_eq!(file_name("r-001_a"), "r-001_a.html");
        assert_eq!(file_name("r/1"), "r~2F1.html");
    }

    #[test]
    fn a_table_is_called_by_its_name_and_two_of_one_name_by_their_fingerprints_too() {
        let mut names = TableNames::default();
        names.add(Some("1"), None);
        names.add(Some("1"), Some("tx40"));
        names.add(Some("2"), Some("arm"));
        names.add(Some("3"), Some("arm"));
        assert_eq!(["1", "2", "3", "4"].map(|f| names.label(f)), ["tx40", "arm (2)", "arm (3)", "4"]);
    }
}
