//! Control codes go to terminals that want them, and nowhere else.
#![cfg(target_os = "linux")]
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use std::io::Write as _;
use std::process::{Command, Stdio};

use common::Folder;

const ESCAPE: char = '\u{1b}';
/// Help, a wrong option, a long search with progress, and a warning.
const COMMANDS: [&str; 4] =
    ["--help", "identify --nope", "simulate planar_2r --motions 1 --period 1 --out sim", "effects striebck"];

/// What a command writes to a terminal, or to pipes; `None` where this machine has no `script` to make one.
fn written(folder: &Folder, words: &str, terminal: bool, no_color: bool) -> Option<String> {
    let program = env!("CARGO_BIN_EXE_dynid");
    let line = format!("{program} {words}");
    let mut command = if terminal { Command::new("script") } else { Command::new(program) };
    match terminal {
        true => command.args(["-qec", &line, "/dev/null"]),
        false => command.args(words.split(' ')),
    };
    command
        .env_clear()
        .env("TERM", "xterm-256color")
        .env("PATH", std::env::var_os("PATH").unwrap_or_default());
    if no_color {
        command.env("NO_COLOR", "1");
    }
    let output = command.current_dir(&folder.0).stdin(Stdio::null()).output().ok()?;
    Some(String::from_utf8_lossy(&[output.stdout, output.stderr].concat()).into_owned())
}

#[test]
fn a_pipe_gets_no_control_codes() {
    let folder = Folder::new("colour-pipe");
    for words in COMMANDS {
        let text = written(&folder, words, false, false).unwrap();
        assert!(!text.is_empty() && !text.contains(ESCAPE), "{words}: {text:?}");
    }
}

#[test]
fn a_terminal_gets_none_either_where_no_color_is_set() {
    let folder = Folder::new("colour-terminal");
    if written(&folder, "--help", true, false).is_none_or(|text| !text.contains("dynid")) {
        let _ = writeln!(std::io::stderr(), "skipped: there is no `script` to make a terminal with");
        return;
    }
    // That these are terminals: codes come where they are not asked to stay away.
    for words in &COMMANDS[..3] {
        let text = written(&folder, words, true, false).unwrap();
        assert!(text.contains(ESCAPE), "{words}: {text:?}");
    }
    for words in COMMANDS {
        let text = written(&folder, words, true, true).unwrap();
        assert!(!text.is_empty() && !text.contains(ESCAPE), "{words}: {text:?}");
    }
}
