//! A saved model alone is enough, from any folder; and a robot is never another one of the same name.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use common::{ARM, Folder, MANIFEST, error_of, json_of, moving, words_of};

/// A folder with a planar arm given by path, a recording of it, and its model.
fn identified(name: &str) -> Folder {
    let folder = Folder::new(name);
    folder.write("arm.yaml", ARM).write("motion.csv", &moving(900));
    folder.write("recording.yaml", &MANIFEST.replace("planar_2r", "./arm.yaml"));
    let output = folder.run(&["identify", "recording.yaml", "--out", "m.json"]);
    assert!(output.status.success(), "{}", error_of(&output));
    folder
}

#[test]
fn a_model_of_a_robot_given_by_path_is_validated_and_simulated_without_its_yaml() {
    let folder = identified("alone");
    std::fs::remove_file(folder.path("arm.yaml")).unwrap();
    let elsewhere = Folder::new("alone-elsewhere");
    std::fs::rename(folder.path("m.json"), elsewhere.path("moved.json")).unwrap();
    let recording = folder.path("recording.yaml").display().to_string();
    let output = elsewhere.run(&["validate", "moved.json", &recording, "--json", "-"]);
    assert!(output.status.success(), "{}", error_of(&output));
    assert!(json_of(&output)["relative_error"].as_f64().unwrap() < 0.2);
    assert!(json_of(&output)["table"].is_object());
    let output = elsewhere.run(&["simulate", "moved.json", "--out", "run", "--follow", "none.csv"]);
    let error = error_of(&output);
    assert!(error.contains("motion1.csv") && !error.contains("arm.yaml"), "{error}");
}

#[test]
fn a_table_that_was_edited_since_is_said_and_the_models_own_is_used() {
    let folder = identified("edited");
    let before = json_of(&folder.run(&["validate", "m.json", "recording.yaml", "--json", "-"]));
    folder.write("arm.yaml", &ARM.replace("l1: 0.5", "l1: 0.7"));
    let output = folder.run(&["validate", "m.json", "recording.yaml", "--json", "-"]);
    let error = error_of(&output);
    assert!(output.status.success(), "{error}");
    assert!(error.contains("d of frame 2 was 0.5, now 0.7") && error.contains("--robot"), "{error}");
    assert_eq!(json_of(&output)["relative_error"], before["relative_error"]);
    let asked = folder.run(&["validate", "m.json", "recording.yaml", "--robot", "arm.yaml", "--json", "-"]);
    assert!(asked.status.success() && error_of(&asked).contains("another table"), "{}", error_of(&asked));
    assert_ne!(json_of(&asked)["relative_error"], before["relative_error"]);
}

#[test]
fn a_model_of_another_robot_is_refused() {
    let folder = identified("other");
    folder.write("recording.yaml", MANIFEST);
    let output = folder.run(&["validate", "m.json", "recording.yaml"]);
    let error = error_of(&output);
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(error.contains("model of arm") && error.contains("planar_2r"), "{error}");
}

#[test]
fn a_robot_named_by_a_recording_is_the_one_beside_it_and_never_a_namesake() {
    let folder = Folder::new("beside");
    let long = ARM.replace("l1: 0.5", "l1: 2.5").replace("name: arm", "name: long_arm");
    // A robot of the same file name in the working directory.
    folder.write("arm.yaml", &long).make("data");
    folder.write("data/arm.yaml", ARM).write("data/motion.csv", &moving(900));
    folder.write("data/recording.yaml", &MANIFEST.replace("planar_2r", "arm.yaml"));
    let output = folder.run(&["identify", "data/recording.yaml"]);
    assert!(words_of(&output).starts_with("arm\n"), "{}{}", words_of(&output), error_of(&output));
    // Without one beside the recording the namesake is offered, not taken.
    std::fs::remove_file(folder.path("data/arm.yaml")).unwrap();
    let output = folder.run(&["identify", "data/recording.yaml"]);
    let error = error_of(&output);
    assert_eq!(output.status.code(), Some(2), "{error}");
    assert!(error.contains("data/arm.yaml") && error.contains("--robot arm.yaml"), "{error}");
    // The command line is relative to the working directory.
    let output = folder.run(&["identify", "data/recording.yaml", "--robot", "arm.yaml", "--implausible"]);
    assert!(words_of(&output).starts_with("long_arm\n"), "{}", error_of(&output));
}

#[test]
fn a_field_that_cannot_be_is_named_with_its_file() {
    let folder = identified("fields");
    let text = std::fs::read_to_string(folder.path("m.json")).unwrap();
    let mut model: serde_json::Value = serde_json::from_str(&text).unwrap();
    model["effects"] = serde_json::json!([{
        "effect": "stribeck", "place": {"joint": 9}, "joints": [1], "shape": [0.1], "amplitude": [1.0],
        "sigma": [0.1], "scale": null
    }]);
    folder.write("bad.json", &model.to_string());
    for words in [&["validate", "bad.json", "recording.yaml"][..], &["simulate", "bad.json", "--out", "x"]] {
        let output = folder.run(words);
        let error = error_of(&output);
        assert_eq!(output.status.code(), Some(2), "{error}");
        assert!(error.contains("bad.json:effects[0].place.joint"), "{error}");
    }
}
