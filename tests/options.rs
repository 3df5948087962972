//! Every option that a command offers changes what it says, or is refused.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use common::{Folder, error_of, json_of};
use serde_json::Value;

fn simulated() -> Folder {
    let folder = Folder::new("options");
    let words =
        "simulate planar_2r --out . --motions 3 --period 4 --rate 1000 --record-every 2 --noise 20 --seed 7";
    let output = folder.run(&words.split(' ').collect::<Vec<_>>());
    assert!(output.status.success(), "{}", error_of(&output));
    folder
}

fn run(folder: &Folder, words: &str) -> Value {
    let mut words: Vec<&str> = words.split(' ').collect();
    words.extend(["--json", "-"]);
    let output = folder.run(&words);
    assert!(output.status.success(), "{words:?}: {}", error_of(&output));
    json_of(&output)
}

#[test]
fn the_options_of_each_command_are_honoured() {
    let folder = simulated();
    let saved = folder.run(&["identify", "recording.yaml", "--out", "m.json"]);
    assert!(saved.status.success(), "{}", error_of(&saved));
    for command in ["identify recording.yaml", "validate m.json recording.yaml", "diagnose recording.yaml"] {
        let usual = run(&folder, command);
        let mut options = vec!["--band 5", "--cutoff 15", "--standstill 0.6", "--from 0.5", "--to 3.5"];
        if !command.starts_with("diagnose") {
            options.extend(["--rate 13", "--all-rows"]);
        }
        for option in options {
            let other = run(&folder, &format!("{command} {option}"));
            assert_ne!(figures(&usual), figures(&other), "{command} {option}");
        }
        for threads in ["--threads 1", "--threads 3"] {
            assert_eq!(figures(&usual), figures(&run(&folder, &format!("{command} {threads}"))), "{command}");
        }
    }
    for refused in ["--rate 100", "--all-rows"] {
        let mut words = vec!["diagnose", "recording.yaml"];
        words.extend(refused.split(' '));
        let output = folder.run(&words);
        assert_eq!(output.status.code(), Some(2));
        assert!(error_of(&output).contains(words[2]), "{}", error_of(&output));
    }
}

/// The numbers that sampling decides.
fn figures(json: &Value) -> Vec<String> {
    ["relative_error", "per_joint", "base_parameters", "equations", "rows", "before", "held_out", "mismatch"]
        .iter()
        .map(|key| json[key].to_string())
        .collect()
}
