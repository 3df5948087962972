//! Finished runs in a file, one a line: a test of an hour can be stopped, and goes on where it was.

use std::collections::HashMap;
use std::fs::{self, File, OpenOptions};
use std::io::Write;
use std::path::Path;
use std::sync::{Mutex, PoisonError};

use serde::{Deserialize, Serialize};

use crate::case::Case;
use crate::failure::Failure;
use crate::score::Score;

/// The file, and what it held when it was opened.
pub struct Journal {
    file: Mutex<File>,
    done: HashMap<String, Score>,
}

/// A line.
#[derive(Serialize, Deserialize)]
struct Run {
    case: String,
    score: Score,
}

impl Journal {
    /// Opens a journal, or starts one. A line that was cut when the test was stopped is a run that is not done.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let text = if path.exists() { fs::read_to_string(path)? } else { String::new() };
        let runs = text.lines().filter_map(|line| serde_json::from_str::<Run>(line).ok());
        let done = runs.map(|run| (run.case, run.score)).collect();
        let mut file = OpenOptions::new().create(true).append(true).open(path)?;
        if !text.is_empty() && !text.ends_with('\n') {
            writeln!(file)?;
        }
        Ok(Self { file: Mutex::new(file), done })
    }

    /// How a case ended, if it did.
    pub fn done(&self, case: &Case) -> Option<Score> {
        self.done.get(&case.name()).cloned()
    }

    /// Writes down how a case ended.
    pub fn add(&self, case: &Case, score: &Score) -> Result<(), Failure> {
        let line = serde_json::to_string(&Run { case: case.name(), score: score.clone() })?;
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        Ok(writeln!(file, "{line}")?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::hide::Hidden;
    use crate::recorder::Recorder;
    use crate::score::Outcome;
    use dynid_runtime::effects::EffectKind;

    #[test]
    fn a_test_that_was_stopped_goes_on_where_it_was() -> Result<(), Failure> {
        let case = |seed| Case {
            push: Default::default(),
            robot: "tx40".into(),
            effects: vec![EffectKind::Stribeck],
            size: 1,
            seed,
            seconds: Some(5.0),
            baseline: false,
            reference: None,
            recorder: Recorder::White,
        };
        let hidden = Hidden {
            effect: EffectKind::Stribeck,
            joint: Some(2),
            magnitude: 1.5,
            visible: 2.5,
            outside: None,
            numbers: Vec::new(),
        };
        let outcome = Outcome { detected: true, named: true, ..Outcome::default() };
        let score = Score { hidden: vec![(hidden, outcome)], seconds: 2.0, ..Score::default() };
        let path = std::env::temp_dir().join(format!("dynid_journal_{}.jsonl", std::process::id()));
        let first = Journal::open(&path)?;
        first.add(&case(1), &score)?;
        // The second line is cut.
        fs::write(&path, fs::read_to_string(&path)? + "{\"case\": \"tx40_strib")?;
        let second = Journal::open(&path)?;
        second.add(&case(3), &score)?;
        let third = Journal::open(&path)?;
        fs::remove_file(&path)?;
        assert!(third.done(&case(1)).is_some_and(|s| s.solved() && s.seconds == 2.0));
        assert!(third.done(&case(2)).is_none());
        assert!(third.done(&case(3)).is_some());
        assert!(third.done(&Case { seconds: None, ..case(1) }).is_none());
        Ok(())
    }
}
