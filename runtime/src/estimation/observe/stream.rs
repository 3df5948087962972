//! Decimation on the fly: columns are computed in blocks that stay in cache and are filtered into the rows that
//! are kept, so that no column exists at the full rate.

use std::ops::Range;

use wide::f64x4;

use super::block::BLOCK;
use super::source::Source;
use crate::model::{LINE, Lanes, Line};
use crate::signal::{Decimator, KeptRows};

/// Columns that are filtered together.
const QUAD: usize = 4;
/// Rows that are: twelve sums, three taps and a sample are what sixteen registers hold.
const TOGETHER: usize = 3;

/// Calls `keep(row, values)` for each of the kept rows `rows` in ascending order; `values` has one number per
/// column that the source wants filtered.
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
    let width = source.width();
    let quads = quads(source.filtered());
    let taps = Taps::new(decimator);
    let window = |row: usize| {
        let start = grid.first + row * grid.step - decimator.support();
        start..start + taps.count
    };
    let open = (taps.count + BLOCK) / grid.step + 2;
    let mut sums = vec![f64x4::ZERO; open * quads.len()];
    let mut lines = vec![[Lanes::splat(0.0); 2]; width * (BLOCK / LINE)];
    let mut values = vec![0.0; QUAD * quads.len()];
    let mut passes = Vec::with_capacity(open);
    let mut scratch = Vec::new();
    let end = window(rows.end - 1).end;
    let mut touched = rows.start..rows.start;
    let mut at = window(rows.start).start;
    while at < end {
        let block = at..(at + BLOCK).min(end);
        source.fill(block.clone(), &mut lines, &mut scratch);
        while touched.end < rows.end && window(touched.end).start < block.end {
            touched.end += 1;
        }
        passes.clear();
        for first in touched.clone().step_by(TOGETHER) {
            let count = TOGETHER.min(touched.end - first);
            let from = window(first).start.max(block.start) - block.start;
            let to = window(first + count - 1).end.min(block.end) - block.start;
            let lines = from / LINE..to.div_ceil(LINE);
            let start = block.start + lines.start * LINE;
            let row = |k: usize| first + k.min(count - 1);
            let taps = std::array::from_fn(|k| taps.of(start, window(row(k)).start, lines.len()));
            let places = std::array::from_fn(|k| row(k) % open);
            passes.push(Pass { lines: lines.start * width..lines.end * width, count, taps, places });
        }
        // Columns outermost: their samples and sums stay in the nearest cache while all rows pass.
        for (columns, sums) in quads.iter().zip(sums.chunks_exact_mut(open)) {
            for pass in &passes {
                pass.add(&lines, width, *columns, sums);
            }
        }
        while touched.start < touched.end && window(touched.start).end <= block.end {
            let place = touched.start % open;
            for (values, sums) in values.chunks_exact_mut(QUAD).zip(sums.chunks_exact_mut(open)) {
                values.copy_from_slice(&sums[place].to_array());
                sums[place] = f64x4::ZERO;
            }
            keep(touched.start, &values[..source.filtered().len()]);
            touched.start += 1;
        }
        at = block.end;
    }
}

/// A few rows in sequence over the lines of a block that they reach.
struct Pass<'a> {
    /// Where the lines begin and end in the block.
    lines: Range<usize>,
    /// Rows.
    count: usize,
    /// The taps of each row; those of the last one again where there are fewer rows.
    taps: [&'a [f64]; TOGETHER],
    /// Where the sums of each row are.
    places: [usize; TOGETHER],
}

impl Pass<'_> {
    fn add(&self, lines: &[Line], width: usize, columns: [usize; QUAD], sums: &mut [f64x4]) {
        let lines = &lines[self.lines.clone()];
        let [a, b, c] = self.taps;
        match self.count {
            1 => self.store(products([a], lines, width, columns), sums),
            2 => self.store(products([a, b], lines, width, columns), sums),
            _ => self.store(products([a, b, c], lines, width, columns), sums),
        }
    }

    fn store<const R: usize>(&self, products: [f64x4; R], sums: &mut [f64x4]) {
        for (product, &place) in products.iter().zip(&self.places) {
            sums[place] += *product;
        }
    }
}

/// The columns four by four; the last ones are filled up with the first column.
fn quads(columns: &[usize]) -> Vec<[usize; QUAD]> {
    let quad = |part: &[usize]| std::array::from_fn(|k| part.get(k).copied().unwrap_or(columns[0]));
    columns.chunks(QUAD).map(quad).collect()
}

/// The taps between zeros, so that a row can be given more samples than its window has.
struct Taps {
    padded: Vec<f64>,
    count: usize,
}

impl Taps {
    /// A row that is open reaches less than a block beyond its window.
    const PADDING: usize = BLOCK + LINE;

    fn new(decimator: &Decimator) -> Taps {
        let taps = decimator.taps();
        let mut padded = vec![0.0; taps.len() + 2 * Self::PADDING];
        padded[Self::PADDING..][..taps.len()].copy_from_slice(taps);
        Taps { padded, count: taps.len() }
    }

    /// For a number of lines from the sample `start` on: the taps of the row whose window starts at `window`.
    fn of(&self, start: usize, window: usize, lines: usize) -> &[f64] {
        &self.padded[start + Self::PADDING - window..][..lines * LINE]
    }
}

/// Sums over samples of tap times value: one per row, for four columns side by side. Not inlined, so that the sums
/// have the registers to themselves.
#[inline(never)]
fn products<const R: usize>(
    taps: [&[f64]; R],
    lines: &[Line],
    width: usize,
    [a, b, c, d]: [usize; QUAD],
) -> [f64x4; R] {
    assert!(a < width && b < width && c < width && d < width);
    assert!(taps.iter().all(|taps| taps.len() >= lines.len() / width * LINE));
    let zero = [f64x4::ZERO; R];
    let (mut sum_a, mut sum_b, mut sum_c, mut sum_d) = (zero, zero, zero, zero);
    let mut at = 0;
    for line in lines.chunks_exact(width) {
        for part in 0..2 {
            let h: [f64x4; R] = std::array::from_fn(|r| load(&taps[r][at..at + 4]));
            add_products(&mut sum_a, &h, line[a][part].simd());
            add_products(&mut sum_b, &h, line[b][part].simd());
            add_products(&mut sum_c, &h, line[c][part].simd());
            add_products(&mut sum_d, &h, line[d][part].simd());
            at += 4;
        }
    }
    std::array::from_fn(|r| {
        let [a, b, c, d] = f64x4::transpose([sum_a[r], sum_b[r], sum_c[r], sum_d[r]]);
        (a + b) + (c + d)
    })
}

#[inline(always)]
fn add_products<const R: usize>(sums: &mut [f64x4; R], h: &[f64x4; R], x: f64x4) {
    for (sum, h) in sums.iter_mut().zip(h) {
        *sum = h.mul_add(x, *sum);
    }
}

fn load(x: &[f64]) -> f64x4 {
    f64x4::from([x[0], x[1], x[2], x[3]])
}
