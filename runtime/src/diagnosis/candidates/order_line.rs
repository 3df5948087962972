//! Torque ripple by its line: a wave over the joint's angle that stands out of the orders around it, and that one half
//! of a motion predicts for the other.
//!
//! A line has few per cent of a residual's variance and all of it in one order, so that a share of the variance
//! dilutes it. How far it stands out is not enough either: the foot of a strong line, or of what is left of friction,
//! reaches far. Both are asked for, motion by motion, at the full rate, of the residual without what is slower than a few
//! waves.
//!
//! A motor's torque shows a ripple only as far as its controller answers to it: what is faster than the loop is left in the
//! speed. How fast that is nobody knows beforehand, so that a wave is also sought where the joint is slow. Where the positions
//! hold it, what is left in the speed is part of the torque of the model: there it has its whole amplitude.

use super::wave::{Orders, Sample, Wave, turned, wave};
use crate::diagnosis::rules::{
    LINE_ABOVE, LINE_AROUND, LINE_BANDS, LINE_COVERED, LINE_FOLLOWED, LINE_LEAST_FRACTION,
    LINE_LEAST_SAMPLES, LINE_LEAST_WAVES, LINE_PICKED_ABOVE, LINE_SLOWER, LINE_TOLD,
};
use crate::statistics::greatest_of::highest_p_value;
use crate::statistics::median::median;
use std::f64::consts::TAU;

/// A joint in one motion, at the full rate.
pub(in crate::diagnosis) struct Stroke<'a> {
    pub q: &'a [f64],
    pub dq: &'a [f64],
    /// Measured torque less that of the model.
    pub residual: &'a [f64],
    /// Highest frequency that the residual holds, Hz.
    pub band: f64,
    /// Highest frequency that the positions hold, from which the torque of the model is, Hz.
    pub cutoff: f64,
}

/// A line in the order spectrum of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(in crate::diagnosis) struct Line {
    /// Angle of the wave per angle of the joint.
    pub order: f64,
    /// Amplitudes of cosine and sine, N.m or N, all motions together, and their standard deviation from the orders
    /// around it; of a wave that is slow for long enough with what a controller leaves of it in the acceleration. Any other is told
    /// as the torque shows it, which may be a part of it: its deviation is what is not known of the rest, as large as itself where
    /// the wave is slow nowhere.
    pub cosine: f64,
    pub sine: f64,
    pub sigma: f64,
    /// Amplitude of the wave in standard deviations of those around it, where it stands out farthest.
    pub above: f64,
    /// Rms of the residual without what is slower, N.m or N, the median of the motions.
    pub rms: f64,
    /// Probability that noise stands as far above the orders on both sides of it anywhere near the order that was asked for, in
    /// any of the bands, all motions together.
    pub p_value: f64,
    /// Whether motors have lines at its order, so that it was looked for there.
    pub known: bool,
    /// Share of the residual that one half of a motion predicts for the other, the median of the motions.
    pub share: f64,
}

#[cfg(test)]
impl Line {
    /// Of the wave, N.m or N.
    pub fn amplitude(&self) -> f64 {
        self.cosine.hypot(self.sine)
    }
}

/// The lines of a joint among `known` orders and those that were `picked` from a spectrum, strongest first.
///
/// `slowest` is the speed below which the joint stands. A line must show in more than half of the motions that could
/// show it, and in all of them together.
pub(in crate::diagnosis) fn lines(
    strokes: &[Stroke<'_>],
    known: &[f64],
    picked: &[f64],
    slowest: f64,
) -> Vec<Line> {
    let known = known.iter().map(|&o| (o, LINE_ABOVE, true));
    let picked = picked.iter().map(|&o| (o, LINE_PICKED_ABOVE, false));
    let resolved = resolution(strokes);
    let best = |(order, above, known): (f64, f64, bool)| {
        let in_band = |part: f64| line(strokes, (order, above, known), (part, slowest), resolved);
        let found = LINE_BANDS.into_iter().filter_map(in_band);
        let best = found.min_by(|a, b| a.p_value.total_cmp(&b.p_value))?;
        Some(Line { p_value: LINE_BANDS.len() as f64 * best.p_value, ..best })
    };
    let mut found: Vec<Line> = known.chain(picked).filter_map(best).collect();
    found.sort_by(|a, b| b.share.total_cmp(&a.share));
    // The same line may have been asked for twice: what the travel cannot resolve is one.
    let mut apart: Vec<Line> = Vec::new();
    for line in found {
        if apart.iter().all(|a| (a.order - line.order).abs() > LINE_COVERED as f64 * resolved) {
            apart.push(line);
        }
    }
    apart
}

/// The line at an order where the wave is slower than this part of what the residual holds.
fn line(
    strokes: &[Stroke<'_>],
    (order, above, known): (f64, f64, bool),
    (part, slowest): (f64, f64),
    resolved: f64,
) -> Option<Line> {
    let slower = |s: &Stroke<'_>| 0.9 * part * s.band;
    let sampled: Vec<Vec<Sample>> = strokes.iter().map(|s| samples(s, order, [slowest, slower(s)])).collect();
    let looked: Vec<Look> = strokes.iter().zip(&sampled).map(|(s, all)| look(s, all, order)).collect();
    let able = looked.iter().filter(|l| !matches!(l, Look::Blind)).count();
    let shown: Vec<&InMotion> = looked.iter().filter_map(|l| l.line(above)).collect();
    if shown.is_empty() || 2 * shown.len() <= able {
        return None;
    }
    let usual = |value: fn(&InMotion) -> f64| {
        let mut values: Vec<f64> = shown.iter().map(|l| value(l)).collect();
        median(&mut values)
    };
    let all: Vec<Sample> = sampled.into_iter().flatten().collect();
    let (order, together) = highest(&all, usual(|l| l.order), resolved)?;
    // A wave over the joint's angle has one phase in all motions: together they show it no worse than one by one.
    let around = Around::of(&all, order, resolved);
    if together.norm() < above * around.level {
        return None;
    }
    let followed = |s: &Stroke<'_>| slower(s).min(LINE_FOLLOWED * s.cutoff);
    let whole: Vec<Sample> = strokes.iter().flat_map(|s| samples(s, order, [slowest, followed(s)])).collect();
    let (wave, sigma) = if turns(&whole, order) < LINE_LEAST_WAVES {
        (together, together.norm())
    } else {
        let slow = wave(&whole, &turned(&whole, order));
        let sigma = deviation(Around::of(&whole, order, resolved).level);
        let apart = (slow.c - together.c).hypot(slow.s - together.s);
        if sigma <= LINE_TOLD * together.norm() { (slow, sigma) } else { (together, sigma.max(apart)) }
    };
    Some(Line {
        order,
        cosine: wave.c,
        sine: wave.s,
        sigma,
        above: together.norm() / deviation(around.level),
        rms: usual(|l| l.rms),
        p_value: highest_p_value(together.norm() / around.level, around.orders, resolved * spread(&all)),
        known,
        share: usual(|l| l.share),
    })
}

/// Step between orders that the longest travel tells apart.
pub(in crate::diagnosis) fn resolution(strokes: &[Stroke<'_>]) -> f64 {
    TAU / strokes.iter().map(|s| travel(s.q)).fold(1e-9, f64::max)
}

fn travel(q: &[f64]) -> f64 {
    let (low, high) = q.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), &x| (a.min(x), b.max(x)));
    (high - low).max(0.0)
}

/// What one motion says of an order.
enum Look {
    /// It cannot show a line.
    Blind,
    /// One half of it does not predict the other.
    Nothing,
    /// It predicts enough of it: a line, if it stands out far enough.
    Wave(InMotion),
}

/// A wave in one motion, in the terms of a [`Line`].
struct InMotion {
    order: f64,
    rms: f64,
    /// Its amplitude against the larger median of the orders on both sides of it.
    above: f64,
    share: f64,
}

impl Look {
    /// The line, where it stands out this far.
    fn line(&self, above: f64) -> Option<&InMotion> {
        match self {
            Look::Wave(line) if line.above >= above => Some(line),
            _ => None,
        }
    }
}

/// Looks for one order in the samples of one motion.
fn look(stroke: &Stroke<'_>, samples: &[Sample], order: f64) -> Look {
    let half = samples.len() / 2;
    let (first, second) = samples.split_at(half);
    let few = |part: &[Sample]| turns(part, order) < LINE_LEAST_WAVES;
    if half < LINE_LEAST_SAMPLES || few(first) || few(second) {
        return Look::Blind;
    }
    let step = TAU / travel(stroke.q).max(1e-9);
    let Some((order, fitted)) = highest(samples, order, step) else { return Look::Blind };
    let turned = turned(samples, order);
    let (first, second) = ((first, &turned[..half]), (second, &turned[half..]));
    let predicted = |fit: (&[Sample], &[(f64, f64)]), test: (&[Sample], &[(f64, f64)])| {
        let w = wave(fit.0, fit.1);
        let (mut left, mut whole) = (0.0, 0.0);
        for (s, &turned) in test.0.iter().zip(test.1) {
            left += (s.r - w.at(turned)).powi(2);
            whole += s.r * s.r;
        }
        (left, whole)
    };
    let (a, b) = (predicted(first, second), predicted(second, first));
    let share = 1.0 - (a.0 + b.0) / (a.1 + b.1).max(1e-300);
    if share < LINE_LEAST_FRACTION {
        return Look::Nothing;
    }
    Look::Wave(InMotion {
        order,
        rms: (samples.iter().map(|s| s.r * s.r).sum::<f64>() / samples.len() as f64).sqrt(),
        above: fitted.norm() / Around::of(samples, order, step).level,
        share,
    })
}

/// Waves that samples pass.
fn turns(samples: &[Sample], order: f64) -> f64 {
    let steps = samples.windows(2).map(|w| (w[1].q - w[0].q).abs());
    steps.filter(|d| d * order < 3.0).sum::<f64>() * order / TAU
}

/// Where exactly a line near an order is, as far as the travel tells.
fn highest(samples: &[Sample], order: f64, step: f64) -> Option<(f64, Wave)> {
    let near = Orders { first: order - 0.5 * step, step: 0.125 * step, count: 9 };
    near.all().zip(near.waves(samples)).max_by(|a, b| a.1.norm().total_cmp(&b.1.norm()))
}

/// Standard deviation of the angles at which there is noise: how fast a wave of noise changes with its order.
fn spread(samples: &[Sample]) -> f64 {
    let mean = |of: &dyn Fn(&Sample) -> f64| {
        let sums =
            samples.iter().fold((0.0, 0.0), |(sum, all), s| (sum + s.r * s.r * of(s), all + s.r * s.r));
        sums.0 / sums.1.max(f64::MIN_POSITIVE)
    };
    let centre = mean(&|s| s.q);
    mean(&|s| (s.q - centre).powi(2)).sqrt()
}

/// Standard deviation of the parts of waves of noise whose amplitudes have this median: it is sqrt(2 ln 2) of it.
fn deviation(median: f64) -> f64 {
    median / (2.0 * std::f64::consts::LN_2).sqrt()
}

/// The orders on both sides of one, as many steps away as its own foot does not reach.
struct Around {
    /// The larger one of the medians of their amplitudes: what the model lacks and noise that lasts fall with the order, and an
    /// edge is no line.
    level: f64,
    /// How many they are on each side.
    orders: [usize; 2],
}

impl Around {
    fn of(samples: &[Sample], order: f64, step: f64) -> Self {
        let far = LINE_COVERED as f64 * step;
        let below = Orders { first: order - far, step: -step, count: LINE_AROUND };
        let above = Orders { first: order + far, step, count: LINE_AROUND };
        let sides = [below, above].map(|side| {
            let waves = side.all().zip(side.waves(samples));
            let mut norms: Vec<f64> = waves.filter(|(o, _)| *o > step).map(|(_, w)| w.norm()).collect();
            (median(&mut norms), norms.len())
        });
        let [(below, _), (above, _)] = sides;
        Self { level: below.max(above).max(1e-300), orders: sides.map(|(_, orders)| orders) }
    }
}

/// Samples at which the joint moves faster than `slowest` and the wave is slower than a frequency.
fn samples(stroke: &Stroke<'_>, order: f64, [slowest, frequency]: [f64; 2]) -> Vec<Sample> {
    let fastest = frequency * TAU / order;
    let usable = |t: usize| stroke.dq[t].abs() > slowest && stroke.dq[t].abs() < fastest;
    let reach = 0.5 * LINE_SLOWER * TAU / order;
    let mut out = Vec::new();
    let mut t = 0;
    while t < stroke.q.len() {
        if !usable(t) {
            t += 1;
            continue;
        }
        // A run in one direction.
        let sign = stroke.dq[t].signum();
        let end = (t..stroke.q.len())
            .find(|&k| !usable(k) || stroke.dq[k].signum() != sign)
            .unwrap_or(stroke.q.len());
        let (q, r) = (&stroke.q[t..end], &stroke.residual[t..end]);
        let mut sums = vec![0.0];
        for x in r {
            sums.push(sums[sums.len() - 1] + x);
        }
        let (mut a, mut b) = (0, 0);
        for k in 0..q.len() {
            while (q[k] - q[a]).abs() > reach {
                a += 1;
            }
            while b < q.len() && (q[b] - q[k]).abs() <= reach {
                b += 1;
            }
            // As far to both sides, and at least two waves, or the mean holds the wave itself.
            let side = (k - a).min(b - 1 - k);
            let (low, high) = (k - side, k + side + 1);
            if (q[high - 1] - q[low]).abs() * order / TAU > 0.5 * LINE_SLOWER {
                out.push(Sample { q: q[k], r: r[k] - (sums[high] - sums[low]) / (high - low) as f64 });
            }
        }
        t = end;
    }
    out
}

#[cfg(test)]
#[path = "order_line_tests.rs"]
mod tests;
