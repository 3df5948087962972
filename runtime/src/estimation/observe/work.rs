//! Blocks of time over threads: the same digits for every number of threads, because what is one piece of work and
//! in what order factors are merged depends on the motions alone.

use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

use super::observation::{EquationFactor, TimeBlock};
use super::prepared::Prepared;
use super::rows::Rows;
use super::settings::{ObserveSettings, Progress};
use super::stream::decimate;
use crate::estimation::{BLOCK_ROWS, Factor};
use crate::parallel;

/// Shortest block of time, s: longer than the residuals of a robot remember.
const BLOCK_SECONDS: f64 = 0.5;
/// Most blocks of one trajectory, and about as many as there may be of all: their factors are kept.
const MAX_BLOCKS: usize = 64;
const ALL_BLOCKS: usize = 256;
/// Fewest blocks that a trajectory is cut into, if it is long enough.
const FEW_BLOCKS: usize = 4;
/// A piece of work is at least this many filter lengths long: its first filter length is evaluated twice.
const CHUNK_WINDOWS: usize = 16;

/// Rows of one trajectory that one thread runs through, block after block.
struct Chunk {
    trajectory: usize,
    blocks: Vec<Range<usize>>,
}

/// Values of kept rows: (row, values) of one chunk, one after the other.
type Kept = (Range<usize>, Vec<f64>);

pub(super) fn run(
    prepared: &[Prepared<'_>],
    settings: &ObserveSettings,
    progress: Option<Progress<'_>>,
) -> (Vec<TimeBlock>, Option<Vec<Rows>>) {
    let most = (ALL_BLOCKS / prepared.len().max(1)).clamp(FEW_BLOCKS, MAX_BLOCKS);
    let chunks: Vec<Chunk> = prepared.iter().enumerate().flat_map(|(k, p)| chunks_of(k, p, most)).collect();
    let total: usize = chunks.iter().map(|c| rows_of(c).len() * prepared[c.trajectory].grid.step).sum();
    let done = AtomicUsize::new(0);
    let results = parallel::map(settings.threads, chunks.len(), |c| {
        let p = &prepared[chunks[c].trajectory];
        let result = run_chunk(p, &chunks[c], settings.keep_rows);
        let samples = rows_of(&chunks[c]).len() * p.grid.step;
        let done = done.fetch_add(samples, Ordering::Relaxed) + samples;
        if let Some(progress) = progress {
            progress(done, total);
        }
        result
    });
    let mut blocks = Vec::new();
    let mut kept: Vec<Vec<Kept>> = prepared.iter().map(|_| Vec::new()).collect();
    for (chunk, (factors, values)) in chunks.iter().zip(results) {
        blocks.extend(factors);
        kept[chunk.trajectory].push((rows_of(chunk), values));
    }
    let rows = settings.keep_rows.then(|| {
        prepared.iter().zip(&kept).enumerate().flat_map(|(k, (p, kept))| gather(k, p, kept)).collect()
    });
    (blocks, rows)
}

/// The factors of each trajectory and equation, merged over its blocks in their order.
pub(super) fn merge(prepared: &[Prepared<'_>], blocks: &[TimeBlock], threads: usize) -> Vec<EquationFactor> {
    let groups: Vec<(usize, usize)> = prepared
        .iter()
        .enumerate()
        .flat_map(|(k, p)| (0..p.equations.len()).map(move |equation| (k, equation)))
        .collect();
    parallel::map(threads, groups.len(), |g| {
        let (trajectory, equation) = groups[g];
        let mut merged = empty(trajectory, equation, &prepared[trajectory]);
        for block in blocks.iter().filter(|b| b.trajectory == trajectory) {
            let factor = &block.equations[equation].factor;
            if factor.rows() > 0 {
                merged.factor.merge(factor);
            }
        }
        merged
    })
}

fn empty(trajectory: usize, equation: usize, p: &Prepared<'_>) -> EquationFactor {
    let columns: Vec<usize> = p.equations[equation].unknowns.iter().map(|&(_, u)| u).collect();
    let factor = Factor::new(p.reversals[equation].len() + columns.len());
    EquationFactor { trajectory, equation, columns, factor, reversals: Vec::new() }
}

fn rows_of(chunk: &Chunk) -> Range<usize> {
    let start = chunk.blocks.first().map_or(0, |b| b.start);
    let end = chunk.blocks.last().map_or(start, |b| b.end);
    start..end
}

fn chunks_of(trajectory: usize, p: &Prepared<'_>, most: usize) -> Vec<Chunk> {
    let count = p.grid.count;
    let row_rate = p.motion.rate / p.grid.step as f64;
    let shortest = (BLOCK_SECONDS * row_rate).ceil() as usize;
    let block = shortest.max(count.div_ceil(most)).max(1);
    let window_rows = p.decimator.taps().len().div_ceil(p.grid.step);
    let chunk = (CHUNK_WINDOWS * window_rows).div_ceil(block).max(1);
    let blocks: Vec<Range<usize>> =
        (0..count).step_by(block).map(|from| from..(from + block).min(count)).collect();
    blocks.chunks(chunk).map(|blocks| Chunk { trajectory, blocks: blocks.to_vec() }).collect()
}

/// Rows of one equation on their way into a factor: the columns of its reversals, those of W, and Y.
struct Pending<'a> {
    reversals: &'a [Vec<f64>],
    columns: Vec<usize>,
    rows: usize,
    /// Column by column, BLOCK_ROWS each.
    block: Vec<f64>,
    factor: Factor,
}

impl Pending<'_> {
    fn push(&mut self, row: usize, values: &[f64]) {
        let reversals = self.reversals.iter().map(|column| column[row]);
        let all = reversals.chain(self.columns.iter().map(|&column| values[column]));
        for (block, value) in self.block.chunks_exact_mut(BLOCK_ROWS).zip(all) {
            block[self.rows] = value;
        }
        self.rows += 1;
        if self.rows == BLOCK_ROWS {
            self.flush();
        }
    }

    fn flush(&mut self) {
        self.factor.push(self.rows, BLOCK_ROWS, &mut self.block);
        self.rows = 0;
    }
}

fn run_chunk(p: &Prepared<'_>, chunk: &Chunk, keep_rows: bool) -> (Vec<TimeBlock>, Vec<f64>) {
    let mut pending: Vec<Pending<'_>> = p
        .equations
        .iter()
        .zip(&p.reversals)
        .map(|(e, reversals)| Pending {
            reversals,
            columns: e.unknowns.iter().map(|&(column, _)| column).chain([e.y]).collect(),
            rows: 0,
            block: vec![0.0; (reversals.len() + e.unknowns.len() + 1) * BLOCK_ROWS],
            factor: Factor::new(reversals.len() + e.unknowns.len()),
        })
        .collect();
    let time = |row: usize| p.motion.start + (p.grid.first + row * p.grid.step) as f64 / p.motion.rate;
    let mut finished = Vec::with_capacity(chunk.blocks.len());
    let mut kept = Vec::new();
    let mut blocks = chunk.blocks.iter();
    let mut current = blocks.next();
    decimate(&*p.source, &p.decimator, p.grid, rows_of(chunk), |row, values| {
        for (pending, selection) in pending.iter_mut().zip(&p.selection) {
            if selection.used[row] {
                pending.push(row, values);
            }
        }
        if keep_rows {
            kept.extend_from_slice(values);
        }
        if let Some(block) = current.filter(|b| row + 1 == b.end) {
            let equations = pending
                .iter_mut()
                .enumerate()
                .map(|(equation, pending)| {
                    pending.flush();
                    let mut done = empty(chunk.trajectory, equation, p);
                    std::mem::swap(&mut done.factor, &mut pending.factor);
                    done
                })
                .collect();
            let time = [time(block.start), time(row)];
            finished.push(TimeBlock { trajectory: chunk.trajectory, time, equations });
            current = blocks.next();
        }
    });
    (finished, kept)
}

fn gather(trajectory: usize, p: &Prepared<'_>, kept: &[Kept]) -> Vec<Rows> {
    let count = p.grid.count;
    let width = p.source.filtered().len();
    let sample: Vec<usize> = p.grid.centres().collect();
    let time: Vec<f64> = sample.iter().map(|&s| p.motion.start + s as f64 / p.motion.rate).collect();
    p.equations
        .iter()
        .enumerate()
        .map(|(equation, columns)| {
            let column = |c: usize| -> Vec<f64> {
                kept.iter().flat_map(|(_, values)| values.iter().skip(c).step_by(width).copied()).collect()
            };
            let mut w = Vec::with_capacity(count * columns.unknowns.len());
            for &(c, _) in &columns.unknowns {
                w.extend(column(c));
            }
            Rows {
                trajectory,
                equation,
                sample: sample.clone(),
                time: time.clone(),
                y: column(columns.y),
                columns: columns.unknowns.iter().map(|&(_, u)| u).collect(),
                w,
                used: p.selection[equation].used.clone(),
            }
        })
        .collect()
}
