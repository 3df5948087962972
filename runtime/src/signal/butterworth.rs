//! Butterworth low-pass of any order as second-order sections.

use super::SignalError;

/// One second-order section b0 + b1 z^-1 + b2 z^-2 over 1 + a1 z^-1 + a2 z^-2.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Section {
    /// Numerator b0, b1, b2.
    pub b: [f64; 3],
    /// Denominator a1, a2 (a0 is 1).
    pub a: [f64; 2],
}

/// A Butterworth low-pass as a cascade of second-order sections, each with gain 1 at rest.
///
/// Bilinear transformation with the cut-off prewarped, so that one pass has -3 dB at the cut-off and a pass
/// in both directions -6 dB (Oppenheim and Schafer, Discrete-Time Signal Processing, 7.2). Sections keep their
/// digits where the polynomial form loses them: at 20 Hz of 5 kHz an order of 8 is exact here.
#[derive(Debug, Clone, PartialEq)]
pub struct Butterworth {
    sections: Vec<Section>,
    order: usize,
    slowest_pole: f64,
}

impl Butterworth {
    /// Low-pass of `order` (1 to 20) with `cutoff` in Hz for signals of `rate` samples a second.
    ///
    /// # Errors
    /// A rate that is not positive, another order, a cut-off outside of (0, rate / 2).
    pub fn low_pass(order: usize, cutoff: f64, rate: f64) -> Result<Self, SignalError> {
        if !(rate.is_finite() && rate > 0.0) {
            return Err(SignalError::Rate(rate));
        }
        if !(1..=20).contains(&order) {
            return Err(SignalError::Order(order));
        }
        if !(cutoff > 0.0 && cutoff < rate / 2.0) {
            return Err(SignalError::Cutoff { cutoff, limit: rate / 2.0 });
        }
        let w = (std::f64::consts::PI * cutoff / rate).tan();
        let mut sections = Vec::with_capacity(order.div_ceil(2));
        let mut slowest_pole: f64 = 0.0;
        for k in 0..order / 2 {
            // Pole w * exp(i phi) of the analog prototype in the left half plane; z = (1 + s) / (1 - s).
            let phi = std::f64::consts::PI * (2 * k + 1 + order) as f64 / (2 * order) as f64;
            let (re, im) = (w * phi.cos(), w * phi.sin());
            let d = (1.0 - re) * (1.0 - re) + im * im;
            let a1 = -2.0 * (1.0 - re * re - im * im) / d;
            let a2 = ((1.0 + re) * (1.0 + re) + im * im) / d;
            let g = w * w / d;
            sections.push(Section { b: [g, 2.0 * g, g], a: [a1, a2] });
            slowest_pole = slowest_pole.max(a2.sqrt());
        }
        if order % 2 == 1 {
            let g = w / (1.0 + w);
            let a1 = (w - 1.0) / (w + 1.0);
            sections.push(Section { b: [g, g, 0.0], a: [a1, 0.0] });
            slowest_pole = slowest_pole.max(a1.abs());
        }
        Ok(Self { sections, order, slowest_pole })
    }

    /// The sections, applied in this order.
    pub fn sections(&self) -> &[Section] {
        &self.sections
    }

    /// Order of one pass.
    pub fn order(&self) -> usize {
        self.order
    }

    /// Samples after which the slowest mode has decayed to `fraction` of itself: what an end of the signal
    /// spoils.
    pub fn settling(&self, fraction: f64) -> usize {
        if self.slowest_pole <= f64::MIN_POSITIVE {
            return self.order;
        }
        (fraction.ln() / self.slowest_pole.ln()).ceil().max(self.order as f64) as usize
    }

    /// Samples by which `zero_phase` extends the signal at each end unless told otherwise, as in scipy's
    /// `filtfilt`.
    pub fn padding(&self) -> usize {
        3 * (self.order + 1)
    }

    /// One causal pass in place, from rest at `initial` (the state of a signal that has always been `initial`).
    pub fn filter(&self, signal: &mut [f64], initial: f64) {
        self.run(signal.iter_mut(), initial);
    }

    fn run<'a>(&self, signal: impl Iterator<Item = &'a mut f64>, initial: f64) {
        const MOST: usize = 10;
        // Transposed direct form II; every section has gain 1 at rest, so all of them start from `initial`.
        let mut state = [[0.0; 2]; MOST];
        for (z, s) in state.iter_mut().zip(&self.sections) {
            z[1] = (s.b[2] - s.a[1]) * initial;
            z[0] = (s.b[1] - s.a[0]) * initial + z[1];
        }
        let state = &mut state[..self.sections.len()];
        for value in signal {
            let mut x = *value;
            for (z, s) in state.iter_mut().zip(&self.sections) {
                let y = s.b[0] * x + z[0];
                z[0] = s.b[1] * x - s.a[0] * y + z[1];
                z[1] = s.b[2] * x - s.a[1] * y;
                x = y;
            }
            *value = x;
        }
    }

    /// Forward and backward pass, which leaves no phase shift. The ends are extended by a point reflection
    /// (odd padding) of `padding()` samples and each pass starts at rest (Gustafsson 1996 discusses the
    /// choices); agrees with scipy's `sosfiltfilt`.
    ///
    /// # Errors
    /// A signal that is not longer than the padding.
    pub fn zero_phase(&self, signal: &[f64]) -> Result<Vec<f64>, SignalError> {
        let mut out = Vec::new();
        self.zero_phase_into(signal, self.padding(), &mut out)?;
        Ok(out)
    }

    /// `zero_phase` with a padding of one's own, into a buffer that is reused; `out` gets the length of `signal`.
    ///
    /// # Errors
    /// As [`Butterworth::zero_phase`].
    pub fn zero_phase_into(
        &self,
        signal: &[f64],
        padding: usize,
        out: &mut Vec<f64>,
    ) -> Result<(), SignalError> {
        let n = signal.len();
        if n <= padding || n == 0 {
            return Err(SignalError::TooShort {
                name: "signal".into(),
                samples: n,
                needed: padding + 1,
                purpose: "filter it in both directions",
            });
        }
        let (first, last) = (signal[0], signal[n - 1]);
        out.clear();
        out.reserve(n + 2 * padding);
        out.extend(signal[1..=padding].iter().rev().map(|x| 2.0 * first - x));
        out.extend_from_slice(signal);
        out.extend(signal[n - 1 - padding..n - 1].iter().rev().map(|x| 2.0 * last - x));
        let start = out[0];
        self.run(out.iter_mut(), start);
        let start = out[out.len() - 1];
        self.run(out.iter_mut().rev(), start);
        out.copy_within(padding..padding + n, 0);
        out.truncate(n);
        Ok(())
    }
}

#[cfg(test)]
#[path = "butterworth_tests.rs"]
mod tests;
