//! Power spectral density.

use realfft::RealFftPlanner;

use super::SignalError;

/// A one-sided power spectral density.
#[derive(Debug, Clone, PartialEq)]
pub struct Spectrum {
    /// Hz, from 0 to half the rate, equally spaced.
    pub frequency: Vec<f64>,
    /// Unit of the signal squared per Hz.
    pub density: Vec<f64>,
    /// Segments that were averaged.
    pub segments: usize,
}

impl Spectrum {
    /// Variance of the signal between two frequencies, Hz.
    pub fn power(&self, from: f64, to: f64) -> f64 {
        let step = self.frequency.get(1).copied().unwrap_or(0.0);
        let inside = self.frequency.iter().zip(&self.density).filter(|(f, _)| **f >= from && **f <= to);
        inside.map(|(_, d)| d * step).sum()
    }
}

/// Welch's estimate (Welch 1967): Hann window over segments of `segment` samples, half overlapping, each without its
/// mean. Agrees with scipy's `welch`.
///
/// A signal shorter than a segment is taken as one segment of its own length.
///
/// # Errors
/// A rate that is not positive, a signal of fewer than four samples.
pub fn welch(signal: &[f64], rate: f64, segment: usize) -> Result<Spectrum, SignalError> {
    if !(rate.is_finite() && rate > 0.0) {
        return Err(SignalError::Rate(rate));
    }
    let n = segment.min(signal.len());
    if n < 4 {
        let (samples, needed) = (signal.len(), 4);
        return Err(SignalError::TooShort {
            name: "signal".into(),
            samples,
            needed,
            purpose: "take its spectrum",
        });
    }
    let window: Vec<f64> =
        (0..n).map(|k| 0.5 - 0.5 * (2.0 * std::f64::consts::PI * k as f64 / n as f64).cos()).collect();
    let scale = 1.0 / (rate * window.iter().map(|w| w * w).sum::<f64>());
    let fft = RealFftPlanner::<f64>::new().plan_fft_forward(n);
    let (mut input, mut output) = (fft.make_input_vec(), fft.make_output_vec());
    let mut scratch = fft.make_scratch_vec();
    let mut density = vec![0.0; output.len()];
    let mut segments = 0;
    let mut start = 0;
    while start + n <= signal.len() {
        let part = &signal[start..start + n];
        let mean = part.iter().sum::<f64>() / n as f64;
        for ((x, y), w) in input.iter_mut().zip(part).zip(&window) {
            *x = (y - mean) * w;
        }
        // The buffers are the plan's own; their lengths fit.
        if fft.process_with_scratch(&mut input, &mut output, &mut scratch).is_ok() {
            density.iter_mut().zip(&output).for_each(|(d, c)| *d += c.norm_sqr());
            segments += 1;
        }
        start += n - n / 2;
    }
    for (k, d) in density.iter_mut().enumerate() {
        let both_sides = if k == 0 || (2 * k == n) { 1.0 } else { 2.0 };
        *d *= both_sides * scale / f64::from(segments.max(1));
    }
    let frequency = (0..density.len()).map(|k| k as f64 * rate / n as f64).collect();
    Ok(Spectrum { frequency, density, segments: segments as usize })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::signal::oracle::{oracle, worst};

    #[test]
    fn the_density_agrees_with_scipy() {
        for case in oracle().welch {
            let ours = welch(&case.input, case.rate, case.segment).expect("long enough");
            assert!(worst(&ours.density, &case.density) < 1e-9);
            assert!(worst(&ours.frequency, &case.frequency) < 1e-12);
        }
    }

    #[test]
    fn a_sine_has_its_power_at_its_frequency() {
        let x: Vec<f64> =
            (0..5000).map(|k| 3.0 * (2.0 * std::f64::consts::PI * 20.0 * k as f64 / 500.0).sin()).collect();
        let spectrum = welch(&x, 500.0, 500).expect("long enough");
        assert!((spectrum.power(17.0, 23.0) - 4.5).abs() < 1e-9);
        assert!(spectrum.power(30.0, 250.0) < 1e-9);
    }

    #[test]
    fn short_signals_are_told() {
        assert!(welch(&[1.0; 3], 100.0, 256).is_err());
        assert!(welch(&[1.0; 30], f64::NAN, 256).is_err());
        assert_eq!(welch(&[1.0; 30], 100.0, 256).expect("one segment").segments, 1);
    }
}
