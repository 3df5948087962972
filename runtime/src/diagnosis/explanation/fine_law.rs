//! A law drawn finely: at every sample of the motions, not at the means that its residual is drawn by.

use crate::diagnosis::outcome::FineLaw;
use crate::diagnosis::rules::FINE_BINS;
use crate::diagnosis::search::extended_model::ExtendedModel;
use crate::diagnosis::search::term::Accepted;

/// Means of the law of a term with these amplitudes on a joint, over bins of equal width of the variable that `at` tells
/// of a sample (signal, sample); `along` is the factor of its torque there. Bins without a sample are left out.
pub(super) fn fine_law(
    model: &ExtendedModel<'_>,
    (term, amplitude): (&Accepted, &[f64]),
    joint: usize,
    at: impl Fn(usize, usize) -> f64,
    along: impl Fn(usize, usize) -> f64,
) -> FineLaw {
    let context = &model.context;
    let mut samples: Vec<(f64, f64)> = Vec::new();
    for (k, signal) in context.signals.iter().enumerate().filter(|(_, signal)| signal.is_target) {
        let columns = context.series(k, term.effect, term.place, &term.shape);
        let of_joint = |t: usize| -> f64 {
            let torque = |(column, a): (&Vec<(usize, Vec<f64>)>, &f64)| -> f64 {
                column.iter().filter(|(j, _)| *j == joint).map(|(_, values)| a * values[t]).sum()
            };
            columns.iter().zip(amplitude).map(torque).sum()
        };
        let inner = signal.edge_samples..signal.len().saturating_sub(signal.edge_samples);
        samples.extend(inner.map(|t| (at(k, t), along(k, t) * of_joint(t))));
    }
    let (low, high) =
        samples.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), s| (a.min(s.0), b.max(s.0)));
    if low >= high {
        return FineLaw::default();
    }
    let mut bins = vec![[0.0; 3]; FINE_BINS];
    for (x, torque) in samples {
        let bin = ((x - low) / (high - low) * FINE_BINS as f64) as usize;
        let [sum_x, sum, count] = &mut bins[bin.min(FINE_BINS - 1)];
        *sum_x += x;
        *sum += torque;
        *count += 1.0;
    }
    let (x, torque) = bins.iter().filter(|[.., n]| *n > 0.0).map(|[x, sum, n]| (x / n, sum / n)).unzip();
    FineLaw { x, torque }
}
