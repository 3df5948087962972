//! The robots that are shipped, as the tests read them.

use dynid_codegen::robot::{RobotTable, parse};
use std::path::{Path, PathBuf};

/// The folder of the workspace.
pub fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// All tables of `robots/`, by the names of their files.
pub fn robots() -> Vec<RobotTable> {
    let mut paths: Vec<PathBuf> =
        std::fs::read_dir(workspace().join("robots")).unwrap().map(|entry| entry.unwrap().path()).collect();
    paths.sort();
    paths
        .iter()
        .map(|path| {
            let text = std::fs::read(path).unwrap();
            parse(&path.display().to_string(), &text).unwrap_or_else(|mistakes| {
                panic!("{}", mistakes.iter().map(|m| format!("{m}\n")).collect::<String>())
            })
        })
        .collect()
}
