//! Tables whose frames move with several joint variables: torques are those of Pinocchio with one joint a frame, projected
//! (`benches/peers/dependent_reference.py`), by the closed form and by the recursive engine.
#![allow(clippy::unwrap_used, reason = "a test that cannot set itself up has failed")]

mod common;

use common::{Folder, error_of, json_of, words_of};
use dynid_codegen::base::base_set;
use dynid_codegen::mechanics::Equations;
use dynid_codegen::numeric_robot;
use dynid_codegen::robot::parse;
use dynid_codegen::symbolic::Point;
use dynid_runtime::model::{Model, ParameterKind, RecursiveModel, Robot, torques_at};

/// A table, its bodies, states, and the torques that they need.
struct Case {
    yaml: String,
    bodies: Vec<Vec<f64>>,
    states: Vec<[Vec<f64>; 3]>,
    torques: Vec<Vec<f64>>,
}

fn cases() -> Vec<Case> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/dependent.json");
    let all: Vec<serde_json::Value> = serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap();
    let read = |case: &serde_json::Value| Case {
        yaml: case["yaml"].as_str().unwrap().to_owned(),
        bodies: serde_json::from_value(case["bodies"].clone()).unwrap(),
        states: serde_json::from_value(case["states"].clone()).unwrap(),
        torques: serde_json::from_value(case["torques"].clone()).unwrap(),
    };
    all.iter().map(read).collect()
}

/// chi of bodies alone.
fn base_of(robot: &Robot, bodies: &[Vec<f64>]) -> Vec<f64> {
    let value = |kind: ParameterKind, frame: usize| bodies[frame].get(kind as usize).copied().unwrap_or(0.0);
    let standard: Vec<f64> = robot.standard.iter().map(|p| value(p.kind, p.frame)).collect();
    robot.base_from_standard(&standard)
}

fn assert_close(found: &[f64], expected: &[f64], what: &str) {
    let largest = expected.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < 1e-12 * largest, "{what}: {found} and {expected}");
    }
}

#[test]
fn torques_are_those_of_projected_jacobians() {
    let cases = cases();
    assert_eq!(cases.len(), 24);
    for (number, case) in cases.iter().enumerate() {
        let table =
            parse("random.yaml", case.yaml.as_bytes()).unwrap_or_else(|m| panic!("{m:?}\n{}", case.yaml));
        let set = base_set(&table);
        let robot = numeric_robot(&table, &set);
        let chi = base_of(&robot, &case.bodies);
        let equations = Equations::derive(&table, &set).unwrap();
        let model = RecursiveModel::new(robot).unwrap();
        for ([q, dq, ddq], expected) in case.states.iter().zip(&case.torques) {
            let what = format!("table {number}\n{}", case.yaml);
            assert_close(&torques_at(&model, &chi, q, dq, ddq), expected, &what);
            let point = Point { q: q.clone(), dq: dq.clone(), ddq: ddq.clone(), chi: chi.clone() };
            let torque = equations.torque.graph.evaluate(&equations.torque.torques, &point);
            assert_close(&torque, expected, &what);
            let rows = equations.idm.iter().map(|row| equations.graph.evaluate(row, &point));
            let product = |row: Vec<f64>| row.iter().zip(&chi).map(|(w, chi)| w * chi).sum();
            assert_close(&rows.map(product).collect::<Vec<f64>>(), expected, &what);
            let moved = dynamics(&model, &chi, [q, dq, ddq]);
            assert_close(&moved, expected, &what);
        }
    }
}

/// M ddq + N.
fn dynamics(model: &dyn Model, chi: &[f64], [q, dq, ddq]: [&[f64]; 3]) -> Vec<f64> {
    let n = q.len();
    let (mut mass, mut bias) = (vec![0.0; n * n], vec![0.0; n]);
    model.mass_and_bias(chi, q, dq, &mut mass, &mut bias);
    (0..n).map(|i| bias[i] + (0..n).map(|k| mass[i * n + k] * ddq[k]).sum::<f64>()).collect()
}

#[test]
fn the_recursive_engine_has_the_closed_form_of_random_tables() {
    for case in cases() {
        let table = parse("random.yaml", case.yaml.as_bytes()).unwrap();
        let set = base_set(&table);
        let equations = Equations::derive(&table, &set).unwrap();
        let model = RecursiveModel::new(numeric_robot(&table, &set)).unwrap();
        let (n, columns) = (equations.idm.len(), set.base.len());
        for [q, dq, ddq] in &case.states {
            let point = Point { q: q.clone(), dq: dq.clone(), ddq: ddq.clone(), chi: vec![0.0; columns] };
            let (mut h, mut dh) = (vec![0.0; columns], vec![0.0; columns]);
            model.energy(q, dq, &mut h);
            model.power(q, dq, ddq, &mut dh);
            assert_close(&h, &equations.graph.evaluate(&equations.energy, &point), "h");
            assert_close(&dh, &equations.graph.evaluate(&equations.power, &point), "dh");
            let pattern = model.pattern();
            let mut entries = vec![0.0; pattern.columns.len()];
            model.idm(q, dq, ddq, &mut entries);
            for i in 0..n {
                let mut row = vec![0.0; columns];
                (pattern.rows[i]..pattern.rows[i + 1]).for_each(|e| row[pattern.columns[e]] = entries[e]);
                assert_close(&row, &equations.graph.evaluate(&equations.idm[i], &point), "IDM");
            }
        }
    }
}

/// From a table by path to a model and back: parallelograms, and a link that is known to weigh nothing.
#[test]
fn a_robot_with_bars_is_simulated_identified_and_its_model_simulated_again() {
    let folder = Folder::new("bars");
    let table = include_str!("../robots/palletiser.yaml").replace("name: palletiser", "name: bars");
    let without: Vec<&str> = table.lines().filter(|line| !line.contains("XX8: ")).collect();
    folder.write(
        "bars.yaml",
        &format!("{}\nmassless: [8]\nknown: {{Ia5: 0}}\n", without.join("\n")).replace("Ia5: 0.6, ", ""),
    );
    let ok = |words: &[&str]| {
        let output = folder.run(words);
        assert!(output.status.success(), "{words:?}: {}", error_of(&output));
        output
    };
    ok(&["simulate", "./bars.yaml", "--out", "a", "--rate", "500", "--period", "6"]);
    ok(&["identify", "a/recording.yaml", "--out", "m.json"]);
    let model = std::fs::read_to_string(folder.path("m.json")).unwrap();
    let model: serde_json::Value = serde_json::from_str(&model).unwrap();
    assert!(model["relative_error"].as_f64().unwrap() < 0.02);
    let names: Vec<&str> =
        model["base_parameters"].as_array().unwrap().iter().map(|p| p["name"].as_str().unwrap()).collect();
    assert!(
        !names.iter().any(|name| name.ends_with('8') || name.ends_with("8R") || *name == "Ia5"),
        "{names:?}"
    );
    // Without its YAML: the table of the model is written beside the recording.
    ok(&["simulate", "m.json", "--out", "b", "--rate", "500", "--period", "6", "--seed", "5"]);
    let output = ok(&["validate", "m.json", "b/recording.yaml", "--json", "-"]);
    assert!(json_of(&output)["relative_error"].as_f64().unwrap() < 0.02);
    assert!(error_of(&output).is_empty(), "{}", error_of(&output));
    let written = std::fs::read_dir(folder.path("b")).unwrap().map(|e| e.unwrap().path());
    let written = written.filter(|path| path.extension().is_some_and(|e| e == "yaml"));
    let tables: Vec<String> = written.map(|path| std::fs::read_to_string(path).unwrap()).collect();
    let own = tables.iter().find(|text| text.contains("frames:")).unwrap();
    let again = parse("own.yaml", own.as_bytes()).unwrap();
    let first = parse("bars.yaml", &std::fs::read(folder.path("bars.yaml")).unwrap()).unwrap();
    assert_eq!((again.motions(), &again.known), (first.motions(), &first.known));
    for (a, b) in base_set(&again).base.iter().zip(&base_set(&first).base) {
        assert_eq!(a.name, b.name);
    }
    // A rotor that is known to weigh nothing is no rotor.
    let refused = folder.run(&["export", "m.json", "--to", "urdf", "--out", "bars.urdf"]);
    assert!(!refused.status.success() && error_of(&refused).contains("frame 5"), "{}", error_of(&refused));
    ok(&["export", "m.json", "--to", "c", "--out", "c"]);
}

#[test]
fn a_model_of_a_robot_with_bars_is_written_as_urdf_and_mjcf() {
    let folder = Folder::new("bars_written");
    let ok = |words: &[&str]| {
        let output = folder.run(words);
        assert!(output.status.success(), "{words:?}: {}", error_of(&output));
        words_of(&output)
    };
    ok(&["simulate", "palletiser", "--out", "a", "--rate", "500", "--period", "6"]);
    ok(&["identify", "a/recording.yaml", "--out", "m.json"]);
    let said = ok(&["export", "m.json", "--to", "urdf", "--out", "bars.urdf"]);
    assert!(said.contains("K*s on s = q2: on each joint times its coefficient"), "{said}");
    let shown = ok(&["show", "bars.urdf"]);
    assert!(shown.contains("4 joints") && shown.contains("-q2"), "{shown}");
    let said = ok(&["export", "m.json", "--to", "mjcf", "--out", "bars.xml"]);
    assert!(!said.contains("K*s"), "{said}");
    let written = std::fs::read_to_string(folder.path("bars.xml")).unwrap();
    assert!(written.contains("<fixed name=\"spring2\""), "{written}");
}
