//! Order spectrum: amplitude of a joint's residual over waves per angle, at the full rate.

use crate::diagnosis::outcome::OrderSpectrum;
use crate::diagnosis::rows::signals::Signals;

/// Highest order per motor turn that is looked at.
const HIGHEST: f64 = 7.0;
/// Most orders of a spectrum.
const MOST: usize = 600;

/// Amplitudes at orders up to [`HIGHEST`] per motor turn, on samples where the joint moves faster than `slowest`.
/// `residual[signal][t]` is of this joint.
pub(in crate::diagnosis) fn order_spectrum(
    joint: usize,
    number: usize,
    signals: &[Signals],
    residual: &[Vec<f64>],
    gear: f64,
    range: f64,
    slowest: f64,
) -> OrderSpectrum {
    let tau = 2.0 * std::f64::consts::PI;
    // Four periods must fit into the travel; finer than one wave over the travel there is nothing to resolve.
    let least = 4.0 * tau / range;
    // A joint that is known without its gear is searched up to an order that robots' gears do not pass.
    let top = (HIGHEST * gear.max(100.0)).max(2.0 * least);
    let mut step = 0.4 * tau / range;
    step = step.max((top - least) / MOST as f64);
    let count = (((top - least) / step) as usize).max(1);
    let mut spectrum = OrderSpectrum { joint: number, gear, ..OrderSpectrum::default() };
    for k in 0..count {
        let order = least + step * k as f64;
        let (mut c, mut s, mut n) = (0.0, 0.0, 0.0);
        for (signal, r) in signals.iter().zip(residual) {
            let highest = signal.rate * std::f64::consts::PI * 0.6;
            let stride = (signal.rate / 1000.0).max(1.0) as usize;
            let end = signal.len().saturating_sub(signal.edge_samples);
            for t in (signal.edge_samples..end).step_by(stride) {
                let v = signal.dq[joint][t].abs();
                if v > slowest && v * order < highest {
                    let (sine, cosine) = (order * signal.q[joint][t]).sin_cos();
                    c += r[t] * cosine;
                    s += r[t] * sine;
                    n += 1.0;
                }
            }
        }
        spectrum.order.push(order);
        spectrum.amplitude.push(if n > 100.0 { 2.0 * c.hypot(s) / n } else { 0.0 });
    }
    spectrum
}

/// The orders that stand out: local maxima above four times the median amplitude, highest first, at most `most`.
pub(in crate::diagnosis) fn peaks(spectrum: &OrderSpectrum, most: usize) -> Vec<f64> {
    let a = &spectrum.amplitude;
    let mut sorted = a.clone();
    sorted.sort_by(f64::total_cmp);
    let median = sorted.get(sorted.len() / 2).copied().unwrap_or(0.0);
    let mut found: Vec<usize> = (1..a.len().saturating_sub(1))
        .filter(|&k| a[k] > a[k - 1] && a[k] >= a[k + 1] && a[k] > 4.0 * median)
        .collect();
    found.sort_by(|&x, &y| a[y].total_cmp(&a[x]));
    found.truncate(most);
    found.into_iter().map(|k| spectrum.order[k]).collect()
}
