//! `docs/reference.md` says what the program says. `UPDATE=1 cargo test --test reference` writes its generated parts again.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use std::fmt::Write as _;

use common::{Folder, error_of, json_of, words_of};
use dynid_runtime::model::{CouplingLaw, JointKind, ParameterKind};
use dynid_runtime::recording::{Quantity, Unit};
use serde_json::Value;

const PATH: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/reference.md");

fn reference() -> String {
    std::fs::read_to_string(PATH).unwrap()
}

/// The page with its generated parts as they are to be.
fn renewed(page: &str) -> String {
    let folder = Folder::new("reference");
    let mut page = page.to_owned();
    let parts = [
        ("parameters", parameters()),
        ("units", units()),
        ("effects", effects(&folder)),
        ("json", json(&folder)),
        ("commands", commands(&folder)),
    ];
    for (name, text) in parts {
        let begin = format!("<!-- generated: {name} -->\n");
        let at = page.find(&begin).unwrap_or_else(|| panic!("{name} has no place")) + begin.len();
        let end = at + page[at..].find("<!-- end -->").unwrap();
        page.replace_range(at..end, &format!("\n{}\n\n", text.trim()));
    }
    page
}

#[test]
fn the_generated_parts_of_the_reference_are_what_the_program_says() {
    let page = reference();
    let renewed = renewed(&page);
    if std::env::var_os("UPDATE").is_some() {
        std::fs::write(PATH, &renewed).unwrap();
        return;
    }
    let differs = page.lines().zip(renewed.lines()).find(|(is, should)| is != should);
    assert!(
        page == renewed,
        "docs/reference.md is not what the program says: {differs:?}. `UPDATE=1 cargo test --test reference` writes it"
    );
}

fn parameters() -> String {
    let mut text = String::from("| name | unit | of a prismatic joint | what |\n|---|---|---|---|\n");
    let all = ParameterKind::INERTIAL.into_iter().chain(ParameterKind::JOINT).chain(ParameterKind::MOTOR);
    let of_couplings = [CouplingLaw::Friction, CouplingLaw::Spring].map(CouplingLaw::parameters).concat();
    for kind in all.chain(of_couplings) {
        let [turns, slides] = [JointKind::Revolute, JointKind::Prismatic].map(|joint| kind.unit(joint));
        let slides = if slides == turns { "" } else { slides };
        writeln!(text, "| `{}` | {turns} | {slides} | {} |", kind.symbol(), kind.meaning()).unwrap();
    }
    text
}

fn units() -> String {
    use Quantity::{Angle, AngularVelocity, Force, Length, LinearVelocity, Raw, Time, Torque};
    let mut text = String::from("| quantity | units |\n|---|---|\n");
    let all = [
        ("angle", Angle),
        ("length", Length),
        ("angular velocity", AngularVelocity),
        ("velocity", LinearVelocity),
        ("torque", Torque),
        ("force", Force),
        ("time", Time),
        ("a drive's own, with a `gain`", Raw),
    ];
    for (name, quantity) in all {
        let units: Vec<String> =
            Unit::names_of(&[quantity]).split(", ").map(|unit| format!("`{unit}`")).collect();
        writeln!(text, "| {name} | {} |", units.join(" ")).unwrap();
    }
    text
}

fn effects(folder: &Folder) -> String {
    let all = json_of(&folder.run(&["effects", "--json", "-"]));
    let mut text = String::from("| id | what | law | quantities |\n|---|---|---|---|\n");
    for effect in all.as_array().unwrap() {
        let word = |key: &str| effect[key].as_str().unwrap().replace('|', "\\|");
        let texts = |key: &str| -> Vec<String> {
            effect[key].as_array().unwrap().iter().map(|x| x.as_str().unwrap().replace('|', "\\|")).collect()
        };
        let mut laws: Vec<String> = texts("laws").iter().map(|law| format!("`{law}`")).collect();
        if laws.is_empty() {
            laws.push(word("torque"));
        }
        let quantity = |symbol: &Value| {
            let (name, unit) = (symbol["name"].as_str().unwrap(), symbol["unit"].as_str().unwrap());
            let unit = if matches!(unit, "" | "1") { String::new() } else { format!(" {unit}") };
            format!("`{name}`{unit}: {}", symbol["meaning"].as_str().unwrap())
        };
        let symbols = effect["symbols"].as_array().unwrap();
        let own = |symbol: &&Value| !["q", "dq", "ddq"].contains(&symbol["name"].as_str().unwrap());
        let quantities: Vec<String> = symbols.iter().filter(own).map(quantity).collect();
        let baseline = if effect["needs_baseline"] == true { " Needs a baseline." } else { "" };
        writeln!(
            text,
            "| `{}` | {}{baseline} | {} | {} |",
            word("id"),
            word("what"),
            laws.join("<br>"),
            quantities.join("; ").replace('|', "\\|")
        )
        .unwrap();
    }
    text
}

/// The form of a JSON value: names and types, of a list that of its first item.
fn form(value: &Value, depth: usize) -> String {
    let indent = "  ".repeat(depth + 1);
    match value {
        Value::Null => "null".to_owned(),
        Value::Bool(_) => "true or false".to_owned(),
        Value::Number(_) => "number".to_owned(),
        Value::String(_) => "text".to_owned(),
        Value::Array(items) => match items.first() {
            Some(item) => format!("[{}]", form(item, depth)),
            None => "[]".to_owned(),
        },
        Value::Object(fields) => {
            let lines: Vec<String> = fields
                .iter()
                .map(|(key, value)| format!("{indent}\"{key}\": {}", form(value, depth + 1)))
                .collect();
            format!("{{\n{}\n{}}}", lines.join(",\n"), "  ".repeat(depth))
        }
    }
}

fn json(folder: &Folder) -> String {
    let run = |words: &str| {
        let output = folder.run(&words.split(' ').collect::<Vec<_>>());
        assert!(output.status.success(), "{words}: {}", error_of(&output));
        output
    };
    run("simulate planar_2r --effect stribeck:1 --rate 2000 --record-every 4 --out fit");
    run(
        "simulate planar_2r --effect stribeck:1 --rate 2000 --record-every 4 --seed 2 --motions 1 --out test",
    );
    run("identify fit/recording.yaml --out model.json");
    folder.write("motion.csv", &common::moving(400));
    let mut text = String::new();
    for words in [
        "identify fit/recording.yaml --json -",
        "validate model.json test/recording.yaml --json -",
        "diagnose fit/recording.yaml --test test/recording.yaml --json -",
        "look motion.csv --json -",
        "effects stribeck --json -",
    ] {
        let shown = words.trim_end_matches(" -");
        writeln!(text, "`dynid {shown}`\n\n```\n{}\n```\n", form(&json_of(&run(words)), 0)).unwrap();
    }
    text
}

fn commands(folder: &Folder) -> String {
    let help = |words: &[&str]| words_of(&folder.run(words)).trim().to_owned();
    let all = help(&["--help"]);
    let names =
        all.lines().skip_while(|line| *line != "Commands:").skip(1).take_while(|line| !line.is_empty());
    let names = names.filter_map(|line| line.split_whitespace().next()).filter(|name| *name != "help");
    let mut text = String::new();
    for name in names {
        writeln!(text, "### dynid {name}\n\n```\n{}\n```\n", help(&[name, "--help"])).unwrap();
    }
    text
}

/// The keys that a reader lists where it meets one that it does not know.
fn listed(error: &str) -> Vec<String> {
    let (_, list) = error.split_once("expected ").unwrap_or_else(|| panic!("no list in: {error}"));
    // One reader writes `a`, `b` or `c`, the other a, b, c; what helps may follow.
    if list.contains('`') {
        let parts: Vec<&str> = list.split('`').collect();
        let goes_on = |pair: &&[&str]| matches!(pair[0], "one of " | "" | ", " | " or ");
        return parts.chunks_exact(2).take_while(goes_on).map(|pair| pair[1].to_owned()).collect();
    }
    let list = list.lines().next().unwrap_or_default().trim_start_matches("one of ");
    list.split(", ").map(str::to_owned).collect()
}

/// That the part of the reference from `heading` to the next one of its level has each of the keys.
#[track_caller]
fn assert_told(heading: &str, keys: &[String]) {
    let page = reference();
    let (_, part) = page.split_once(&format!("\n## {heading}\n")).unwrap();
    let part = part.split("\n## ").next().unwrap();
    assert!(keys.len() > 1, "{heading}: {keys:?}");
    for key in keys {
        assert!(part.contains(&format!("`{key}`")), "`{key}` does not stand under {heading}");
    }
}

#[test]
fn every_key_of_a_robot_yaml_stands_in_the_reference() {
    let folder = Folder::new("reference-robot");
    let whole = "name: arm\nframes: [{j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}]\n";
    let places = [
        format!("{whole}zzzz: 1\n"),
        whole.replace("r: 0", "r: 0, zzzz: 0"),
        format!("{whole}drive: {{zzzz: 1}}\n"),
        format!("{whole}limits: {{zzzz: 1}}\n"),
        format!("{whole}nominal: {{zzzz: 1}}\n"),
        format!("{whole}nominal: {{controller: {{zzzz: 1}}}}\n"),
        format!("{whole}nominal: {{noise: {{zzzz: 1}}}}\n"),
    ];
    for text in places {
        let error = error_of(&folder.write("arm.yaml", &text).run(&["show", "./arm.yaml"]));
        assert_told("Robot YAML", &listed(&error));
    }
}

#[test]
fn every_key_of_a_recording_yaml_stands_in_the_reference() {
    let folder = Folder::new("reference-recording");
    let whole = "robot: planar_2r\ntime: {column: t}\nposition: {columns: [q1, q2]}\ntorque: {columns: [u1, u2]}\n\
                 trajectories: [{file: a.csv}]\n";
    let places = [
        format!("{whole}zzzz: 1\n"),
        whole.replace("column: t", "zzzz: t"),
        whole.replace("{columns: [q1", "{zzzz: 1, columns: [q1"),
        whole.replace("{file: a.csv}", "{zzzz: 1}"),
        format!("{whole}layout: {{zzzz: 1}}\n"),
        format!("{whole}fields: {{zzzz: 1}}\n"),
        format!("{whole}temperature: {{zzzz: 1}}\n"),
    ];
    for text in places {
        let error = error_of(&folder.write("r.yaml", &text).run(&["look", "r.yaml"]));
        assert_told("Recording YAML", &listed(&error));
    }
}

#[test]
fn every_key_of_laws_and_payloads_stands_in_the_reference() {
    let folder = Folder::new("reference-others");
    folder.write("motion.csv", &common::moving(400)).write("r.yaml", common::MANIFEST);
    folder.write("laws.yaml", "- {zzzz: 1}\n");
    let error = error_of(&folder.run(&["diagnose", "r.yaml", "--laws", "laws.yaml"]));
    assert_told("Other files", &listed(&error));
    for text in ["zzzz: 1\n", "mass: 1\ncentre: [0, 0, 0]\ninertia: {zzzz: 1}\n"] {
        folder.write("payload.yaml", text);
        let error =
            error_of(&folder.run(&["identify", "r.yaml", "--loaded", "r.yaml", "--payload", "payload.yaml"]));
        assert_told("Other files", &listed(&error));
    }
}
