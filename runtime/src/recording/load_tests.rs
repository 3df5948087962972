use std::borrow::Cow;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use super::{Loader, Recording, load};
use crate::model::{Drive, Frame, JointKind, Limits, Robot};
use crate::recording::folder::Folder;
use crate::recording::{Manifest, Reason, RecordingError};

fn robot(kinds: &[JointKind], gear: Vec<f64>) -> Robot {
    let frame = |&kind: &JointKind| Frame::on_base(kind);
    Robot {
        name: "test_arm".into(),
        description: "".into(),
        gravity: [0.0, 0.0, -9.81],
        frames: kinds.iter().map(frame).collect::<Vec<_>>().into(),
        dependent: Vec::new().into(),
        drive: Drive { gear: gear.into(), coupled_friction: Cow::Borrowed(&[]) },
        couplings: Vec::new().into(),
        known: Vec::new().into(),
        fixed: Vec::new().into(),
        ellipsoids: Vec::new().into(),
        limits: Limits::default(),
        standard: Cow::Borrowed(&[]),
        base: Cow::Borrowed(&[]),
        nominal: None,
    }
}

fn revolute(joints: usize) -> Robot {
    let gear = (0..joints * joints).map(|k| f64::from(u8::from(k % (joints + 1) == 0)));
    robot(&vec![JointKind::Revolute; joints], gear.collect())
}

fn tx40() -> Robot {
    let n = [32.0, 32.0, 45.0, -48.0, 45.0, 32.0];
    let mut gear = vec![0.0; 36];
    for j in 0..6 {
        gear[7 * j] = n[j];
    }
    gear[5 * 6 + 4] = 32.0;
    let mut kinds = vec![JointKind::Revolute; 6];
    kinds.push(JointKind::Fixed);
    robot(&kinds, gear)
}

fn shared(path: &str) -> Option<PathBuf> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared").join(path);
    if path.exists() {
        return Some(path);
    }
    let _ = writeln!(std::io::stderr(), "skipped: {} is absent", path.display());
    None
}

#[test]
fn motor_angles_and_torques_of_the_tx40_become_those_of_its_joints() {
    let Some(path) = shared("data/tx40/recording.yaml") else { return };
    let manifest = Manifest::read(&path).expect("the manifest keeps to the contract");
    let recording = load(&manifest, &tx40()).expect("the recording loads");
    assert_eq!(recording.trajectories.len(), 1);
    assert_eq!(recording.rows.left_out, 0);
    let t = &recording.trajectories[0];
    // 0.05 s to 7.4 s at 5 kHz, both included.
    assert_eq!(t.time.len(), 36751);
    assert!((t.time[0] - 0.05).abs() < 1e-9 && (t.time[36750] - 7.4).abs() < 1e-9);
    // Position limits, deg.
    for (q, limit) in t.position.iter().zip([180.0f64, 125.0, 138.0, 270.0, 133.5, 270.0]) {
        assert!(q.iter().all(|q| q.abs() <= limit.to_radians()), "beyond {limit} deg");
        assert!(q.iter().any(|q| q.abs() > 0.1));
    }
    // At rest the shoulder carries the arm: 50.265 / 32 rad and some 20 N.m.
    assert!((t.position[1][0] - 50.265 / 32.0).abs() < 1e-3);
}

#[test]
fn every_recording_at_hand_loads() {
    let Some(path) = shared("challenge") else { return };
    let mut folders: Vec<PathBuf> = std::fs::read_dir(path)
        .expect("a folder")
        .flatten()
        .map(|e| e.path())
        .filter(|p| p.is_dir())
        .collect();
    folders.sort();
    assert!(!folders.is_empty());
    for manifest in folders.iter().flat_map(|f| ["recording", "test", "baseline"].map(|n| f.join(n))) {
        let manifest = manifest.with_extension("yaml");
        if !manifest.exists() {
            continue;
        }
        let manifest = Manifest::read(&manifest).expect("the manifest keeps to the contract");
        let robot = match manifest.robot.as_str() {
            "scara4" => {
                let mut kinds = [JointKind::Revolute; 4];
                kinds[2] = JointKind::Prismatic;
                robot(&kinds, revolute(4).drive.gear.into_owned())
            }
            _ => revolute(6),
        };
        let recording = load(&manifest, &robot).expect("the recording loads");
        assert_eq!(recording.trajectories.len(), manifest.trajectories.len());
        assert_eq!(recording.rows.left_out, 0);
    }
}

#[test]
fn the_panda_and_the_ur10e_load() {
    for (path, joints, trajectories) in
        [("data/panda/recording.yaml", 7, 1), ("data/ur10e/train.yaml", 6, 3), ("data/ur10e/test.yaml", 6, 2)]
    {
        let Some(path) = shared(path) else { return };
        let manifest = Manifest::read(&path).expect("the manifest keeps to the contract");
        let recording = load(&manifest, &revolute(joints)).expect("the recording loads");
        assert_eq!(recording.trajectories.len(), trajectories, "{:?}", recording.rows);
        assert_eq!(recording.rows.left_out, 0, "{:?}", recording.rows);
        for t in &recording.trajectories {
            assert_eq!(t.velocity.is_some(), joints == 6);
            assert!(t.time[0] >= 0.0 && t.time.windows(2).all(|w| w[0] < w[1]));
        }
    }
}

#[test]
fn garbage_rows_of_a_real_logger_are_counted_and_left_out() {
    let Some(path) = shared("data/ur10e/ur-19_09_27-11_32_02.csv") else { return };
    let text = "robot: ur10e\nlayout: {header: false}\ntime: {column: 0}\n\
                position: {columns: [1, 2, 3, 4, 5, 6]}\nvelocity: {columns: [7, 8, 9, 10, 11, 12]}\n\
                torque: {columns: [13, 14, 15, 16, 17, 18], unit: A, gain: [14.87, 13.26, 11.13, 10.62, 11.03, 11.47]}\n\
                trajectories: [{file: ur-19_09_27-11_32_02.csv}]\n";
    let manifest =
        Manifest::parse(&path.with_file_name("garbage.yaml"), text.as_bytes()).expect("a manifest");
    let recording = load(&manifest, &revolute(6)).expect("the recording loads");
    // The logger found its step at line 21; of the 20 rows before only the first could be a posture.
    assert_eq!(recording.rows.rows, 1139);
    assert_eq!(recording.rows.left_out, 20, "{:#?}", recording.rows);
    assert_eq!(recording.trajectories.len(), 1);
    assert_eq!(recording.trajectories[0].time[0], 0.727);
    assert!(recording.rows.examples.iter().all(|e| e.line <= 20 && e.file == "ur-19_09_27-11_32_02.csv"));
}

/// 200 rows of two joints at 100 Hz: t, q1, q2, u1, u2.
fn table(rows: usize) -> String {
    let mut text = String::from("t,q1,q2,u1,u2\n");
    for k in 0..rows {
        let t = 0.01 * k as f64;
        text.push_str(&format!(
            "{t:.2},{:.6},{:.6},{:.4},{:.4}\n",
            t.sin(),
            (0.5 * t).min(20.0),
            10.0 + t,
            -t
        ));
    }
    text
}

const MANIFEST: &str = "robot: arm\ntime: {column: t}\nposition: {columns: [q1, q2]}\n\
                        torque: {columns: [u1, u2]}\ntrajectories: [{file: a.csv}]\n";

fn load_text(manifest: &str, data: &str, robot: &Robot) -> Result<Recording, RecordingError> {
    let folder = Folder::with(&[("rec.yaml", manifest), ("a.csv", data)]);
    load(&Manifest::read(&folder.path("rec.yaml"))?, robot)
}

fn changed(from: &str, to: &str) -> String {
    let text = MANIFEST.replacen(from, to, 1);
    assert_ne!(text, MANIFEST, "{from}");
    text
}

#[test]
fn offset_gain_and_unit_apply_to_the_value_as_recorded_and_the_gear_after_them() {
    let manifest = "robot: arm\nside: motor\ntime: {rate: 100}\n\
                    position: {columns: [q1, q2], unit: deg, offset: [10, 0], gain: [1, -1]}\n\
                    torque: {columns: [u1, u2], unit: A, offset: [0, 1], gain: [2, 3]}\n\
                    trajectories: [{file: a.csv}]\n";
    let mut data = String::from("q1,q2,u1,u2\n");
    (0..40).for_each(|_| data.push_str("20,30,5,6\n"));
    // Motor 2 turns with 4 (q1 + q2).
    let arm = robot(&[JointKind::Revolute; 2], vec![10.0, 0.0, 4.0, 4.0]);
    let recording = load_text(manifest, &data, &arm).expect("a recording");
    let t = &recording.trajectories[0];
    let motor = [30f64.to_radians(), -30f64.to_radians()];
    let q1 = motor[0] / 10.0;
    assert!((t.position[0][7] - q1).abs() < 1e-15);
    assert!((t.position[1][7] - (motor[1] / 4.0 - q1)).abs() < 1e-15);
    let torque = [10.0, 21.0];
    assert!((t.torque[0][7] - (10.0 * torque[0] + 4.0 * torque[1])).abs() < 1e-12);
    assert!((t.torque[1][7] - 4.0 * torque[1]).abs() < 1e-12);
}

#[test]
fn windows_are_in_the_recordings_time_and_both_ends_belong_to_them() {
    let whole = load_text(MANIFEST, &table(200), &revolute(2)).expect("a recording");
    assert_eq!(whole.trajectories[0].time.len(), 200);
    assert_eq!(whole.trajectories[0].name, "a.csv");
    let manifest = changed("{file: a.csv}", "{file: a.csv, from: 0.5, to: 1.5, fixed: [2]}");
    let part = load_text(&manifest, &table(200), &revolute(2)).expect("a recording");
    let t = &part.trajectories[0];
    assert_eq!((t.time.len(), t.time[0], t.time[100]), (101, 0.5, 1.5));
    assert_eq!(t.fixed, [1]);
    assert_eq!(t.name, "a.csv 0.5 s to 1.5 s");
    let late: String = table(200).replace("\n0.", "\n70.").replace("\n1.", "\n71.");
    let shifted = manifest.replace("{column: t}", "{column: t, from_first_row: true}");
    let t = load_text(&shifted, &late, &revolute(2)).expect("a recording").trajectories.remove(0);
    assert_eq!(t.time.len(), 101);
    assert!((t.time[0] - 0.5).abs() < 1e-9);
}

#[test]
fn bounded_pieces_hold_the_rows_of_the_whole() {
    let folder = Folder::with(&[("rec.yaml", MANIFEST), ("a.csv", &table(30_000))]);
    let manifest = Manifest::read(&folder.path("rec.yaml")).expect("a manifest");
    let arm = revolute(2);
    let whole = load(&manifest, &arm).expect("a recording").trajectories.remove(0);
    let mut loader = Loader::new(&manifest, &arm, 10_000).expect("a loader");
    let mut time = Vec::new();
    let mut torque = Vec::new();
    let mut pieces = 0;
    while let Some(piece) = loader.next_trajectory().expect("a piece") {
        assert!(piece.time.len() <= 10_000);
        time.extend(piece.time);
        torque.extend_from_slice(&piece.torque[0]);
        pieces += 1;
    }
    assert!(pieces >= 3);
    assert_eq!(loader.into_report().rows, 30_000);
    assert_eq!((time, &torque), (whole.time, &whole.torque[0]));
}

#[test]
fn position_and_torque_files_of_unequal_length_are_refused() {
    let manifest = "robot: arm\ntime: {rate: 100}\nposition: {file: a.csv, columns: [q1, q2]}\n\
                    torque: {file: b.csv, columns: [u1, u2]}\n";
    let folder = Folder::with(&[("rec.yaml", manifest), ("a.csv", &table(5000)), ("b.csv", &table(9000))]);
    let manifest = Manifest::read(&folder.path("rec.yaml")).expect("a manifest");
    let error = load(&manifest, &revolute(2)).expect_err("unequal").to_string();
    assert!(error.contains("a.csv has 5000 rows and b.csv has 9000"), "{error}");
}

#[test]
fn a_manifest_that_does_not_fit_the_robot_is_told_with_its_place() {
    let mut scara = revolute(2);
    let frames = scara.frames.to_mut();
    frames[1].kind = JointKind::Prismatic;
    let cases = [
        ("[q1, q2]", "[q1, q2, t]", revolute(2), "3 given, but test_arm has 2 joints"),
        ("[q1, q2]", "[]", revolute(2), "no column"),
        (
            "[q1, q2]}",
            "[q1, q2], unit: rad}",
            scara.clone(),
            "joint 2, which is prismatic: expected one of m",
        ),
        ("[q1, q2]}", "[q1, q2], unit: [rad, N]}", scara.clone(), "`N` does not fit joint 2"),
        ("[q1, q2]}", "[q1, q2], offset: [1]}", revolute(2), "1 given"),
        ("[u1, u2]}", "[u1, u2], unit: A}", revolute(2), "needs a `gain`"),
        ("[u1, u2]}", "[u1, u2], gain: [1, 0]}", revolute(2), "0 for joint 2"),
        ("{file: a.csv}", "{file: a.csv, fixed: [3]}", revolute(2), "names joint 3"),
        ("title", "title", revolute(2), ""),
    ];
    for (from, to, arm, words) in cases.into_iter().filter(|c| !c.3.is_empty()) {
        let error = load_text(&changed(from, to), &table(50), &arm).expect_err(to);
        assert!(!error.is_about_data());
        let error = error.to_string();
        assert!(error.contains("rec.yaml:") && error.contains(words), "{to}: {error}");
    }
    let units = changed("[q1, q2]}", "[q1, q2], unit: [rad, mm]}");
    let t = load_text(&units, &table(50), &scara).expect("units fit").trajectories.remove(0);
    assert!((t.position[1][40] - 0.2e-3).abs() < 1e-12);
    let mut singular = revolute(2);
    singular.drive.gear = vec![1.0, 1.0, 1.0, 1.0].into();
    let error =
        load_text(&changed("time:", "side: motor\ntime:"), &table(50), &singular).expect_err("singular");
    assert!(error.to_string().contains("singular"), "{error}");
}

#[test]
fn data_that_cannot_support_an_answer_are_told_apart_from_wrong_input() {
    let error =
        |manifest: &str, data: &str| load_text(manifest, data, &revolute(2)).expect_err("no recording");
    let empty = error(&changed("{file: a.csv}", "{file: a.csv, from: 50, to: 60}"), &table(200));
    assert!(empty.is_about_data() && empty.to_string().contains("between 50 s and 60 s"), "{empty}");
    // Every third row is garbled.
    let garbled: String = table(200)
        .lines()
        .enumerate()
        .map(|(k, l)| if k % 3 == 1 { "x,x,x,x,x\n".into() } else { format!("{l}\n") })
        .collect();
    let many = error(MANIFEST, &garbled);
    assert!(many.is_about_data());
    let many = many.to_string();
    assert!(many.contains("67 of 200 rows") && many.contains("a.csv:2: not a number"), "{many}");
    // Degrees read as radians: joint 2 runs out of reach or jumps, and the message asks for the unit.
    let mut degrees = String::from("t,q1,q2,u1,u2\n");
    (0..400).for_each(|k| {
        degrees.push_str(&format!("{},{},{},1,1\n", 0.01 * k as f64, k as f64 * 2.0 - 400.0, 0))
    });
    let wrong_unit = error(MANIFEST, &degrees).to_string();
    assert!(wrong_unit.contains("units"), "{wrong_unit}");
    let missing = error(&changed("file: a.csv", "file: b.csv"), "");
    assert!(!missing.is_about_data() && missing.to_string().contains("no such file"));
}

#[test]
fn rows_at_fault_are_reported_with_file_line_and_reason() {
    let mut lines: Vec<String> = table(300).lines().map(Into::into).collect();
    lines[50] = "0.49,nan,0,0,0".into();
    lines[100] = "0.99,300,0,0,0".into();
    lines[150] = "0.01,0.1,0.1,0,0".into();
    let cut = lines[300].len() - 12;
    lines[300].truncate(cut);
    let recording = load_text(MANIFEST, &lines.join("\n"), &revolute(2)).expect("a recording");
    assert_eq!((recording.rows.rows, recording.rows.left_out), (300, 4));
    let mut found: Vec<(u64, Reason)> = recording.rows.examples.iter().map(|e| (e.line, e.reason)).collect();
    found.sort_unstable();
    let wanted =
        [(51, Reason::NotFinite), (101, Reason::OutOfReach), (151, Reason::TimeOrder), (301, Reason::CutOff)];
    assert_eq!(found, wanted);
    assert_eq!(recording.trajectories.len(), 1, "single rows are bridged");
}

#[test]
fn a_binary_recording_is_the_recording_in_text() {
    let text = load_text(MANIFEST, &table(300), &revolute(2)).expect("a recording").trajectories.remove(0);
    let mut dict = String::from("{'descr': '<f8', 'fortran_order': True, 'shape': (300, 5), }");
    dict.push_str(&" ".repeat(128 - 11 - dict.len()));
    dict.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    bytes.extend(dict.bytes());
    for column in [&text.time, &text.position[0], &text.position[1], &text.torque[0], &text.torque[1]] {
        bytes.extend(column.iter().flat_map(|v| v.to_le_bytes()));
    }
    let manifest = "robot: arm\ntime: {column: 0}\nposition: {columns: [1, 2]}\n\
                    torque: {columns: [3, 4]}\ntrajectories: [{file: a.npy}]\n";
    let folder = Folder::with(&[("rec.yaml", manifest)]);
    std::fs::write(folder.path("a.npy"), bytes).expect("a file");
    let manifest = Manifest::read(&folder.path("rec.yaml")).expect("a manifest");
    let mut binary = load(&manifest, &revolute(2)).expect("a recording").trajectories.remove(0);
    binary.name = text.name.clone();
    assert_eq!(binary, text);
}
