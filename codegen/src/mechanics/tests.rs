#![allow(clippy::unwrap_used)]

use super::model::Equations;
use crate::robot::RobotTable;
use crate::testing::{Random, Row, all_parameters, numeric_base, planar_2r, serial, tx40};
use std::io::Write as _;
use std::path::Path;

/// Robots, states and regressors of an independent engine; `None` where the file is not at hand.
fn reference() -> Option<serde_yaml::Value> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../shared/reference/regressors.json");
    match std::fs::read_to_string(&path) {
        Ok(text) => Some(serde_yaml::from_str(&text).unwrap()),
        Err(_) => {
            let _ = writeln!(std::io::stderr(), "skipped: {} is not there", path.display());
            None
        }
    }
}

fn numbers(value: &serde_yaml::Value) -> Vec<f64> {
    value.as_sequence().unwrap().iter().map(|x| x.as_f64().unwrap()).collect()
}

fn reference_robot(name: &str, entry: &serde_yaml::Value) -> RobotTable {
    let rows: Vec<Row> = entry["mdh"]
        .as_sequence()
        .unwrap()
        .iter()
        .map(|row| {
            let x = numbers(row);
            (x[0] as u8, x[1], x[2], x[3], x[4])
        })
        .collect();
    let gravity = numbers(&entry["gravity"]);
    serial(name, [gravity[0], gravity[1], gravity[2]], &rows)
}

/// CasADi's generated C of the same regressor has 1302 operations.
#[test]
fn the_tx40_regressor_costs_a_third_less_than_the_best_known() {
    let robot = tx40();
    let counts = Equations::derive(&robot, &numeric_base(&robot)).unwrap().counts();
    assert!(counts.idm.arithmetic() <= 868, "{}", counts.idm);
    // The paper's point: the power model is far simpler.
    assert!(counts.power.arithmetic() < counts.idm.arithmetic() / 2, "{}", counts.power);
    assert!(counts.energy.arithmetic() < counts.power.arithmetic(), "{}", counts.energy);
}

/// The regressor times the parameters takes 1021 operations, mass matrix and bias 831 without friction.
#[test]
fn the_tx40_torques_cost_half_of_regressor_times_parameters() {
    let robot = tx40();
    let set = crate::base::base_set(&robot);
    let counts = Equations::derive(&robot, &set).unwrap().counts();
    assert!(counts.torque.arithmetic() <= 550, "{}", counts.torque);
}

#[test]
fn rows_and_energies_agree_with_an_independent_engine() {
    let Some(reference) = reference() else { return };
    for (name, entry) in reference.as_mapping().unwrap() {
        if entry.get("mdh").is_none() {
            continue;
        }
        let robot = reference_robot(name.as_str().unwrap(), entry);
        let set = all_parameters(&robot);
        let inertial: Vec<usize> =
            (0..set.standard.len()).filter(|&k| (set.standard[k].kind as usize) < 10).collect();
        let equations = Equations::derive(&robot, &set).unwrap();
        for state in entry["states"].as_sequence().unwrap() {
            let point = crate::symbolic::Point {
                q: numbers(&state["q"]),
                dq: numbers(&state["dq"]),
                ddq: numbers(&state["ddq"]),
                chi: vec![],
            };
            let h = equations.graph.evaluate(&equations.energy, &point);
            for (k, expected) in inertial.iter().zip(numbers(&state["energy"])) {
                assert!(
                    (h[*k] - expected).abs() < 1e-10,
                    "{name:?} h {} {} {expected}",
                    set.standard[*k].name,
                    h[*k]
                );
            }
            for (i, row) in state["torque"].as_sequence().unwrap().iter().enumerate() {
                let values = equations.graph.evaluate(&equations.idm[i], &point);
                for (k, expected) in inertial.iter().zip(numbers(row)) {
                    assert!(
                        (values[*k] - expected).abs() < 1e-10,
                        "{name:?} row {i} {}: {} {expected}",
                        set.standard[*k].name,
                        values[*k]
                    );
                }
            }
        }
    }
}

#[test]
fn power_is_the_rate_of_energy_plus_friction_and_the_product_of_speeds_and_torques() {
    let mut random = Random(3);
    for robot in [planar_2r(), tx40()] {
        let set = all_parameters(&robot);
        let equations = Equations::derive(&robot, &set).unwrap();
        let n = equations.idm.len();
        for _ in 0..5 {
            let point = random.point(n);
            let dh = equations.graph.evaluate(&equations.power, &point);
            let mut total = vec![0.0; dh.len()];
            for i in 0..n {
                let row = equations.graph.evaluate(&equations.idm[i], &point);
                total.iter_mut().zip(row).for_each(|(t, x)| *t += point.dq[i] * x);
            }
            for k in 0..dh.len() {
                assert!((dh[k] - total[k]).abs() < 1e-10, "{} {}", robot.name, set.standard[k].name);
            }
        }
    }
}
