//! The command line as a newcomer and as another program meet it: exit status, words, JSON.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use std::path::Path;
use std::process::{Command, Output};

use common::{ARM, Folder, MANIFEST, error_of, moving, words_of};

fn assert_refused(output: &Output, status: i32, what: &[&str]) {
    let error = error_of(output);
    assert_eq!(output.status.code(), Some(status), "{error}");
    for part in what {
        assert!(error.contains(part), "'{part}' is not in: {error}");
    }
    assert!(!error.contains("panicked"), "{error}");
}

#[test]
fn wrong_input_ends_with_status_2_and_says_where() {
    let folder = Folder::new("wrong");
    folder.write("motion.csv", &moving(800)).write("recording.yaml", MANIFEST);
    folder.write("column.yaml", &MANIFEST.replace("u1", "zz"));
    folder.write("robot.yaml", &MANIFEST.replace("planar_2r", "planar_3r"));
    folder.write("joints.yaml", &MANIFEST.replace("planar_2r", "tx40"));
    folder.write("key.yaml", &MANIFEST.replace("side:", "sides:"));
    folder.write("bytes.yaml", "\u{1}\u{2}");
    assert_refused(&folder.run(&["identify", "none.yaml"]), 2, &["none.yaml"]);
    assert_refused(&folder.run(&["identify", "column.yaml"]), 2, &["motion.csv:1", "`zz`", "q1"]);
    assert_refused(&folder.run(&["identify", "robot.yaml"]), 2, &["planar_3r", "planar_2r"]);
    assert_refused(&folder.run(&["identify", "joints.yaml"]), 2, &["joints.yaml:5", "6 joints"]);
    assert_refused(&folder.run(&["identify", "key.yaml"]), 2, &["key.yaml:2", "sides"]);
    assert_refused(&folder.run(&["identify", "motion.csv"]), 2, &["not a recording YAML"]);
    assert_refused(&folder.run(&["identify", "recording.yaml", "--from", "3", "--to", "2"]), 2, &["--from"]);
    assert_refused(&folder.run(&["identify", "recording.yaml", "--band", "nan"]), 2, &["band"]);
    assert_refused(&folder.run(&["diagnose", "recording.yaml", "--band", "nan"]), 2, &["band"]);
    assert_refused(&folder.run(&["diagnose", "recording.yaml", "--standstill", "1,2,3"]), 2, &["3", "2"]);
    assert_refused(
        &folder.run(&["validate", "recording.yaml", "recording.yaml"]),
        2,
        &["recording.yaml:1:1"],
    );
    assert_refused(&folder.run(&["show", "nobody"]), 2, &["nobody", "tx40"]);
    assert_refused(&folder.run(&["show", "bytes.yaml"]), 2, &["bytes.yaml"]);
}

#[test]
fn data_that_cannot_support_an_answer_end_with_status_1_and_say_why() {
    let folder = Folder::new("data");
    folder.write("recording.yaml", MANIFEST);
    folder.write("motion.csv", "t,q1,q2,u1,u2\n");
    assert_refused(&folder.run(&["identify", "recording.yaml"]), 1, &["motion.csv", "no rows"]);
    folder.write("motion.csv", &moving(3));
    assert_refused(&folder.run(&["identify", "recording.yaml"]), 1, &["3 samples"]);
    let still: String = (0..900).map(|k| format!("{},0.3,0.4,1,1\n", k as f64 * 0.01)).collect();
    folder.write("motion.csv", &format!("t,q1,q2,u1,u2\n{still}"));
    assert_refused(&folder.run(&["identify", "recording.yaml"]), 1, &["no joint moves"]);
    assert_refused(&folder.run(&["diagnose", "recording.yaml"]), 1, &["no joint moves"]);
    let not_a_number: String = (0..900).map(|k| format!("{},NaN,0.4,1,1\n", k as f64 * 0.01)).collect();
    folder.write("motion.csv", &format!("t,q1,q2,u1,u2\n{not_a_number}"));
    assert_refused(&folder.run(&["identify", "recording.yaml"]), 1, &["not finite", "motion.csv:2"]);
}

#[test]
fn a_value_that_no_robot_can_have_is_marked_in_print_and_in_the_page() {
    let folder = Folder::new("marked");
    folder.write("motion.csv", &moving(800));
    folder.write("recording.yaml", &MANIFEST.replace("unit: N.m}", "unit: N.m, gain: [1, -1]}"));
    let refused = folder.run(&["identify", "recording.yaml"]);
    assert_refused(&refused, 1, &["recording.yaml", "sign", "joint 2", "--implausible"]);
    // What a diagnosis would find in it is a part of the mistake.
    let refused = folder.run(&["diagnose", "recording.yaml"]);
    assert_refused(&refused, 1, &["recording.yaml", "sign", "joint 2", "--implausible"]);
    let words = ["identify", "recording.yaml", "--implausible", "--report", "r.html", "--out", "m.json"];
    let output = folder.run(&words);
    let said = words_of(&output);
    let page = std::fs::read_to_string(folder.path("r.html")).unwrap();
    let model: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path("m.json")).unwrap()).unwrap();
    let doubted: Vec<&serde_json::Value> =
        model["base_parameters"].as_array().unwrap().iter().filter(|p| !p["doubt"].is_null()).collect();
    assert!(!doubted.is_empty(), "{said}");
    for p in doubted {
        let name = p["name"].as_str().unwrap();
        let line = said.lines().find(|l| l.trim_start().starts_with(&format!("{name} "))).unwrap();
        assert!(line.contains(" !"), "{line}");
        assert!(said.contains(&format!("! {name} is below zero")), "{said}");
        assert!(page.contains(&format!("! {name} is below zero")));
    }
    assert!(page.matches(" !<").count() > 0, "no mark in the table");
}

#[test]
fn angles_that_look_like_degrees_are_said_where_a_robot_is_identified() {
    let folder = Folder::new("degrees");
    folder.write("motion.csv", &moving(800));
    folder.write("arm.yaml", &ARM.replace("{j: 2, sigma: 0, alpha: 0,", "{j: 2, sigma: 0, alpha: 90,"));
    folder.write("recording.yaml", &MANIFEST.replace("planar_2r", "./arm.yaml"));
    for words in [vec!["identify", "recording.yaml"], vec!["show", "./arm.yaml"]] {
        let output = folder.run(&words);
        let said = words_of(&output) + &error_of(&output);
        assert!(said.contains("alpha is 90") && said.contains("pi/180"), "{words:?}: {said}");
    }
}

#[test]
fn every_mistake_of_a_robot_yaml_is_named_at_once_with_line_and_column() {
    let folder = Folder::new("robot");
    folder.write(
        "arm.yaml",
        "name: arm\ngravity: [0, 0, .nan]\nframes:\n  - {j: 1, sigma: 7, alpha: 0, d: 0, theta: q1, r: 0}\n  \
         - {j: 2, sigma: 0, alpha: 0, d: width, theta: q2, r: 0}\ncolour: red\n",
    );
    let output = folder.run(&["show", "./arm.yaml"]);
    assert_refused(
        &output,
        2,
        &["arm.yaml:2:", "arm.yaml:4:", "arm.yaml:5:", "arm.yaml:6:", "width", "colour"],
    );
}

#[test]
fn a_robot_given_by_path_and_the_generated_one_identify_the_same_parameters() {
    let folder = Folder::new("path");
    folder.write("motion.csv", &moving(900)).write("recording.yaml", MANIFEST);
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("robots/planar_2r.yaml");
    let run = |more: &[&str]| -> serde_json::Value {
        let mut words = vec!["identify", "recording.yaml", "--json", "-"];
        words.extend(more);
        let output = folder.run(&words);
        assert!(output.status.success(), "{}", error_of(&output));
        serde_json::from_str(&words_of(&output)).unwrap()
    };
    let (generated, recursive) = (run(&[]), run(&["--robot", robots.to_str().unwrap()]));
    let values = |value: &serde_json::Value| -> Vec<(String, f64)> {
        let parameters = value["base_parameters"].as_array().unwrap();
        parameters.iter().map(|p| (p["name"].to_string(), p["value"].as_f64().unwrap())).collect()
    };
    let (generated, recursive) = (values(&generated), values(&recursive));
    assert!(!generated.is_empty() && generated.len() == recursive.len());
    for ((name, a), (other, b)) in generated.iter().zip(&recursive) {
        assert_eq!(name, other);
        approx::assert_relative_eq!(a, b, epsilon = 1e-9, max_relative = 1e-7);
    }
}

#[test]
fn a_model_of_a_robot_given_by_path_is_validated_from_any_folder() {
    let folder = Folder::new("by-path");
    let robot = Path::new(env!("CARGO_MANIFEST_DIR")).join("robots/planar_2r.yaml");
    let robot = std::fs::read_to_string(robot).unwrap().replace("name: planar_2r", "name: arm");
    folder.write("arm.yaml", &robot).write("motion.csv", &moving(900));
    folder.write("recording.yaml", &MANIFEST.replace("planar_2r", "./arm.yaml"));
    let identified = folder.run(&["identify", "recording.yaml", "--out", "m.json"]);
    assert!(identified.status.success(), "{}", error_of(&identified));
    assert!(words_of(&identified).starts_with("arm\n"));
    let validated = folder.run(&["validate", "m.json", "recording.yaml"]);
    assert!(validated.status.success(), "{}", error_of(&validated));
    let elsewhere = Folder::new("by-path-elsewhere");
    let from = |name: &str| folder.0.join(name).display().to_string();
    let validated = elsewhere.run(&["validate", &from("m.json"), &from("recording.yaml")]);
    assert!(validated.status.success(), "{}", error_of(&validated));
}

#[test]
fn an_angle_that_is_nearly_a_right_one_is_warned_of() {
    let folder = Folder::new("rounded");
    folder.write(
        "arm.yaml",
        "name: arm\nframes:\n  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}\n  \
         - {j: 2, sigma: 0, alpha: 1.5708, d: 0, theta: q2, r: 0}\n",
    );
    let shown = folder.run(&["show", "./arm.yaml"]);
    assert!(shown.status.success());
    let warning = error_of(&shown);
    assert!(warning.contains("arm.yaml:4:29") && warning.contains("pi/2"), "{warning}");
}

#[test]
fn identify_writes_the_json_of_the_contract_and_a_model_that_validate_reads() {
    let folder = Folder::new("contract");
    folder.write("motion.csv", &moving(900)).write("recording.yaml", MANIFEST);
    let output = folder.run(&[
        "identify",
        "recording.yaml",
        "--json",
        "id.json",
        "--out",
        "m.json",
        "--report",
        "r.html",
    ]);
    assert!(output.status.success(), "{}", error_of(&output));
    let text = std::fs::read_to_string(folder.0.join("id.json")).unwrap();
    let json: serde_json::Value = serde_json::from_str(&text).unwrap();
    assert_eq!(json["robot"], "planar_2r");
    assert_eq!(json["method"], "idim-wls");
    assert_eq!(json["samples"], 900);
    assert_eq!(json["per_joint"].as_array().unwrap().len(), 2);
    for key in ["relative_error", "condition_number", "rows_left_out"] {
        assert!(json[key].is_number(), "{key}");
    }
    for key in ["name", "value", "sigma", "relative_sigma_percent", "unit"] {
        assert!(!json["base_parameters"][0][key].is_null(), "{key}");
    }
    let validated = folder.run(&["validate", "m.json", "recording.yaml", "--json", "-"]);
    let again: serde_json::Value = serde_json::from_str(&words_of(&validated)).unwrap();
    approx::assert_relative_eq!(
        again["relative_error"].as_f64().unwrap(),
        json["relative_error"].as_f64().unwrap(),
        max_relative = 1e-9
    );
    let page = std::fs::read_to_string(folder.0.join("r.html")).unwrap();
    assert!(page.contains("<svg"));
    assert!(!page.contains("src=") && !page.contains("href="), "the page needs nothing from elsewhere");
}

#[test]
fn a_challenge_tells_refused_cases_and_reads_the_truth_last() {
    let folder = Folder::new("challenge");
    let still: String = (0..900).map(|k| format!("{},0.3,0.4,1,1\n", k as f64 * 0.01)).collect();
    for case in ["cases/a", "cases/b"] {
        std::fs::create_dir_all(folder.0.join(case)).unwrap();
        folder.write(&format!("{case}/recording.yaml"), MANIFEST);
        folder.write(&format!("{case}/motion.csv"), &format!("t,q1,q2,u1,u2\n{still}"));
    }
    let truth = "effects:\n- effect: stribeck\n  fs: 4\n  joint: 2\n";
    folder.write("cases/a/truth.yaml", truth);
    folder.write("cases/b/truth.yaml", &truth.replace("stribeck", "gremlins"));
    let output = folder.run(&["challenge", "cases", "a", "--json", "-"]);
    assert!(output.status.success(), "{}", error_of(&output));
    let json: serde_json::Value = serde_json::from_str(&words_of(&output)).unwrap();
    let case = &json["cases"][0];
    assert_eq!(case["missed"][0], "stribeck@2");
    assert_eq!((&case["solved"], &json["solved"]), (&false.into(), &0.into()));
    assert!(case["refused"].as_str().unwrap().contains("no joint moves"));
    assert_refused(&folder.run(&["challenge", "cases", "b"]), 2, &["truth.yaml", "gremlins"]);
    assert_refused(&folder.run(&["challenge", "cases", "c"]), 2, &["no case starts with c", "a, b"]);
    assert_refused(&folder.run(&["challenge", "cases/a"]), 2, &["recording.yaml"]);
}

#[test]
fn simulate_excite_and_paper_refuse_what_cannot_be_with_status_2() {
    let folder = Folder::new("simulate");
    let tx40 =
        std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("robots/tx40.yaml")).unwrap();
    folder.write("bad.yaml", &tx40.replace("ZZ3: 0.0046", "ZZ3: 5.0").replace("name: tx40", "name: bad"));
    folder.write("file", "");
    let refused = |words: &[&str], what: &[&str]| assert_refused(&folder.run(words), 2, what);
    for (more, what) in [
        (["--period", "-3"], "period"),
        (["--period", "1e9"], "period"),
        (["--rate", "0"], "rate"),
        (["--rate", "1e12"], "rate"),
        (["--rate", "0.02"], "rows"),
        (["--record-every", "0"], "--record-every"),
        (["--record-every", "1000000"], "rows"),
        (["--noise", "-1"], "--noise"),
        (["--residue", "nan"], "--residue"),
        (["--ripple", "inf"], "--ripple"),
        (["--elastic", "9:1000"], "not 9"),
        (["--share", "2"], "share"),
        (["--reach", "0"], "reach"),
        (["--follow", "nowhere"], "motion1.csv"),
        (["--out", "file/x"], "file/x"),
    ] {
        let mut words = vec!["simulate", "tx40", "--motions", "1", more[0], more[1]];
        if more[0] != "--out" {
            words.extend(["--out", "out"]);
        }
        refused(&words, &[what]);
    }
    let twice = ["simulate", "tx40", "--out", "out", "--elastic", "3:1e4", "--elastic", "3:2e4"];
    refused(&twice, &["another joint", "3"]);
    refused(&["simulate", "./bad.yaml", "--out", "out"], &["link 3 cannot exist", "bad"]);
    refused(&["excite", "./bad.yaml", "--out", "out"], &["link 3 cannot exist"]);
    refused(&["excite", "tx40", "--out", "out", "--criterion", "beauty"], &["determinant", "condition"]);
    refused(&["excite", "tx40", "--out", "file", "--evaluations", "0"], &["file", "folder"]);
    refused(&["paper", "--robot", "./bad.yaml", "--seeds", "1"], &["link 3 cannot exist"]);
    refused(&["paper", "--seeds", "0"], &["--seeds", "1..1000"]);
    refused(&["paper", "--noise", "-1"], &["--noise"]);
    refused(&["paper", "--single-points", "1", "--seeds", "1"], &["points"]);
    refused(&["paper", "--out", "file/x"], &["file/x"]);
}

#[test]
fn what_is_simulated_is_identified_again() {
    let folder = Folder::new("again");
    let robots = Path::new(env!("CARGO_MANIFEST_DIR")).join("robots/scara4.yaml");
    folder.write("arm.yaml", &std::fs::read_to_string(robots).unwrap());
    // A robot given by path is found from the recording too.
    for robot in ["scara4", "./arm.yaml"] {
        let words = [
            "simulate",
            robot,
            "--out",
            "deep/out",
            "--motions",
            "2",
            "--rate",
            "2000",
            "--record-every",
            "2",
        ];
        let output = folder.run(&words);
        assert!(output.status.success(), "{}", error_of(&output));
        let output = folder.run(&["identify", "deep/out/recording.yaml", "--json", "-"]);
        assert!(output.status.success(), "{}", error_of(&output));
        let json: serde_json::Value = serde_json::from_str(&words_of(&output)).unwrap();
        assert!(json["relative_error"].as_f64().unwrap() < 0.05, "{}", json["relative_error"]);
    }
}

#[test]
fn a_reader_that_goes_away_is_no_failure() {
    use std::process::Stdio;
    let mut child = Command::new(env!("CARGO_BIN_EXE_dynid"))
        .args(["show", "tx40", "--base"])
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    drop(child.stdout.take());
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success(), "{}", error_of(&output));
}

#[test]
fn a_motion_that_tells_laws_apart_is_written_with_how_far_it_puts_them() {
    let folder = Folder::new("tell");
    let words =
        ["excite", "planar_2r", "--tell", "stribeck,presliding_hysteresis", "--joint", "1", "--out", "m"];
    let said = words_of(&folder.run(&words));
    for part in ["Stribeck", "an ordinary exciting motion", "least", "multiples of the noise"] {
        assert!(said.contains(part), "'{part}' is not in: {said}");
    }
    let plan = std::fs::read_to_string(folder.path("m/motions.yaml")).unwrap();
    assert!(plan.contains("file: motion1-"), "{plan}");
    let with = |tell: &str, joint: &str| {
        folder.run(&["excite", "planar_2r", "--tell", tell, "--joint", joint, "--out", "n"])
    };
    assert_refused(&with("stribeck,nothing", "1"), 2, &["nothing", "catalogue"]);
    assert_refused(&with("stribeck", "1"), 2, &["two laws"]);
    assert_refused(&with("stribeck,payload", "1"), 2, &["payload", "no law of that joint"]);
    assert_refused(&with("stribeck,spring", "7"), 2, &["--joint 7"]);
}

#[test]
fn a_saved_model_is_a_reference_and_one_of_another_table_is_refused() {
    let folder = Folder::new("reference");
    folder.write("motion.csv", &moving(1500)).write("arm.yaml", ARM);
    folder.write("recording.yaml", &MANIFEST.replace("planar_2r", "./arm.yaml"));
    let saved = folder.run(&["identify", "recording.yaml", "--out", "m.json"]);
    assert_eq!(saved.status.code(), Some(0), "{}", error_of(&saved));
    let model: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path("m.json")).unwrap()).unwrap();
    let count = model["covariance"]["of"].as_array().unwrap().len();
    assert_eq!(count, model["base_parameters"].as_array().unwrap().len());
    assert_eq!(model["covariance"]["upper"].as_array().unwrap().len(), count * (count + 1) / 2);
    let against = folder.run(&["diagnose", "recording.yaml", "--reference", "m.json", "--json", "d.json"]);
    let said = words_of(&against) + &error_of(&against);
    assert!(said.contains("Compared with a model"), "{said}");
    assert!(said.contains("is the one that is diagnosed"), "{said}");
    folder.write("arm.yaml", &ARM.replace("l1: 0.5", "l1: 0.7"));
    let other = folder.run(&["diagnose", "recording.yaml", "--reference", "m.json"]);
    assert_refused(&other, 2, &["m.json", "0.5", "0.7"]);
}

#[test]
fn a_reference_is_taken_with_its_motions_where_they_are_as_they_were() {
    let folder = Folder::new("origin");
    folder.make("before").make("now").make("models");
    folder.write("before/motion.csv", &moving(1500)).write("before/recording.yaml", MANIFEST);
    folder.write("now/motion.csv", &moving(1400)).write("now/recording.yaml", MANIFEST);
    let saved = folder.run(&["diagnose", "before/recording.yaml", "--out", "models/m.json"]);
    assert_eq!(saved.status.code(), Some(0), "{}", error_of(&saved));
    let model: serde_json::Value =
        serde_json::from_str(&std::fs::read_to_string(folder.path("models/m.json")).unwrap()).unwrap();
    assert_eq!(model["recording"]["path"], "../before/recording.yaml");
    let against = || {
        let said = folder.run(&["diagnose", "now/recording.yaml", "--reference", "models/m.json"]);
        assert_eq!(said.status.code(), Some(0), "{}", error_of(&said));
        words_of(&said)
    };
    let said = against();
    assert!(said.contains("Compared with the motions from before"), "{said}");
    // A data file that is another is not what the model is from.
    folder.write("before/motion.csv", &moving(1501));
    let said = against();
    assert!(said.contains("recording.yaml, has changed since"), "{said}");
    std::fs::remove_file(folder.path("before/recording.yaml")).unwrap();
    let said = against();
    assert!(said.contains("recording.yaml, is not there"), "{said}");
}
