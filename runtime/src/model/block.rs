//! Many samples through a function of one: what generated models share.

use super::lanes::{LANES, Lanes};

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

/// Groups of lanes that are written together: one cache line of every column.
const GROUPS: usize = 2;

/// Samples that are read and written together.
const LINE: usize = GROUPS * LANES;

/// Evaluates a function of q, dq and ddq of N joints at every sample, four at a time: value k of sample t is written
/// to `out[k * stride + t]`. A last line that is not full is filled up with its last sample, so that a sample's
/// digits do not depend on where in a block it stands.
///
/// A stride of a multiple of 512 bytes (64 values) sends all columns to the same few sets of the cache and takes twice
/// as long as a stride of eight more.
///
/// # Panics
/// Where signals differ in length or number, or `out` is too short: a bug of the caller.
#[inline(always)]
pub fn evaluate_block<const N: usize, const K: usize>(
    signals: [&[&[f64]]; 3],
    stride: usize,
    out: &mut [f64],
    evaluate: impl Fn([&[Lanes; N]; 3], &mut [Lanes; K]),
) {
    let samples = signals[0].first().map_or(0, |q| q.len());
    assert!(stride >= samples, "a stride of {stride} is less than {samples} samples");
    assert!(
        signals.iter().all(|s| s.len() == N && s.iter().all(|x| x.len() == samples)),
        "expected {N} signals of {samples} samples"
    );
    let mut values = [[Lanes::splat(0.0); K]; GROUPS];
    let mut inputs = [[[Lanes::splat(0.0); N]; 3]; GROUPS];
    for first in (0..samples).step_by(LINE) {
        let count = (samples - first).min(LINE);
        if count == LINE {
            gather_line(signals, first, &mut inputs);
        } else {
            gather_rest(signals, first, &mut inputs);
        }
        for (inputs, values) in inputs.iter().zip(&mut values) {
            evaluate([&inputs[0], &inputs[1], &inputs[2]], values);
        }
        if count == LINE {
            let mut at = first;
            for k in 0..K {
                let line: &mut [f64; LINE] = array_mut(&mut out[at..at + LINE]);
                for (part, values) in line.chunks_exact_mut(LANES).zip(&values) {
                    part.copy_from_slice(&values[k].to_array());
                }
                at += stride;
            }
        } else {
            write_rest(&values, first, count, stride, out);
        }
    }
}

/// The samples of one line, lane by lane.
#[inline(always)]
fn gather_line<const N: usize>(
    signals: [&[&[f64]]; 3],
    first: usize,
    inputs: &mut [[[Lanes; N]; 3]; GROUPS],
) {
    for (s, signals) in signals.into_iter().enumerate() {
        for (j, signal) in signals.iter().enumerate().take(N) {
            let line: &[f64; LINE] = array(&signal[first..first + LINE]);
            for (inputs, part) in inputs.iter_mut().zip(line.chunks_exact(LANES)) {
                inputs[s][j] = Lanes::new(*array(part));
            }
        }
    }
}

/// [`gather_line`] where there are fewer samples: the last one is repeated.
#[cold]
#[inline(never)]
fn gather_rest<const N: usize>(
    signals: [&[&[f64]]; 3],
    first: usize,
    inputs: &mut [[[Lanes; N]; 3]; GROUPS],
) {
    for (s, signals) in signals.into_iter().enumerate() {
        for (j, signal) in signals.iter().enumerate().take(N) {
            for (group, inputs) in inputs.iter_mut().enumerate() {
                let at = |lane: usize| (first + group * LANES + lane).min(signal.len() - 1);
                inputs[s][j] = Lanes::new(std::array::from_fn(|lane| signal[at(lane)]));
            }
        }
    }
}

#[cold]
#[inline(never)]
fn write_rest<const K: usize>(
    values: &[[Lanes; K]; GROUPS],
    first: usize,
    count: usize,
    stride: usize,
    out: &mut [f64],
) {
    for k in 0..K {
        let column = &mut out[k * stride + first..][..count];
        for (part, values) in column.chunks_mut(LANES).zip(values) {
            part.copy_from_slice(&values[k].to_array()[..part.len()]);
        }
    }
}
