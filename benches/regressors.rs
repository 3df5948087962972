//! Generated against recursive regressors, measured side by side in one run: `cargo bench --bench regressors`.
//!
//! Each figure is the fastest of many short rounds, in which the contenders take turns, so that another load on the
//! machine hurts them alike.

use comfy_table::{CellAlignment, Table, presets};
use dynid::models;
use dynid_runtime::model::{Model, RecursiveModel, States};
use std::hint::black_box;
use std::time::Instant;

/// Samples of a block, and the distance of its columns: not a multiple of 64, which would crowd the cache.
const SAMPLES: usize = 64;
const STRIDE: usize = 72;
const ROUNDS: usize = 300;

const HEADER: [&str; 9] = [
    "robot",
    "IDM operations",
    "IDM recursive ns",
    "scalar ns",
    "batch ns",
    "recursive : scalar",
    "recursive : batch",
    "dh recursive ns",
    "dh batch ns",
];

fn main() {
    let mut table = Table::new();
    table.load_style(presets::ASCII_MARKDOWN).set_header(HEADER);
    for &model in models::all() {
        let robot = model.robot();
        let times = match RecursiveModel::new(robot.clone()) {
            Ok(recursive) => measure(model, &recursive),
            Err(error) => {
                eprintln!("{}: {error}", robot.name);
                continue;
            }
        };
        let operations: usize = models::operations(&robot.name)
            .and_then(|list| list.iter().find(|o| o.function == "IDM"))
            .map_or(0, |o| o.multiplications + o.additions);
        table.add_row([
            robot.name.to_string(),
            operations.to_string(),
            format!("{:.0}", times.recursive),
            format!("{:.0}", times.scalar),
            format!("{:.1}", times.batch),
            format!("{:.1}", times.recursive / times.scalar),
            format!("{:.1}", times.recursive / times.batch),
            format!("{:.0}", times.recursive_power),
            format!("{:.1}", times.power),
        ]);
    }
    for column in table.column_iter_mut().skip(1) {
        column.set_cell_alignment(CellAlignment::Right);
    }
    println!("Base regressor IDM and power row dh, one sample:\n{table}");
}

/// Nanoseconds a sample.
struct Times {
    recursive: f64,
    scalar: f64,
    batch: f64,
    power: f64,
    recursive_power: f64,
}

fn measure(model: &dyn Model, recursive: &dyn Model) -> Times {
    let (n, nb) = (model.robot().joints(), model.robot().base.len());
    let signal = |phase: f64| -> Vec<Vec<f64>> {
        let value = |j: usize, t: usize| 2.0 * (0.37 * (7 * t + 13 * j) as f64 + phase).sin();
        (0..n).map(|j| (0..SAMPLES).map(|t| value(j, t)).collect()).collect()
    };
    let signals = [signal(0.0), signal(1.0), signal(2.0)];
    let at = |s: usize, t: usize| -> Vec<f64> { signals[s].iter().map(|x| x[t]).collect() };
    let states: Vec<[Vec<f64>; 3]> = (0..SAMPLES).map(|t| [at(0, t), at(1, t), at(2, t)]).collect();
    let slices = signals.each_ref().map(|s| s.iter().map(Vec::as_slice).collect::<Vec<_>>());
    let block = States { q: &slices[0], dq: &slices[1], ddq: &slices[2] };
    // The recursive engine keeps entries that it cannot know to vanish.
    let most = |m: &dyn Model| m.pattern().columns.len();
    let values = most(model).max(most(recursive)).max(nb);
    let (mut row, mut out) = (vec![0.0; values], vec![0.0; values * STRIDE]);
    let mut best = [f64::INFINITY; 5];
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
    }
    let [recursive, scalar, batch, power, recursive_power] = best.map(|s| s / SAMPLES as f64 * 1e9);
    Times { recursive, scalar, batch, power, recursive_power }
}
