//! Order spectrum: amplitude of a joint's residual over waves per angle, at the full rate.

use crate::diagnosis::outcome::OrderSpectrum;
use crate::diagnosis::rows::signals::Signals;
use crate::diagnosis::rules::{
    ASSUMED_GEAR, HIGHEST_ORDER, LEAST_PERIODS, LEAST_SAMPLES, MOST_ORDERS, ORDER_STEP, PART_OF_NYQUIST,
    PEAK_OVER_MEDIAN, SPECTRUM_RATE,
};
use crate::effects::Scale;
use std::f64::consts::PI;

/// Amplitudes at orders up to [`HIGHEST_ORDER`] per motor turn, on samples where the joint (0-based, of this `scale`)
/// moves faster than `slowest`. `residual[signal][t]` is of this joint.
pub(in crate::diagnosis) fn order_spectrum(
    joint: usize,
    signals: &[Signals],
    residual: &[Vec<f64>],
    scale: &Scale,
    slowest: f64,
) -> OrderSpectrum {
    let Orders { least, step, count } = orders(scale);
    // Sums over the samples of each order: with the cosine, with the sine, how many.
    let mut sums = vec![(0.0, 0.0, 0.0_f64); count];
    for (signal, r) in signals.iter().zip(residual) {
        let highest = signal.rate * PI * PART_OF_NYQUIST;
        let stride = (signal.rate / SPECTRUM_RATE).max(1.0) as usize;
        let end = signal.len().saturating_sub(signal.edge_samples);
        for t in (signal.edge_samples..end).step_by(stride) {
            let v = signal.dq[joint][t].abs();
            if v <= slowest {
                continue;
            }
            // The angle grows by the same from order to order, so that it is turned on instead of evaluated again.
            let (mut sine, mut cosine) = (least * signal.q[joint][t]).sin_cos();
            let (turn_sine, turn_cosine) = (step * signal.q[joint][t]).sin_cos();
            for (k, (c, s, n)) in sums.iter_mut().enumerate() {
                if v * (least + step * k as f64) >= highest {
                    break;
                }
                *c += r[t] * cosine;
                *s += r[t] * sine;
                *n += 1.0;
                (sine, cosine) =
                    (sine * turn_cosine + cosine * turn_sine, cosine * turn_cosine - sine * turn_sine);
            }
        }
    }
    OrderSpectrum {
        gear: scale.gear,
        order: (0..count).map(|k| least + step * k as f64).collect(),
        amplitude: sums
            .iter()
            .map(|&(c, s, n)| if n > LEAST_SAMPLES { 2.0 * f64::hypot(c, s) / n } else { 0.0 })
            .collect(),
        ..OrderSpectrum::default()
    }
}

/// The orders of a spectrum.
struct Orders {
    least: f64,
    step: f64,
    count: usize,
}

fn orders(scale: &Scale) -> Orders {
    let least = LEAST_PERIODS * 2.0 * PI / scale.range;
    let top = (HIGHEST_ORDER * scale.gear.max(ASSUMED_GEAR)).max(2.0 * least);
    // Finer than a part of one wave over the travel there is nothing to resolve.
    let step = (ORDER_STEP * 2.0 * PI / scale.range).max((top - least) / MOST_ORDERS as f64);
    Orders { least, step, count: (((top - least) / step) as usize).max(1) }
}

/// The orders that stand out: local maxima above some times the median amplitude, highest first, at most `most`.
pub(in crate::diagnosis) fn peaks(spectrum: &OrderSpectrum, most: usize) -> Vec<f64> {
    let a = &spectrum.amplitude;
    let mut sorted = a.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let mut found: Vec<usize> = (1..a.len().saturating_sub(1))
        .filter(|&k| a[k] > a[k - 1] && a[k] >= a[k + 1] && a[k] > PEAK_OVER_MEDIAN * median)
        .collect();
    found.sort_by(|&x, &y| a[y].total_cmp(&a[x]));
    found.truncate(most);
    found.into_iter().map(|k| spectrum.order[k]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A joint that swings, seen 500 times a second.
    fn swing(seconds: f64) -> Signals {
        let rate = 500.0;
        let samples = (rate * seconds) as usize;
        let at =
            |f: &dyn Fn(f64) -> f64| vec![(0..samples).map(|t| f(t as f64 / rate)).collect::<Vec<f64>>()];
        let mut signals = Signals::of_motion(&crate::signal::Motion {
            name: "swing".into(),
            rate,
            start: 0.0,
            q: at(&|t| (1.3 * t).sin()),
            dq: at(&|t| 1.3 * (1.3 * t).cos()),
            ddq: at(&|t| -1.69 * (1.3 * t).sin()),
            torque: vec![vec![0.0; samples]],
            fixed: vec![],
            edge_samples: 0,
        });
        signals.edge_samples = 10;
        signals
    }

    /// Of the swing.
    const SWING: Scale = Scale {
        speed: 1.3,
        range: 2.0,
        centre: 0.0,
        torque: 1.0,
        start: 0.0,
        duration: 40.0,
        gear: 50.0,
        fast: 0.0,
        inertia: 0.0,
        kind: crate::model::JointKind::Revolute,
    };

    #[test]
    fn a_ripple_is_a_peak_at_its_order_and_of_its_amplitude() {
        let signals = [swing(40.0)];
        for order in [50.0, 101.5] {
            let ripple = |q: &f64| 0.3 * (order * q + 0.7).cos();
            let residual = [signals[0].q[0].iter().map(ripple).collect::<Vec<f64>>()];
            let spectrum = order_spectrum(0, &signals, &residual, &SWING, 0.05);
            let found = peaks(&spectrum, 2);
            assert!((found[0] - order).abs() < 1.3, "{order}: {found:?}");
            let highest = spectrum.amplitude.iter().fold(0.0_f64, |a, &b| a.max(b));
            assert!((highest - 0.3).abs() < 0.06, "{order}: {highest}");
        }
    }

    #[test]
    fn a_residual_that_is_flat_has_no_peaks() {
        let signals = [swing(40.0)];
        let spectrum = order_spectrum(0, &signals, &[vec![0.0; signals[0].len()]], &SWING, 0.05);
        assert!(peaks(&spectrum, 2).is_empty());
    }
}
