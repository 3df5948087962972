//! Rows of a comparison as files, and the pages that are made of the same.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use common::{Folder, error_of, json_of};

fn simulated(name: &str) -> Folder {
    let folder = Folder::new(name);
    run(
        &folder,
        "simulate planar_2r --out . --motions 2 --period 4 --rate 1000 --record-every 2 --noise 1 --seed 7",
    );
    run(&folder, "identify recording.yaml --out m.json");
    folder
}

fn run(folder: &Folder, words: &str) {
    let output = folder.run(&words.split(' ').collect::<Vec<_>>());
    assert!(output.status.success(), "{words}: {}", error_of(&output));
}

/// The columns of a CSV by their names.
fn column(text: &str, name: &str) -> Vec<f64> {
    let mut lines = text.lines();
    let at = lines.next().unwrap().split(',').position(|n| n == name).unwrap_or_else(|| panic!("{name}"));
    lines.map(|line| line.split(',').nth(at).unwrap().parse().unwrap()).collect()
}

#[test]
fn the_error_of_each_joint_is_that_of_the_rows_that_are_written() {
    let folder = simulated("residuals-errors");
    for (command, last) in [
        ("identify recording.yaml", "per_joint"),
        ("validate m.json recording.yaml", "per_joint"),
        ("diagnose recording.yaml", "after"),
    ] {
        let mut words: Vec<&str> = command.split(' ').collect();
        words.extend(["--residuals", "rows.csv", "--json", "-"]);
        let output = folder.run(&words);
        assert!(output.status.success(), "{}", error_of(&output));
        let json = json_of(&output);
        let told = if last == "after" { &json["after"]["per_joint"] } else { &json[last] };
        let text = std::fs::read_to_string(folder.path("rows.csv")).unwrap();
        for j in 1..=2 {
            let of = |name: &str| column(&text, &format!("{name}{j}"));
            let (measured, predicted, left) = (of("tau"), of("predicted"), of("residual"));
            assert!(measured.len() > 100);
            let (mut squares, mut whole) = (0.0, 0.0);
            for (k, used) in of("used").into_iter().enumerate() {
                assert!((measured[k] - predicted[k] - left[k]).abs() < 1e-9);
                squares += used * left[k].powi(2);
                whole += used * measured[k].powi(2);
            }
            let (ours, theirs) = ((squares / whole).sqrt(), told[j - 1].as_f64().unwrap());
            assert!((ours - theirs).abs() < 1e-9 * theirs.max(1e-3), "{command}: {ours} {theirs}");
        }
        assert_eq!(command.starts_with("diagnose"), text.contains("before1"));
    }
}

#[test]
fn a_log_of_residuals_is_a_recording_and_holds_what_the_tables_hold() {
    let folder = simulated("residuals-formats");
    for file in ["rows.csv", "rows.parquet", "rows.mcap"] {
        run(&folder, &format!("validate m.json recording.yaml --residuals {file}"));
    }
    let text = std::fs::read_to_string(folder.path("rows.csv")).unwrap();
    let columns = "time: {rate: 100}\nposition: {columns: [q1, q2]}\ntorque: {columns: [predicted1, predicted2], unit: N.m}\n";
    folder
        .write("table.yaml", &format!("robot: planar_2r\n{columns}trajectories: [{{file: rows.parquet}}]\n"));
    let log = "robot: planar_2r\njoints: [joint1, joint2]\ntorque: {unit: N.m}\n\
               trajectories: [{file: rows.mcap, topic: /motion1/measured}]\n";
    folder.write("log.yaml", log);
    let read = |name: &str| {
        let manifest = dynid_runtime::recording::Manifest::read(&folder.path(name)).unwrap();
        let robot = dynid::models::find("planar_2r").unwrap().robot().clone();
        dynid_runtime::recording::load(&manifest, &robot).unwrap().trajectories.remove(0)
    };
    let table = read("table.yaml");
    // Where the second motion begins, the arm is elsewhere: the reader cuts there.
    let first = column(&text, "motion").iter().filter(|m| **m == 1.0).count();
    assert_eq!(table.torque[1], column(&text, "predicted2")[..first]);
    let log = read("log.yaml");
    assert_eq!(log.torque[0], column(&text, "tau1")[..first]);
    assert_eq!(log.position[1], column(&text, "q2")[..first]);
}

#[test]
fn another_end_of_a_name_is_refused_and_a_page_says_where_it_comes_from() {
    let folder = simulated("residuals-names");
    let output = folder.run(&["validate", "m.json", "recording.yaml", "--residuals", "rows.xlsx"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(error_of(&output).contains(".csv, .parquet or .mcap"), "{}", error_of(&output));
    run(&folder, "validate m.json recording.yaml --report r.html");
    let page = std::fs::read_to_string(folder.path("r.html")).unwrap();
    run(&folder, "validate m.json recording.yaml --report r.html");
    assert_eq!(page, std::fs::read_to_string(folder.path("r.html")).unwrap());
    let known = "dynid validate m.json recording.yaml --report r.html";
    assert!(page.contains(known) && page.contains("m.json</td>") && page.contains("recording.yaml</td>"));
    let folder_name = folder.0.display().to_string();
    assert!(!page.contains(&folder_name), "a path of the machine that was not asked for");
}
