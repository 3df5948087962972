//! Every mistake in a robot's YAML is reported at its place, all of them at once.

mod magnitudes;
mod rows;
mod sections;
mod text;

use dynid_codegen::robot::{RobotTable, parse};
use std::fmt::Display;

/// The mistakes of a text as `line:column: message`.
fn mistakes(text: impl AsRef<[u8]>) -> Vec<String> {
    match parse("arm.yaml", text.as_ref()) {
        Ok(robot) => panic!("no mistake found in {robot:?}"),
        Err(found) => without_file(&found),
    }
}

/// Messages after the name of the file that each begins with.
fn without_file(found: &[impl Display]) -> Vec<String> {
    found
        .iter()
        .map(|m| m.to_string().strip_prefix("arm.yaml:").expect("names the file").to_owned())
        .collect()
}

/// That the text has exactly one mistake, at this place, with these words in its message.
#[track_caller]
fn one_mistake(text: &str, place: &str, words: &[&str]) {
    let found = mistakes(text);
    assert_eq!(found.len(), 1, "{found:#?}");
    assert!(found[0].starts_with(&format!("{place}: ")), "{found:#?}");
    for word in words {
        assert!(found[0].contains(word), "no '{word}' in {found:#?}");
    }
}

fn read(text: &str) -> RobotTable {
    parse("arm.yaml", text.as_bytes()).unwrap_or_else(|m| panic!("{}", m[0]))
}

/// A robot of two revolute joints with one line replaced or added.
fn arm(rest: &str) -> String {
    format!(
        "name: arm\nframes:\n  - {{j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}}\n  \
         - {{j: 2, sigma: 0, alpha: 0, d: 0.5, theta: q2, r: 0}}\n{rest}\n"
    )
}

/// A robot whose second row is given.
fn arm_with_row(row: &str) -> String {
    format!(
        "name: arm\nconstants: {{d2: 0.5, zero: 0}}\nframes:\n  \
         - {{j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}}\n  - {{{row}}}\n"
    )
}
