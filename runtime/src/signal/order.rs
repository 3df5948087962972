//! Order spectrum: what of a signal is periodic in an angle.

use realfft::RealFftPlanner;
use realfft::num_complex::Complex;

use super::SignalError;

/// Amplitude of a signal over the order of an angle. Entry k belongs to the order k * `step`.
///
/// An order o is o cycles per turn of the angle: a signal a sin(o angle + phase) has a peak of height a at o, whatever
/// the speed and however often it changed.
#[derive(Debug, Clone, PartialEq)]
pub struct OrderSpectrum {
    /// Orders from one entry to the next.
    pub step: f64,
    /// Two orders nearer than this cannot be told apart: 2 pi / (range of the angle).
    pub resolution: f64,
    /// Amplitude of the least-squares sine at each order, unit of the signal.
    pub amplitude: Vec<f64>,
    /// Phase of that sine, rad: a sin(o angle + phase).
    pub phase: Vec<f64>,
    /// Share of the signal's variance that the sine explains.
    pub explained: Vec<f64>,
}

/// A local maximum of an order spectrum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OrderPeak {
    /// Cycles per turn of the angle.
    pub order: f64,
    /// Unit of the signal.
    pub amplitude: f64,
    /// rad; a sin(order angle + phase).
    pub phase: f64,
    /// Share of the signal's variance.
    pub explained: f64,
    /// How far `explained` stands out of the median within 20 resolutions around it.
    pub prominence: f64,
}

/// Bins per cycle at the highest order.
const BINS: f64 = 16.0;
/// Entries per resolution.
const OVERSAMPLING: f64 = 4.0;
/// Most bins of the transform.
const MOST_BINS: f64 = 1.7e7;

/// Least-squares spectrum of a signal over an angle (rad), for orders up to `highest` cycles per turn. Several
/// motions go in as several (angle, signal) pairs and add up coherently.
///
/// At every order a constant, a sine and a cosine of the angle are fitted (Zechmeister and Kuerster 2009); the sums
/// come from one fast transform of the signal spread over equal bins of the angle (Press and Rybicki 1989).
/// Resampling over the angle would need a speed that never changes its sign; this does not. Slow trends of the signal
/// leak into low orders: take them out before, and distrust orders below twice `resolution`.
///
/// Errors: no samples, unequal lengths, values that are not finite, an angle that does not move by at least one
/// cycle of the highest order, or so far that the transform grows beyond 16 million bins.
pub fn order_spectrum(motions: &[(&[f64], &[f64])], highest: f64) -> Result<OrderSpectrum, SignalError> {
    let too_short =
        |samples, needed, purpose| SignalError::TooShort { name: "signal".into(), samples, needed, purpose };
    let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
    let (mut count, mut sum) = (0usize, 0.0);
    for (angle, signal) in motions {
        if angle.len() != signal.len() {
            return Err(SignalError::Shape {
                name: "signal".into(),
                found: signal.len(),
                expected: angle.len(),
            });
        }
        if !angle.iter().chain(*signal).all(|x| x.is_finite()) {
            return Err(SignalError::NotFinite { name: "signal".into() });
        }
        count += angle.len();
        sum += signal.iter().sum::<f64>();
        for a in *angle {
            low = low.min(*a);
            high = high.max(*a);
        }
    }
    if count < 16 {
        return Err(too_short(count, 16, "take its order spectrum"));
    }
    let range = high - low;
    let turn = 2.0 * std::f64::consts::PI;
    if !(highest.is_finite() && highest * range >= turn) {
        return Err(too_short(
            count,
            count,
            "take an order spectrum: the angle moves by less than one cycle",
        ));
    }
    let width = turn / (highest * BINS);
    let bins = (range / width * OVERSAMPLING).ceil() + 8.0;
    if bins > MOST_BINS {
        return Err(SignalError::TooLong { name: "order spectrum".into(), samples: bins });
    }
    let bins = (bins as usize).next_power_of_two();
    let mean = sum / count as f64;
    let (mut values, mut density) = (vec![0.0; bins], vec![0.0; bins]);
    let mut total = 0.0;
    for (angle, signal) in motions {
        for (a, y) in angle.iter().zip(*signal) {
            let y = y - mean;
            total += y * y;
            spread(&mut values, &mut density, (a - low) / width, y);
        }
    }
    let (values, density) = (transform(&mut values), transform(&mut density));
    let step = turn / (bins as f64 * width);
    let entries = ((highest / step) as usize + 1).min(values.len().min(density.len() / 2));
    let n = count as f64;
    let mut out = OrderSpectrum {
        step,
        resolution: turn / range,
        amplitude: vec![0.0; entries],
        phase: vec![0.0; entries],
        explained: vec![0.0; entries],
    };
    for k in 1..entries {
        // exp(-i o (angle - low)): the transform has minus the sine.
        let (yc, ys) = (values[k].re, -values[k].im);
        let (c, s) = (density[k].re, -density[k].im);
        let (c2, s2) = (density[2 * k].re, -density[2 * k].im);
        let cc = 0.5 * (n + c2) - c * c / n;
        let ss = 0.5 * (n - c2) - s * s / n;
        let cs = 0.5 * s2 - c * s / n;
        let determinant = cc * ss - cs * cs;
        // Less than a part of a cycle is seen: sine, cosine and constant are not independent.
        if determinant <= 1e-3 * n * n {
            continue;
        }
        let a = (yc * ss - ys * cs) / determinant;
        let b = (ys * cc - yc * cs) / determinant;
        let order = k as f64 * step;
        out.amplitude[k] = a.hypot(b);
        out.phase[k] = (a.atan2(b) - order * low).rem_euclid(turn);
        if total > 0.0 {
            out.explained[k] = ((a * yc + b * ys) / total).clamp(0.0, 1.0);
        }
    }
    Ok(out)
}

impl OrderSpectrum {
    /// Order of entry `k`, cycles per turn.
    pub fn order(&self, k: usize) -> f64 {
        k as f64 * self.step
    }

    /// The `count` most prominent peaks at or above `lowest` cycles per turn, most prominent first, no two nearer than
    /// 1.5 resolutions.
    pub fn peaks(&self, lowest: f64, count: usize) -> Vec<OrderPeak> {
        let e = &self.explained;
        let cell = (self.resolution / self.step).ceil() as usize;
        let start = ((lowest / self.step).ceil().max(1.0)) as usize;
        let mut peaks: Vec<OrderPeak> = Vec::new();
        let mut nearby = Vec::new();
        for k in start..e.len().saturating_sub(1) {
            if !(e[k] > 0.0 && e[k] >= e[k - 1] && e[k] > e[k + 1]) {
                continue;
            }
            nearby.clear();
            nearby
                .extend_from_slice(&e[k.saturating_sub(20 * cell).max(1)..(k + 20 * cell + 1).min(e.len())]);
            let middle = nearby.len() / 2;
            let median = *nearby.select_nth_unstable_by(middle, f64::total_cmp).1;
            // Vertex of the parabola through three entries.
            let bend = e[k - 1] - 2.0 * e[k] + e[k + 1];
            let shift = if bend < 0.0 { 0.5 * (e[k - 1] - e[k + 1]) / bend } else { 0.0 };
            peaks.push(OrderPeak {
                order: (k as f64 + shift) * self.step,
                amplitude: self.amplitude[k],
                phase: self.phase[k],
                explained: e[k],
                prominence: if median > 0.0 { e[k] / median } else { f64::MAX },
            });
        }
        peaks.sort_by(|a, b| b.prominence.total_cmp(&a.prominence).then(b.explained.total_cmp(&a.explained)));
        let mut out: Vec<OrderPeak> = Vec::new();
        for peak in peaks {
            if out.len() == count {
                break;
            }
            if out.iter().all(|p| (p.order - peak.order).abs() > 1.5 * self.resolution) {
                out.push(peak);
            }
        }
        out
    }
}

/// Spreads a value over the four bins around `at` with the weights of cubic interpolation.
fn spread(values: &mut [f64], density: &mut [f64], at: f64, y: f64) {
    let bins = values.len();
    let base = at.floor();
    let u = at - base;
    let weights = [
        -u * (u - 1.0) * (u - 2.0) / 6.0,
        (u + 1.0) * (u - 1.0) * (u - 2.0) / 2.0,
        -(u + 1.0) * u * (u - 2.0) / 2.0,
        (u + 1.0) * u * (u - 1.0) / 6.0,
    ];
    // Bin -1 of the first sample wraps to the last bin, which the transform takes as the same.
    let first = base as usize + bins - 1;
    for (k, w) in weights.into_iter().enumerate() {
        let bin = (first + k) % bins;
        values[bin] += w * y;
        density[bin] += w;
    }
}

fn transform(bins: &mut [f64]) -> Vec<Complex<f64>> {
    let fft = RealFftPlanner::<f64>::new().plan_fft_forward(bins.len());
    let mut out = fft.make_output_vec();
    // The lengths are the plan's own, so that it cannot fail; zeros if it did.
    if fft.process(bins, &mut out).is_err() {
        out.fill(Complex::new(0.0, 0.0));
    }
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    fn back_and_forth(n: usize) -> Vec<f64> {
        (0..n).map(|k| 1.3 * (k as f64 * 0.004).sin() + 0.4 * (k as f64 * 0.011).cos() + 0.7).collect()
    }

    #[test]
    fn a_ripple_is_found_at_its_order_amplitude_and_phase_though_the_speed_changes_its_sign() {
        let angle = back_and_forth(8000);
        let signal: Vec<f64> =
            angle.iter().map(|a| 0.5 + 0.02 * (48.0 * a + 1.1).sin() + 1e-3 * (a * 977.0).cos()).collect();
        let spectrum = order_spectrum(&[(&angle, &signal)], 200.0).expect("a valid spectrum");
        let peak = spectrum.peaks(2.0 * spectrum.resolution, 1)[0];
        assert!((peak.order - 48.0).abs() < 0.1 * spectrum.resolution, "{peak:?}");
        assert!((peak.amplitude - 0.02).abs() < 1e-3, "{peak:?}");
        let phase = peak.phase - (48.0 - peak.order) * 0.7;
        assert!((phase - 1.1).abs() < 0.2, "{peak:?}");
        assert!(peak.explained > 0.9 && peak.prominence > 100.0);
    }

    #[test]
    fn entries_are_the_least_squares_fit_done_directly() {
        let angle = back_and_forth(900);
        let signal: Vec<f64> =
            angle.iter().enumerate().map(|(k, a)| (9.0 * a).sin() + ((k * k) % 17) as f64 * 0.1).collect();
        let spectrum = order_spectrum(&[(&angle, &signal)], 40.0).expect("a valid spectrum");
        for k in [9, 30, 62] {
            let o = spectrum.order(k);
            let design = nalgebra::DMatrix::from_fn(900, 3, |r, c| match c {
                0 => 1.0,
                1 => (o * angle[r]).cos(),
                _ => (o * angle[r]).sin(),
            });
            let y = nalgebra::DVector::from_row_slice(&signal);
            let x = design.svd(true, true).solve(&y, 1e-12).expect("full rank");
            let amplitude = x[1].hypot(x[2]);
            assert!(
                (spectrum.amplitude[k] / amplitude - 1.0).abs() < 2e-3,
                "{o}: {} {amplitude}",
                spectrum.amplitude[k]
            );
        }
    }

    #[test]
    fn two_motions_add_up_coherently() {
        let all = back_and_forth(8000);
        let signal: Vec<f64> = all.iter().map(|a| (30.0 * a).sin()).collect();
        let whole = order_spectrum(&[(&all, &signal)], 100.0).expect("a valid spectrum");
        let parts =
            order_spectrum(&[(&all[..3000], &signal[..3000]), (&all[3000..], &signal[3000..])], 100.0)
                .expect("a valid spectrum");
        for (a, b) in whole.amplitude.iter().zip(&parts.amplitude) {
            assert!((a - b).abs() < 1e-9);
        }
    }

    #[test]
    fn an_angle_that_does_not_move_is_told() {
        assert!(order_spectrum(&[(&[1.0; 50], &[2.0; 50])], 100.0).is_err());
        assert!(order_spectrum(&[], 100.0).is_err());
        assert!(order_spectrum(&[(&[1.0; 50], &[2.0; 49])], 100.0).is_err());
        let angle = back_and_forth(100);
        assert!(order_spectrum(&[(&angle, &angle)], 1e12).is_err());
        assert!(order_spectrum(&[(&angle, &angle)], f64::NAN).is_err());
    }
}
