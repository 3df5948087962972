//! `fleet.yaml`: where recordings are, whose they are, and what to work out.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use dynid_runtime::recording::yaml::{MAX_BYTES, Mistake, Node, Place, read_positions_of};
use dynid_runtime::regular_file;
use serde::Deserialize;

use crate::error::{FleetError, Result};
use crate::pattern::Pattern;

/// What a fleet file says.
#[derive(Debug, Clone)]
pub struct FleetFile {
    /// Where it stands.
    pub path: PathBuf,
    /// Its folder, which local paths in it are relative to.
    pub folder: PathBuf,
    /// Where recordings are listed.
    pub recordings: Recordings,
    /// Where recordings are: `http://host/fleet`, `s3://bucket/fleet`; `None`: beside the fleet file.
    pub store: Option<String>,
    /// The table of each robot, `*` for those that are not named: the name of a robot of dynid, or the path of a YAML or
    /// URDF. Robots without one are those that their recordings name.
    pub robots: BTreeMap<String, String>,
    /// Path of the model that each robot is compared with, with `{robot}`; `None`: what its first day says.
    pub references: Option<String>,
    /// Band of the equations, Hz; `None`: that of each recording.
    pub band: Option<f64>,
    /// When a recording is diagnosed.
    pub diagnosis: DiagnosisRule,
    /// Folder of the results, where `--out` names none.
    pub out: Option<PathBuf>,
}

/// Where recordings are listed.
#[derive(Debug, Clone)]
pub enum Recordings {
    /// In their paths.
    Pattern(Pattern),
    /// In a CSV or Parquet table with the columns robot, time and recording.
    Table(PathBuf),
}

/// When a recording is diagnosed.
#[derive(Debug, Clone, Copy, PartialEq, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct DiagnosisRule {
    /// Whether at all.
    pub enabled: bool,
    /// How many times the error with the recording's own parameters that with the reference's must be, and how many times
    /// the largest such ratio of the robot's earlier days: what was there yesterday is no news today. It must also be more
    /// than these days predict.
    ///
    /// 1.05 is a tenth more squares: one joint of six whose error is a quarter larger. Less than that costs a diagnosis,
    /// which takes a hundred times as long as an identification, and finds nothing that stands out.
    pub error_rises: f64,
    /// Rows at the beginning of the recording that are diagnosed: a diagnosis holds them in memory.
    pub rows: usize,
}

impl Default for DiagnosisRule {
    fn default() -> Self {
        Self { enabled: true, error_rises: 1.05, rows: 60_000 }
    }
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    recordings: String,
    store: Option<String>,
    #[serde(default)]
    robots: BTreeMap<String, String>,
    references: Option<String>,
    band: Option<f64>,
    #[serde(default)]
    diagnosis: DiagnosisRule,
    out: Option<PathBuf>,
}

impl FleetFile {
    /// Reads a fleet file.
    ///
    /// # Errors
    /// A file that cannot be read; every mistake in it with its line and column.
    pub fn read(path: &Path) -> Result<Self> {
        let bytes = regular_file::read(path, MAX_BYTES as u64)
            .map_err(|error| FleetError::io(path, "read the fleet", &error))?;
        Self::parse(path, &bytes)
    }

    /// Reads the text of a fleet file; `path` is where it stands.
    ///
    /// # Errors
    /// As of [`FleetFile::read`].
    pub fn parse(path: &Path, bytes: &[u8]) -> Result<Self> {
        let fail = |Mistake { place, message }: Mistake| FleetError::Place {
            file: path.display().to_string(),
            line: place.line,
            column: place.column,
            message,
        };
        let root = read_positions_of(bytes, "fleet").map_err(fail)?;
        let Some(root) = root.filter(Node::is_mapping) else {
            let message =
                "this is no fleet: it needs the key recordings, a table or a path with {robot} and {day}";
            return Err(fail(Mistake { place: Place::START, message: message.to_owned() }));
        };
        let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
        let raw: Raw = serde_yaml::from_slice(text).map_err(|error| fail(mistake_of(&error, &root)))?;
        Self::checked(path, raw, &root).map_err(fail)
    }

    fn checked(path: &Path, raw: Raw, root: &Node) -> std::result::Result<Self, Mistake> {
        let at = |keys: &[&str], message: &str| {
            let message = format!("{}: {message}", keys.join("."));
            Mistake { place: root.place_of(keys), message }
        };
        let folder = path.parent().map(Path::to_path_buf).unwrap_or_default();
        let recordings = recordings(&raw, &folder, root)?;
        if let Some(store) = &raw.store
            && !store.contains("://")
        {
            return Err(at(
                &["store"],
                &format!(
                    "`{store}` is no address; expected http://host/folder, s3://bucket/folder or file:///folder"
                ),
            ));
        }
        if raw.references.as_ref().is_some_and(|path| !path.contains("{robot}")) {
            return Err(at(&["references"], "each robot has a model of its own: write {robot} in the path"));
        }
        if raw.band.is_some_and(|band| !(band.is_finite() && band > 0.0)) {
            return Err(at(&["band"], "a positive number of Hz is expected"));
        }
        let rule = raw.diagnosis;
        if !(rule.error_rises.is_finite() && rule.error_rises >= 1.0) {
            return Err(at(&["diagnosis", "error_rises"], "a ratio of at least 1 is expected, such as 1.05"));
        }
        if rule.rows < 1000 {
            return Err(at(&["diagnosis", "rows"], "at least 1000 rows are needed for a diagnosis"));
        }
        let out = raw.out.map(|out| folder.join(out));
        let Raw { store, robots, references, band, .. } = raw;
        let path = path.to_path_buf();
        Ok(Self { path, folder, recordings, store, robots, references, band, diagnosis: rule, out })
    }

    /// The table of a robot, where the fleet file says one: a name, or a path.
    pub fn table_of(&self, robot: &str) -> Option<String> {
        let named = self.robots.get(robot).or_else(|| self.robots.get("*"))?;
        let is_path =
            [".yaml", ".yml", ".urdf"].iter().any(|end| named.ends_with(end)) || named.contains('/');
        Some(if is_path { self.folder.join(named).display().to_string() } else { named.clone() })
    }

    /// The path of the model that a robot is compared with, where the fleet file says one.
    pub fn reference_of(&self, robot: &str) -> Option<PathBuf> {
        Some(self.folder.join(self.references.as_ref()?.replace("{robot}", robot)))
    }
}

fn recordings(raw: &Raw, folder: &Path, root: &Node) -> std::result::Result<Recordings, Mistake> {
    let node = root.value_of("recordings");
    let place = |offset| node.map_or(Place::START, |node| node.place_of_text(offset));
    let text = &raw.recordings;
    if Pattern::is_pattern(text) || text.contains(['{', '*']) {
        return Pattern::parse(text).map(Recordings::Pattern).map_err(|(offset, what)| Mistake {
            place: place(offset),
            message: format!("recordings: {what}"),
        });
    }
    if [".csv", ".parquet"].iter().any(|end| text.ends_with(end)) {
        return Ok(Recordings::Table(folder.join(text)));
    }
    let message = format!(
        "recordings: `{text}` is neither a table (.csv, .parquet) with the columns robot, time and recording, nor a path with \
         {{robot}} and {{day}} in it"
    );
    Err(Mistake { place: place(0), message })
}

/// What the deserialiser says, without its own words of the place.
fn mistake_of(error: &serde_yaml::Error, root: &Node) -> Mistake {
    let message = error.to_string();
    if message.starts_with("missing field `recordings`") {
        let message = "a fleet has no 'recordings': a table, or a path with {robot} and {day}".to_owned();
        return Mistake { place: root.place, message };
    }
    let place = error.location().map_or(root.place, |l| Place { line: l.line(), column: l.column() });
    let message = message.split(" at line ").next().unwrap_or_default().chars().take(300).collect();
    Mistake { place, message }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mistake(text: &str) -> String {
        FleetFile::parse(Path::new("fleet.yaml"), text.as_bytes()).expect_err("a mistake").to_string()
    }

    #[test]
    fn a_fleet_says_where_recordings_are_and_whose() {
        let text = "recordings: logs/{robot}/{day}.yaml\nrobots: {'*': tx40, r7: tables/own.yaml}\n\
                    references: models/{robot}.json\nband: 10\ndiagnosis: {rows: 5000}\nout: results\n";
        let fleet = FleetFile::parse(Path::new("plant/fleet.yaml"), text.as_bytes()).expect("a fleet");
        assert_eq!(fleet.table_of("r1").as_deref(), Some("tx40"));
        assert_eq!(fleet.table_of("r7").as_deref(), Some("plant/tables/own.yaml"));
        assert_eq!(fleet.reference_of("r1"), Some(PathBuf::from("plant/models/r1.json")));
        assert_eq!(fleet.out, Some(PathBuf::from("plant/results")));
        assert_eq!(fleet.diagnosis, DiagnosisRule { rows: 5000, ..DiagnosisRule::default() });
    }

    #[test]
    fn mistakes_are_told_with_their_place_and_what_to_do() {
        assert_eq!(
            mistake("band: 3\n"),
            "fleet.yaml:1:1: a fleet has no 'recordings': a table, or a path with {robot} and {day}"
        );
        assert!(
            mistake("recordings: a.txt\n").starts_with("fleet.yaml:1:13: recordings: `a.txt` is neither")
        );
        assert!(
            mistake("recordings: a/{robto}/{day}\n").starts_with("fleet.yaml:1:15: recordings: expected")
        );
        assert!(mistake("recordings: a.csv\nband: -1\n").starts_with("fleet.yaml:2:1: band: a positive"));
        assert!(
            mistake("recordings: a.csv\nbands: 1\n").starts_with("fleet.yaml:2:1: unknown field `bands`")
        );
        assert!(
            mistake("recordings: a.csv\ndiagnosis:\n  error_rises: 0.5\n")
                .starts_with("fleet.yaml:3:3: diagnosis.error_rises: a ratio")
        );
        assert!(mistake("recordings: a.csv\nstore: /x\n").starts_with("fleet.yaml:2:1: store: `/x` is no"));
        assert!(mistake("recordings: a.csv\nreferences: m.json\n").contains("{robot}"));
        assert!(mistake("- a\n").starts_with("fleet.yaml:1:1: this is no fleet"));
        assert!(mistake("").starts_with("fleet.yaml:1:1: this is no fleet"));
    }
}
