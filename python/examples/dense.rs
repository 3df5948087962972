//! How long the regressor of many states takes in Rust, to compare Python with: ns a sample, the least of several runs.
//! `cargo run --release --example dense -- [SAMPLES]`, and `python examples/dense.py`.

#[path = "../src/dense.rs"]
mod dense;

use std::hint::black_box;
use std::time::Instant;

use dynid_runtime::model::{Model, States};

const BLOCK: usize = 64;

fn main() {
    let samples = std::env::args().nth(1).and_then(|n| n.parse().ok()).unwrap_or(100_000);
    let Some(model) = dynid::models::find("tx40") else { return };
    let n = model.robot().joints();
    let signal = |w: f64| -> Vec<Vec<f64>> {
        (0..n).map(|j| (0..samples).map(|t| (w * (j + 1) as f64 * t as f64 * 1e-3).sin()).collect()).collect()
    };
    let signals = [signal(1.0), signal(1.3), signal(1.7)];
    let entries = model.pattern().columns.len();
    let size = n * model.robot().base.len();
    report("entries, fresh memory", samples, || {
        let mut out = vec![0.0; entries * samples];
        with_blocks(&signals, samples, |from, states| model.idm_block(states, samples, &mut out[from..]));
        black_box(out);
    });
    report("dense, fresh memory", samples, || {
        let mut out = vec![0.0; size * samples];
        dense(model, &signals, samples, &mut out, true);
        black_box(out);
    });
    let mut out = vec![0.0; size * samples];
    report("dense, the same memory again", samples, || {
        dense(model, &signals, samples, &mut out, false);
        black_box(&out);
    });
}

fn dense(model: &dyn Model, signals: &[Vec<Vec<f64>>; 3], samples: usize, out: &mut [f64], is_fresh: bool) {
    let mut dense = dense::DenseRegressor::new(model);
    with_blocks(signals, samples, |from, states| {
        let range = from..from + states.samples();
        dense.write(&range, states, out, is_fresh);
    });
}

fn with_blocks(signals: &[Vec<Vec<f64>>; 3], samples: usize, mut work: impl FnMut(usize, States<'_>)) {
    for from in (0..samples).step_by(BLOCK) {
        let to = samples.min(from + BLOCK);
        let [q, dq, ddq] = [0, 1, 2].map(|s| signals[s].iter().map(|x| &x[from..to]).collect::<Vec<_>>());
        work(from, States { q: &q, dq: &dq, ddq: &ddq });
    }
}

fn report(what: &str, samples: usize, mut run: impl FnMut()) {
    let mut least = f64::INFINITY;
    for _ in 0..15 {
        let began = Instant::now();
        run();
        least = least.min(began.elapsed().as_secs_f64());
    }
    println!("{what}: {:.0} ns a sample", 1e9 * least / samples as f64);
}
