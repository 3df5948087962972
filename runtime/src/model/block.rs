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

/// [`array`] for a result.
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

/// Evaluates a function of q, dq and ddq of N joints at every sample, four at a time: value k of sample t is written
/// to `out[k * stride + t]`. A last group that is not full is filled up with its last sample, so that a sample's
/// digits do not depend on where in a block it stands.
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
    assert!(signals.iter().all(|s| s.len() == N), "expected signals of {N} joints");
    let signals: [[&[f64]; N]; 3] = signals.map(|s| std::array::from_fn(|j| &s[j][..samples]));
    let mut values = [Lanes::splat(0.0); K];
    let whole = samples - samples % LANES;
    for t in (0..whole).step_by(LANES) {
        let [q, dq, ddq] = signals.map(|s| s.map(|s| load(&s[t..t + LANES])));
        evaluate([&q, &dq, &ddq], &mut values);
        for (k, value) in values.iter().enumerate() {
            let at = k * stride + t;
            out[at..at + LANES].copy_from_slice(&value.to_array());
        }
    }
    let rest = samples - whole;
    if rest > 0 {
        let last = |s: &[f64]| Lanes::new(std::array::from_fn(|k| s[whole + k.min(rest - 1)]));
        let [q, dq, ddq] = signals.map(|s| s.map(last));
        evaluate([&q, &dq, &ddq], &mut values);
        for (k, value) in values.iter().enumerate() {
            let at = k * stride + whole;
            out[at..at + rest].copy_from_slice(&value.to_array()[..rest]);
        }
    }
}

#[inline(always)]
fn load(samples: &[f64]) -> Lanes {
    Lanes::new(*array(samples))
}
