//! What the README shows is what its commands print.

#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use common::{Folder, error_of, words_of};

#[test]
fn what_the_readme_shows_of_the_demo_is_what_the_demo_prints() {
    let readme = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/README.md")).unwrap();
    let shown = readme.split("```").find(|block| block.contains("$ dynid diagnose dynid-demo")).unwrap();
    let folder = Folder::new("readme-demo");
    let output = folder.run(&["demo"]);
    assert!(output.status.success(), "{}", error_of(&output));
    let printed = words_of(&output);
    let lines: Vec<&str> = shown.lines().map(str::trim).filter(|line| !line.is_empty()).collect();
    assert!(lines.len() > 5, "{shown}");
    for line in lines {
        // The beginning of a command stands for it.
        let line = line.trim_end_matches(" ...");
        assert!(printed.contains(line), "'{line}' is not in: {printed}");
    }
}
