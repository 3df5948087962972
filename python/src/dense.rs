//! The inverse dynamic regressor as a dense array, by the batch engine.

use std::ops::Range;
use std::thread;

use dynid_runtime::model::{LANES, LINE, Lanes, Line, Model, States};
use wide::f64x4;

#[path = "past_the_cache.rs"]
mod past_the_cache;

/// Samples that threads share are cut at multiples of this.
const GRAIN: usize = 64;

/// Fewer samples than this are not worth a thread.
const PIECE: usize = 4096;

/// Arrays of more numbers than this are written past the cache: 16 MB, less than the last level of most machines holds.
pub const CACHED: usize = 2 << 20;

/// Writes the regressors of all samples to `out`: sample by sample, n rows of p columns each, every number of them.
///
/// `blocks` calls its second argument with the states of a range of samples, block by block in sequence, each block but
/// the last of the range with a multiple of [`LINE`] samples. 0 threads are as many as the machine has. The numbers are the
/// same for any number of threads.
///
/// # Panics
/// Where `out` does not have the length of the regressors of the samples: a bug of the caller.
pub fn regressors(
    model: &dyn Model,
    samples: usize,
    threads: usize,
    out: &mut [f64],
    blocks: impl Fn(Range<usize>, &mut dyn FnMut(States<'_>)) + Sync,
) {
    let size = model.robot().joints() * model.robot().base.len();
    assert_eq!(out.len(), samples * size, "room for {samples} regressors of {size} numbers");
    if out.is_empty() {
        return;
    }
    let available = || thread::available_parallelism().map_or(1, |n| n.get());
    let threads = if threads == 0 { available() } else { threads }.min(samples.div_ceil(PIECE));
    let share = samples.div_ceil(threads).next_multiple_of(GRAIN);
    let is_cached = out.len() <= CACHED;
    let work = |first: usize, part: &mut [f64]| {
        let mut tile = Tile::new(model, size);
        let mut rest = part;
        blocks(first..first + rest.len() / size, &mut |states| {
            let (now, later) = std::mem::take(&mut rest).split_at_mut(states.samples() * size);
            tile.write(states, now, is_cached);
            rest = later;
        });
    };
    thread::scope(|scope| {
        let mut parts = out.chunks_mut(share * size).enumerate();
        let first = parts.next();
        for (k, part) in parts {
            let work = &work;
            scope.spawn(move || work(k * share, part));
        }
        if let Some((_, part)) = first {
            work(0, part);
        }
    });
}

/// Four numbers of a matrix that follow one another.
struct Quad {
    /// The first one's place in the matrix.
    place: usize,
    /// Their entries of the pattern, or its length for what is no entry and zero.
    entries: [usize; 4],
}

/// The matrices of one line of samples, in the cache.
struct Tile<'a> {
    model: &'a dyn Model,
    /// Numbers of a matrix.
    size: usize,
    /// Where there are entries, from the back to the front.
    quads: Vec<Quad>,
    /// Entries by lines of samples, as they are computed, and a zero behind those of each line.
    lines: Vec<Line>,
    /// The matrices one after the other, and room for what the last quad writes too much. What is no entry stays zero.
    matrices: Vec<f64>,
}

impl<'a> Tile<'a> {
    fn new(model: &'a dyn Model, size: usize) -> Self {
        let (pattern, columns) = (model.pattern(), model.robot().base.len());
        let entries = pattern.columns.len();
        let mut entry_at = vec![entries; size.next_multiple_of(4)];
        for (row, range) in pattern.rows.windows(2).enumerate() {
            for entry in range[0]..range[1] {
                entry_at[row * columns + pattern.columns[entry]] = entry;
            }
        }
        let quads = entry_at
            .chunks_exact(4)
            .enumerate()
            .map(|(k, four)| Quad { place: 4 * k, entries: std::array::from_fn(|i| four[i]) });
        // The last quad may reach into the next matrix, whose first one comes after it and mends that.
        let is_needed = |quad: &Quad| quad.place == 0 || quad.entries.iter().any(|&e| e < entries);
        let quads = quads.rev().filter(is_needed).collect();
        Self { model, size, quads, lines: Vec::new(), matrices: vec![0.0; LINE * size + 3] }
    }

    /// Writes the matrices of a block of samples.
    fn write(&mut self, states: States<'_>, out: &mut [f64], is_cached: bool) {
        let width = self.model.pattern().columns.len() + 1;
        let lines = states.samples().div_ceil(LINE);
        self.lines.resize(lines * width, [Lanes::splat(0.0); LINE / LANES]);
        self.model.idm_lines(states, width, &mut self.lines);
        for (line, out) in self.lines.chunks_exact(width).zip(out.chunks_mut(LINE * self.size)) {
            for quad in &self.quads {
                let [a, b, c, d] = quad.entries.map(|entry| &line[entry]);
                for group in 0..LINE / LANES {
                    let of_entries = [a, b, c, d].map(|lanes| f64x4::new(lanes[group].to_array()));
                    for (k, four) in f64x4::transpose(of_entries).into_iter().enumerate() {
                        let at = (group * LANES + k) * self.size + quad.place;
                        self.matrices[at..at + 4].copy_from_slice(&four.to_array());
                    }
                }
            }
            let found = &self.matrices[..out.len()];
            if is_cached {
                out.copy_from_slice(found);
            } else {
                past_the_cache::copy(found, out);
            }
        }
    }
}
