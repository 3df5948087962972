//! Many samples through a function of one: what generated models share.

use super::lanes::{LANES, Lanes};
use std::ops::{Index, IndexMut};

/// A slice as an array of the length a model needs.
///
/// # Panics
/// Where the length is another one: a bug of the caller.
#[inline(always)]
pub fn array<const K: usize>(values: &[f64]) -> &[f64; K] {
    match values.try_into() {
        Ok(array) => array,
        Err(_) => panic!("expected {K} values, got {}", values.len()),
    }
}

/// [`array()`] for a result.
///
/// # Panics
/// Where the length is another one: a bug of the caller.
#[inline(always)]
pub fn array_mut<const K: usize>(values: &mut [f64]) -> &mut [f64; K] {
    let found = values.len();
    match values.try_into() {
        Ok(array) => array,
        Err(_) => panic!("expected room for {K} values, got {found}"),
    }
}

/// Groups of lanes in a line.
const GROUPS: usize = 2;

/// Samples of a [`Line`].
pub const LINE: usize = GROUPS * LANES;

/// One value at eight samples in sequence, four to a group: one line of the cache.
pub type Line = [Lanes; GROUPS];

/// q, dq and ddq of N joints at the samples of a line, group by group.
pub type LineStates<const N: usize> = [[[Lanes; N]; 3]; GROUPS];

/// The places of one group in the lines of K values: what a generated function writes to.
pub struct InLines<'a, const K: usize> {
    lines: &'a mut [Line; K],
    group: usize,
}

impl<const K: usize> Index<usize> for InLines<'_, K> {
    type Output = Lanes;
    #[inline(always)]
    fn index(&self, k: usize) -> &Lanes {
        &self.lines[k][self.group % GROUPS]
    }
}

impl<const K: usize> IndexMut<usize> for InLines<'_, K> {
    #[inline(always)]
    fn index_mut(&mut self, k: usize) -> &mut Lanes {
        &mut self.lines[k][self.group % GROUPS]
    }
}

/// Evaluates a function of one state at every sample of a line, four at a time.
#[inline(always)]
pub fn evaluate_line<const N: usize, const K: usize>(
    states: &LineStates<N>,
    lines: &mut [Line; K],
    evaluate: impl Fn([&[Lanes; N]; 3], &mut InLines<'_, K>),
) {
    for (group, [q, dq, ddq]) in states.iter().enumerate() {
        evaluate([q, dq, ddq], &mut InLines { lines, group });
    }
}

/// Evaluates a function of q, dq and ddq of N joints at every sample, eight at a time: value k of the i-th line of
/// samples is written to `out[i * width + k]`. A last line that is not full is filled up with its last sample, so
/// that a sample's digits do not depend on where in a block it stands.
///
/// # Panics
/// Where signals differ in length or number, or `out` is too short: a bug of the caller.
pub fn evaluate_lines<const N: usize, const K: usize>(
    signals: [&[&[f64]]; 3],
    width: usize,
    out: &mut [Line],
    evaluate: fn(&LineStates<N>, &mut [Line; K]),
) {
    let samples = check::<N>(signals);
    assert!(width >= K, "lines of {K} values do not go into a width of {width}");
    let mut states = [[[Lanes::splat(0.0); N]; 3]; GROUPS];
    for (i, first) in (0..samples).step_by(LINE).enumerate() {
        gather(signals, first, samples, &mut states);
        match out.get_mut(i * width..).and_then(|rest| rest.first_chunk_mut()) {
            Some(lines) => evaluate(&states, lines),
            None => panic!("no room for line {i} of {samples} samples"),
        }
    }
}

/// Evaluates a function as [`evaluate_lines`] does and writes value k of sample t to `out[k * stride + t]`.
///
/// # Panics
/// As [`evaluate_lines`].
pub fn evaluate_block<const N: usize, const K: usize>(
    signals: [&[&[f64]]; 3],
    stride: usize,
    out: &mut [f64],
    evaluate: impl Fn(&LineStates<N>, &mut [Line; K]),
) {
    let samples = check::<N>(signals);
    assert!(stride >= samples, "a stride of {stride} is less than {samples} samples");
    let mut lines = [[Lanes::splat(0.0); GROUPS]; K];
    let mut states = [[[Lanes::splat(0.0); N]; 3]; GROUPS];
    for first in (0..samples).step_by(LINE) {
        gather(signals, first, samples, &mut states);
        evaluate(&states, &mut lines);
        if samples - first >= LINE {
            let mut at = first;
            for line in &lines {
                let column: &mut [f64; LINE] = array_mut(&mut out[at..at + LINE]);
                for (part, values) in column.chunks_exact_mut(LANES).zip(line) {
                    part.copy_from_slice(&values.to_array());
                }
                at += stride;
            }
        } else {
            write_rest(&lines, first, samples - first, stride, out);
        }
    }
}

/// The number of samples, where the signals are of one length and as many as there are joints.
fn check<const N: usize>(signals: [&[&[f64]]; 3]) -> usize {
    let samples = signals[0].first().map_or(0, |q| q.len());
    assert!(
        signals.iter().all(|s| s.len() == N && s.iter().all(|x| x.len() == samples)),
        "expected {N} signals of {samples} samples"
    );
    samples
}

/// The samples of one line from `first` on.
#[inline(always)]
fn gather<const N: usize>(signals: [&[&[f64]]; 3], first: usize, samples: usize, states: &mut LineStates<N>) {
    if samples - first < LINE {
        return gather_rest(signals, first, states);
    }
    for (s, signals) in signals.into_iter().enumerate() {
        for (j, signal) in signals.iter().enumerate().take(N) {
            let line: &[f64; LINE] = array(&signal[first..first + LINE]);
            for (states, part) in states.iter_mut().zip(line.chunks_exact(LANES)) {
                states[s][j] = Lanes::new(*array(part));
            }
        }
    }
}

/// [`gather`] where there are fewer samples: the last one is repeated.
#[cold]
#[inline(never)]
fn gather_rest<const N: usize>(signals: [&[&[f64]]; 3], first: usize, states: &mut LineStates<N>) {
    for (s, signals) in signals.into_iter().enumerate() {
        for (j, signal) in signals.iter().enumerate().take(N) {
            for (group, states) in states.iter_mut().enumerate() {
                let at = |lane: usize| (first + group * LANES + lane).min(signal.len() - 1);
                states[s][j] = Lanes::new(std::array::from_fn(|lane| signal[at(lane)]));
            }
        }
    }
}

#[cold]
#[inline(never)]
fn write_rest<const K: usize>(lines: &[Line; K], first: usize, count: usize, stride: usize, out: &mut [f64]) {
    for (k, line) in lines.iter().enumerate() {
        let column = &mut out[k * stride + first..][..count];
        for (part, values) in column.chunks_mut(LANES).zip(line) {
            part.copy_from_slice(&values.to_array()[..part.len()]);
        }
    }
}
