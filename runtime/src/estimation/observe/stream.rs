//! Decimation on the fly: columns are computed in blocks that stay in cache and are filtered into the rows that
//! are kept, so that no column exists at the full rate.

use std::ops::Range;

use wide::f64x4;

use super::source::Source;
use crate::signal::{Decimator, KeptRows};

/// Samples that are evaluated at a time.
const BLOCK: usize = 64;
/// From one column to the next: at a power of two all columns would fall on the same lines of the cache.
const STRIDE: usize = BLOCK + 8;

/// Calls `keep(row, values)` for each of the kept rows `rows` in ascending order; `values` has one number per
/// column of the source.
///
/// A row depends on nothing but its own window of samples: it has the same digits in whatever run it is computed
/// that starts at the same row.
pub(super) fn decimate<S: Source + ?Sized>(
    source: &S,
    decimator: &Decimator,
    grid: KeptRows,
    rows: Range<usize>,
    mut keep: impl FnMut(usize, &[f64]),
) {
    if rows.is_empty() {
        return;
    }
    let columns = source.columns();
    let taps = decimator.taps();
    let window = |row: usize| {
        let start = grid.first + row * grid.step - decimator.support();
        start..start + taps.len()
    };
    let open = (taps.len() + BLOCK) / grid.step + 2;
    let mut sums = vec![0.0; open * columns];
    let mut values = vec![0.0; columns * STRIDE];
    let mut scratch = Vec::new();
    let end = window(rows.end - 1).end;
    let mut first_open = rows.start;
    let mut at = window(rows.start).start;
    while at < end {
        let block = at..(at + BLOCK).min(end);
        source.fill(block.clone(), STRIDE, &mut values, &mut scratch);
        let mut finished = 0;
        for row in first_open..rows.end {
            let window = window(row);
            if window.start >= block.end {
                break;
            }
            let from = window.start.max(block.start);
            let to = window.end.min(block.end);
            let sum = &mut sums[row % open * columns..][..columns];
            if from < to {
                let taps = &taps[from - window.start..to - window.start];
                accumulate(taps, &values, from - block.start, sum);
            }
            if window.end <= block.end {
                keep(row, sum);
                sum.fill(0.0);
                finished += 1;
            }
        }
        first_open += finished;
        at = block.end;
    }
}

/// Adds the products of the taps with each column's samples from `offset` on.
fn accumulate(taps: &[f64], values: &[f64], offset: usize, sums: &mut [f64]) {
    let whole = taps.len() / 4 * 4;
    let mut groups = values.chunks_exact(4 * STRIDE);
    let mut outs = sums.chunks_exact_mut(4);
    for (group, out) in groups.by_ref().zip(outs.by_ref()) {
        let x: [&[f64]; 4] = std::array::from_fn(|c| &group[c * STRIDE + offset..][..taps.len()]);
        let mut lanes = [f64x4::ZERO; 4];
        for i in (0..whole).step_by(4) {
            let h = load(&taps[i..i + 4]);
            for (lane, x) in lanes.iter_mut().zip(&x) {
                *lane = h.mul_add(load(&x[i..i + 4]), *lane);
            }
        }
        for ((out, lane), x) in out.iter_mut().zip(lanes).zip(&x) {
            *out += lane.reduce_add() + plain(&taps[whole..], &x[whole..]);
        }
    }
    for (column, out) in groups.remainder().chunks_exact(STRIDE).zip(outs.into_remainder()) {
        let x = &column[offset..][..taps.len()];
        let mut lane = f64x4::ZERO;
        for i in (0..whole).step_by(4) {
            lane = load(&taps[i..i + 4]).mul_add(load(&x[i..i + 4]), lane);
        }
        *out += lane.reduce_add() + plain(&taps[whole..], &x[whole..]);
    }
}

fn plain(h: &[f64], x: &[f64]) -> f64 {
    h.iter().zip(x).map(|(h, x)| h * x).sum()
}

fn load(x: &[f64]) -> f64x4 {
    f64x4::from([x[0], x[1], x[2], x[3]])
}
