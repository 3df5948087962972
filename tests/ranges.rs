//! Whatever number an option is given and whatever a file holds: a result or an error, within bounded time and memory.
#![cfg(unix)]
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use std::io::Write as _;
use std::process::{Command, Output, Stdio};
use std::sync::LazyLock;

use common::{ARM, Folder, MANIFEST, error_of, moving};
use proptest::prelude::*;

/// Most seconds of computing, and most kilobytes of memory, that any of these commands may take.
const SECONDS: u32 = 20;
const KILOBYTES: u32 = 2_000_000;

/// Runs a command within the limits.
fn bounded(folder: &Folder, words: &[&str]) -> Output {
    let script = format!("ulimit -t {SECONDS}; ulimit -v {KILOBYTES}; exec \"$@\"");
    let mut command = Command::new("sh");
    command.args(["-c", &script, "sh", env!("CARGO_BIN_EXE_dynid")]).args(words);
    command.current_dir(&folder.0).stdin(Stdio::null()).output().unwrap()
}

/// That a command ended by itself, with a status of the contract and nothing that no person can read.
#[track_caller]
fn assert_answer(output: &Output, words: &str) {
    let error = error_of(output);
    assert!(matches!(output.status.code(), Some(0..=2)), "{words}: {:?}: {error}", output.status);
    assert!(!error.contains("panicked"), "{words}: {error}");
    assert!(output.status.success() || !error.is_empty(), "{words}: no word why");
}

/// A folder with a short recording and a model.
static FOLDER: LazyLock<Folder> = LazyLock::new(|| {
    let folder = Folder::new("ranges");
    folder.write("motion.csv", &moving(600)).write("recording.yaml", MANIFEST);
    folder.write("arm.urdf", include_str!("urdf/twins.urdf"));
    let output = folder.run(&["identify", "recording.yaml", "--out", "m.json"]);
    assert!(output.status.success(), "{}", error_of(&output));
    folder
});

/// Commands with options of numbers, each as fast as it can be.
const COMMANDS: [&str; 7] = [
    "import arm.urdf --out arm.yaml",
    "identify recording.yaml",
    "validate m.json recording.yaml",
    "diagnose recording.yaml",
    "simulate planar_2r --out sim",
    "excite planar_2r --out plan",
    "paper --robot planar_2r",
];

/// What makes the others fast, where it is not the option that is tried.
const FAST: [(&str, &str); 8] = [
    ("--motions", "1"),
    ("--period", "0.5"),
    ("--rate", "500"),
    ("--starts", "1"),
    ("--evaluations", "1"),
    ("--seeds", "1"),
    ("--single-points", "2"),
    ("--set-points", "2"),
];

/// Options that ask for so much work: no larger numbers are tried.
const WORK: [(&str, f64); 9] = [
    ("--motions", 3.0),
    ("--period", 5.0),
    ("--rate", 1e4),
    ("--starts", 3.0),
    ("--evaluations", 10.0),
    ("--seeds", 1.0),
    ("--single-points", 4.0),
    ("--set-points", 4.0),
    ("--harmonics", 8.0),
];

/// Options whose value is no number of a range: files, names, joints of the robot, and a seed, which may be any.
const OTHERS: [&str; 33] = [
    "--svg",
    "--effect",
    "--format",
    "--loaded",
    "--payload",
    "--prior",
    "--to",
    "--real",
    "--template",
    "--base",
    "--tip",
    "--laws",
    "--joint",
    "--tell",
    "--out",
    "--json",
    "--report",
    "--residuals",
    "--robot",
    "--method",
    "--baseline",
    "--reference",
    "--test",
    "--follow",
    "--planned",
    "--kind",
    "--seed",
    "--elastic",
    "--criterion",
    "--recording",
    "--instant",
    "--help",
    "--version",
];

/// An option of a command and the range that its help says.
#[derive(Debug, Clone)]
struct Ranged {
    command: &'static str,
    option: String,
    low: f64,
    high: f64,
}

impl Ranged {
    fn words(&self, value: &str) -> String {
        let (command, option) = (self.command, &self.option);
        let of_robots = ["simulate", "excite", "paper"].iter().any(|c| command.starts_with(c));
        let known = OPTIONS.iter().filter(|o| o.command == command);
        let fast: String = known
            .filter(|o| of_robots && o.option != *option)
            .filter_map(|o| FAST.iter().find(|(name, _)| *name == o.option))
            .map(|(name, value)| format!(" {name} {value}"))
            .collect();
        format!("{command}{fast} {option}={value}")
    }

    fn run(&self, value: &str) -> Output {
        let words = self.words(value);
        bounded(&FOLDER, &words.split(' ').collect::<Vec<_>>())
    }

    fn is_whole(&self) -> bool {
        [
            "--threads",
            "--harmonics",
            "--points",
            "--motions",
            "--record-every",
            "--starts",
            "--evaluations",
            "--seeds",
        ]
        .contains(&self.option.as_str())
            || self.option.ends_with("-points")
    }

    /// A number of the range: 0 and 1 are its ends; between them the exponent grows evenly where there is room for it.
    fn at(&self, place: f64) -> String {
        let most = WORK.iter().find(|(name, _)| *name == self.option).map_or(self.high, |(_, most)| *most);
        let (low, high) = (self.low, most.min(self.high));
        let value = match place {
            0.0 => low,
            1.0 => high,
            _ if low > 0.0 => low * (high / low).powf(place),
            _ if low == 0.0 => high * 10_f64.powf(-15.0 * (1.0 - place)),
            _ => low + place * (high - low),
        };
        if self.is_whole() { format!("{}", value.round()) } else { format!("{value:e}") }
    }
}

/// Every ranged option of every command, from the help.
static OPTIONS: LazyLock<Vec<Ranged>> = LazyLock::new(|| {
    let mut options = Vec::new();
    for command in COMMANDS {
        let name = command.split(' ').next().unwrap();
        let help = common::words_of(&FOLDER.run(&[name, "--help"]));
        for line in
            help.lines().map(str::trim).filter(|line| line.starts_with("--") || line.starts_with("-h"))
        {
            let option = line.split(' ').find(|word| word.starts_with("--")).unwrap();
            let Some((_, value)) = line.split_once('<') else { continue };
            let range = value.split_once('>').unwrap().0;
            let Some((low, high)) = range.split_once("..") else {
                assert!(OTHERS.contains(&option), "{name} {option} does not say its range");
                continue;
            };
            let (low, high) = (low.parse().unwrap(), high.parse().unwrap());
            options.push(Ranged { command, option: option.to_owned(), low, high });
        }
    }
    assert!(options.len() > 40, "{options:#?}");
    options
});

#[test]
fn outside_of_its_range_every_option_is_refused_with_the_range() {
    for option in OPTIONS.iter() {
        let (below, above) = (option.low - option.low.abs().max(1e-3), option.high * 1.01 + 1.0);
        let whole = |value: f64| if option.is_whole() { value.round() } else { value };
        for value in [format!("{}", whole(below)), format!("{}", whole(above)), "nan".to_owned()] {
            let output = option.run(&value);
            let (words, error) = (option.words(&value), error_of(&output));
            assert_eq!(output.status.code(), Some(2), "{words}: {error}");
            assert!(
                error.contains(&option.option) && error.contains("must be a number from"),
                "{words}: {error}"
            );
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 48, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_number_of_a_range_is_answered_within_bounds(
        which in 0_usize..1000,
        place in prop_oneof![Just(0.0), Just(1.0), 0.0..1.0_f64],
    ) {
        // The cases of `paper` need motions of many seconds; its options are those of `simulate`.
        let tried: Vec<&Ranged> = OPTIONS.iter().filter(|o| !o.command.starts_with("paper")).collect();
        let option = tried[which % tried.len()];
        let value = option.at(place);
        assert_answer(&option.run(&value), &option.words(&value));
    }
}

#[test]
fn a_bad_value_of_an_option_ends_with_status_2() {
    for words in ["identify recording.yaml --cutoff 60", "identify recording.yaml --standstill 1,2,3"] {
        let output = bounded(&FOLDER, &words.split(' ').collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(2), "{words}: {}", error_of(&output));
    }
    for (elastic, part) in [("1:1e-300", "stiffness"), ("1:1e4:1e300", "damping"), ("1:1e4:0:1e300", "play")]
    {
        let output = bounded(&FOLDER, &["simulate", "planar_2r", "--out", "sim", "--elastic", elastic]);
        let error = error_of(&output);
        assert_eq!(output.status.code(), Some(2), "{elastic}: {error}");
        assert!(error.contains(part) && error.contains("must be a number from"), "{elastic}: {error}");
    }
}

#[test]
fn a_step_of_encoders_below_all_digits_is_none() {
    let folder = Folder::new("quantum");
    let simulated = |out: &str, quantum: &str| {
        let words =
            ["--motions", "1", "--period", "0.5", "--rate", "500", "--quantum", quantum, "--out", out];
        let output = folder.run(&[&["simulate", "planar_2r"], &words[..]].concat());
        assert!(output.status.success(), "{}", error_of(&output));
        std::fs::read_to_string(folder.path(&format!("{out}/recording.yaml"))).unwrap()
    };
    assert_eq!(simulated("none", "0"), simulated("tiny", "1e-320"));
}

#[test]
fn tables_with_numbers_beyond_all_robots_are_refused_at_their_place() {
    let folder = Folder::new("tables");
    for (from, to, place) in [
        ("theta: q2, r: 0", "theta: q2, r: -1e308", "arm.yaml:6:"),
        ("constants: {l1: 0.5}", "constants: {l1: 1e200}", "arm.yaml:6:"),
        ("drive: {gear: [50, 50]}", "limits: {velocity: 1e-300}", "arm.yaml:7:"),
    ] {
        folder.write("arm.yaml", &ARM.replace(from, to));
        let output = bounded(&folder, &["show", "./arm.yaml", "--base"]);
        assert_eq!(output.status.code(), Some(2), "{to}");
        assert!(error_of(&output).contains(place), "{to}: {}", error_of(&output));
    }
    folder.write("arm.yaml", &ARM.replace("sigma: 0, alpha: 0, d: l1", "sigma: 0, alpha: 90, d: l1"));
    let output = bounded(&folder, &["show", "./arm.yaml"]);
    assert!(
        output.status.success() && error_of(&output).contains("is it in degrees?"),
        "{}",
        error_of(&output)
    );
}

#[test]
fn what_is_no_file_is_not_read_and_what_is_too_much_is_said() {
    let folder = Folder::new("endless");
    folder.write("motion.csv", &moving(600)).write("recording.yaml", MANIFEST);
    if !std::path::Path::new("/dev/zero").exists() {
        let _ = writeln!(std::io::stderr(), "skipped: there is no /dev/zero");
        return;
    }
    folder.write("robot.yaml", &MANIFEST.replace("robot: planar_2r", "robot: /dev/zero"));
    folder.write("rows.yaml", &MANIFEST.replace("motion.csv", "/dev/zero"));
    let channel =
        MANIFEST.replace("u2], ", "u2], file: motion.csv, ").replace("q2], ", "q2], file: motion.csv, ");
    let channel = channel.replace("time: {", "time: {file: motion.csv, ");
    let (before, _) = channel.split_once("trajectories:").unwrap();
    folder.write("windows.yaml", &format!("{before}trajectories: [{}]\n", "{},".repeat(100_000)));
    folder.write("brackets.yaml", &format!("robot: {}", "[".repeat(200_000)));
    assert!(Command::new("mkfifo").arg(folder.path("pipe")).status().unwrap().success());
    for (words, said) in [
        ("identify robot.yaml", "/dev/zero: cannot read the robot: it is a device or a pipe"),
        ("identify rows.yaml", "it is a device or a pipe"),
        ("identify /dev/zero", "it is a device or a pipe"),
        ("identify pipe", "it is a device or a pipe"),
        ("show /dev/zero", "it is a device or a pipe"),
        ("validate /dev/zero recording.yaml", "it is a device or a pipe"),
        ("simulate planar_2r --out x --follow pipe", "motion1.csv"),
        ("identify windows.yaml", "windows.yaml:7:"),
        ("identify brackets.yaml", "nested deeper than 16 levels"),
        ("show ./brackets.yaml", "nested deeper than 16 levels"),
    ] {
        let output = bounded(&folder, &words.split(' ').collect::<Vec<_>>());
        assert_eq!(output.status.code(), Some(2), "{words}: {}", error_of(&output));
        assert!(error_of(&output).contains(said), "{words}: {}", error_of(&output));
    }
}

#[test]
fn an_array_whose_header_promises_too_many_columns_is_refused() {
    let folder = Folder::new("columns");
    let mut dict = "{'descr': '<f8', 'fortran_order': False, 'shape': (10, 100000000), }".to_owned();
    while !(10 + dict.len() + 1).is_multiple_of(64) {
        dict.push(' ');
    }
    dict.push('\n');
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((dict.len() as u16).to_le_bytes());
    bytes.extend(dict.bytes());
    std::fs::write(folder.path("motion.npy"), &bytes).unwrap();
    // A file of that length with nothing in it takes no room on the disk.
    let file = std::fs::File::options().write(true).open(folder.path("motion.npy")).unwrap();
    if file.set_len(bytes.len() as u64 + 8_000_000_000).is_err() {
        let _ = writeln!(std::io::stderr(), "skipped: no file of 8 GB without content can be made here");
        return;
    }
    let columns = MANIFEST.replace("motion.csv", "motion.npy").replace("column: t", "column: 0");
    let columns = columns.replace("[q1, q2]", "[1, 2]").replace("[u1, u2]", "[3, 4]");
    folder.write("recording.yaml", &columns);
    let output = bounded(&folder, &["identify", "recording.yaml"]);
    assert_eq!(output.status.code(), Some(2), "{}", error_of(&output));
    assert!(error_of(&output).contains("columns"), "{}", error_of(&output));
}
