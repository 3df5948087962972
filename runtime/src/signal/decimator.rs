//! Parallel decimation: one linear-phase FIR low-pass for Y and for every column of W.

use std::ops::Range;

use wide::f64x4;

use super::SignalError;

/// A linear-phase FIR low-pass that keeps one sample in `factor`.
///
/// The paper's IV.A asks for one filter for Y and for all columns of W. An FIR is taken instead of the order-8
/// Chebyshev I of the usual `decimate`, run in both directions, because it can be streamed in blocks, because
/// what an end of the recording spoils is known exactly (`support` samples), because only the kept rows are
/// computed, and because its phase is exactly linear: after the delay is taken out it shifts nothing.
///
/// The window is Hamming's over 20 * factor + 1 taps, the design of scipy's `decimate(ftype="fir")`: -6 dB at the
/// cut-off; with the cut-off at the new Nyquist frequency f: within 0.3 % up to 0.83 f, below -50 dB from
/// 1.17 f on. With factor 1 it is the identity.
#[derive(Debug, Clone, PartialEq)]
pub struct Decimator {
    factor: usize,
    taps: Vec<f64>,
}

/// Half the longest filter, samples; a recording that it fits into has a rate a hundred thousand times the band.
const LONGEST: f64 = 1e6;

/// The rows that a decimator keeps from a range of valid samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct KeptRows {
    /// Sample at the centre of the first kept row.
    pub first: usize,
    /// Samples from one kept row to the next.
    pub step: usize,
    /// Number of kept rows.
    pub count: usize,
}

impl KeptRows {
    /// The samples at the centres of the kept rows.
    pub fn centres(&self) -> impl ExactSizeIterator<Item = usize> + use<> {
        let Self { first, step, count } = *self;
        (0..count).map(move |k| first + k * step)
    }
}

impl Decimator {
    /// Keeps one sample in `factor`, cut-off at the new Nyquist frequency.
    ///
    /// # Errors
    /// A factor of 0.
    pub fn new(factor: usize) -> Result<Self, SignalError> {
        Self::with_band(factor, 1.0)
    }

    /// Keeps one sample in `factor`, cut-off at `band` times the new Nyquist frequency (0 < band <= 1); the number
    /// of taps grows with 1 / band, so that the transition keeps its shape.
    ///
    /// # Errors
    /// A factor of 0, a band outside of (0, 1], or a filter of more than two million taps.
    pub fn with_band(factor: usize, band: f64) -> Result<Self, SignalError> {
        if factor == 0 {
            return Err(SignalError::Factor);
        }
        if !(band > 0.0 && band <= 1.0) {
            return Err(SignalError::Band(band));
        }
        if factor == 1 && band == 1.0 {
            return Ok(Self { factor, taps: vec![1.0] });
        }
        let half = (10.0 * factor as f64 / band).ceil();
        if half > LONGEST {
            return Err(SignalError::TooManyTaps(2.0 * half));
        }
        let half = half as usize;
        let cutoff = band / factor as f64;
        Ok(Self { factor, taps: hamming_low_pass(half, cutoff) })
    }

    /// The whole factor that brings `rate` nearest to `target` (both Hz), at least 1: the rate after it is
    /// `rate / factor`, which a caller reports when it is not `target`.
    pub fn factor_for(rate: f64, target: f64) -> usize {
        let ratio = rate / target;
        if ratio.is_finite() && ratio > 1.0 { ratio.round().min(1e9) as usize } else { 1 }
    }

    /// The filter that brings a signal of `rate` to rows that hold the frequencies up to `band`, about `rows_per_second`
    /// of them (all Hz); `None`: twice the band. A band that the rows cannot hold is made narrower.
    ///
    /// # Errors
    /// As of [`Decimator::with_band`].
    pub fn for_rows(rate: f64, band: f64, rows_per_second: Option<f64>) -> Result<Self, SignalError> {
        let factor = Self::factor_for(rate, rows_per_second.unwrap_or(2.0 * band));
        let nyquist = 0.5 * rate / factor as f64;
        Self::with_band(factor, (band / nyquist).min(1.0))
    }

    /// Samples in per sample out.
    pub fn factor(&self) -> usize {
        self.factor
    }

    /// Samples that the filter reaches to each side of a kept row.
    pub fn support(&self) -> usize {
        self.taps.len() / 2
    }

    /// The taps, symmetric, summing to 1.
    pub fn taps(&self) -> &[f64] {
        &self.taps
    }

    /// The rows that can be kept when the samples in `valid` may be used and no others.
    pub fn kept_rows(&self, valid: Range<usize>) -> KeptRows {
        let samples = valid.end.saturating_sub(valid.start);
        let count = if samples < self.taps.len() { 0 } else { (samples - self.taps.len()) / self.factor + 1 };
        KeptRows { first: valid.start + self.support(), step: self.factor, count }
    }

    /// Samples that `count` kept rows in sequence need.
    pub fn input_len(&self, count: usize) -> usize {
        if count == 0 { 0 } else { (count - 1) * self.factor + self.taps.len() }
    }

    /// Samples that a block must hand on to the next one, so that the next kept row has its left side.
    pub fn overlap(&self) -> usize {
        self.taps.len().saturating_sub(self.factor)
    }

    /// Gain at `frequency`, in units of the sampling rate of the input.
    pub fn response(&self, frequency: f64) -> f64 {
        let centre = self.support() as f64;
        let w = 2.0 * std::f64::consts::PI * frequency;
        self.taps.iter().enumerate().map(|(i, h)| h * (w * (i as f64 - centre)).cos()).sum()
    }

    /// Filters one column: `output[k]` is the row centred at `input[k * factor + support]`. Only kept rows are
    /// computed; the number of rows written is returned (`output` may be longer than what `input` gives).
    pub fn decimate_run(&self, input: &[f64], output: &mut [f64]) -> usize {
        let count = self.kept_rows(0..input.len()).count.min(output.len());
        for (out, x) in output[..count].iter_mut().zip(self.windows(input)) {
            *out = dot(&self.taps, x);
        }
        count
    }

    /// Filters columns that lie behind each other, `input[c * stride + t]`, `stride` samples each, into
    /// `output[c * rows + k]` with `rows` the kept rows of one column. Four columns share each load of a tap.
    /// Returns `rows`; `output` must hold that many per column (columns that do not fit are left out).
    pub fn decimate_columns(&self, input: &[f64], stride: usize, output: &mut [f64]) -> usize {
        let rows = self.kept_rows(0..stride).count;
        if rows == 0 {
            return 0;
        }
        let n = self.taps.len();
        let mut columns = input.chunks_exact(4 * stride);
        let mut outputs = output.chunks_exact_mut(4 * rows);
        for (x, out) in columns.by_ref().zip(outputs.by_ref()) {
            let (x0, x) = x.split_at(stride);
            let (x1, x) = x.split_at(stride);
            let (x2, x3) = x.split_at(stride);
            let (out0, out) = out.split_at_mut(rows);
            let (out1, out) = out.split_at_mut(rows);
            let (out2, out3) = out.split_at_mut(rows);
            for k in 0..rows {
                let at = k * self.factor;
                let sums =
                    dot4(&self.taps, [&x0[at..at + n], &x1[at..at + n], &x2[at..at + n], &x3[at..at + n]]);
                [out0[k], out1[k], out2[k], out3[k]] = sums;
            }
        }
        for (x, out) in
            columns.remainder().chunks_exact(stride).zip(outputs.into_remainder().chunks_exact_mut(rows))
        {
            self.decimate_run(x, out);
        }
        rows
    }

    fn windows<'a>(&self, input: &'a [f64]) -> impl Iterator<Item = &'a [f64]> + use<'a> {
        let (factor, n) = (self.factor, self.taps.len());
        (0..).map(move |k: usize| k * factor).map_while(move |at| input.get(at..at + n))
    }
}

/// Windowed sinc, Hamming's window, `2 * half + 1` taps, `cutoff` in units of the Nyquist frequency, gain 1 at 0.
fn hamming_low_pass(half: usize, cutoff: f64) -> Vec<f64> {
    use std::f64::consts::PI;
    let tap = |k: usize| {
        let window = 0.54 + 0.46 * (PI * k as f64 / half as f64).cos();
        let angle = PI * cutoff * k as f64;
        window * cutoff * if k == 0 { 1.0 } else { angle.sin() / angle }
    };
    let side: Vec<f64> = (0..=half).map(tap).collect();
    let sum = side[0] + 2.0 * side[1..].iter().rev().sum::<f64>();
    (0..=2 * half).map(|i| side[i.abs_diff(half)] / sum).collect()
}

fn quad(x: &[f64]) -> f64x4 {
    f64x4::from([x[0], x[1], x[2], x[3]])
}

/// Sum of h[i] x[i] over equal lengths. Four accumulators of four lanes hide the latency of the addition; the
/// order of the sums depends on the length alone.
fn dot(h: &[f64], x: &[f64]) -> f64 {
    let mut sums = [f64x4::ZERO; 4];
    let (mut hs, mut xs) = (h.chunks_exact(16), x.chunks_exact(16));
    for (h, x) in hs.by_ref().zip(xs.by_ref()) {
        for (lane, sum) in sums.iter_mut().enumerate() {
            *sum = quad(&h[4 * lane..4 * lane + 4]).mul_add(quad(&x[4 * lane..4 * lane + 4]), *sum);
        }
    }
    let rest: f64 = hs.remainder().iter().zip(xs.remainder()).map(|(h, x)| h * x).sum();
    ((sums[0] + sums[1]) + (sums[2] + sums[3])).reduce_add() + rest
}

/// `dot` of four columns with the same taps.
fn dot4(h: &[f64], x: [&[f64]; 4]) -> [f64; 4] {
    let mut sums = [[f64x4::ZERO; 2]; 4];
    let whole = h.len() / 8 * 8;
    let (head, rest) = h.split_at(whole);
    let columns = x.map(|x| x.split_at(whole));
    for (i, h) in head.chunks_exact(8).enumerate() {
        let (low, high) = (quad(h), quad(&h[4..]));
        for (sum, (x, _)) in sums.iter_mut().zip(&columns) {
            let x = &x[8 * i..8 * i + 8];
            sum[0] = low.mul_add(quad(x), sum[0]);
            sum[1] = high.mul_add(quad(&x[4..]), sum[1]);
        }
    }
    let mut out = [0.0; 4];
    for ((out, sum), (_, x)) in out.iter_mut().zip(&sums).zip(&columns) {
        *out = (sum[0] + sum[1]).reduce_add() + rest.iter().zip(*x).map(|(h, x)| h * x).sum::<f64>();
    }
    out
}

#[cfg(test)]
#[path = "decimator_tests.rs"]
mod tests;
