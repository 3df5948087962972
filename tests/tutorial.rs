//! The commands of `docs/tutorial.md` print what it shows. `UPDATE=1 cargo test --test tutorial` makes its pictures again.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use std::path::PathBuf;

use common::{Folder, error_of, words_of};
use dynid_runtime::report::alone;

fn docs(file: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("docs").join(file)
}

/// Commands with the lines that they are shown to print.
fn commands(page: &str) -> Vec<(String, Vec<String>)> {
    let mut all: Vec<(String, Vec<String>)> = Vec::new();
    for block in page.split("```").skip(1).step_by(2) {
        for line in block.lines() {
            match (line.strip_prefix("$ dynid "), all.last_mut()) {
                (Some(command), _) => all.push((command.to_owned(), Vec::new())),
                (None, Some((_, shown))) if !line.trim().is_empty() => shown.push(line.to_owned()),
                _ => {}
            }
        }
    }
    all
}

/// That lines stand in a text in this order; `...` stands for any, and between two others there is none.
#[track_caller]
fn assert_shown(command: &str, shown: &[String], printed: &str) {
    let lines: Vec<&str> = printed.lines().map(str::trim_end).filter(|line| !line.is_empty()).collect();
    let (mut at, mut skipping) = (0, false);
    for line in shown {
        if line == "..." {
            skipping = true;
            continue;
        }
        let found = if skipping {
            lines[at..].iter().position(|printed| *printed == line.trim_end())
        } else {
            (lines.get(at) == Some(&line.trim_end())).then_some(0)
        };
        let found =
            found.unwrap_or_else(|| panic!("dynid {command}\n'{line}' is not at its place in:\n{printed}"));
        at += found + 1;
        skipping = false;
    }
    assert!(skipping || at == lines.len(), "dynid {command}\nprints more than is shown:\n{printed}");
}

/// A picture of the report, by the beginning of its caption.
fn of_report(report: &str, caption: &str) -> String {
    let at = report.find(caption).unwrap_or_else(|| panic!("the report has no picture '{caption}'"));
    let from = at + report[at..].find("<svg").unwrap();
    let to = from + report[from..].find("</svg>").unwrap() + "</svg>".len();
    alone(&report[from..to])
}

/// The figure that a list of motions names.
fn figure(list: &str) -> String {
    let (_, name) = list.split_once("figure: ").unwrap();
    format!("motions/{}", name.split('}').next().unwrap())
}

/// The last curve of a picture: of a report's, the law.
fn curve(svg: &str) -> Option<&str> {
    let (_, path) = svg.rsplit_once(" d=\"M")?;
    path.split('"').next()
}

#[test]
fn every_command_of_the_tutorial_prints_what_it_shows() {
    let page = std::fs::read_to_string(docs("tutorial.md")).unwrap();
    let folder = Folder::new("tutorial");
    let commands = commands(&page);
    assert!(commands.len() > 10, "{commands:?}");
    for (command, shown) in &commands {
        let output = folder.run(&command.split(' ').collect::<Vec<_>>());
        assert!(output.status.success(), "dynid {command}: {}", error_of(&output));
        assert!(!shown.is_empty(), "dynid {command}: nothing is shown of it");
        assert_shown(command, shown, &words_of(&output));
    }

    let read = |name: &str| std::fs::read_to_string(folder.path(name)).unwrap();
    let residual = of_report(&read("report.html"), "What the standard model leaves, over joint speed");
    // What else a page puts into its pictures is no matter of the tutorial.
    let pictures = [
        ("tutorial_motion.svg", read(&figure(&read("motions/motions.yaml"))), true),
        ("tutorial_law.svg", read("law.svg"), true),
        ("tutorial_residual.svg", residual, false),
    ];
    for (name, made, to_the_byte) in pictures {
        assert!(page.contains(&format!("]({name})")), "{name} is not in the tutorial");
        if std::env::var_os("UPDATE").is_some() {
            std::fs::write(docs(name), made).unwrap();
            continue;
        }
        let committed = std::fs::read_to_string(docs(name)).unwrap_or_default();
        assert!(
            if to_the_byte { committed == made } else { curve(&committed) == curve(&made) },
            "docs/{name} is not what the commands make: `UPDATE=1 cargo test --test tutorial`"
        );
    }
}
