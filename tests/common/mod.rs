//! What the tests of the command line share.
#![allow(dead_code, reason = "every test file uses a part of it")]
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

use std::path::PathBuf;
use std::process::{Command, Output};

/// Runs the command in an own folder that is removed afterwards.
pub struct Folder(pub PathBuf);

impl Folder {
    pub fn new(name: &str) -> Self {
        let path = std::env::temp_dir().join(format!("dynid-test-{name}-{}", std::process::id()));
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    pub fn path(&self, name: &str) -> PathBuf {
        self.0.join(name)
    }

    pub fn make(&self, name: &str) -> &Self {
        std::fs::create_dir_all(self.0.join(name)).unwrap();
        self
    }

    pub fn write(&self, name: &str, text: &str) -> &Self {
        std::fs::write(self.0.join(name), text).unwrap();
        self
    }

    pub fn run(&self, words: &[&str]) -> Output {
        Command::new(env!("CARGO_BIN_EXE_dynid")).args(words).current_dir(&self.0).output().unwrap()
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

pub fn error_of(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).into_owned()
}

pub fn words_of(output: &Output) -> String {
    String::from_utf8_lossy(&output.stdout).into_owned()
}

pub fn json_of(output: &Output) -> serde_json::Value {
    serde_json::from_str(&words_of(output)).unwrap_or_else(|_| panic!("{}", error_of(output)))
}

pub const ARM: &str = "\
name: arm
gravity: [0, -9.81, 0]
constants: {l1: 0.5}
frames:
  - {j: 1, sigma: 0, alpha: 0, d: 0,  theta: q1, r: 0}
  - {j: 2, sigma: 0, alpha: 0, d: l1, theta: q2, r: 0}
drive: {gear: [50, 50]}
";

pub const MANIFEST: &str = "\
robot: planar_2r
side: joint
layout: {header: true, delimiter: \",\"}
time: {column: t, unit: s}
position: {columns: [q1, q2], unit: rad}
torque: {columns: [u1, u2], unit: N.m}
trajectories:
  - {file: motion.csv}
";

/// A planar arm that moves, with the torques of rotors and friction that a real one could have.
pub fn moving(rows: usize) -> String {
    let mut text = String::from("t,q1,q2,u1,u2\n");
    for k in 0..rows {
        let t = k as f64 * 0.01;
        let (a, da) = ((2.0 * t).sin(), 2.0 * (2.0 * t).cos());
        let (b, db) = ((3.1 * t).cos(), -3.1 * (3.1 * t).sin());
        let (first, second) = (-4.0 * 0.7 * a + 1.5 * da, -9.61 * 0.2 * b + 0.4 * db);
        text.push_str(&format!("{t},{a},{b},{first},{second}\n"));
    }
    text
}
