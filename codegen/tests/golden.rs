//! What the generator writes, to the byte.
//!
//! After a wanted change of the output: `UPDATE_GOLDEN=1 cargo test -p dynid-codegen --test golden`, then read the
//! difference before committing it.
#![allow(clippy::unwrap_used)]

use dynid_codegen::{generate, robot};
use std::path::Path;

fn module(name: &str) -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(format!("../robots/{name}.yaml"));
    let robot = robot::parse(&format!("robots/{name}.yaml"), &std::fs::read(path).unwrap()).unwrap();
    generate(&robot).unwrap()
}

#[test]
fn the_planar_arm_comes_out_as_checked_in() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/golden/planar_2r.rs");
    let found = module("planar_2r");
    if std::env::var_os("UPDATE_GOLDEN").is_some() {
        std::fs::write(&path, &found).unwrap();
    }
    let expected = std::fs::read_to_string(&path).unwrap();
    for (line, (found, expected)) in found.lines().zip(expected.lines()).enumerate() {
        assert_eq!(found, expected, "line {} of {}", line + 1, path.display());
    }
    assert_eq!(found.len(), expected.len(), "{} ends earlier or later", path.display());
}

#[test]
fn the_same_table_gives_the_same_bytes() {
    assert_eq!(module("tx40"), module("tx40"));
}

/// rustc overflows its stack on functions of a few thousand statements.
#[test]
fn no_function_exceeds_a_thousand_statements() {
    for name in ["panda", "branched", "tx40"] {
        let mut statements = 0;
        for line in module(name).lines() {
            if line.starts_with("    ") && line.ends_with(';') && !line.starts_with("     ") {
                statements += 1;
            }
            if line == "}" {
                assert!(statements <= 1000, "{name}: {statements} statements");
                statements = 0;
            }
        }
    }
}
