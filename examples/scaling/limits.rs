//! What the machine could do at best, by two small loops, beside what the pipeline does.

use std::hint::black_box;
use std::time::Instant;

use dynid::models;
use dynid_runtime::model::{Lanes, Model, Number};

use crate::made_up::RATE;

/// Operations of a sine and a cosine in lanes, logic not counted.
const SINE_COSINE: f64 = 38.0;
/// Operations of the position filter and the two differences, a joint and sample: two passes of two sections of nine,
/// and two stencils of about six.
const PREPARATION: f64 = 60.0;
/// Numbers that are read or written outside of the inner cache, a joint and sample: position and torque as measured,
/// two passes of the filter, q, dq, ddq and torque written and read again.
const NUMBERS: f64 = 16.0;
/// Band of the rows, Hz, as `ObserveSettings` has it.
const BAND: f64 = 50.0;

/// Arithmetic and memory of one sample against the fastest that one core does.
pub fn compare(model: &dyn Model, seconds: f64) -> String {
    let robot = model.robot();
    let (pattern, n) = (model.pattern(), robot.joints() as f64);
    let operations = models::operations(&robot.name).and_then(|all| all.iter().find(|o| o.function == "IDM"));
    let evaluation = operations
        .map_or(0.0, |o| (o.multiplications + o.additions) as f64 + SINE_COSINE * o.sine_cosine_pairs as f64);
    let distinct = (0..pattern.same_as.len()).filter(|&e| pattern.same_as[e] == e).count() as f64;
    // Each sample is in the windows of about twenty rows.
    let decimation = 2.0 * 20.0 * (distinct + n);
    let squares: f64 = pattern.rows.windows(2).map(|w| ((w[1] - w[0] + 1) as f64).powi(2)).sum();
    let reduction = 2.0 * squares * 2.0 * BAND / RATE;
    let preparation = PREPARATION * n;
    let all = evaluation + decimation + reduction + preparation;
    let (peak, bandwidth) = (peak_operations(), bandwidth());
    let bytes = 8.0 * NUMBERS * n;
    format!(
        "One sample of {}: {all:.0} operations (evaluation {evaluation:.0}, decimation {decimation:.0}, reduction \
         {reduction:.0}, preparation {preparation:.0}) and {bytes:.0} bytes in {:.0} ns.\n\
         One core does {:.1} billion operations a second in fused products, which is {:.0} ns ({:.0} % of the time), and copies \
         {:.1} GB/s, which is {:.0} ns ({:.0} %).",
        robot.name,
        seconds * 1e9,
        peak * 1e-9,
        all / peak * 1e9,
        all / peak / seconds * 100.0,
        bandwidth * 1e-9,
        bytes / bandwidth * 1e9,
        bytes / bandwidth / seconds * 100.0,
    )
}

/// Additions and multiplications a second of independent fused products in lanes.
fn peak_operations() -> f64 {
    const CHAINS: usize = 10;
    const STEPS: usize = 4096;
    let mut best = f64::INFINITY;
    for _ in 0..500 {
        let (a, b) = black_box((Lanes::constant(0.999), Lanes::constant(0.001)));
        let mut sums = [Lanes::constant(1.0); CHAINS];
        let start = Instant::now();
        for _ in 0..STEPS {
            for sum in &mut sums {
                *sum = b.add_product(*sum, a);
            }
        }
        black_box(sums);
        best = best.min(start.elapsed().as_secs_f64());
    }
    (2 * 4 * CHAINS * STEPS) as f64 / best
}

/// Bytes a second, read and written, of a copy that no cache holds.
fn bandwidth() -> f64 {
    const NUMBERS: usize = 1 << 23;
    let from = vec![1.0_f64; NUMBERS];
    let mut to = vec![0.0_f64; NUMBERS];
    let mut best = f64::INFINITY;
    for _ in 0..10 {
        let start = Instant::now();
        to.copy_from_slice(black_box(&from));
        black_box(&to);
        best = best.min(start.elapsed().as_secs_f64());
    }
    (16 * NUMBERS) as f64 / best
}
