//! How long the regressor of many states takes in Rust, to compare Python with: ns a sample, the least of several runs.
//! `cargo run --release --example dense -- [SAMPLES]`, and `python examples/dense.py`.

#[path = "../src/dense.rs"]
mod dense;

use std::hint::black_box;
use std::ops::Range;
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
        with_blocks(&signals, 0..samples, |from, states| model.idm_block(states, samples, &mut out[from..]));
        black_box(out);
    });
    for threads in [1, 0] {
        let how = if threads == 1 { "one thread" } else { "all threads" };
        report(&format!("dense, fresh memory, {how}"), samples, || {
            let mut out = vec![0.0; size * samples];
            dense(model, &signals, threads, &mut out);
            black_box(out);
        });
        let mut out = vec![0.0; size * samples];
        report(&format!("dense, the same memory again, {how}"), samples, || {
            dense(model, &signals, threads, &mut out);
            black_box(&out);
        });
    }
}

fn dense(model: &dyn Model, signals: &[Vec<Vec<f64>>; 3], threads: usize, out: &mut [f64]) {
    let samples = signals[0].first().map_or(0, Vec::len);
    dense::regressors(model, samples, threads, out, |range, write| {
        with_blocks(signals, range, |_, states| write(states));
    });
}

fn with_blocks(signals: &[Vec<Vec<f64>>; 3], range: Range<usize>, mut work: impl FnMut(usize, States<'_>)) {
    for from in range.clone().step_by(BLOCK) {
        let to = range.end.min(from + BLOCK);
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
