//! A recording of another robot, or one whose signs, orders or units are mixed up, ends in a sentence; a recording of
//! the robot itself never does.
//!
//! Real recordings belong to others; where `../shared` is absent their tests say that they were skipped.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;

fn shared(name: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared").join(name);
    if path.exists() {
        return Some(path);
    }
    let _ = writeln!(std::io::stderr(), "skipped: {} is not there", path.display());
    None
}

/// Exit status of `dynid identify` and all that it says.
fn identify(recording: &Path, more: &[&str]) -> (i32, String) {
    let output =
        Command::new(env!("CARGO_BIN_EXE_dynid")).arg("identify").arg(recording).args(more).output().unwrap();
    let words =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    (output.status.code().unwrap(), words)
}

#[test]
fn real_recordings_are_refused_under_every_other_robot_and_accepted_under_their_own() {
    let recordings = [
        ("tx40/recording", "tx40"),
        ("ur10e/train", "ur10e"),
        ("ur10e/test", "ur10e"),
        ("panda/recording", "panda"),
    ];
    for (name, own) in recordings {
        let Some(path) = shared(&format!("data/{name}.yaml")) else { return };
        for robot in ["tx40", "puma560", "stanford", "cobot6", "ur10e", "panda", "branched"] {
            // The cobot6 has the lengths of the UR10e to within 5 cm: neither fits the other's recording any worse.
            if (own, robot) == ("ur10e", "cobot6") {
                continue;
            }
            let (status, words) = identify(&path, &["--robot", robot]);
            println!("{name} as {robot}: {status}");
            match robot == own {
                true => assert_eq!(status, 0, "{name}: {words}"),
                false => {
                    let sentence = words.contains(".yaml") || words.contains(".csv");
                    assert!(matches!(status, 1 | 2) && sentence, "{name} as {robot}: {status} {words}");
                }
            }
        }
    }
}

#[test]
fn a_part_of_a_real_recording_is_accepted_and_still_refused_under_other_robots() {
    let Some(tx40) = shared("data/tx40/recording.yaml") else { return };
    for window in
        [["--from", "0", "--to", "4.5"], ["--from", "4.5", "--to", "7.4"], ["--from", "0", "--to", "2"]]
    {
        let (status, words) = identify(&tx40, &window);
        assert_eq!(status, 0, "{window:?}: {words}");
    }
    for robot in ["puma560", "cobot6", "ur10e"] {
        let (status, words) = identify(&tx40, &["--from", "0", "--to", "4.5", "--robot", robot]);
        assert!(status == 1 && words.contains("tx40"), "{robot}: {status} {words}");
    }
    let Some(panda) = shared("data/panda/recording.yaml") else { return };
    for window in [["--from", "0", "--to", "12"], ["--from", "10", "--to", "14"]] {
        let (status, words) = identify(&panda, &window);
        assert_eq!(status, 0, "{window:?}: {words}");
    }
}

#[test]
fn strokes_of_a_single_joint_are_accepted_and_say_nothing_of_the_others() {
    let Some(folder) = shared("data/ur10e") else { return };
    let own = std::env::temp_dir().join(format!("dynid-stroke-{}", std::process::id()));
    std::fs::create_dir_all(&own).unwrap();
    for (joint, fixed) in [(1, ", fixed: [2, 3, 4, 5, 6]"), (2, ", fixed: [1, 3, 4, 5, 6]"), (2, "")] {
        let (path, model) = (own.join("recording.yaml"), own.join("model.json"));
        let manifest = format!(
            "title: stroke\nrobot: ur10e\nside: joint\nlayout: {{header: false, delimiter: \",\"}}\n\
             time: {{column: 0, unit: s, from_first_row: true}}\n\
             position: {{columns: [1, 2, 3, 4, 5, 6], unit: rad}}\n\
             torque: {{columns: [13, 14, 15, 16, 17, 18], unit: A, gain: [14.87, 13.26, 11.13, 10.62, 11.03, 11.47]}}\n\
             trajectories:\n  - {{file: {}/ur-20_01_22-joint_{joint}.csv, from: 2, to: 32{fixed}}}\n",
            folder.display()
        );
        std::fs::write(&path, manifest).unwrap();
        let (status, words) = identify(&path, &["--out", model.to_str().unwrap()]);
        assert_eq!(status, 0, "joint {joint}: {words}");
        let model: serde_json::Value =
            serde_json::from_str(&std::fs::read_to_string(&model).unwrap()).unwrap();
        for parameter in model["base_parameters"].as_array().unwrap() {
            // Friction of some ten N.m and a link of some ten kg: nothing that is determined is larger by much.
            assert!(parameter["value"].as_f64().unwrap().abs() < 200.0, "joint {joint}: {parameter}");
        }
    }
    std::fs::remove_dir_all(&own).unwrap();
}

#[test]
fn recordings_that_hide_an_effect_are_accepted() {
    let Some(folder) = shared("challenge") else { return };
    for case in std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).filter(|p| p.is_dir()) {
        for name in ["recording.yaml", "test.yaml", "baseline.yaml"] {
            let path = case.join(name);
            if path.exists() {
                // Half of each motion: the effect is as large in it, and less else speaks for the robot.
                let (status, words) = identify(&path, &["--to", "4"]);
                assert_eq!(status, 0, "{}: {words}", path.display());
            }
        }
    }
}

#[test]
fn a_wrong_sign_order_or_unit_is_named() {
    let Some(folder) = shared("data/tx40") else { return };
    let original = std::fs::read_to_string(folder.join("recording.yaml")).unwrap();
    let original = original
        .replace("file: pos", &format!("file: {}/pos", folder.display()))
        .replace("file: curr", &format!("file: {}/curr", folder.display()));
    let own = std::env::temp_dir().join(format!("dynid-plausible-{}", std::process::id()));
    std::fs::create_dir_all(&own).unwrap();
    let path = own.join("recording.yaml");
    for (from, to, expected) in [
        ("unit: N.m}", "unit: N.m, gain: [1, -1, 1, 1, 1, 1]}", "sign of the torque of joint 2"),
        ("unit: N.m}", "unit: N.m, gain: [1, 1, 1, -1, 1, 1]}", "sign of the torque of joint 4"),
        ("unit: rad}", "unit: deg}", "angles in radians"),
        (
            "columns: [Joint_1, Joint_2, Joint_3, Joint_4, Joint_5, Joint_6], unit: N.m}",
            "columns: [Joint_1, Joint_2, Joint_3, Joint_5, Joint_4, Joint_6], unit: N.m}",
            "torque of joints 4 and 5",
        ),
    ] {
        assert!(original.contains(from));
        std::fs::write(&path, original.replace(from, to)).unwrap();
        // Every explanation is an identification of its own: four seconds of the recording say as much as all of it.
        let (status, words) = identify(&path, &["--to", "4"]);
        println!("{words}");
        assert!(status == 1 && words.contains(expected), "{to}: {status} {words}");
        let (status, words) = identify(&path, &["--to", "4", "--implausible"]);
        assert_eq!(status, 0, "{words}");
    }
    std::fs::remove_dir_all(&own).unwrap();
}

#[test]
fn simulated_recordings_of_every_robot_are_accepted() {
    let own = std::env::temp_dir().join(format!("dynid-simulated-{}", std::process::id()));
    let full = ["--motions", "1", "--period", "6", "--residue", "1"];
    let weak = ["--motions", "1", "--period", "4", "--harmonics", "3", "--share", "0.5", "--residue", "1"];
    let points = ["--motions", "1", "--kind", "trapezoidal", "--points", "4", "--noise", "3"];
    let mut accepted = 0;
    for model in dynid::models::all() {
        let robot = model.robot().name.as_ref();
        for (seed, motions) in [("1", &full[..]), ("3", &weak[..]), ("4", &points[..])] {
            let mut simulate = Command::new(env!("CARGO_BIN_EXE_dynid"));
            simulate.args([
                "simulate",
                robot,
                "--seed",
                seed,
                "--rate",
                "1000",
                "--record-every",
                "2",
                "--out",
            ]);
            let made = simulate.arg(&own).args(motions).output().unwrap();
            // A motion that the robot's limits do not allow is not simulated.
            if !made.status.success() {
                println!("{robot} {seed}: {}", String::from_utf8_lossy(&made.stderr));
                continue;
            }
            let (status, words) = identify(&own.join("recording.yaml"), &[]);
            let too_short = words.contains("cannot determine");
            assert!(status == 0 || too_short, "{robot}, seed {seed}: {words}");
            accepted += usize::from(status == 0);
            std::fs::remove_dir_all(&own).unwrap();
        }
    }
    println!("{accepted} recordings accepted");
    assert!(accepted >= 24);
}

/// A recording of the tx40 as `dynid simulate` writes it, whose encoders 2 and 3 count from elsewhere by these angles.
fn seen_from_elsewhere(own: &Path, name: &str, seed: &str, [second, third]: [f64; 2]) -> PathBuf {
    let folder = own.join(name);
    let out = folder.to_str().unwrap();
    let simulate = ["simulate", "tx40", "--motions", "2", "--seed", seed, "--out", out];
    assert!(Command::new(env!("CARGO_BIN_EXE_dynid")).args(simulate).output().unwrap().status.success());
    for file in std::fs::read_dir(&folder).unwrap().map(|e| e.unwrap().path()) {
        if file.extension().is_none_or(|e| e != "csv") {
            continue;
        }
        let text = std::fs::read_to_string(&file).unwrap();
        let mut lines = text.lines();
        let mut moved = lines.next().unwrap().to_owned();
        for line in lines {
            let mut cells: Vec<String> = line.split(',').map(str::to_owned).collect();
            for (column, by) in [(2, second), (3, third)] {
                cells[column] = (cells[column].parse::<f64>().unwrap() + by).to_string();
            }
            moved += &format!("\n{}", cells.join(","));
        }
        std::fs::write(&file, moved).unwrap();
    }
    folder.join("recording.yaml")
}

#[test]
fn zeros_of_two_encoders_that_undo_each_other_are_told_by_identify_and_named_by_diagnose() {
    let own = std::env::temp_dir().join(format!("dynid-zeros-{}", std::process::id()));
    let quarter = std::f64::consts::FRAC_PI_2;
    let fitted = seen_from_elsewhere(&own, "fitted", "5", [-quarter, quarter]);
    let other = seen_from_elsewhere(&own, "other", "6", [-quarter, quarter]);
    let (status, words) = identify(&fitted, &[]);
    assert!(status == 1 && words.contains("joint 2 +") && words.contains("joint 3 -"), "{status} {words}");
    let (json, model) = (own.join("found.json"), own.join("model.json"));
    let run = |arguments: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_dynid")).args(arguments).output().unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    };
    let [fitted, other] = [&fitted, &other].map(|path| path.to_str().unwrap());
    let (json, model) = (json.to_str().unwrap(), model.to_str().unwrap());
    run(&["diagnose", fitted, "--json", json, "--out", model]);
    let read = |path: &str| -> serde_json::Value {
        serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
    };
    let found = read(json);
    let findings = found["findings"].as_array().unwrap();
    let offset = |joint: u64| {
        let is_it = |f: &&serde_json::Value| f["effect"] == "position_offset" && f["joints"][0] == joint;
        findings.iter().find(is_it).map(|f| f["parameters"]["offset"]["value"].as_f64().unwrap())
    };
    assert_eq!(findings.len(), 2, "{findings:?}");
    let [second, third] = [2, 3].map(|joint| offset(joint).expect("an offset on this joint"));
    assert!((second - quarter).abs() < 0.02 && (third + quarter).abs() < 0.05, "{second} {third}");
    // The saved model has both, one on top of the other.
    run(&["validate", model, other, "--json", json]);
    let error = read(json)["relative_error"].as_f64().unwrap();
    assert!(error < 0.02, "{error}");
    std::fs::remove_dir_all(&own).unwrap();
}
