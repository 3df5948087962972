//! Generated against recursive regressors, measured side by side in one run:
//! `cargo bench --bench regressors [-- ROBOT ...] [--write FILE]`.
//!
//! Each figure is the fastest of many short rounds, in which the contenders take turns, so that another load on the
//! machine hurts them alike. `--write` writes the states, the regressor and the times of the last robot as JSON, for
//! `benches/peers/compare.py`.

use comfy_table::{CellAlignment, Table, presets};
use dynid::models;
use dynid_runtime::model::{
    ForwardDynamics, JointKind, LINE, Lanes, Line, Model, ParameterKind, RecursiveModel, Robot, States,
};
use std::collections::HashMap;
use std::hint::black_box;
use std::time::Instant;

/// Samples of a block, and the distance of its columns: not a multiple of 64, which would crowd the cache.
const SAMPLES: usize = 64;
const STRIDE: usize = 72;
const ROUNDS: usize = 300;

const HEADER: [&str; 11] = [
    "robot",
    "entries",
    "IDM recursive ns",
    "scalar ns",
    "batch ns",
    "batch by columns ns",
    "recursive : scalar",
    "recursive : batch",
    "dh recursive ns",
    "dh batch ns",
    "recursive : dh batch",
];

const DYNAMICS_HEADER: [&str; 6] =
    ["robot", "tau recursive ns", "tau scalar ns", "tau batch ns", "M and N ns", "acceleration ns"];

fn main() {
    // Cargo itself hands in `--bench`.
    let mut arguments = std::env::args().skip(1).filter(|a| a != "--bench");
    let (mut wanted, mut file) = (Vec::new(), None);
    while let Some(argument) = arguments.next() {
        match argument.as_str() {
            "--write" => file = arguments.next(),
            _ => wanted.push(argument),
        }
    }
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN).set_header(HEADER);
    let mut dynamics = Table::new();
    dynamics.load_style(presets::ASCII_MARKDOWN).set_header(DYNAMICS_HEADER);
    let mut last = None;
    for &model in models::all() {
        let robot = model.robot();
        if !wanted.is_empty() && wanted.iter().all(|name| *name != robot.name) {
            continue;
        }
        let times = match RecursiveModel::new(robot.clone()) {
            Ok(recursive) => measure(model, &recursive),
            Err(error) => {
                eprintln!("{}: {error}", robot.name);
                continue;
            }
        };
        table.add_row([
            robot.name.to_string(),
            model.pattern().columns.len().to_string(),
            format!("{:.0}", times.recursive),
            format!("{:.0}", times.scalar),
            format!("{:.1}", times.batch),
            format!("{:.1}", times.columns),
            format!("{:.1}", times.recursive / times.scalar),
            format!("{:.1}", times.recursive / times.batch),
            format!("{:.0}", times.recursive_power),
            format!("{:.1}", times.power),
            format!("{:.1}", times.recursive_power / times.power),
        ]);
        dynamics.add_row([
            robot.name.to_string(),
            format!("{:.0}", times.recursive_torque),
            format!("{:.0}", times.torque),
            format!("{:.1}", times.torque_batch),
            format!("{:.0}", times.forward),
            format!("{:.0}", times.acceleration),
        ]);
        last = Some((model, times));
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    for column in dynamics.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    println!("Base regressor IDM and power row dh, one sample:\n{table}");
    println!("Torques tau(chi, q, dq, ddq) and accelerations, one sample:\n{dynamics}");
    if let (Some(path), Some((model, times))) = (file, last) {
        let text = document(model, &times).to_string();
        if let Err(error) = std::fs::write(&path, text) {
            eprintln!("{path}: {error}");
            std::process::exit(2);
        }
    }
}

/// States, dense regressor of the inertial columns, and times, for a comparison with other tools.
fn document(model: &dyn Model, times: &Times) -> serde_json::Value {
    let (robot, pattern) = (model.robot(), model.pattern());
    let inertial: Vec<usize> = (0..robot.base.len())
        .filter(|&k| robot.standard[robot.base[k].standard].kind <= ParameterKind::M)
        .collect();
    let names: Vec<&str> =
        inertial.iter().map(|&k| robot.standard[robot.base[k].standard].name.as_ref()).collect();
    let signals = signals(robot.joints());
    let mut entries = vec![0.0; pattern.columns.len()];
    let standard = links_alone(robot);
    let chi = robot.base_from_standard(&standard);
    let mut forward = ForwardDynamics::new(model, &chi);
    let states: Vec<serde_json::Value> = (0..SAMPLES)
        .map(|t| {
            let [q, dq, ddq] = state(&signals, t);
            model.idm(&q, &dq, &ddq, &mut entries);
            let mut dense = vec![vec![0.0; robot.base.len()]; robot.joints()];
            for (i, row) in dense.iter_mut().enumerate() {
                for e in pattern.rows[i]..pattern.rows[i + 1] {
                    row[pattern.columns[e]] = entries[e];
                }
            }
            let rows: Vec<Vec<f64>> =
                dense.iter().map(|row| inertial.iter().map(|&k| row[k]).collect()).collect();
            let mut torque = vec![0.0; robot.joints()];
            model.torque(&chi, &q, &dq, &ddq, &mut torque);
            let mut acceleration = vec![0.0; robot.joints()];
            // Accelerations under the torques that the third signal is taken for.
            let solved = forward.acceleration(&q, &dq, &ddq, &mut acceleration).is_ok();
            serde_json::json!({
                "q": q,
                "dq": dq,
                "ddq": ddq,
                "regressor": rows,
                "torque": torque,
                "acceleration": solved.then_some(acceleration),
            })
        })
        .collect();
    serde_json::json!({
        "robot": robot.name,
        "columns": names,
        "states": states,
        "base_parameters": robot.base.len(),
        "entries": pattern.columns.len(),
        "chi": inertial.iter().map(|&k| chi[k]).collect::<Vec<f64>>(),
        "standard": robot.standard.iter().zip(&standard).map(|(p, x)| (&p.name, x)).collect::<HashMap<_, _>>(),
        "ns": {
            "recursive": times.recursive,
            "scalar": times.scalar,
            "batch": times.batch,
            "torque": times.torque,
            "torque_batch": times.torque_batch,
            "acceleration": times.acceleration,
        },
    })
}

/// The nominal inertial parameters of the joints' links; what other tools have no word for is zero.
fn links_alone(robot: &Robot) -> Vec<f64> {
    let Some(nominal) = &robot.nominal else { return vec![0.0; robot.standard.len()] };
    let counts = |k: usize| {
        let parameter = &robot.standard[k];
        parameter.kind <= ParameterKind::M && robot.frames[parameter.frame].kind != JointKind::Fixed
    };
    nominal.standard.iter().enumerate().map(|(k, &x)| if counts(k) { x } else { 0.0 }).collect()
}

/// Nanoseconds a sample.
struct Times {
    recursive: f64,
    scalar: f64,
    /// In the order of evaluation, as the observation takes them.
    batch: f64,
    /// Column by column.
    columns: f64,
    power: f64,
    recursive_power: f64,
    torque: f64,
    recursive_torque: f64,
    torque_batch: f64,
    /// Mass matrix and bias.
    forward: f64,
    acceleration: f64,
}

type Signals = [Vec<Vec<f64>>; 3];

/// q, dq and ddq, joint by joint.
fn signals(joints: usize) -> Signals {
    [0.0, 1.0, 2.0].map(|phase: f64| {
        let value = |j: usize, t: usize| 2.0 * (0.37 * (7 * t + 13 * j) as f64 + phase).sin();
        (0..joints).map(|j| (0..SAMPLES).map(|t| value(j, t)).collect()).collect()
    })
}

fn state(signals: &Signals, t: usize) -> [Vec<f64>; 3] {
    signals.each_ref().map(|signal| signal.iter().map(|x| x[t]).collect())
}

fn measure(model: &dyn Model, recursive: &dyn Model) -> Times {
    let nb = model.robot().base.len();
    let signals = signals(model.robot().joints());
    let states: Vec<[Vec<f64>; 3]> = (0..SAMPLES).map(|t| state(&signals, t)).collect();
    let slices = signals.each_ref().map(|s| s.iter().map(Vec::as_slice).collect::<Vec<_>>());
    let block = States { q: &slices[0], dq: &slices[1], ddq: &slices[2] };
    // The recursive engine keeps entries that it cannot know to vanish.
    let most = |m: &dyn Model| m.pattern().columns.len();
    let values = most(model).max(most(recursive)).max(nb);
    let (mut row, mut out) = (vec![0.0; values], vec![0.0; values * STRIDE]);
    let width = most(model);
    let mut lines: Vec<Line> = vec![[Lanes::splat(0.0); 2]; width * SAMPLES / LINE];
    let mut dynamics = KnownDynamics::new(model, &states);
    let mut best = [f64::INFINITY; 11];
    let mut one = |model: &dyn Model, best: &mut f64| {
        let entries = most(model);
        let start = Instant::now();
        for [q, dq, ddq] in &states {
            model.idm(q, dq, ddq, &mut row[..entries]);
            black_box(&row);
        }
        *best = best.min(start.elapsed().as_secs_f64());
    };
    let mut many = |run: &dyn Fn(&mut [f64]), best: &mut f64| {
        let start = Instant::now();
        run(&mut out);
        black_box(&out);
        *best = best.min(start.elapsed().as_secs_f64());
    };
    for _ in 0..ROUNDS {
        one(recursive, &mut best[0]);
        one(model, &mut best[1]);
        many(&|out| model.idm_block(block, STRIDE, out), &mut best[2]);
        many(&|out| model.power_block(block, STRIDE, out), &mut best[3]);
        many(&|out| recursive.power_block(block, STRIDE, out), &mut best[4]);
        let start = Instant::now();
        model.idm_lines(block, width, &mut lines);
        black_box(&lines);
        best[5] = best[5].min(start.elapsed().as_secs_f64());
        dynamics.time([model, recursive], block, &mut best[6..]);
    }
    let [
        recursive,
        scalar,
        columns,
        power,
        recursive_power,
        batch,
        torque,
        recursive_torque,
        torque_batch,
        forward,
        acceleration,
    ] = best.map(|s| s / SAMPLES as f64 * 1e9);
    Times {
        recursive,
        scalar,
        batch,
        columns,
        power,
        recursive_power,
        torque,
        recursive_torque,
        torque_batch,
        forward,
        acceleration,
    }
}

/// Base parameters and states for torques and accelerations.
struct KnownDynamics<'a> {
    states: &'a [[Vec<f64>; 3]],
    chi: Vec<f64>,
    forward: ForwardDynamics<'a>,
}

impl<'a> KnownDynamics<'a> {
    /// The nominal parameters, or ones that make a mass matrix of some kind.
    fn new(model: &'a dyn Model, states: &'a [[Vec<f64>; 3]]) -> Self {
        let robot = model.robot();
        let chi = match &robot.nominal {
            Some(nominal) => robot.base_from_standard(&nominal.standard),
            None => vec![1.0; robot.base.len()],
        };
        let forward = ForwardDynamics::new(model, &chi);
        KnownDynamics { states, chi, forward }
    }

    /// Seconds of one round of each, where they are less than the `best` so far.
    fn time(&mut self, [model, recursive]: [&dyn Model; 2], block: States<'_>, best: &mut [f64]) {
        let n = model.robot().joints();
        let (mut tau, mut mass, mut out) = (vec![0.0; n], vec![0.0; n * n], vec![0.0; n * STRIDE]);
        let (states, chi, forward) = (self.states, &self.chi, &mut self.forward);
        for (model, best) in [model, recursive].into_iter().zip(&mut best[..2]) {
            keep(best, || {
                for [q, dq, ddq] in states {
                    model.torque(chi, q, dq, ddq, &mut tau);
                    black_box(&tau);
                }
            });
        }
        keep(&mut best[2], || {
            model.torque_block(chi, block, STRIDE, &mut out);
            black_box(&out);
        });
        keep(&mut best[3], || {
            for [q, dq, _] in states {
                model.mass_and_bias(chi, q, dq, &mut mass, &mut tau);
                black_box(&mass);
            }
        });
        keep(&mut best[4], || {
            for [q, dq, torque] in states {
                // A mass matrix that is not positive definite takes no longer.
                let _ = black_box(forward.acceleration(q, dq, torque, &mut tau));
            }
        });
    }
}

/// Keeps the shorter time.
fn keep(best: &mut f64, run: impl FnOnce()) {
    let start = Instant::now();
    run();
    *best = best.min(start.elapsed().as_secs_f64());
}
