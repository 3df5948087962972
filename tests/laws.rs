//! Laws that a user wrote down, from the file to the simulation.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use std::process::Output;

use common::{Folder, MANIFEST, error_of, json_of, moving, words_of};

fn assert_refused(output: &Output, what: &[&str]) {
    let error = error_of(output);
    assert_eq!(output.status.code(), Some(2), "{error}");
    for part in what {
        assert!(error.contains(part), "'{part}' is not in: {error}");
    }
}

/// A recording of a simulated planar_2r in which a magnet pulls at the second joint.
fn with_a_magnet(folder: &Folder) {
    let made = folder.run(&["simulate", "planar_2r", "--out", ".", "--rate", "500", "--period", "5"]);
    assert!(made.status.success(), "{}", error_of(&made));
    for entry in std::fs::read_dir(&folder.0).unwrap() {
        let path = entry.unwrap().path();
        if path.extension().is_none_or(|e| e != "csv") {
            continue;
        }
        let text = std::fs::read_to_string(&path).unwrap();
        let (header, rows) = text.split_once('\n').unwrap();
        let mut out = format!("{header}\n");
        for row in rows.lines() {
            let mut x: Vec<f64> = row.split(',').map(|x| x.parse().unwrap()).collect();
            x[4] += 2.0 * (2.0 * x[2]).sin() - 1.5 * (2.0 * x[2]).cos();
            out += &(x.iter().map(ToString::to_string).collect::<Vec<_>>().join(",") + "\n");
        }
        std::fs::write(&path, out).unwrap();
    }
}

const MAGNET: &str = "- {id: magnet, joint: 2, law: \"k1*sin(2*q2) + k2*cos(2*q2)\", unit: N.m}\n";

#[test]
fn a_law_of_the_user_is_found_saved_with_its_text_validated_and_simulated() {
    let folder = Folder::new("laws");
    with_a_magnet(&folder);
    folder.write("laws.yaml", MAGNET);
    let words = ["diagnose", "recording.yaml", "--laws", "laws.yaml", "--out", "m.json", "--json", "-"];
    let found = json_of(&folder.run(&words));
    let findings = found["findings"].as_array().unwrap();
    assert_eq!(findings.len(), 1, "{findings:?}");
    assert_eq!(findings[0]["effect"], "magnet");
    for (name, truth) in [("k1", 2.0), ("k2", -1.5)] {
        let value = findings[0]["parameters"][name]["value"].as_f64().unwrap();
        assert!((value - truth).abs() < 0.05, "{name} {value}");
    }
    // The law is in the model.
    std::fs::remove_file(folder.path("laws.yaml")).unwrap();
    let validated = folder.run(&["validate", "m.json", "recording.yaml", "--json", "-"]);
    assert!(json_of(&validated)["relative_error"].as_f64().unwrap() < 0.05);
    assert!(words_of(&folder.run(&["validate", "m.json", "recording.yaml"])).contains("magnet"));
    let simulated = folder.run(&["simulate", "m.json", "--out", "sim", "--motions", "1", "--rate", "500"]);
    assert!(simulated.status.success(), "{}", error_of(&simulated));
    let again = folder.run(&["validate", "m.json", "sim/recording.yaml", "--json", "-"]);
    assert!(json_of(&again)["relative_error"].as_f64().unwrap() < 0.05, "the plant has the law");
    let model = std::fs::read_to_string(folder.path("m.json")).unwrap();
    let changed = |from: &str, to: &str| {
        assert!(model.contains(from), "{from}");
        folder.write("changed.json", &model.replace(from, to));
    };
    changed("k1*sin(2*q2)", "k1*ddq2");
    let refused = folder.run(&["simulate", "changed.json", "--out", "sim", "--motions", "1"]);
    assert_refused(&refused, &["changed.json", "magnet", "acceleration"]);
    for (from, to, what) in [
        ("k1*sin(2*q2)", "k1*sin(2*q2", "expected ')'"),
        ("k1*sin(2*q2)", "k1*sin(2*q7)", "q7"),
        ("k1*sin(2*q2)", "k3*k1*sin(2*q2)", "does not enter linearly"),
        ("k1*sin(2*q2) + ", "", "amplitude"),
        ("\"magnet\"", "\"stribeck\"", "catalogue"),
    ] {
        changed(from, to);
        assert_refused(&folder.run(&["validate", "changed.json", "recording.yaml"]), &["changed.json", what]);
    }
}

#[test]
fn a_mistake_in_a_list_of_laws_ends_with_status_2_and_its_place() {
    let folder = Folder::new("wrong-laws");
    folder.write("motion.csv", &moving(800)).write("recording.yaml", MANIFEST);
    let with = |text: &str| {
        folder.write("laws.yaml", text);
        folder.run(&["diagnose", "recording.yaml", "--laws", "laws.yaml"])
    };
    assert_refused(
        &with("# mine\n- {id: a, joint: 2, law: \"k*abs(dq2)^p\"}\n"),
        &["laws.yaml:2:38", "'p'", "shapes: {p: ["],
    );
    assert_refused(&with(&MAGNET.replace("magnet", "payload")), &["laws.yaml:1:8", "catalogue"]);
    assert_refused(&with(&MAGNET.replace("joint: 2", "joint: 3")), &["laws.yaml:1:23", "no joint 3"]);
    assert_refused(&with("magnet"), &["laws.yaml:1:1", "expected a list of laws"]);
    assert_refused(&folder.run(&["diagnose", "recording.yaml", "--laws", "none.yaml"]), &["none.yaml"]);
}
