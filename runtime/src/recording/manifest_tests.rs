use std::path::Path;

use proptest::prelude::*;

use crate::recording::{Column, Manifest, Quantity, RecordingError, Side, Time};

const WHOLE: &str = r#"
robot: tx40
title: all keys at once
side: motor
layout: {header: false, delimiter: ";", decimal: ",", skip: 2}
time: {column: t, unit: ms, from_first_row: true, file: clock.csv}
position: {file: pos.csv, columns: [a, 1], unit: [rad, deg], offset: [0.1, -2], gain: [1, -1]}
velocity: {file: vel.csv, columns: [3, 4], unit: rpm}
torque: {file: cur.csv, columns: [5, 6], unit: A, gain: [14.87, 13.26]}
trajectories:
  - {file: one.csv, from: 0.5, to: 7.25}
  - {file: two.csv, fixed: [1, 2]}
"#;

fn parse(text: &str) -> Result<Manifest, RecordingError> {
    Manifest::parse(Path::new("dir/rec.yaml"), text.as_bytes())
}

#[test]
fn every_key_of_the_contract_is_read() {
    let m = parse(WHOLE).expect("a whole manifest");
    assert_eq!((m.robot.as_str(), m.title.as_str(), m.side), ("tx40", "all keys at once", Side::Motor));
    assert_eq!(m.folder, Path::new("dir"));
    assert!(!m.layout.header);
    assert_eq!((m.layout.delimiter, m.layout.decimal, m.layout.skip), (b';', b',', 2));
    match &m.time {
        Time::Column { column, unit, from_first_row, file } => {
            assert_eq!(*column, Column::Name("t".into()));
            let factor = unit.as_ref().map(|unit| unit.factor);
            assert_eq!((factor, *from_first_row, file.as_deref()), (Some(1e-3), true, Some("clock.csv")));
        }
        Time::Rate(_) => panic!("a column was given"),
    }
    assert_eq!(m.position.columns, [Column::Name("a".into()), Column::Index(1)]);
    assert_eq!(m.position.unit.iter().map(|u| u.name.as_str()).collect::<Vec<_>>(), ["rad", "deg"]);
    assert_eq!(m.position.offset, [0.1, -2.0]);
    assert_eq!(m.position.gain, [1.0, -1.0]);
    assert_eq!(m.velocity.map(|v| v.unit[0].quantity), Some(Quantity::AngularVelocity));
    assert_eq!(m.torque.gain, [14.87, 13.26]);
    assert_eq!((m.trajectories[0].from, m.trajectories[0].to), (Some(0.5), Some(7.25)));
    assert_eq!(m.trajectories[1].fixed, [1, 2]);
}

#[test]
fn what_is_not_said_has_the_contracts_defaults() {
    let m = parse("robot: arm\ntime: {rate: 100}\nposition: {file: a.csv, columns: [q]}\ntorque: {file: a.csv, columns: [u]}")
        .expect("a short manifest");
    assert_eq!((m.side, m.time.clone()), (Side::Joint, Time::Rate(100.0)));
    assert!(m.layout.header && m.layout.delimiter == b',');
    assert_eq!(m.trajectories.len(), 1, "no list means the whole file");
}

/// Each mistake, the line it is told at, and words the message must have.
#[test]
fn mistakes_are_told_with_their_place_and_what_was_expected() {
    let cases: &[(&str, &str, usize, &[&str])] = &[
        ("robot: tx40", "robott: tx40", 2, &["unknown field `robott`", "expected one of", "robot"]),
        ("side: motor", "side: both", 4, &["both", "joint", "motor"]),
        ("unit: rpm", "unit: furlong", 8, &["furlong", "rad/s"]),
        ("unit: ms", "unit: rad", 6, &["rad", "time"]),
        ("unit: A", "unit: [A, 7]", 9, &["7"]),
        ("delimiter: \";\"", "delimiter: abc", 5, &["abc", "one ASCII character"]),
        ("delimiter: \";\"", "delimiter: \",\"", 5, &["same"]),
        ("columns: [3, 4]", "columns: 3", 8, &["sequence"]),
        ("columns: [3, 4]", "columns: [3, -4]", 8, &["name", "index"]),
        ("columns: [3, 4]", "columns: [3, 1.5]", 8, &["index from 0"]),
        ("gain: [14.87, 13.26]", "gain: [14.87, .nan]", 9, &["finite"]),
        ("gain: [14.87, 13.26]", "gain: [14.87, x]", 9, &["x"]),
        ("from: 0.5", "from: .inf", 11, &["finite"]),
        ("to: 7.25", "to: 0.25", 10, &["later"]),
        ("fixed: [1, 2]", "fixxed: [1]", 12, &["unknown field `fixxed`", "fixed"]),
        ("time: {column: t,", "time: {rate: 5, column: t,", 6, &["exclude"]),
        ("title: all keys at once", "robot: panda", 3, &["robot", "twice", "first at line 2"]),
        ("rpm}", "rpm,\n  columns: [1, 2]}", 9, &["columns", "twice", "first at line 8"]),
        ("side: motor", "side: [", 5, &[]),
    ];
    for (good, bad, line, words) in cases {
        let text = WHOLE.replacen(good, bad, 1);
        assert_ne!(text, WHOLE, "{good}");
        let error = parse(&text).expect_err(bad);
        let RecordingError::Manifest { file, line: at, column, message } = &error else {
            panic!("{error:?}")
        };
        assert_eq!(file, "dir/rec.yaml");
        assert!(*column >= 1);
        // serde_yaml tells some errors at the mapping that holds them.
        assert!(at.abs_diff(*line) <= 1, "{bad}: told at line {at}, not {line}: {message}");
        for word in *words {
            assert!(message.contains(word), "{bad}: `{message}` lacks `{word}`");
        }
    }
}

#[test]
fn what_is_no_manifest_is_told() {
    for (bytes, word) in [
        (&b""[..], "empty"),
        (b"# only a comment\n", "empty"),
        (b"robot: \xff\xfe", "UTF-8"),
        (b"- a\n- b\n", "not a recording YAML"),
        (b"robot: a\n", "rec.yaml:1:1: a recording has no 'time'"),
        (b"# of an arm\n\ntime: {rate: 0}", "rec.yaml:3:1: a recording has no 'robot'"),
        (b"robot: a\ntime:\n\trate: 5\n", "rec.yaml:3:1: not YAML: indented with a tab; expected spaces"),
        (b"robot: a\n---\nrobot: b\n", "second document"),
    ] {
        let error = Manifest::parse(Path::new("rec.yaml"), bytes).expect_err("no manifest").to_string();
        assert!(error.starts_with("rec.yaml:") && error.contains(word), "{error}");
    }
    let missing = Manifest::read(Path::new("no/such/file.yaml")).expect_err("no file").to_string();
    assert!(missing.contains("no/such/file.yaml") && missing.contains("no such file"), "{missing}");
}

#[test]
fn rate_and_file_must_make_sense() {
    let with = |time: &str, rest: &str| {
        parse(&format!(
            "robot: a\ntime: {time}\nposition: {{columns: [q]}}\ntorque: {{columns: [u]}}\n{rest}"
        ))
    };
    assert!(with("{rate: -5}", "trajectories: [{file: a.csv}]").is_err());
    assert!(with("{}", "trajectories: [{file: a.csv}]").is_err());
    assert!(with("{rate: 5, unit: s}", "trajectories: [{file: a.csv}]").is_err());
    assert!(with("{rate: 5}", "").expect_err("no file").to_string().contains("no 'trajectories'"));
    let unnamed = with("{rate: 5}", "trajectories: [{from: 1}]").expect_err("no file").to_string();
    assert!(unnamed.contains("trajectory 1 names no `file`"), "{unnamed}");
    assert!(with("{rate: 5}", "trajectories: [{file: a.csv}]").is_ok());
}

#[test]
fn words_in_a_title_do_not_move_a_mistake_to_its_line() {
    let text = WHOLE
        .replacen("all keys at once", "\"torque: unit: of the trajectories: to: and back\"", 1)
        .replacen("to: 7.25", "to: 0.25", 1);
    let error = parse(&text).expect_err("a window that ends before it begins").to_string();
    assert!(error.starts_with("dir/rec.yaml:11:32: trajectories.to: trajectory 1"), "{error}");
    let manifest = parse(&WHOLE.replacen("all keys at once", "\"torque: unit: A\"", 1)).expect("a manifest");
    let error = manifest.error(&["torque", "unit"], "wrong").to_string();
    assert_eq!(error, "dir/rec.yaml:9:42: torque.unit: wrong");
}

#[test]
fn a_recording_without_trajectories_is_told_so() {
    let text = "# of an arm\nrobot: a\ntime: {rate: 5}\nposition: {columns: [q]}\ntorque: {columns: [u]}\n";
    let error = parse(text).expect_err("no file").to_string();
    assert!(
        error.starts_with("dir/rec.yaml:2:1: trajectories: a recording has no 'trajectories'"),
        "{error}"
    );
    assert!(parse(&format!("{text}trajectories:\n")).is_err());
}

#[test]
fn a_byte_order_mark_is_no_part_of_a_manifest() {
    let marked = format!("\u{feff}{WHOLE}");
    assert_eq!(parse(&marked).expect("a manifest").robot, "tx40");
    let error = parse(&marked.replacen("unit: A", "unit: 7", 1)).expect_err("no unit").to_string();
    assert!(error.starts_with("dir/rec.yaml:9:"), "{error}");
}

#[test]
fn what_is_far_too_long_or_too_deep_is_refused_at_once() {
    let start = std::time::Instant::now();
    let deep = parse(&format!("robot: {}", "[".repeat(200_000))).expect_err("too deep").to_string();
    assert!(deep.contains("nested deeper than 16 levels"), "{deep}");
    let long = parse(&format!("{WHOLE}{}", "#".repeat(2_000_000))).expect_err("too long").to_string();
    assert!(long.contains("longer than 1048576 bytes"), "{long}");
    assert!(start.elapsed().as_secs() < 5, "{:?}", start.elapsed());
}

proptest! {
    #[test]
    fn no_bytes_panic(bytes in proptest::collection::vec(any::<u8>(), 0..300)) {
        let _ = Manifest::parse(Path::new("rec.yaml"), &bytes);
    }

    #[test]
    fn no_damaged_manifest_panics(at in 0usize..600, len in 0usize..40, with in "[\\[\\]{}:,\\-#&*!|>'\"%@` \\na0.]{0,6}") {
        let at = at.min(WHOLE.len());
        let end = (at + len).min(WHOLE.len());
        let text = format!("{}{with}{}", &WHOLE[..at], &WHOLE[end..]);
        let _ = parse(&text);
    }
}
