//! A fixed frame in mid-chain: every command says the same joint numbers, those of the table.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

use std::path::PathBuf;
use std::process::Command;

/// Two revolute axes with a bracket between them, and a prismatic one: frame 2 is fixed, the joints are 1, 3 and 4.
const ARM: &str = "\
name: bracket_arm
description: three joints, with a fixed frame between the first two
constants: {d2: 0.2, d3: 0.15}
frames:
  - {j: 1, sigma: 0, alpha: 0, d: 0,  theta: q1, r: 0}
  - {j: 2, sigma: 2, alpha: 0, d: d2, theta: pi/2, r: 0}
  - {j: 3, sigma: 0, alpha: pi/2, d: d3, theta: q3, r: 0}
  - {j: 4, sigma: 1, alpha: 0, d: 0,  theta: 0,  r: q4}
drive: {gear: [80, 50, 400]}
limits:
  position: [2, 2, 0.2]
  velocity: [3, 4, 0.5]
  acceleration: [20, 30, 8]
  torque: [160, 100, 160]
nominal:
  parameters: {
    XX1: 0.0126, YY1: 0.278833, ZZ1: 0.278833, MX1: 1.12, M1: 7, Ia1: 0.35, Fv1: 5, Fc1: 6, off1: 0.3,
    XX3: 0.0135, XZ3: -0.018, YY3: 0.132042, ZZ3: 0.127542, MX3: 0.6, MZ3: 0.15, M3: 5,
    Ia3: 0.12, Fv3: 2.2, Fc3: 3, off3: -0.2,
    XX4: 0.0152932, YY4: 0.0152932, ZZ4: 8.64e-5, MZ4: 0.06, M4: 1.2, Ia4: 2, Fv4: 25, Fc4: 12, off4: 0.5}
  controller: {kp: [9000, 2500, 25000], kd: [220, 65, 450], ki: [20000, 6000, 60000]}
  noise: {position: [2e-5, 2e-5, 2e-6], torque: [0.4, 0.2, 0.4]}
";

/// A folder that is removed afterwards, with the arm in it.
struct Folder(PathBuf);

impl Folder {
    fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("dynid-fixed-frame-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        std::fs::write(path.join("arm.yaml"), ARM).unwrap();
        Self(path)
    }

    /// Exit status, and what is printed on both streams.
    fn run(&self, words: &[&str]) -> (i32, String) {
        let output =
            Command::new(env!("CARGO_BIN_EXE_dynid")).args(words).current_dir(&self.0).output().unwrap();
        let text = [output.stdout, output.stderr].concat();
        (output.status.code().unwrap(), String::from_utf8_lossy(&text).into_owned())
    }

    fn must(&self, words: &[&str]) -> String {
        let (status, text) = self.run(words);
        assert_eq!(status, 0, "{words:?}: {text}");
        text
    }

    fn json(&self, name: &str) -> serde_json::Value {
        serde_json::from_slice(&std::fs::read(self.0.join(name)).unwrap()).unwrap()
    }

    /// The arm moves in simulation; the recording is at `out/recording.yaml`.
    fn simulate(&self) {
        let motions = ["--motions", "1", "--rate", "2000", "--record-every", "2"];
        self.must(&[&["simulate", "./arm.yaml", "--out", "out"], &motions[..]].concat());
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The numbers behind a letter in names such as `Fv3`.
fn numbers_of(kind: &str, names: &[&str]) -> Vec<u64> {
    names.iter().filter_map(|name| name.strip_prefix(kind)?.parse().ok()).collect()
}

#[test]
fn show_names_variables_and_parameters_after_the_rows_of_the_table() {
    let folder = Folder::new("show");
    let shown = folder.must(&["show", "./arm.yaml"]);
    for variable in ["q1", "q3", "q4"] {
        assert!(shown.contains(variable), "{variable} is not in: {shown}");
    }
    assert!(!shown.contains("q2"), "{shown}");
    let names: Vec<&str> = shown.split_whitespace().collect();
    assert_eq!(numbers_of("Fv", &names), [1, 3, 4]);
    assert_eq!(numbers_of("off", &names), [1, 3, 4]);
}

#[test]
fn identify_and_validate_say_the_numbers_that_show_says() {
    let folder = Folder::new("identify");
    folder.simulate();
    let said =
        folder.must(&["identify", "out/recording.yaml", "--json", "found.json", "--out", "model.json"]);
    let found = folder.json("found.json");
    let names: Vec<&str> =
        found["base_parameters"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap()).collect();
    assert_eq!(numbers_of("Fc", &names), [1, 3, 4]);
    let mut joints: Vec<u64> =
        found["equations"].as_array().unwrap().iter().map(|rows| rows["joint"].as_u64().unwrap()).collect();
    joints.dedup();
    assert_eq!(joints, [1, 3, 4]);
    assert_eq!(found["per_joint"].as_array().unwrap().len(), 3);
    assert!(said.contains(" 3: ") && said.contains(" 4: ") && !said.contains(" 2: "), "{said}");

    let validated = folder.must(&["validate", "model.json", "out/recording.yaml"]);
    let rows: Vec<&str> = validated
        .lines()
        .filter(|line| line.contains('%'))
        .filter_map(|line| line.split_whitespace().find(|word| word.parse::<usize>().is_ok()))
        .collect();
    assert!(rows.windows(3).any(|joints| joints == ["1", "3", "4"]), "{validated}");
}

#[test]
fn a_recording_names_its_joints_by_the_table_too() {
    let folder = Folder::new("recording");
    folder.simulate();
    let path = folder.0.join("out/recording.yaml");
    let manifest = std::fs::read_to_string(&path).unwrap();
    let with = |fixed: &str| std::fs::write(&path, manifest.replace(".csv\"}", fixed)).unwrap();
    with(".csv\", fixed: [2]}");
    let (status, text) = folder.run(&["identify", "out/recording.yaml"]);
    assert_eq!(status, 2);
    assert!(text.contains("names joint 2, which bracket_arm does not have"), "{text}");
    with(".csv\", fixed: [4]}");
    folder.must(&["identify", "out/recording.yaml", "--json", "found.json"]);
    let found = folder.json("found.json");
    let left_out: Vec<(u64, bool)> = found["equations"]
        .as_array()
        .unwrap()
        .iter()
        .map(|rows| (rows["joint"].as_u64().unwrap(), rows["fixed"].as_u64().unwrap() > 0))
        .collect();
    assert_eq!(left_out, [(1, false), (3, false), (4, true)]);
}

#[test]
fn an_elastic_joint_is_chosen_by_its_number() {
    let folder = Folder::new("elastic");
    let simulate = |joint: &str| {
        folder.run(&["simulate", "./arm.yaml", "--out", "out", "--motions", "1", "--elastic", joint])
    };
    let (status, text) = simulate("2:1e5");
    assert_eq!(status, 2, "{text}");
    assert!(text.contains("the joints of bracket_arm are 1, 3, 4, not 2"), "{text}");
    let (status, text) = simulate("4:1e6");
    assert_eq!(status, 0, "{text}");
}
