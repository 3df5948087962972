//! Reading a text table, and the parallel decimation: `cargo bench -p dynid-runtime --bench signals`.

use std::fmt::Write as _;
use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use dynid_runtime::recording::{Column, Layout, Rows, TableReader};
use dynid_runtime::signal::Decimator;

/// A recording as a logger writes it: time, six angles with six decimals, six torques with four.
fn table(rows: usize) -> String {
    let mut text = String::from("t,q1,q2,q3,q4,q5,q6,tau1,tau2,tau3,tau4,tau5,tau6\n");
    for k in 0..rows {
        let t = k as f64 * 2e-4;
        let _ = write!(text, "{t:.4}");
        for j in 1..=6 {
            let _ = write!(text, ",{:.6}", (1.3 * t * j as f64).sin() * 2.0);
        }
        for j in 1..=6 {
            let _ = write!(text, ",{:.4}", (0.7 * t * j as f64).cos() * 30.0);
        }
        text.push('\n');
    }
    text
}

fn reading(c: &mut Criterion) {
    let text = table(100_000);
    let columns: Vec<Column> = (0..13).map(Column::Index).collect();
    let mut group = c.benchmark_group("csv");
    group.throughput(Throughput::Bytes(text.len() as u64)).sample_size(20);
    group.bench_function("13 columns", |b| {
        let mut rows = Rows::new(13);
        b.iter(|| {
            let reader = TableReader::new(text.as_bytes(), "bench", &Layout::default(), &columns);
            let mut reader = reader.expect("the table is right");
            let mut count = 0;
            loop {
                rows.clear();
                match reader.read(&mut rows, 4096).expect("bytes can be read") {
                    0 => break,
                    more => count += more,
                }
            }
            assert_eq!(count, 100_000);
            count
        });
    });
    group.finish();
}

fn decimation(c: &mut Criterion) {
    let mut group = c.benchmark_group("decimation of 145 columns x 37,000 samples");
    group.sample_size(20);
    for factor in [5, 10, 50, 100] {
        let decimator = Decimator::new(factor).expect("a positive factor");
        // Blocks as the observation makes them: the new samples of some kept rows, and the overlap.
        let new_samples = 8 * factor;
        let stride = decimator.overlap() + new_samples;
        let block: Vec<f64> = (0..145 * stride).map(|k| (k as f64 * 0.01).sin()).collect();
        let mut out = vec![0.0; 145 * decimator.kept_rows(0..stride).count];
        let blocks = 37_000 / new_samples;
        group.bench_function(format!("factor {factor}"), |b| {
            b.iter(|| {
                for _ in 0..blocks {
                    decimator.decimate_columns(black_box(&block), stride, &mut out);
                }
            });
        });
    }
    group.finish();
}

criterion_group!(benches, reading, decimation);
criterion_main!(benches);
