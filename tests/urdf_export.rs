//! From a recording to a URDF and MJCF with identified bodies: what was not identified stays byte for byte, every body has a
//! density, and other tools have dynid's torques of it.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use std::io::Write as _;
use std::path::Path;
use std::process::Command;
use std::sync::LazyLock;

use common::{Folder, error_of, words_of};
use dynid_codegen::base::base_set;
use dynid_codegen::numeric_robot;
use dynid_codegen::robot::parse;
use dynid_runtime::model::{ParameterKind, RecursiveModel, Robot, torques_at};
use dynid_urdf::{ImportOptions, Skeleton, import, read};

const TEMPLATE: &str = include_str!("urdf/leaning.urdf");
const JOINTS: [&str; 5] = ["waist", "shoulder", "elbow", "reach", "wrist"];

const RECORDING: &str = "\
robot: ./leaning.urdf
time: {column: t, unit: s}
position: {columns: [q1, q2, q3, q4, q5], unit: [rad, rad, rad, m, rad]}
torque: {columns: [u1, u2, u3, u4, u5], unit: [N.m, N.m, N.m, N, N.m]}
trajectories: [{file: motion.csv}]
";

fn robot_of(urdf: &str) -> Robot {
    let urdf = read(urdf.as_bytes(), 1e-8).unwrap();
    let yaml = import(&urdf, "arm.urdf", &ImportOptions::default()).unwrap().yaml;
    let table = parse("arm.yaml", yaml.as_bytes()).unwrap();
    numeric_robot(&table, &base_set(&table))
}

/// The robot as it is: heavier than its URDF says, with rotors and other friction.
fn truth(robot: &Robot) -> Vec<f64> {
    let nominal = &robot.nominal.as_ref().unwrap().standard;
    let value = |(p, x): (&dynid_runtime::model::StandardParameter, &f64)| match p.kind {
        ParameterKind::Ia => 0.4,
        ParameterKind::Fv => 1.5 * x + 0.5,
        ParameterKind::Fc => 0.7 * x + 1.0,
        ParameterKind::Off => 0.2,
        // Every length by a tenth, every mass by a quarter: a body again.
        ParameterKind::M => 1.25 * x,
        ParameterKind::MX | ParameterKind::MY | ParameterKind::MZ => 1.25 * 1.1 * x,
        _ => 1.25 * 1.21 * x,
    };
    robot.standard.iter().zip(nominal.iter()).map(value).collect()
}

fn state(t: f64) -> [Vec<f64>; 3] {
    let mut state = [vec![0.0; 5], vec![0.0; 5], vec![0.0; 5]];
    for j in 0..5 {
        let scale = if j == 3 { 0.08 } else { 0.9 };
        let middle = if j == 3 { 0.15 } else { 0.0 };
        state[0][j] = middle;
        for (k, amplitude) in [(1.0, 0.5), (2.3, 0.3), (3.7, 0.2)] {
            let (w, phase) = (k * (0.9 + 0.23 * j as f64), 0.7 * j as f64 + k);
            let a = scale * amplitude;
            state[0][j] += a * (w * t + phase).sin();
            state[1][j] += a * w * (w * t + phase).cos();
            state[2][j] -= a * w * w * (w * t + phase).sin();
        }
    }
    state
}

/// A folder with the recording of the robot, its identified model, and both exports.
static FOLDER: LazyLock<Folder> = LazyLock::new(|| {
    use rand::RngExt;
    use rand::SeedableRng;
    let folder = Folder::new("urdf-export");
    let robot = robot_of(TEMPLATE);
    let chi = robot.base_from_standard(&truth(&robot));
    let model = RecursiveModel::new(robot).unwrap();
    let mut random = rand_pcg::Pcg64::seed_from_u64(4);
    let mut csv = String::from("t,q1,q2,q3,q4,q5,u1,u2,u3,u4,u5\n");
    for k in 0..6000 {
        let t = k as f64 * 0.005;
        let [q, dq, ddq] = state(t);
        let torque = torques_at(&model, &chi, &q, &dq, &ddq);
        let noisy = torque.iter().map(|u| u + 0.3 * (random.random::<f64>() - 0.5));
        let numbers: Vec<String> = q.iter().copied().chain(noisy).map(|x| format!("{x:.9}")).collect();
        csv.push_str(&format!("{t},{}\n", numbers.join(",")));
    }
    folder.write("leaning.urdf", TEMPLATE).write("recording.yaml", RECORDING).write("motion.csv", &csv);
    for words in [
        "identify recording.yaml --out model.json",
        "export model.json --to urdf --template leaning.urdf --out better.urdf",
        "export model.json --to mjcf --template leaning.urdf --out better.xml",
        "export model.json --to mjcf --out table.xml",
        "export model.json --to urdf --out table.urdf",
    ] {
        let output = folder.run(&words.split(' ').collect::<Vec<_>>());
        assert!(output.status.success(), "{words}: {}", error_of(&output));
    }
    folder
});

fn text(name: &str) -> String {
    std::fs::read_to_string(FOLDER.path(name)).unwrap()
}

/// Standard parameters that are written beside an export.
fn written(name: &str) -> Vec<(String, f64)> {
    let beside: serde_json::Value = serde_json::from_str(&text(name)).unwrap();
    let list = beside["standard_parameters"].as_array().unwrap();
    list.iter().map(|p| (p["name"].as_str().unwrap().to_owned(), p["value"].as_f64().unwrap())).collect()
}

/// The text without what an export may change.
fn rest(text: &str) -> String {
    let mut out = String::new();
    let mut open = text;
    while let Some(start) = open.find("<inertial>") {
        let end = start + open[start..].find("</inertial>").unwrap();
        out.push_str(&open[..start]);
        open = &open[end..];
    }
    out.push_str(open);
    out.lines().filter(|line| !line.contains("<dynamics")).collect::<Vec<_>>().join("\n")
}

#[test]
fn everything_but_inertials_and_friction_stays_byte_for_byte() {
    let better = text("better.urdf");
    assert_eq!(rest(&better), rest(TEMPLATE));
    assert_ne!(better, TEMPLATE);
    // The base does not move, and the tool is lumped into the hand: both keep their own.
    let inertial = |text: &str, link: &str| {
        let at = text.find(&format!("<link name=\"{link}\">")).unwrap();
        text[at..at + text[at..].find("</link>").unwrap()].to_owned()
    };
    for link in ["base", "tool"] {
        assert_eq!(inertial(&better, link), inertial(TEMPLATE, link));
    }
    assert_ne!(inertial(&better, "hand"), inertial(TEMPLATE, "hand"));
}

#[test]
fn the_urdf_has_the_torques_of_its_parameters_and_every_body_has_a_density() {
    let robot = robot_of(TEMPLATE);
    let parameters = written("better.urdf.json");
    let standard: Vec<f64> = parameters.iter().map(|(_, x)| *x).collect();
    for (name, frame) in [("better.urdf", 0.0), ("table.urdf", 0.0)] {
        let again = robot_of(&text(name));
        let beside = written(&format!("{name}.json"));
        let own: Vec<f64> = beside.iter().map(|(_, x)| *x).collect();
        let inertial = |robot: &Robot, all: &[f64]| -> Vec<f64> {
            let only = robot.standard.iter().zip(all);
            let only =
                only.map(|(p, x)| if ParameterKind::INERTIAL.contains(&p.kind) { *x } else { *x * frame });
            robot.base_from_standard(&only.collect::<Vec<_>>())
        };
        let chi = inertial(&robot, &own);
        let back = inertial(&again, &again.nominal.as_ref().unwrap().standard);
        let (ours, theirs) =
            (RecursiveModel::new(robot.clone()).unwrap(), RecursiveModel::new(again).unwrap());
        for k in 0..20 {
            let [q, dq, ddq] = state(0.37 * k as f64);
            let (a, b) = (torques_at(&ours, &chi, &q, &dq, &ddq), torques_at(&theirs, &back, &q, &dq, &ddq));
            let largest = a.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            a.iter().zip(&b).for_each(|(a, b)| assert!((a - b).abs() < 1e-9 * largest, "{name}: {a} {b}"));
        }
    }
    let skeleton = Skeleton::of_table(&robot, &standard);
    assert!(skeleton.segments.iter().all(|segment| segment.body.is_possible()));
}

/// The template with geometry: a column that is far within its own, an upper arm whose box is drawn beside it, a mesh, and
/// meshes and links without.
fn with_geometry() -> String {
    let parts = [
        ("column", "<cylinder radius=\"0.4\" length=\"0.8\"/>", "0 0 0.1"),
        ("upper", "<box size=\"0.2 0.3 0.5\"/>", "0.3 0.03 0.21"),
        ("fore", "<mesh filename=\"fore.stl\" scale=\"0.001 0.001 0.001\"/>", "0 0 0"),
        ("slide", "<mesh filename=\"package://arm/slide.dae\"/>", "0 0 0"),
    ];
    parts.iter().fold(TEMPLATE.to_owned(), |text, (link, geometry, xyz)| {
        let open = format!("<link name=\"{link}\">");
        let own = format!("<collision><origin xyz=\"{xyz}\"/><geometry>{geometry}</geometry></collision>");
        text.replace(&open, &format!("{open}{own}"))
    })
}

/// An ASCII STL with these corners, mm.
fn stl() -> String {
    let corners = [-300.0, 500.0].map(|x| [-300.0, 300.0].map(|y| [-300.0, 300.0].map(|z| [x, y, z])));
    let facets = corners.iter().flatten().flatten().map(|[x, y, z]| {
        let vertex = format!("vertex {x} {y} {z}\n").repeat(3);
        format!("facet normal 0 0 1\nouter loop\n{vertex}endloop\nendfacet\n")
    });
    format!("solid fore\n{}endsolid fore\n", facets.collect::<String>())
}

#[test]
fn bodies_stay_within_the_geometry_of_the_prior_and_what_has_none_is_named() {
    FOLDER.write("bounded.urdf", &with_geometry()).write("fore.stl", &stl());
    let words =
        "identify recording.yaml --physical --prior bounded.urdf --json bounded.json --report bounded.html";
    let output = FOLDER.run(&words.split(' ').collect::<Vec<_>>());
    assert!(output.status.success(), "{}", error_of(&output));
    let (said, warned) = (words_of(&output), error_of(&output));
    assert!(said.contains("held back by it") && said.contains("it has no <collision>"), "{said}");
    assert!(
        warned.contains("'upper'") && warned.contains("not that of a body within its geometry"),
        "{warned}"
    );
    assert!(
        text("bounded.html").contains("held back by it")
            && text("bounded.html").contains("The prior has weight")
    );
    assert!(said.contains("the prior has weight"), "{said}");
    let json: serde_json::Value = serde_json::from_str(&text("bounded.json")).unwrap();
    let [weight, from_data, determined] =
        ["prior_weight", "from_data", "determined"].map(|key| json["bodies"][key].as_f64().unwrap());
    assert!(weight > 0.0 && from_data > 0.0 && from_data < determined, "{json}");
    let links = json["bodies"]["ellipsoids"].as_array().unwrap();
    let of = |name: &str| links.iter().find(|link| link["link"] == name).unwrap();
    assert!(of("upper")["active"] == true && of("upper")["margin_of_prior"].as_f64().unwrap() < 0.0);
    assert!(of("upper")["margin"].as_f64().unwrap().abs() < 1e-9);
    for link in ["column", "fore"] {
        assert!(of(link)["active"] == false && of(link)["margin"].as_f64().unwrap() > 0.5, "{json}");
    }
    assert!(of("slide")["none_because"].as_str().unwrap().contains("slide.dae"));
    // A robot whose arm is where its geometry is not costs something, and the arm is named.
    let [with, without] =
        [&json["bodies"]["least"], &json["bodies"]["without_ellipsoids"][1]].map(|x| x.as_f64().unwrap());
    assert!(with > 100.0 && without < 10.0, "{with} {without}");
    let costs = json["bodies"]["impossible"].as_array().unwrap();
    let arm = costs.iter().find(|one| one["what"] == "link 2").unwrap();
    assert!(arm["least"].as_f64().unwrap() < 0.1 * with, "{costs:?}");
}

#[test]
fn a_recording_of_a_urdf_and_the_table_imported_from_it_have_its_geometry() {
    let folder = Folder::new("urdf-geometry");
    folder.write("bounded.urdf", &with_geometry()).write("fore.stl", &stl());
    folder.write("motion.csv", &text("motion.csv"));
    folder.write("urdf.yaml", &RECORDING.replace("./leaning.urdf", "./bounded.urdf"));
    folder.write("table.yaml", &RECORDING.replace("./leaning.urdf", "./arm.yaml"));
    let bodies = |words: &str| -> serde_json::Value {
        let output = folder.run(&words.split(' ').collect::<Vec<_>>());
        assert!(output.status.success(), "{words}: {}", error_of(&output));
        common::json_of(&output)["bodies"].clone()
    };
    let given = bodies("identify urdf.yaml --physical --prior bounded.urdf --json -");
    assert_eq!(bodies("identify urdf.yaml --physical --json -"), given);
    let output = folder.run(&["import", "bounded.urdf", "--out", "arm.yaml"]);
    assert!(output.status.success(), "{}", error_of(&output));
    let yaml = std::fs::read_to_string(folder.path("arm.yaml")).unwrap();
    let (_, ellipsoids) = yaml.split_once("\nellipsoids:").unwrap();
    assert_eq!(ellipsoids.matches("{frame: ").count(), 3, "{ellipsoids}");
    for why in ["'hand' has an <inertial> and no <collision>", "of 'slide' the mesh package://arm/slide.dae"]
    {
        assert!(ellipsoids.contains(why), "{ellipsoids}");
    }
    // The same links are held back by the same bounds.
    let table = bodies("identify table.yaml --physical --json -");
    let links = |bodies: &serde_json::Value| -> Vec<(u64, Option<bool>)> {
        let all = bodies["ellipsoids"].as_array().unwrap();
        let one = |link: &serde_json::Value| {
            let bounded = link["margin"].is_number().then(|| link["active"] == true);
            (link["frame"].as_u64().unwrap(), bounded)
        };
        all.iter().map(one).collect()
    };
    assert_eq!(links(&table), links(&given));
    let least = |bodies: &serde_json::Value| bodies["least"].as_f64().unwrap();
    assert!((least(&table) / least(&given) - 1.0).abs() < 1e-2, "{} {}", least(&table), least(&given));
}

#[test]
fn the_bodies_have_the_identified_base_parameters_within_their_uncertainty() {
    let beside: serde_json::Value = serde_json::from_str(&text("better.urdf.json")).unwrap();
    let robot = robot_of(TEMPLATE);
    let expected = robot.base_from_standard(&truth(&robot));
    let [distance, least] = [0, 1].map(|k| beside["distance"][k].as_f64().unwrap());
    let count = robot.base.len() as f64;
    assert!(least < count && distance <= least + count + 1e-6, "{distance} {least}");
    for (p, truth) in beside["base_parameters"].as_array().unwrap().iter().zip(expected) {
        let (value, sigma) = (p["value"].as_f64().unwrap(), p["sigma"].as_f64().unwrap());
        assert!((value - truth).abs() < 6.0 * sigma + 1e-3 * truth.abs(), "{p} {truth}");
    }
    let left: Vec<&str> =
        beside["not_in_the_format"].as_array().unwrap().iter().map(|x| x["name"].as_str().unwrap()).collect();
    assert!(left.contains(&"Ia3") && left.contains(&"off1"), "{left:?}");
    let said = words_of(&FOLDER.run(&["export", "model.json", "--to", "urdf", "--out", "again.urdf"]));
    assert!(said.contains("from the data, %") && said.contains("cannot hold"), "{said}");
}

#[test]
fn a_template_of_another_robot_is_refused() {
    let other = TEMPLATE.replace("xyz=\"0.05 0.12 0.2\"", "xyz=\"0.05 0.22 0.2\"");
    FOLDER.write("other.urdf", &other.replace("<axis xyz=\"0 1 0\"/>", "<axis xyz=\"0 0.8 0.6\"/>"));
    let words = ["export", "model.json", "--to", "urdf", "--template", "other.urdf", "--out", "none.urdf"];
    let output = FOLDER.run(&words);
    assert_eq!(output.status.code(), Some(2));
    assert!(error_of(&output).contains("'shoulder' of the template"), "{}", error_of(&output));
    let output = FOLDER.run(&[&words[..], &["--tip", "fore"]].concat());
    assert!(error_of(&output).contains("5 joints, the template 3"), "{}", error_of(&output));
}

/// Torques of an exported file by the tool that reads it; `None`, said aloud, where it is not installed.
fn by_its_tool(file: &str, joints: &[&str], states: &[[Vec<f64>; 3]]) -> Option<Vec<Vec<f64>>> {
    let python = std::env::var("DYNID_PYTHON").unwrap_or_else(|_| "python3".to_owned());
    let script = Path::new(env!("CARGO_MANIFEST_DIR")).join("benches/peers/load.py");
    let name = format!("{file}.states.json");
    FOLDER.write(&name, &serde_json::json!({"joints": joints, "states": states}).to_string());
    let output = Command::new(&python).arg(script).arg(FOLDER.path(file)).arg(FOLDER.path(&name)).output();
    let output = match output {
        Ok(output) if output.status.code() != Some(3) => output,
        _ => {
            let _ = writeln!(
                std::io::stderr(),
                "skipped: {python} has no tool that loads {file} (DYNID_PYTHON names one that has)"
            );
            return None;
        }
    };
    assert!(output.status.success(), "{file}: {}", error_of(&output));
    Some(serde_json::from_slice(&output.stdout).unwrap())
}

#[test]
fn pinocchio_and_mujoco_have_the_torques_of_what_was_written() {
    let robot = robot_of(TEMPLATE);
    let model = RecursiveModel::new(robot.clone()).unwrap();
    let states: Vec<[Vec<f64>; 3]> = (0..20).map(|k| state(0.41 * k as f64)).collect();
    let numbered = ["joint1", "joint2", "joint3", "joint4", "joint5"];
    for (file, joints) in
        [("better.urdf", JOINTS), ("table.urdf", numbered), ("better.xml", JOINTS), ("table.xml", numbered)]
    {
        let Some(theirs) = by_its_tool(file, &joints, &states) else { continue };
        let kept = |p: &dynid_runtime::model::StandardParameter| {
            ParameterKind::INERTIAL.contains(&p.kind)
                || (p.kind == ParameterKind::Ia && file.ends_with(".xml"))
        };
        let standard: Vec<f64> = robot
            .standard
            .iter()
            .zip(written(&format!("{file}.json")))
            .map(|(p, (_, x))| if kept(p) { x } else { 0.0 })
            .collect();
        let chi = robot.base_from_standard(&standard);
        for ([q, dq, ddq], theirs) in states.iter().zip(theirs) {
            let ours = torques_at(&model, &chi, q, dq, ddq);
            let largest = ours.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
            for (a, b) in ours.iter().zip(theirs) {
                assert!((a - b).abs() < 1e-9 * largest, "{file}: {a} {b}");
            }
        }
    }
}

#[test]
fn the_five_lines_of_the_readme_make_a_better_urdf() {
    let readme = std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("README.md")).unwrap();
    let block = readme.split("```").find(|block| block.contains("--to urdf --template")).unwrap();
    let lines: Vec<&str> = block.trim().lines().collect();
    assert_eq!(lines.len(), 5, "{block}");
    let folder = Folder::new("urdf-readme");
    let recording = RECORDING.replace("leaning", "arm");
    folder.write("arm.urdf", TEMPLATE).write("recording.yaml", &recording).write("another.yaml", &recording);
    folder.write("motion.csv", &text("motion.csv"));
    for line in lines {
        let words: Vec<&str> = line.trim().strip_prefix("dynid ").unwrap().split(' ').collect();
        let output = folder.run(&words);
        assert!(output.status.success(), "{line}: {}", error_of(&output));
    }
    let better = std::fs::read_to_string(folder.path("better.urdf")).unwrap();
    assert_eq!(rest(&better), rest(TEMPLATE));
    assert!(folder.path("better.xml").is_file() && folder.path("better.urdf.json").is_file());
}

#[test]
fn physical_parameters_predict_as_well_and_are_exported_as_they_are() {
    let output = FOLDER.run(&[
        "identify",
        "recording.yaml",
        "--physical",
        "--prior",
        "leaning.urdf",
        "--out",
        "physical.json",
    ]);
    assert!(output.status.success(), "{}", error_of(&output));
    assert!(words_of(&output).contains("from the data, %"), "{}", words_of(&output));
    let error = |model: &str| {
        let output = FOLDER.run(&["validate", model, "recording.yaml", "--json", "-"]);
        common::json_of(&output)["relative_error"].as_f64().unwrap()
    };
    let (free, bodies) = (error("model.json"), error("physical.json"));
    assert!(bodies < 1.02 * free, "{free} {bodies}");
    // The prior is satisfied by the parameters then: nothing moves.
    let output = FOLDER.run(&["export", "physical.json", "--to", "urdf", "--out", "physical.urdf"]);
    assert!(output.status.success(), "{}", error_of(&output));
    let model: serde_json::Value = serde_json::from_str(&text("physical.json")).unwrap();
    let nominal = model["table"]["nominal"]["standard"].as_array().unwrap();
    for ((name, value), kept) in written("physical.urdf.json").iter().zip(nominal) {
        let kept = kept.as_f64().unwrap();
        assert!((value - kept).abs() <= 1e-6 * (1e-3 + kept.abs()), "{name}: {value} {kept}");
    }
    let output = FOLDER.run(&["identify", "recording.yaml", "--physical", "--prior", "other.yaml"]);
    assert_eq!(output.status.code(), Some(2), "{}", error_of(&output));
}
