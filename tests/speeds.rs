//! A column of speeds that contradicts the positions is told, with its joint and what it is; one that is noisy is not.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use common::{Folder, MANIFEST, error_of, json_of, words_of};

/// The moving arm with columns of speeds, which `altered` makes of the true ones and the row.
fn with_speeds(altered: impl Fn([f64; 2], usize) -> [f64; 2]) -> Folder {
    static NEXT: std::sync::atomic::AtomicUsize = std::sync::atomic::AtomicUsize::new(0);
    let number = NEXT.fetch_add(1, std::sync::atomic::Ordering::Relaxed);
    let folder = Folder::new(&format!("speeds-{number}"));
    let mut text = String::from("t,q1,q2,v1,v2,u1,u2\n");
    for k in 0..1500 {
        let t = k as f64 * 0.005;
        let (a, da) = ((2.0 * t).sin(), 2.0 * (2.0 * t).cos());
        let (b, db) = ((3.1 * t).cos(), -3.1 * (3.1 * t).sin());
        let [v1, v2] = altered([da, db], k);
        let (first, second) = (-4.0 * 0.7 * a + 1.5 * da, -9.61 * 0.2 * b + 0.4 * db);
        text.push_str(&format!("{t},{a},{b},{v1},{v2},{first},{second}\n"));
    }
    folder.write("motion.csv", &text);
    let manifest = MANIFEST.replace("torque:", "velocity: {columns: [v1, v2], unit: rad/s}\ntorque:");
    folder.write("recording.yaml", &manifest);
    folder
}

/// What identification and diagnosis say.
fn said(folder: &Folder) -> [String; 2] {
    ["identify", "diagnose"].map(|command| {
        let output = folder.run(&[command, "recording.yaml"]);
        words_of(&output) + &error_of(&output)
    })
}

fn assert_told(altered: impl Fn([f64; 2], usize) -> [f64; 2], parts: &[&str]) {
    for words in said(&with_speeds(altered)) {
        for part in parts {
            assert!(words.contains(part), "'{part}' is not in: {words}");
        }
    }
}

#[test]
fn speeds_in_degrees_are_told_with_their_joint_and_factor() {
    let degrees = |[a, b]: [f64; 2], _| [a, b.to_degrees()];
    assert_told(degrees, &["speed of joint 2", "57.3 times", "degrees where radians", "correct the unit"]);
}

#[test]
fn a_speed_with_the_other_sign_is_told() {
    assert_told(|[a, b], _| [-a, b], &["speed of joint 1", "other sign", "correct the sign"]);
}

#[test]
fn exchanged_columns_are_told_as_those_of_the_neighbour() {
    let parts = ["speed of joint 1", "that of joint 2", "that of joint 1", "order of the columns"];
    assert_told(|[a, b], _| [b, a], &parts);
}

#[test]
fn speeds_that_are_right_or_only_noisy_are_not_mentioned_and_no_row_is_lost() {
    // A noise as large as the speed itself, the same every time.
    let noise = |k: usize| 3.0 * ((k * k % 1009) as f64 / 1009.0 - 0.5);
    for size in [0.0, 0.1, 1.0] {
        let folder = with_speeds(move |[a, b], k| [a + size * noise(k), b + size * noise(k + 7)]);
        for words in said(&folder) {
            assert!(!words.contains("contradicts"), "{size}: {words}");
        }
    }
    let turned = with_speeds(|[a, b], _| [1000.0 * a, b]);
    let json = json_of(&turned.run(&["identify", "recording.yaml", "--json", "-"]));
    assert_eq!(json["rows_left_out"], 0);
}
