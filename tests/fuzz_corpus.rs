//! The inputs of the fuzz targets as ordinary tests, and their near neighbours: bytes changed, removed, repeated.

use std::fs;
use std::path::PathBuf;

use proptest::prelude::*;

#[path = "../fuzz/targets.rs"]
mod targets;

type Target = fn(&[u8]);

const TARGETS: [(&str, Target); 9] = [
    ("robot", targets::robot),
    ("urdf", targets::urdf),
    ("manifest", targets::manifest),
    ("table", targets::table),
    ("array", targets::array),
    ("mcap", targets::mcap),
    ("parquet", targets::parquet),
    ("model", targets::model),
    ("estimate", targets::estimate),
];

/// The inputs of a target, by name.
fn corpus(target: &str) -> Vec<(PathBuf, Vec<u8>)> {
    let folder = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fuzz/corpus").join(target);
    let mut paths: Vec<PathBuf> =
        fs::read_dir(folder).expect("a folder of inputs").map(|e| e.expect("an input").path()).collect();
    paths.sort();
    paths.into_iter().map(|path| (path.clone(), fs::read(path).expect("an input"))).collect()
}

#[test]
fn every_input_of_the_corpus_is_answered() {
    for (name, target) in TARGETS {
        let inputs = corpus(name);
        assert!(inputs.len() >= 3, "{name} has {} inputs", inputs.len());
        for (path, bytes) in inputs {
            let answered = std::panic::catch_unwind(|| target(&bytes));
            assert!(answered.is_ok(), "{}", path.display());
        }
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn what_is_near_an_input_is_answered(
        (which, input) in (0..TARGETS.len(), any::<prop::sample::Index>()),
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>(), 0..3_u8, 1..40_usize), 1..6),
    ) {
        let (name, target) = TARGETS[which];
        let inputs = corpus(name);
        let mut bytes = input.get(&inputs).1.clone();
        for (at, byte, kind, length) in changes {
            if bytes.is_empty() {
                break;
            }
            let at = at.index(bytes.len());
            let end = (at + length).min(bytes.len());
            match kind {
                0 => bytes[at] = byte,
                1 => { bytes.drain(at..end); }
                _ => { let again = bytes[at..end].to_vec(); bytes.splice(at..at, again); }
            }
        }
        target(&bytes);
    }
}
