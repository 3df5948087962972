//! What the commands print, whole: a change of a word or a column shows here.
//!
//! `INSTA_UPDATE=always cargo test --test snapshots` writes what is printed now to `tests/snapshots/`.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use std::process::Output;

use common::{ARM, Folder, MANIFEST, error_of, moving, words_of};

/// All that a command says: its status, standard output, then standard error.
fn said(output: &Output) -> String {
    let status = output.status.code().map_or_else(|| "killed".to_owned(), |code| code.to_string());
    without_fingerprints(format!("exit status {status}\n{}{}", words_of(output), error_of(output)))
}

/// A text in which simulated files are called alike (`traj1-00000000.csv`): their last digits, and so the fingerprints
/// in their names, are the machine's.
fn without_fingerprints(mut text: String) -> String {
    let ends: Vec<usize> = text.match_indices(".csv").map(|(at, _)| at).collect();
    for end in ends {
        let is_print = |name: &str| name.starts_with('-') && name[1..].bytes().all(|b| b.is_ascii_hexdigit());
        if end >= 9 && text.get(end - 9..end).is_some_and(is_print) {
            text.replace_range(end - 8..end, "00000000");
        }
    }
    text
}

/// A short closed-loop simulation of the planar arm, the same on every machine in the digits that are printed.
fn simulated(name: &str) -> Folder {
    let folder = Folder::new(name);
    let words =
        "simulate planar_2r --out . --motions 3 --period 4 --rate 1000 --record-every 2 --noise 1 --seed 7";
    let output = folder.run(&words.split(' ').collect::<Vec<_>>());
    assert!(output.status.success(), "{}", error_of(&output));
    folder
}

#[test]
fn robots_and_their_tables() {
    let folder = Folder::new("snap-robots");
    insta::assert_snapshot!("robots", said(&folder.run(&["robots"])));
    insta::assert_snapshot!("show", said(&folder.run(&["show", "planar_2r", "--base"])));
}

#[test]
fn identify_and_validate() {
    let folder = simulated("snap-identify");
    insta::assert_snapshot!(
        "identify",
        said(&folder.run(&["identify", "recording.yaml", "--out", "m.json"]))
    );
    insta::assert_snapshot!("validate", said(&folder.run(&["validate", "m.json", "recording.yaml"])));
}

#[test]
fn diagnose_where_there_is_nothing_to_find() {
    let folder = simulated("snap-diagnose");
    insta::assert_snapshot!(
        "diagnose",
        said(&folder.run(&["diagnose", "recording.yaml", "--test", "recording.yaml"]))
    );
}

#[test]
fn errors() {
    let folder = Folder::new("snap-errors");
    folder.write("motion.csv", &moving(800)).write("recording.yaml", MANIFEST).write("arm.yaml", ARM);
    folder.write("column.yaml", &MANIFEST.replace("u1", "zz"));
    folder.write("robot.yaml", &MANIFEST.replace("planar_2r", "planar_3r"));
    folder.write("key.yaml", &MANIFEST.replace("side:", "sides:"));
    folder.write("m.json", "{\"robot\": 3}");
    let mut all = String::new();
    for words in [
        "identify none.yaml",
        "identify column.yaml",
        "identify robot.yaml",
        "identify key.yaml",
        "identify recording.yaml --from 3 --to 2",
        "identify recording.yaml --band nan",
        "validate m.json recording.yaml",
        "show nobody",
        "simulate ./arm.yaml --out x",
        "diagnose recording.yaml --rate 100",
    ] {
        let output = folder.run(&words.split(' ').collect::<Vec<_>>());
        all.push_str(&format!("$ dynid {words}\n{}\n", said(&output)));
    }
    insta::assert_snapshot!("errors", all);
}
