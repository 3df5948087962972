//! From stamped, jittery time to a uniform grid.

use super::SignalError;

/// The uniform grid of a recording's time stamps, and how to get there.
///
/// Interpolation is by a cubic spline with not-a-knot ends (de Boor 1978), the same for positions and torques. Its
/// error falls with (frequency / rate)^4: 2e-5 for 5 Hz sampled at 95 Hz, where an interpolation by straight lines has
/// 1 % and damps what it passes; a band-limited (sinc) interpolation is exact only on uniform stamps. Stamps that
/// lie nearer than half the typical step are averaged first, values and times: two readings of one instant would
/// set the slope of the spline by their noise.
#[derive(Debug, Clone, PartialEq)]
pub struct UniformGrid {
    /// Samples a second, Hz.
    pub rate: f64,
    /// Time of the first sample, s.
    pub start: f64,
    /// Number of samples.
    pub len: usize,
    /// What to interpolate over; `None` where the stamps are uniform already.
    knots: Option<Knots>,
}

#[derive(Debug, Clone, PartialEq)]
struct Knots {
    /// Rows averaged into each knot: (first, count).
    rows: Vec<(usize, usize)>,
    time: Vec<f64>,
    /// The tridiagonal system of the spline's slopes after forward elimination: multiplier of the row above,
    /// reciprocal pivot, super-diagonal.
    multiplier: Vec<f64>,
    pivot: Vec<f64>,
    upper: Vec<f64>,
}

/// Stamps further than this fraction of a step from an exact grid count as non-uniform.
const UNIFORM_WITHIN: f64 = 0.05;
/// Most samples that a uniform grid may have: 1 GB a column.
const MOST_SAMPLES: f64 = 1.3e8;

impl UniformGrid {
    /// The grid of strictly increasing stamps (s): their own where they are uniform, else at the typical (median)
    /// step, or at `rate` Hz where one is given. `name` is for errors.
    ///
    /// # Errors
    /// Fewer than four stamps, stamps that do not increase or are not finite, a rate that is not positive, a grid of
    /// more than 130 million samples.
    pub fn of(name: &str, time: &[f64], rate: Option<f64>) -> Result<Self, SignalError> {
        let n = time.len();
        if n < 4 {
            return Err(SignalError::TooShort {
                name: name.into(),
                samples: n,
                needed: 4,
                purpose: "lay a uniform grid",
            });
        }
        let increases = |(k, w): (usize, &[f64])| {
            (!(w[1] > w[0] && w[0].is_finite() && w[1].is_finite())).then_some(k + 1)
        };
        if let Some(row) = time.windows(2).enumerate().find_map(increases) {
            return Err(SignalError::Time { name: name.into(), row });
        }
        if let Some(rate) = rate
            && !(rate.is_finite() && rate > 0.0)
        {
            return Err(SignalError::Rate(rate));
        }
        let (start, end) = (time[0], time[n - 1]);
        let mean = (end - start) / (n - 1) as f64;
        let step = typical_step(time);
        let deviation =
            time.iter().enumerate().map(|(k, t)| (t - (start + k as f64 * mean)).abs()).fold(0.0, f64::max);
        let own = tidy(1.0 / mean);
        if deviation <= UNIFORM_WITHIN * mean && rate.is_none_or(|r| (r / own - 1.0).abs() < 1e-9) {
            return Ok(Self { rate: own, start, len: n, knots: None });
        }
        let rate = rate.unwrap_or_else(|| tidy(1.0 / step));
        let knots = Knots::new(name, time, step)?;
        let (start, end) = (knots.time[0], knots.time[knots.time.len() - 1]);
        let samples = ((end - start) * rate * (1.0 + 1e-12)).floor() + 1.0;
        if samples > MOST_SAMPLES {
            return Err(SignalError::TooLong { name: name.into(), samples });
        }
        Ok(Self { rate, start, len: samples as usize, knots: Some(knots) })
    }

    /// Whether the stamps were uniform, so that `resample` copies.
    pub fn is_exact(&self) -> bool {
        self.knots.is_none()
    }

    /// One channel, a value per stamp, on the grid.
    pub fn resample(&self, values: &[f64]) -> Vec<f64> {
        let Some(knots) = &self.knots else { return values.to_vec() };
        let y = knots.average(values);
        let slopes = knots.slopes(&y);
        let mut piece = 0;
        let last = knots.time.len() - 2;
        (0..self.len)
            .map(|k| {
                let t = self.start + k as f64 / self.rate;
                while piece < last && t >= knots.time[piece + 1] {
                    piece += 1;
                }
                let h = knots.time[piece + 1] - knots.time[piece];
                let u = (t - knots.time[piece]) / h;
                let v = 1.0 - u;
                let (y0, y1) = (y[piece], y[piece + 1]);
                let (m0, m1) = (slopes[piece] * h, slopes[piece + 1] * h);
                // Cubic Hermite form.
                v * v * ((1.0 + 2.0 * u) * y0 + u * m0) + u * u * ((1.0 + 2.0 * v) * y1 - v * m1)
            })
            .collect()
    }
}

impl Knots {
    fn new(name: &str, time: &[f64], step: f64) -> Result<Self, SignalError> {
        let mut rows: Vec<(usize, usize)> = Vec::with_capacity(time.len());
        for (k, t) in time.iter().enumerate() {
            match rows.last_mut() {
                Some((first, count)) if t - time[*first] < 0.5 * step => *count += 1,
                _ => rows.push((k, 1)),
            }
        }
        let n = rows.len();
        if n < 4 {
            return Err(SignalError::TooShort {
                name: name.into(),
                samples: n,
                needed: 4,
                purpose: "interpolate between distinct time stamps",
            });
        }
        // Relative to the first stamp, so that clock times of a day's length lose no digits.
        let mean = |&(first, count): &(usize, usize)| {
            let base = time[first];
            base + time[first..first + count].iter().map(|t| t - base).sum::<f64>() / count as f64
        };
        let time: Vec<f64> = rows.iter().map(mean).collect();
        let h: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
        let (mut multiplier, mut pivot, mut upper) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        pivot[0] = 1.0 / h[1];
        upper[0] = h[0] + h[1];
        for k in 1..n {
            let (lower, diagonal) = if k < n - 1 {
                upper[k] = h[k - 1];
                (h[k], 2.0 * (h[k - 1] + h[k]))
            } else {
                (h[n - 3] + h[n - 2], h[n - 3])
            };
            multiplier[k] = lower * pivot[k - 1];
            pivot[k] = 1.0 / (diagonal - multiplier[k] * upper[k - 1]);
        }
        Ok(Self { rows, time, multiplier, pivot, upper })
    }

    fn average(&self, values: &[f64]) -> Vec<f64> {
        let mean = |&(first, count): &(usize, usize)| {
            values.get(first..first + count).map_or(f64::NAN, |v| v.iter().sum::<f64>() / count as f64)
        };
        self.rows.iter().map(mean).collect()
    }

    fn slopes(&self, y: &[f64]) -> Vec<f64> {
        let n = y.len();
        let h = |k: usize| self.time[k + 1] - self.time[k];
        let chord = |k: usize| (y[k + 1] - y[k]) / h(k);
        let mut s = vec![0.0; n];
        let two = h(0) + h(1);
        s[0] = ((h(0) + 2.0 * two) * h(1) * chord(0) + h(0) * h(0) * chord(1)) / two;
        for k in 1..n {
            let right = if k < n - 1 {
                3.0 * (h(k) * chord(k - 1) + h(k - 1) * chord(k))
            } else {
                let (a, b) = (h(n - 3), h(n - 2));
                (b * b * chord(n - 3) + (2.0 * (a + b) + b) * a * chord(n - 2)) / (a + b)
            };
            s[k] = right - self.multiplier[k] * s[k - 1];
        }
        s[n - 1] *= self.pivot[n - 1];
        for k in (0..n - 1).rev() {
            s[k] = (s[k] - self.upper[k] * s[k + 1]) * self.pivot[k];
        }
        s
    }
}

/// The median step, or the mean where stamps come in bursts and the median step is less than half of it.
fn typical_step(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time.windows(2).map(|w| w[1] - w[0]).collect();
    let middle = steps.len() / 2;
    let (_, median, _) = steps.select_nth_unstable_by(middle, f64::total_cmp);
    let median = *median;
    let mean = (time[time.len() - 1] - time[0]) / (time.len() - 1) as f64;
    if median < 0.5 * mean { mean } else { median }
}

/// A rate that is a whole number but for the rounding of printed stamps is that whole number.
fn tidy(rate: f64) -> f64 {
    let whole = rate.round();
    if whole > 0.0 && (rate / whole - 1.0).abs() < 1e-6 { whole } else { rate }
}

#[cfg(test)]
#[path = "resample_tests.rs"]
mod tests;
