use std::borrow::Cow;
use std::path::{Path, PathBuf};

use super::load;
use crate::model::{Drive, Frame, JointKind, Limits, Robot};
use crate::recording::Manifest;

fn robot(kinds: &[JointKind], gear: Vec<f64>) -> Robot {
    let frame = |&kind: &JointKind| Frame {
        parent: None,
        kind,
        gamma: 0.0,
        b: 0.0,
        alpha: 0.0,
        d: 0.0,
        theta: 0.0,
        r: 0.0,
    };
    Robot {
        name: "test_arm".into(),
        description: "".into(),
        gravity: [0.0, 0.0, -9.81],
        frames: kinds.iter().map(frame).collect::<Vec<_>>().into(),
        drive: Drive { gear: gear.into(), coupled_friction: Cow::Borrowed(&[]) },
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
    eprintln!("skipped: {} is absent", path.display());
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
