//! Time between two channels that should be simultaneous.

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

use super::SignalError;

/// How much one signal lags behind another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lag {
    /// Samples by which the second signal comes after the first, to a fraction of a sample.
    pub samples: f64,
    /// Correlation of the two at that lag, -1 to 1.
    pub correlation: f64,
}

/// Lag of `late` behind `early` by their cross-correlation, within `most` samples to either side.
///
/// Means are taken out and the ends are faded over a tenth of the length, so that they do not pin the lag to 0. The
/// largest value over whole samples is refined by Newton's steps on the cross-spectrum, that is with exact
/// interpolation of band-limited signals (Knapp and Carter 1976 discuss the estimator). A constant signal has
/// correlation 0 at lag 0.
pub fn lag_between(early: &[f64], late: &[f64], most: usize) -> Result<Lag, SignalError> {
    let n = early.len();
    if late.len() != n {
        return Err(SignalError::Shape { name: "signal".into(), found: late.len(), expected: n });
    }
    let needed = 2 * most + 8;
    if n < needed {
        return Err(SignalError::TooShort {
            name: "signal".into(),
            samples: n,
            needed,
            purpose: "find its lag",
        });
    }
    if !early.iter().chain(late).all(|x| x.is_finite()) {
        return Err(SignalError::NotFinite { name: "signal".into() });
    }
    let length = (2 * n).next_power_of_two();
    let mut planner = RealFftPlanner::<f64>::new();
    let (forward, inverse) = (planner.plan_fft_forward(length), planner.plan_fft_inverse(length));
    let spectrum = |signal: &[f64]| {
        let mut input = faded(signal, length);
        let energy: f64 = input.iter().map(|x| x * x).sum();
        let mut output = forward.make_output_vec();
        let done = forward.process(&mut input, &mut output).is_ok();
        (output, if done { energy } else { 0.0 })
    };
    let ((a, energy_a), (b, energy_b)) = (spectrum(early), spectrum(late));
    let scale = (energy_a * energy_b).sqrt();
    if scale <= f64::MIN_POSITIVE {
        return Ok(Lag { samples: 0.0, correlation: 0.0 });
    }
    let cross: Vec<Complex<f64>> = a.iter().zip(&b).map(|(a, b)| a.conj() * b).collect();
    let mut correlation = inverse.make_output_vec();
    let mut work = cross.clone();
    // The inverse transform wants real ends; those of a product of real spectra are, up to rounding.
    work[0].im = 0.0;
    work[length / 2].im = 0.0;
    if inverse.process(&mut work, &mut correlation).is_err() {
        return Ok(Lag { samples: 0.0, correlation: 0.0 });
    }
    let reach = most as isize;
    let at = |lag: isize| correlation[lag.rem_euclid(length as isize) as usize];
    let best = (-reach..=reach).max_by(|x, y| at(*x).total_cmp(&at(*y))).unwrap_or(0);
    let lag = refine(&cross, length, best as f64);
    let peak = derivatives(&cross, length, lag)[0];
    Ok(Lag { samples: lag, correlation: (peak / scale).clamp(-1.0, 1.0) })
}

/// Newton's steps on the correlation, held within a sample of the start.
fn refine(cross: &[Complex<f64>], length: usize, start: f64) -> f64 {
    let mut lag = start;
    for _ in 0..20 {
        let [_, slope, bend] = derivatives(cross, length, lag);
        if bend >= 0.0 {
            break;
        }
        let next = (lag - slope / bend).clamp(start - 1.0, start + 1.0);
        let step = (next - lag).abs();
        lag = next;
        if step < 1e-9 {
            break;
        }
    }
    lag
}

/// Correlation at a lag, and its first and second derivative.
fn derivatives(cross: &[Complex<f64>], length: usize, lag: f64) -> [f64; 3] {
    let mut out = [0.0; 3];
    for (k, c) in cross.iter().enumerate() {
        let weight = if k == 0 || 2 * k == length { 1.0 } else { 2.0 } / length as f64;
        let w = 2.0 * std::f64::consts::PI * k as f64 / length as f64;
        let turned = c * Complex::from_polar(weight, w * lag);
        out[0] += turned.re;
        out[1] -= w * turned.im;
        out[2] -= w * w * turned.re;
    }
    out
}

/// The signal without its mean, faded in and out, followed by zeros.
fn faded(signal: &[f64], length: usize) -> Vec<f64> {
    let n = signal.len();
    let mean = signal.iter().sum::<f64>() / n as f64;
    let fade = n as f64 / 10.0;
    let mut out = vec![0.0; length];
    for (k, (out, x)) in out.iter_mut().zip(signal).enumerate() {
        let edge = k.min(n - 1 - k) as f64 / fade;
        let weight = if edge < 1.0 { 0.5 - 0.5 * (std::f64::consts::PI * edge).cos() } else { 1.0 };
        *out = weight * (x - mean);
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn signal(t: f64) -> f64 {
        (0.031 * t).sin() + 0.6 * (0.113 * t + 0.3).cos() + 0.2 * (0.37 * t).sin()
    }

    #[test]
    fn a_lag_of_a_fraction_of_a_sample_is_found() {
        for lag in [-7.3, -0.4, 0.0, 0.25, 3.0, 12.6] {
            let early: Vec<f64> = (0..3000).map(|k| signal(k as f64)).collect();
            let late: Vec<f64> = (0..3000).map(|k| 2.0 * signal(k as f64 - lag) + 5.0).collect();
            let found = lag_between(&early, &late, 20).expect("long enough");
            assert!((found.samples - lag).abs() < 0.02, "{lag}: {found:?}");
            assert!(found.correlation > 0.99);
        }
    }

    #[test]
    fn constants_have_no_lag() {
        let found = lag_between(&[2.0; 100], &[3.0; 100], 10).expect("long enough");
        assert_eq!((found.samples, found.correlation), (0.0, 0.0));
    }

    #[test]
    fn misuse_is_told() {
        assert!(lag_between(&[1.0; 10], &[1.0; 9], 1).is_err());
        assert!(lag_between(&[1.0; 10], &[1.0; 10], 5).is_err());
        assert!(lag_between(&[f64::NAN; 100], &[1.0; 100], 5).is_err());
    }
}
