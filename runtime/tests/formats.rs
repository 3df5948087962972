//! MCAP, rosbag2 folders and Parquet as the official packages write them: `data/formats/make.py` made the files, and says
//! what is in them.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

use std::path::{Path, PathBuf};

use dynid_runtime::model::{Drive, Frame, JointKind, Limits, Robot};
use dynid_runtime::recording::{Manifest, Recording, load};

const ROWS: usize = 40;
const LOG: &str =
    "robot: arm\njoints: [elbow, shoulder]\ntorque: {unit: N.m}\ntrajectories: [{file: FILE}]\n";
const TABLE: &str = "robot: arm\ntime: {column: t}\nposition: {columns: [q1, q2]}\nvelocity: {columns: [dq1, dq2]}\n\
    torque: {columns: [u1, u2], unit: N.m}\ntrajectories: [{file: FILE}]\n";

fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/formats")
}

fn robot() -> Robot {
    let drive = Drive { gear: vec![1.0, 0.0, 0.0, 1.0].into(), coupled_friction: vec![].into() };
    let frames = vec![Frame::on_base(JointKind::Revolute); 2];
    Robot::with_standard_as_base("arm", [0.0; 3], frames, drive, Limits::default())
}

fn read_in(folder: &Path, text: &str) -> Result<Recording, String> {
    let manifest =
        Manifest::parse(&folder.join("recording.yaml"), text.as_bytes()).map_err(|e| e.to_string())?;
    load(&manifest, &robot()).map_err(|e| e.to_string())
}

fn read(text: &str) -> Result<Recording, String> {
    read_in(&folder(), text)
}

#[track_caller]
fn refused(text: &str, words: &[&str]) {
    let error = read(text).expect_err(text);
    for word in words {
        assert!(error.contains(word), "`{word}` is not in: {error}");
    }
}

/// That a recording holds rows `first..first + count` of what the script wrote, by the formulas that it names.
#[track_caller]
fn assert_rows(recording: &Recording, rows: impl Iterator<Item = usize>, velocity: bool, what: &str) {
    let [trajectory] = &recording.trajectories[..] else {
        panic!("{what}: {}", recording.trajectories.len())
    };
    let rows: Vec<usize> = rows.collect();
    assert_eq!(trajectory.time.len(), rows.len(), "{what}");
    assert_eq!(trajectory.velocity.is_some(), velocity, "{what}");
    for (at, &row) in rows.iter().enumerate() {
        let k = row as f64;
        assert!((trajectory.time[at] - 0.01 * k).abs() < 1e-6, "{what}: {}", trajectory.time[at]);
        let of = |channel: &[Vec<f64>]| [channel[0][at], channel[1][at]];
        assert_eq!(of(&trajectory.position), [k / 128.0, -k / 256.0], "{what} row {row}");
        assert_eq!(of(&trajectory.torque), [1.0 + k / 16.0, 2.0 - k / 8.0], "{what} row {row}");
        if let Some(velocity) = &trajectory.velocity {
            assert_eq!(of(velocity), [k / 64.0, -k / 32.0], "{what} row {row}");
        }
    }
}

#[test]
fn joints_are_read_by_name_from_every_kind_of_mcap_file() {
    for name in ["zstd", "lz4", "chunked", "unchunked", "unindexed", "big_endian", "dynamic"] {
        let file = format!("{name}.mcap");
        let recording = read(&LOG.replace("FILE", &file)).unwrap();
        assert_rows(&recording, 0..ROWS, false, name);
        assert!(recording.rows.notes.is_empty(), "{name}: {:?}", recording.rows.notes);
    }
    let with_speeds = LOG.replace("FILE", "zstd.mcap") + "velocity: {unit: rad/s}\n";
    assert_rows(&read(&with_speeds).unwrap(), 0..ROWS, true, "with speeds");
    let named = "robot: arm\ntime: {column: log_time}\nposition: {columns: [elbow.position, shoulder.position]}\n\
                 torque: {columns: [elbow.effort, shoulder.effort]}\ntrajectories: [{file: lz4.mcap}]\n";
    assert_rows(&read(named).unwrap(), 0..ROWS, false, "signals by name");
}

#[test]
fn a_window_counts_from_the_first_message() {
    let text = LOG.replace("FILE", "zstd.mcap, topic: /joint_states, from: 0.095, to: 0.305");
    assert_rows(&read(&text).unwrap(), 10..31, false, "window");
}

#[test]
fn the_files_of_a_bag_are_one_log() {
    assert_rows(&read(&LOG.replace("FILE", "bag")).unwrap(), 0..ROWS, false, "bag");
    // Without metadata.yaml the files are those of the folder, by number.
    let copy = std::env::temp_dir().join(format!("dynid-bag-{}", std::process::id()));
    std::fs::create_dir_all(copy.join("bag")).unwrap();
    for (from, to) in [("bag_0.mcap", "run_2.mcap"), ("bag_1.mcap", "run_10.mcap")] {
        std::fs::copy(folder().join("bag").join(from), copy.join("bag").join(to)).unwrap();
    }
    let read = read_in(&copy, &LOG.replace("FILE", "bag"));
    let _ = std::fs::remove_dir_all(&copy);
    assert_rows(&read.unwrap(), 0..ROWS, false, "folder");
}

#[test]
fn publishers_of_one_topic_are_put_together_by_stamp_and_others_passed_over() {
    let recording = read(&LOG.replace("FILE", "several.mcap")).unwrap();
    assert_rows(&recording, 0..ROWS, false, "several");
    let notes = recording.rows.notes.join("\n");
    assert!(notes.contains("8 messages of /joint_states lack a signal"), "{notes}");
}

#[test]
fn of_a_file_that_was_cut_off_or_damaged_what_is_whole_is_read() {
    let recording = read(&LOG.replace("FILE", "truncated.mcap")).unwrap();
    let rows = recording.trajectories[0].time.len();
    assert!((20..30).contains(&rows), "{rows}");
    assert_rows(&recording, 0..rows, false, "truncated");
    assert!(
        recording.rows.notes[0].contains("truncated.mcap: the file was cut off"),
        "{:?}",
        recording.rows.notes
    );
    let recording = read(&LOG.replace("FILE", "flipped.mcap")).unwrap();
    assert!(recording.rows.notes[0].contains("checksum is wrong"), "{:?}", recording.rows.notes);
    let rows: usize = recording.trajectories.iter().map(|t| t.time.len()).sum();
    assert!((25..40).contains(&rows), "{rows}");
}

#[test]
fn what_a_log_lacks_is_told_with_what_it_has() {
    let with = |file: &str| LOG.replace("FILE", file);
    refused(
        &with("zstd.mcap, topic: /joint_state"),
        &["`/joint_state`", "did you mean `/joint_states`", "40 messages"],
    );
    refused(&with("two_topics.mcap"), &["say which", "/arm/joint_states (sensor_msgs/msg/JointState, 40"]);
    read(&with("two_topics.mcap, topic: /arm/joint_states")).unwrap();
    refused(
        &with("zstd.mcap").replace("elbow", "elbov"),
        &["`elbov`", "did you mean `elbow`", "elbow, shoulder"],
    );
    refused(&with("no_effort.mcap"), &["`elbow.effort` is in none of 40 messages"]);
    refused(&with("unstamped.mcap"), &["header stamps", "time: {column: log_time}"]);
    let by_log_time = with("unstamped.mcap") + "time: {column: log_time}\n";
    assert_rows(&read(&by_log_time).unwrap(), 0..ROWS, false, "log time");
    refused(&with("json.mcap"), &["no topic holds JointState", "/chatter (std_msgs/msg/String, 1 messages)"]);
    refused(&with("json.mcap, topic: /chatter"), &["`json`"]);
    refused(
        &with("zstd.mcap").replace("{unit: N.m}", "{}"),
        &["recording.yaml:3:", "motor's current", "unit: N.m"],
    );
    refused(&with("zstd.mcap").replace("torque: {unit: N.m}\n", ""), &["no 'torque'", "unit: A"]);
    refused(&with("zstd.mcap").replace("[elbow, shoulder]", "[elbow]"), &["joints", "1 named", "2 joints"]);
    refused(
        &with("zstd.mcap").replace("[elbow, shoulder]", "[elbow, elbow]"),
        &["recording.yaml:2:", "elbow"],
    );
    refused(&with("snappy.parquet"), &["snappy.parquet", "`columns`"]);
    refused(&TABLE.replace("FILE", "zstd.mcap"), &["`q1`", "joint.position"]);
    refused(&TABLE.replace("FILE", "snappy.parquet, topic: /a"), &["`topic`"]);
}

#[test]
fn bags_that_are_not_read_are_refused_with_how_to_convert_them() {
    let folder = std::env::temp_dir().join(format!("dynid-db3-{}", std::process::id()));
    std::fs::create_dir_all(folder.join("old")).unwrap();
    std::fs::write(folder.join("old/old_0.db3"), "SQLite format 3\0").unwrap();
    let errors =
        ["old", "old/old_0.db3"].map(|file| read_in(&folder, &LOG.replace("FILE", file)).unwrap_err());
    std::fs::write(
        folder.join("old/metadata.yaml"),
        "rosbag2_bagfile_information:\n  storage_identifier: sqlite3\n  relative_file_paths: [old_0.db3]\n",
    )
    .unwrap();
    let said = read_in(&folder, &LOG.replace("FILE", "old")).unwrap_err();
    let _ = std::fs::remove_dir_all(&folder);
    for error in errors.iter().chain([&said]) {
        assert!(error.contains("ros2 bag convert -i old") && error.contains("storage_id: mcap"), "{error}");
    }
}

#[test]
fn columns_are_read_from_parquet_files_of_every_codec() {
    for name in ["snappy", "zstd", "lz4", "none", "gzip", "brotli", "pages_v2"] {
        let recording = read(&TABLE.replace("FILE", &format!("{name}.parquet"))).unwrap();
        assert_rows(&recording, 0..ROWS, true, name);
    }
    let by_index = "robot: arm\ntime: {column: 0}\nposition: {columns: [1, 2]}\ntorque: {columns: [5, 6]}\n\
                    trajectories: [{file: snappy.parquet}]\n";
    assert_rows(&read(by_index).unwrap(), 0..ROWS, false, "by index");
}

#[test]
fn stamps_of_nanoseconds_and_narrow_numbers_are_read_and_gaps_are_left_out() {
    let text = TABLE
        .replace("FILE", "types.parquet")
        .replace("column: t", "column: t, unit: ns, from_first_row: true");
    let recording = read(&text).unwrap();
    assert_rows(&recording, (0..ROWS).filter(|k| ![7, 8].contains(k)), true, "types");
    assert_eq!((recording.rows.left_out, recording.rows.examples[0].line), (2, 8));
}

#[test]
fn a_unit_of_stamps_that_is_not_said_is_that_of_their_type_or_of_their_steps_and_told() {
    let from_first = |unit: &str| format!("column: t, {unit}from_first_row: true");
    let with = |file: &str, unit: &str| TABLE.replace("FILE", file).replace("column: t", &from_first(unit));
    let typed = read(&with("types.parquet", "")).unwrap();
    assert_rows(&typed, (0..ROWS).filter(|k| ![7, 8].contains(k)), true, "by type");
    assert!(typed.rows.notes[0].contains("stamps are in ns, by the type"), "{:?}", typed.rows.notes);
    refused(&with("types.parquet", "unit: ms, "), &["recording.yaml:2:", "in ns", "`unit: ns`"]);
    let whole = read(&with("whole.parquet", "")).unwrap();
    assert_rows(&whole, 0..ROWS, true, "by steps");
    assert!(whole.rows.notes[0].contains("taken as ms (`time: {unit: ms}`"), "{:?}", whole.rows.notes);
    let said = read(&with("whole.parquet", "unit: ms, ")).unwrap();
    assert_rows(&said, 0..ROWS, true, "said");
    assert!(said.rows.notes.is_empty(), "{:?}", said.rows.notes);
    let seconds = read(&with("whole.parquet", "unit: s, ")).unwrap();
    assert!((seconds.trajectories[0].time[1] - 10.0).abs() < 1e-9, "what is said holds");
}

#[test]
fn messages_of_any_type_are_read_by_the_fields_of_their_definition() {
    let fields = "fields: {position: actual.positions, velocity: actual.velocities, torque: actual.effort}\n";
    let log = LOG.replace("FILE", "controller.mcap, topic: /arm_controller/state") + fields;
    assert_rows(&read(&log).unwrap(), 0..ROWS, false, "fields");
    assert_rows(&read(&format!("{log}velocity: {{unit: rad/s}}\n")).unwrap(), 0..ROWS, true, "with speeds");
    let by_place = "robot: arm\ntime: {column: header.stamp}\ntorque: {columns: ['actual.effort[elbow]', \
        'actual.effort[shoulder]'], unit: N.m}\nposition: {columns: ['actual.positions[elbow]', 'actual.positions[shoulder]']}\n\
        trajectories: [{file: controller.mcap, topic: /arm_controller/state}]\n";
    assert_rows(&read(by_place).unwrap(), 0..ROWS, false, "columns");
    let scalar =
        by_place.replace("'actual.effort[elbow]'", "load").replace("'actual.effort[shoulder]'", "'flags[1]'");
    let recording = read(&scalar).unwrap();
    let torque = &recording.trajectories[0].torque;
    assert_eq!((torque[0][24], torque[1][24]), (3.0, 2.0));
}

#[test]
fn fields_that_are_not_there_are_told_with_those_that_are() {
    let log = LOG.replace("FILE", "controller.mcap, topic: /arm_controller/state");
    let fields = |text: &str| format!("{log}fields: {{{text}}}\n");
    let good = "position: actual.positions, torque: actual.effort";
    refused(
        &log,
        &["JointTrajectoryControllerState", "`fields: {position:", "look FILE --topic /arm_controller/state"],
    );
    let by_name = log
        .replace("joints: [elbow, shoulder]", "time: {column: header.stamp}")
        .replace("{unit: N.m}", "{columns: [a.b, load]}")
        + "position: {columns: [load, load]}\n";
    refused(&by_name, &["`a.b`: there is no field `a`", "actual.positions[]", "load"]);
    refused(
        &log.replace(", topic: /arm_controller/state", ""),
        &["no topic holds JointState", "/arm_controller/state"],
    );
    refused(
        &fields(&good.replace("positions", "position")),
        &["there is no field `position`", "did you mean `positions`"],
    );
    refused(&fields(&good.replace("actual.effort", "load")), &["`load` is one number"]);
    refused(
        &fields(good).replace("[elbow,", "[elbov,"),
        &["no joint `elbov`", "did you mean `elbow`", "shoulder"],
    );
    refused(
        &fields(&format!("{good}, names: header.frame_id")),
        &["there is no list of names (header.frame_id)"],
    );
    refused(&(fields(good) + "velocity: {unit: rad/s}\n"), &["recording.yaml:5:", "fields", "no path to it"]);
    refused(
        &TABLE.replace("FILE", "zstd.mcap").replace("torque", "fields: {position: a, torque: b}\ntorque"),
        &["fields", "joints"],
    );
    refused(
        &fields("position: desired.positions, torque: actual.accelerations"),
        &["`actual.accelerations[elbow]` is in none of 40"],
    );
}

#[test]
fn numbers_of_a_list_are_columns() {
    for name in ["lists", "lists_snappy"] {
        for list in ["observation.state", "action"] {
            let text = format!(
                "robot: arm\ntime: {{column: timestamp}}\nposition: {{columns: ['{list}[0]', '{list}[1]']}}\n\
                 torque: {{columns: ['{list}[2]', '{list}[3]']}}\ntrajectories: [{{file: {name}.parquet}}]\n"
            );
            assert_rows(&read(&text).unwrap(), 0..ROWS, false, name);
            refused(&text.replace("[3]", "[4]"), &["no number 4", "its lists have 4"]);
            refused(
                &text.replace(&format!("'{list}[0]'"), list),
                &["holds a list", &format!("\"{list}[0]\"")],
            );
        }
    }
}

#[test]
fn what_a_parquet_file_lacks_is_told_with_what_it_has() {
    let with = |from: &str, to: &str| TABLE.replace("FILE", "types.parquet").replace(from, to);
    refused(&with("dq2", "dq3"), &["`dq3`", "did you mean", "t, q1, q2, dq1"]);
    refused(&with("dq2", "task"), &["`task`", "texts"]);
    refused(&TABLE.replace("FILE", "none.parquet").replace("columns: [q1, q2]", "columns: [1, 77]"), &["77"]);
    let folder = std::env::temp_dir().join(format!("dynid-no-parquet-{}", std::process::id()));
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("a.parquet"), "t,q1\n").unwrap();
    std::fs::write(folder.join("a.mcap"), "t,q1\n").unwrap();
    let errors = [TABLE, LOG].map(|text| {
        let file = if text == TABLE { "a.parquet" } else { "a.mcap" };
        read_in(&folder, &text.replace("FILE", file)).unwrap_err()
    });
    let _ = std::fs::remove_dir_all(&folder);
    assert!(errors[0].contains("no Parquet file") && errors[1].contains("no MCAP file"), "{errors:?}");
}

#[test]
fn a_log_says_when_it_began_and_which_files_were_read() {
    let manifest = |text: &str| Manifest::parse(&folder().join("recording.yaml"), text.as_bytes()).unwrap();
    for file in ["chunked.mcap", "big_endian.mcap", "bag", "zstd.mcap"] {
        assert_eq!(manifest(&LOG.replace("FILE", file)).begun(), Some(1_700_000_000), "{file}");
    }
    // Nothing is made up where nothing is said.
    assert_eq!(manifest(&LOG.replace("FILE", "unstamped.mcap")).begun(), None);
    assert_eq!(manifest(&TABLE.replace("FILE", "none.parquet")).begun(), None);
    let files = |text: &str| -> Vec<String> {
        manifest(text)
            .data_files()
            .into_iter()
            .map(|(name, path)| {
                assert!(path.is_file());
                name
            })
            .collect()
    };
    assert_eq!(files(&TABLE.replace("FILE", "none.parquet")), ["none.parquet"]);
    let bag = files(&LOG.replace("FILE", "bag"));
    assert!(bag.len() > 1 && bag.iter().all(|name| name.starts_with("bag/")), "{bag:?}");
}
