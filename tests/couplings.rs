//! Friction between links and springs: torques are those of MuJoCo's tendons (`benches/peers/couplings_reference.py`), by the
//! closed form and by the recursive engine, and what a robot with them does from a simulation to a model.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use common::{Folder, error_of, json_of, words_of};
use dynid_codegen::base::base_set;
use dynid_codegen::mechanics::Equations;
use dynid_codegen::numeric_robot;
use dynid_codegen::robot::parse;
use dynid_codegen::symbolic::Point;
use dynid_runtime::model::{Model, RecursiveModel, torques_at};
use dynid_runtime::model_file::{fingerprint, to_yaml};

fn cases() -> Vec<serde_json::Value> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/couplings.json");
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    assert_eq!(found.len(), expected.len());
    let largest = expected.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < tolerance * largest, "{what}: {found} and {expected}");
    }
}

#[test]
fn torques_are_those_of_tendons_in_mujoco() {
    let cases = cases();
    assert_eq!(cases.len(), 16);
    for (number, case) in cases.iter().enumerate() {
        let yaml = case["yaml"].as_str().unwrap();
        let what = format!("table {number}\n{yaml}");
        let table = parse("random.yaml", yaml.as_bytes()).unwrap_or_else(|m| panic!("{m:?}\n{what}"));
        let set = base_set(&table);
        let equations = Equations::derive(&table, &set).unwrap();
        let model = RecursiveModel::new(numeric_robot(&table, &set)).unwrap();
        let chi = model.robot().base_from_standard(&model.robot().nominal.as_ref().unwrap().standard);
        let states: Vec<[Vec<f64>; 3]> = serde_json::from_value(case["states"].clone()).unwrap();
        let torques: Vec<Vec<f64>> = serde_json::from_value(case["torques"].clone()).unwrap();
        for ([q, dq, ddq], expected) in states.into_iter().zip(&torques) {
            assert_close(&torques_at(&model, &chi, &q, &dq, &ddq), expected, 1e-12, &what);
            let point = Point { q, dq, ddq, chi: chi.clone() };
            let graph = &equations.torque.graph;
            assert_close(&graph.evaluate(&equations.torque.torques, &point), expected, 1e-12, &what);
            let rows = equations.idm.iter().map(|row| equations.graph.evaluate(row, &point));
            let product = |row: Vec<f64>| row.iter().zip(&chi).map(|(w, chi)| w * chi).sum();
            assert_close(&rows.map(product).collect::<Vec<f64>>(), expected, 1e-12, &what);
            // No power is lost between the joints: dh chi is that of the torques.
            let dh = equations.graph.evaluate(&equations.power, &point);
            let power: f64 = dh.iter().zip(&chi).map(|(dh, chi)| dh * chi).sum();
            let moved: f64 = point.dq.iter().zip(expected).map(|(dq, torque)| dq * torque).sum();
            assert_close(&[power], &[moved], 1e-11, &what);
            same_as_recursive(&equations, &model, &point, &what);
        }
    }
}

/// h, dh and M, N of the closed form and of the recursive engine.
fn same_as_recursive(equations: &Equations, model: &RecursiveModel, point: &Point, what: &str) {
    let (n, columns) = (point.q.len(), point.chi.len());
    let (mut h, mut dh) = (vec![0.0; columns], vec![0.0; columns]);
    model.energy(&point.q, &point.dq, &mut h);
    model.power(&point.q, &point.dq, &point.ddq, &mut dh);
    assert_close(&h, &equations.graph.evaluate(&equations.energy, point), 1e-12, what);
    assert_close(&dh, &equations.graph.evaluate(&equations.power, point), 1e-12, what);
    let (mut mass, mut bias) = (vec![0.0; n * n], vec![0.0; n]);
    model.mass_and_bias(&point.chi, &point.q, &point.dq, &mut mass, &mut bias);
    assert_close(&bias, &equations.graph.evaluate(&equations.bias, point), 1e-12, what);
    // The springs' part of dh is the rate of their part of h.
    for (k, base) in model.robot().base.iter().enumerate() {
        if model.robot().standard[base.standard].kind.is_spring() {
            let rate = equations.clone().graph.time_derivative(equations.energy[k]);
            let mut derived = equations.clone();
            let rate_again = derived.graph.time_derivative(equations.energy[k]);
            assert_eq!(rate, rate_again);
            assert_close(&derived.graph.evaluate(&[rate_again], point), &[dh[k]], 1e-12, what);
        }
    }
}

#[test]
fn the_table_of_a_model_says_what_its_yaml_said() {
    for case in cases() {
        let read = |text: &str| {
            let table = parse("random.yaml", text.as_bytes()).unwrap();
            numeric_robot(&table, &base_set(&table))
        };
        let robot = read(case["yaml"].as_str().unwrap());
        let again = read(&to_yaml(&robot));
        assert_eq!(again.couplings, robot.couplings);
        assert_eq!(fingerprint(&again), fingerprint(&robot));
        let mut other = robot.clone();
        other.couplings.to_mut()[0].terms.to_mut()[0].1 *= 2.0;
        assert_ne!(fingerprint(&other), fingerprint(&robot));
    }
}

const ARM: &str = "name: tendons
gravity: [0, -9.81, 0]
frames:
  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}
  - {j: 2, sigma: 0, alpha: 0, d: 0.5, theta: q2, r: 0}
friction:
  - {joints: {q1: 1, q2: -0.5}, name: belt}
springs:
  - {joint: 1}
limits: {position: 1.5, velocity: 3, acceleration: 10, torque: 200}
nominal:
  parameters: {XX1: 0.3, YY1: 0.45, ZZ1: 0.6, MX1: 1, M1: 4, Ia1: 0.4, Fv1: 2, Fc1: 1.5, XX2: 0.1, YY2: 0.22, ZZ2: 0.25, MX2: 0.7, M2: 3, Ia2: 0.3, Fv2: 1, Fc2: 1,
    Fvc_belt: 2.5, Fcc_belt: 3, K1: 12, KR1: 3}
  controller: {kp: [900, 500], kd: [40, 20], ki: 100}
  noise: {position: 1e-6, torque: 0.02}
";

#[test]
fn friction_of_a_belt_and_a_spring_are_identified_from_a_simulation() {
    let folder = Folder::new("tendons");
    folder.write("tendons.yaml", ARM);
    let ok = |words: &[&str]| {
        let output = folder.run(words);
        assert!(output.status.success(), "{words:?}: {}", error_of(&output));
        output
    };
    let shown = words_of(&ok(&["show", "./tendons.yaml", "--base"]));
    for line in ["friction on s = q1 - 0.5*q2: Fvc_belt*ds", "spring on s = q1: K1*s - KR1", "= off1 - KR1"] {
        assert!(shown.contains(line), "{line}\n{shown}");
    }
    ok(&["simulate", "./tendons.yaml", "--out", "a", "--rate", "1000", "--period", "10"]);
    ok(&["identify", "a/recording.yaml", "--out", "m.json"]);
    let model = std::fs::read_to_string(folder.path("m.json")).unwrap();
    let model: serde_json::Value = serde_json::from_str(&model).unwrap();
    let parameters = model["base_parameters"].as_array().unwrap();
    for (name, truth) in [("Fvc_belt", 2.5), ("Fcc_belt", 3.0), ("K1", 12.0), ("Fc1", 1.5), ("off1R", -3.0)] {
        let found = parameters.iter().find(|p| p["name"] == name).unwrap();
        let (value, sigma) = (found["value"].as_f64().unwrap(), found["sigma"].as_f64().unwrap());
        assert!((value - truth).abs() < 5.0 * sigma && sigma < 0.05, "{name}: {value} ± {sigma}, {truth}");
    }
    ok(&["simulate", "m.json", "--out", "b", "--rate", "500", "--period", "6", "--seed", "5"]);
    let output = ok(&["validate", "m.json", "b/recording.yaml", "--json", "-"]);
    assert!(json_of(&output)["relative_error"].as_f64().unwrap() < 0.02);
    for to in ["c", "rust"] {
        ok(&["export", "m.json", "--to", to, "--out", to]);
    }
}

#[test]
fn a_spring_of_the_table_is_not_found_missing() {
    let folder = Folder::new("spring_known");
    // The table with its spring alone, and the same table without it.
    let left_out = |start: &[&str]| -> String {
        let kept = |line: &&str| !start.iter().any(|start| line.starts_with(start));
        ARM.lines().filter(kept).map(|line| format!("{line}\n")).collect()
    };
    let with =
        left_out(&["friction:", "  - {joints"]).replace("Fvc_belt: 2.5, Fcc_belt: 3, K1: 12", "K1: 40");
    folder.write("with.yaml", &with.replace("position: 1.5", "position: 2.5"));
    let without =
        left_out(&["friction:", "  - {joints", "springs:", "  - {joint: 1}", "nominal", "  ", "    F"]);
    let frames: String = ARM.lines().skip(2).take(3).map(|line| format!("{line}\n")).collect();
    folder.write("without.yaml", &without.replace("frames:\n", &frames));
    let findings = |table: &str| -> Vec<String> {
        let recording = std::fs::read_to_string(folder.path("a/recording.yaml")).unwrap();
        let own = recording.lines().find(|line| line.starts_with("robot:")).unwrap().to_owned();
        folder.write("a/other.yaml", &recording.replace(&own, &format!("robot: ../{table}")));
        let output = folder.run(&["diagnose", "a/other.yaml", "--json", "found.json"]);
        assert!(output.status.success(), "{}", error_of(&output));
        let text = std::fs::read_to_string(folder.path("found.json")).unwrap();
        let found: serde_json::Value = serde_json::from_str(&text).unwrap();
        let found = found["findings"].as_array().unwrap().iter();
        found.map(|f| format!("{} {}", f["effect"].as_str().unwrap(), f["joints"])).collect()
    };
    let made = folder.run(&["simulate", "./with.yaml", "--out", "a", "--rate", "500", "--period", "20"]);
    assert!(made.status.success(), "{}", error_of(&made));
    assert_eq!(findings("with.yaml"), [""; 0]);
    assert_eq!(findings("without.yaml"), ["spring [1]"]);
}

#[test]
fn a_balancer_between_points_goes_from_a_simulation_to_a_model_and_into_code() {
    let folder = Folder::new("balancer");
    let line = "springs:\n  - {between: [{frame: 0, point: [0.2, 0.5, 0]}, {frame: 2, point: [0.15, 0, 0]}], name: coil}\n";
    let arm = ARM
        .replace("friction:\n  - {joints: {q1: 1, q2: -0.5}, name: belt}\nsprings:\n  - {joint: 1}\n", line);
    let arm = arm.replace("Fvc_belt: 2.5, Fcc_belt: 3, K1: 12, KR1: 3", "K_coil: 60, KR_coil: 18");
    folder.write("tendons.yaml", &arm);
    let ok = |words: &[&str]| {
        let output = folder.run(words);
        assert!(output.status.success(), "{words:?}: {}", error_of(&output));
        output
    };
    let shown = words_of(&ok(&["show", "./tendons.yaml", "--base"]));
    let words =
        "spring on s = distance of (0.2, 0.5, 0) of frame 0 and (0.15, 0, 0) of frame 2: K_coil*s - KR_coil";
    assert!(shown.contains(words), "{shown}");
    ok(&["simulate", "./tendons.yaml", "--out", "a", "--rate", "1000", "--period", "10"]);
    ok(&["identify", "a/recording.yaml", "--out", "m.json"]);
    let model = std::fs::read_to_string(folder.path("m.json")).unwrap();
    let model: serde_json::Value = serde_json::from_str(&model).unwrap();
    let parameters = model["base_parameters"].as_array().unwrap();
    for (name, truth, unit) in [("K_coil", 60.0, "N/m"), ("KR_coil", 18.0, "N")] {
        let found = parameters.iter().find(|p| p["name"] == name).unwrap();
        let (value, sigma) = (found["value"].as_f64().unwrap(), found["sigma"].as_f64().unwrap());
        assert!((value - truth).abs() < 5.0 * sigma && sigma < 0.05 * truth, "{name}: {value} ± {sigma}");
        assert_eq!(found["unit"], unit);
    }
    // Everything that reads a model knows it: other motion, code, and files that say what they cannot hold.
    ok(&["simulate", "m.json", "--out", "b", "--rate", "500", "--period", "6", "--seed", "5"]);
    let output = ok(&["validate", "m.json", "b/recording.yaml", "--json", "-"]);
    assert!(json_of(&output)["relative_error"].as_f64().unwrap() < 0.02);
    for to in ["c", "rust"] {
        ok(&["export", "m.json", "--to", to, "--out", to]);
    }
    let export = |to: &str, file: &str| {
        ok(&["export", "./tendons.yaml", "--to", to, "--out", file]);
        let text = |name: &str| std::fs::read_to_string(folder.path(name)).unwrap();
        (text(file), text(&format!("{file}.json")))
    };
    let (_, beside) = export("urdf", "arm.urdf");
    assert!(beside.contains("K*s on s = distance of") && beside.contains("ds/dq"), "{beside}");
    let (mjcf, beside) = export("mjcf", "arm.xml");
    assert!(mjcf.contains("<spatial name=") && !beside.contains("distance of"), "{mjcf}\n{beside}");
}
