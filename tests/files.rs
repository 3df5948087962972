//! Whatever happens while a file is written, a reader meets the old one or the new one.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use std::collections::BTreeMap;
use std::fs;
use std::io::Write as _;
use std::os::unix::fs::{PermissionsExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::Duration;

use common::{Folder, MANIFEST, error_of, moving};

const DYNID: &str = env!("CARGO_BIN_EXE_dynid");

/// A short simulation into a folder.
fn simulation(out: &str, seed: u32) -> String {
    let more = "--motions 2 --period 1 --rate 2000 --record-every 2";
    format!("simulate planar_2r --out {out} --seed {seed} {more}")
}

fn run(folder: &Folder, words: &str) -> Output {
    folder.run(&words.split(' ').collect::<Vec<_>>())
}

fn recorded(name: &str) -> Folder {
    let folder = Folder::new(name);
    folder.write("motion.csv", &moving(900)).write("recording.yaml", MANIFEST);
    folder
}

/// The names and bytes of all files of a folder.
fn contents(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let entries = fs::read_dir(folder).unwrap().map(|e| e.unwrap().path());
    let files = entries.filter(|path| path.is_file());
    files.map(|path| (path.file_name().unwrap().into(), fs::read(&path).unwrap())).collect()
}

/// The files that a recording's manifest names, with their bytes, and the manifest itself.
fn recording(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let manifest = fs::read_to_string(folder.join("recording.yaml")).unwrap();
    let all = contents(folder);
    let named = all.into_iter().filter(|(name, _)| {
        name.as_path() == Path::new("recording.yaml") || manifest.contains(name.to_str().unwrap())
    });
    let named: BTreeMap<_, _> = named.collect();
    assert_eq!(named.len(), 1 + manifest.matches("file:").count(), "a file is missing: {manifest}");
    named
}

fn unfinished(folder: &Path) -> usize {
    contents(folder).keys().filter(|name| name.to_str().unwrap().ends_with(".part")).count()
}

#[test]
fn a_full_device_is_an_error_and_never_a_panic() {
    if !Path::new("/dev/full").exists() {
        let _ = writeln!(std::io::stderr(), "skipped: there is no /dev/full");
        return;
    }
    let folder = recorded("full-device");
    let full = || Stdio::from(fs::File::options().write(true).open("/dev/full").unwrap());
    let command = |words: &str| {
        let mut command = Command::new(DYNID);
        command.args(words.split(' ')).current_dir(&folder.0);
        command
    };
    for words in ["identify recording.yaml --json -", "identify recording.yaml", "show tx40", "--help"] {
        let output = command(words).stdout(full()).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{words}: {}", error_of(&output));
        assert!(error_of(&output).contains("standard output"), "{words}: {}", error_of(&output));
    }
    for words in ["identify recording.yaml --json /dev/full", "identify recording.yaml --out /dev/full"] {
        let output = command(words).output().unwrap();
        assert_eq!(output.status.code(), Some(2), "{words}: {}", error_of(&output));
    }
    for (words, status) in [
        ("show nobody", 2),
        ("identify none.yaml", 2),
        ("identify", 2),
        ("identify recording.yaml --from 99", 1),
    ] {
        let output = command(words).stderr(full()).output().unwrap();
        assert_eq!(output.status.code(), Some(status), "{words}");
    }
}

#[test]
fn a_disk_that_is_full_leaves_the_old_files_and_nothing_else() {
    let folder = recorded("file-size");
    assert!(run(&folder, &simulation("sim", 1)).status.success());
    let words = "identify recording.yaml --out m.json --report r.html --json j.json";
    assert!(run(&folder, words).status.success());
    // A limit on the length of files refuses writes as a full disk does, and needs no permission.
    let limited = |words: &str| {
        let script = "trap '' XFSZ; ulimit -f 1; exec \"$@\"";
        let mut command = Command::new("sh");
        command.args(["-c", script, "sh", DYNID]).args(words.split(' ')).current_dir(&folder.0);
        command.output().unwrap()
    };
    let commands = [
        "identify recording.yaml --band 10 --out m.json".to_owned(),
        "identify recording.yaml --band 10 --json j.json".to_owned(),
        "identify recording.yaml --band 10 --report r.html".to_owned(),
        simulation("sim", 2),
        "excite planar_2r --out plan --starts 1 --evaluations 1".to_owned(),
    ];
    let (before, simulated) = (contents(&folder.0), contents(&folder.path("sim")));
    for words in &commands {
        let output = limited(words);
        assert_eq!(output.status.code(), Some(2), "{words}: {}", error_of(&output));
        assert!(error_of(&output).contains("cannot write it"), "{words}: {}", error_of(&output));
    }
    assert_eq!(contents(&folder.0), before);
    assert_eq!(contents(&folder.path("sim")), simulated);
    assert!(contents(&folder.path("plan")).is_empty());
}

#[test]
fn a_file_system_without_room_leaves_the_old_model() {
    let folder = recorded("tmpfs");
    folder.make("small");
    let script = "mount -t tmpfs -o size=128k none small || exit; : > mounted; : > small/full; \
                  \"$@\" --out small/m.json >/dev/null && dd if=/dev/zero of=small/full bs=1k count=256 2>/dev/null; \
                  cp small/m.json before.json && \"$@\" --band 10 --out small/m.json; echo $? > status; \
                  cmp small/m.json before.json && echo same > same; ls -A small > listed; umount small";
    let mut command = Command::new("unshare");
    command.args(["-rm", "sh", "-c", script, "sh", DYNID, "identify", "recording.yaml"]);
    let output = command.current_dir(&folder.0).output();
    if !folder.path("mounted").exists() {
        let _ = writeln!(std::io::stderr(), "skipped: a tmpfs cannot be mounted here: {output:?}");
        return;
    }
    assert!(folder.path("before.json").exists(), "{output:?}");
    let status = fs::read_to_string(folder.path("status")).unwrap();
    assert_eq!(status.trim(), "2", "{output:?}");
    assert!(folder.path("same").exists());
    assert_eq!(fs::read_to_string(folder.path("listed")).unwrap(), "full\nm.json\n");
}

#[test]
fn a_link_stays_a_link_and_permissions_stay() {
    let folder = recorded("link");
    folder.write("real.json", "old").write("open.json", "old").write("closed.json", "old");
    symlink("real.json", folder.path("link.json")).unwrap();
    let mode = |name: &str, bits: u32| {
        fs::set_permissions(folder.path(name), fs::Permissions::from_mode(bits)).unwrap();
    };
    mode("open.json", 0o664);
    mode("closed.json", 0o444);
    for name in ["link.json", "open.json", "new.json"] {
        let output = run(&folder, &format!("identify recording.yaml --json {name}"));
        assert!(output.status.success(), "{}", error_of(&output));
    }
    assert!(fs::symlink_metadata(folder.path("link.json")).unwrap().is_symlink());
    assert!(fs::read_to_string(folder.path("real.json")).unwrap().contains("base_parameters"));
    let bits = |name: &str| fs::metadata(folder.path(name)).unwrap().permissions().mode() & 0o777;
    folder.write("usual", "");
    assert_eq!((bits("open.json"), bits("new.json")), (0o664, bits("usual")));
    let output = run(&folder, "identify recording.yaml --json closed.json");
    assert_eq!(output.status.code(), Some(2));
    assert!(error_of(&output).contains("not permitted"), "{}", error_of(&output));
    assert_eq!(fs::read_to_string(folder.path("closed.json")).unwrap(), "old");
}

#[test]
fn a_reader_at_the_same_time_reads_a_whole_file() {
    let folder = recorded("reader");
    let path = folder.path("m.json");
    let mut writers: Vec<_> = (0..6)
        .map(|k| {
            let band = (10 + k).to_string();
            let words = ["identify", "recording.yaml", "--band", &band, "--out", "m.json"];
            Command::new(DYNID).args(words).current_dir(&folder.0).stdout(Stdio::null()).spawn().unwrap()
        })
        .collect();
    let mut read = 0;
    while writers.iter_mut().any(|w| w.try_wait().unwrap().is_none()) {
        if let Ok(text) = fs::read_to_string(&path) {
            assert!(serde_json::from_str::<serde_json::Value>(&text).is_ok(), "{} bytes", text.len());
            read += 1;
        }
        std::thread::sleep(Duration::from_micros(200));
    }
    assert!(writers.iter_mut().all(|w| w.wait().unwrap().success()) && read > 0);
    assert_eq!(unfinished(&folder.0), 0);
}

#[test]
fn runs_into_one_folder_at_once_do_not_mix() {
    let folder = Folder::new("at-once");
    let alone = |seed: u32| {
        let name = format!("alone{seed}");
        assert!(run(&folder, &simulation(&name, seed)).status.success());
        recording(&folder.path(&name))
    };
    let known: Vec<_> = (1..=3).map(alone).collect();
    for _ in 0..4 {
        let runs: Vec<_> = (1..=3)
            .map(|seed| {
                let mut command = Command::new(DYNID);
                command
                    .args(simulation("both", seed).split(' '))
                    .current_dir(&folder.0)
                    .stdout(Stdio::null());
                command.spawn().unwrap()
            })
            .collect();
        assert!(runs.into_iter().all(|mut run| run.wait().unwrap().success()));
        assert!(known.contains(&recording(&folder.path("both"))));
    }
    assert_eq!(unfinished(&folder.path("both")), 0);
    // What no manifest of the last two names has been removed.
    assert!(run(&folder, &simulation("both", 1)).status.success());
    assert!(run(&folder, &simulation("both", 1)).status.success());
    assert_eq!(contents(&folder.path("both")), known[0]);
}

#[test]
fn a_run_that_is_killed_leaves_the_recording_before_or_its_own() {
    let folder = Folder::new("killed");
    let known: Vec<_> = (1..=2)
        .map(|seed| {
            let name = format!("whole{seed}");
            assert!(run(&folder, &simulation(&name, seed)).status.success());
            recording(&folder.path(&name))
        })
        .collect();
    assert!(run(&folder, &simulation("out", 1)).status.success());
    let started = std::time::Instant::now();
    assert!(run(&folder, &simulation("out", 2)).status.success());
    let usual = started.elapsed();
    for k in 0..20 {
        let mut command = Command::new(DYNID);
        command.args(simulation("out", 1 + k % 2).split(' ')).current_dir(&folder.0).stdout(Stdio::null());
        let mut child = command.spawn().unwrap();
        std::thread::sleep(usual.mul_f64(f64::from((k * 7) % 20) / 16.0));
        let _ = child.kill();
        child.wait().unwrap();
        assert!(known.contains(&recording(&folder.path("out"))), "after kill {k}");
    }
}

#[test]
fn what_would_command_a_terminal_is_shown_escaped() {
    let folder = recorded("escapes");
    let title = "title: \"harmless\\e]0;owned\\a\\nwarning: none\"\nrobot: planar_2r";
    folder.write("recording.yaml", &MANIFEST.replace("robot: planar_2r", title));
    let page = ["identify", "recording.yaml", "--report", "r.html"];
    let output = folder.run(&page);
    let words = common::words_of(&output);
    assert!(words.starts_with("planar_2r: harmless\\u{1b}]0;owned\\u{7} warning: none\n"), "{words}");
    let page = fs::read_to_string(folder.path("r.html")).unwrap();
    assert!(!page.contains(|c: char| c.is_control() && c != '\n'));
    folder.write("bad.yaml", "name: \"\\e[2J\"\nframes: []\n");
    let error = error_of(&folder.run(&["show", "./bad.yaml\u{1b}[1m"]))
        + &error_of(&folder.run(&["show", "./bad.yaml"]));
    assert!(!error.contains('\u{1b}'), "{error}");
}
