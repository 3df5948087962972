//! The base regressor and the torques of a robot's nominal parameters at given states, as JSON: what `benches/peers`
//! compares with other tools.
//!
//! ```text
//! cargo run --release --example regressor -- ROBOT STATES.json
//! ```
//! `STATES.json` is a list of `[q, dq, ddq]`; the answer has `base` (names), `chi` (nominal), `torques` and `regressor`, one
//! row a joint for each state.

use std::path::Path;
use std::process::ExitCode;

use dynid::robots::resolve;
use dynid_runtime::model::torques_at;
use serde_json::json;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let [robot, states] = &arguments[..] else {
        eprintln!("usage: regressor ROBOT STATES.json");
        return ExitCode::from(2);
    };
    match run(robot, Path::new(states)) {
        Ok(answer) => {
            println!("{answer}");
            ExitCode::SUCCESS
        }
        Err(error) => {
            eprintln!("{error}");
            ExitCode::from(2)
        }
    }
}

fn run(robot: &str, states: &Path) -> Result<serde_json::Value, Box<dyn std::error::Error>> {
    let dynamics = resolve(robot, None)?;
    let model = dynamics.model();
    let robot = model.robot();
    let states: Vec<[Vec<f64>; 3]> = serde_json::from_str(&std::fs::read_to_string(states)?)?;
    let standard =
        robot.nominal.as_ref().map_or_else(|| vec![0.0; robot.standard.len()], |n| n.standard.to_vec());
    let chi = robot.base_from_standard(&standard);
    let n = robot.joints();
    if states.iter().flatten().any(|x| x.len() != n) {
        return Err(format!("a state has {n} positions, speeds and accelerations").into());
    }
    let torques: Vec<_> = states.iter().map(|[q, dq, ddq]| torques_at(model, &chi, q, dq, ddq)).collect();
    let mut regressor = Vec::new();
    for [q, dq, ddq] in &states {
        let mut entries = vec![0.0; model.pattern().columns.len()];
        model.idm(q, dq, ddq, &mut entries);
        for row in model.pattern().rows.windows(2) {
            let mut dense = vec![0.0; robot.base.len()];
            (row[0]..row[1]).for_each(|e| dense[model.pattern().columns[e]] = entries[e]);
            regressor.push(dense);
        }
    }
    let names: Vec<&str> = robot.base.iter().map(|b| b.name.as_ref()).collect();
    Ok(json!({"base": names, "chi": chi, "torques": torques, "regressor": regressor}))
}
