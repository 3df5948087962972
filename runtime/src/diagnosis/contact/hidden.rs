//! Pushes that hide themselves: they are most of what the memory of a residual is fitted to.
//!
//! An autoregression that is fitted with a long push among its rows takes it for noise that is slow, and the fit of a model
//! spreads a large one over all rows: neither stands out of its residual. Here the memory is fitted anew beside the
//! half wave of each window, and the window with which the residual is likeliest, as a normal autoregression, is one to try (as
//! for outliers that mask themselves: Chen and Liu 1993, Joint estimation of model parameters and outlier effects in time
//! series).

use crate::diagnosis::contact::half_waves::Refined;
use crate::diagnosis::contact::memory::raise_order;
use crate::diagnosis::contact::white::White;
use crate::diagnosis::rules::SCAN_STEPS;
use std::ops::Range;

/// The window of a joint with which its residual is likeliest, and its motion, of windows of these lengths in the recording that is
/// diagnosed, those that are free, `(motion, places)`; its square is twice the gain of the logarithm of the likelihood. `step` is
/// the time from one place to the next, s. `None` where none makes the residual likelier, or what does lasts too short or too long.
pub(super) fn likeliest(
    white: &White,
    lengths: &[usize],
    step: f64,
    is_free: impl Fn((usize, [usize; 2])) -> bool,
) -> Option<(usize, Refined)> {
    let remembering = Remembering::of(white)?;
    let mut wave = Vec::new();
    let mut best: Option<(f64, usize, Range<usize>)> = None;
    for motion in white.motions.iter().filter(|m| m.is_target) {
        for &length in lengths {
            let last = (motion.length() + 1).saturating_sub(length);
            let from = (0..last).step_by((length / SCAN_STEPS).max(1));
            for from in from.filter(|from| is_free((motion.motion, [*from, from + length]))) {
                let gain = remembering.gain(motion.motion, from..from + length, &mut wave).unwrap_or(0.0);
                if gain > best.as_ref().map_or(0.0, |best| best.0) {
                    best = Some((gain, motion.motion, from..from + length));
                }
            }
        }
    }
    let (gain, motion, places) = best?;
    Some((motion, Refined::best_of(&remembering.tried_near(motion, (gain, places)), step)?))
}

/// A residual with all that it remembers.
struct Remembering<'a> {
    white: &'a White,
    /// Sums of products of values so many rows apart, from none up to the order of its autoregression.
    products: Vec<f64>,
    /// Logarithm of the variance that the autoregression leaves.
    log_variance: f64,
}

impl<'a> Remembering<'a> {
    fn of(white: &'a White) -> Option<Self> {
        let x = &white.even;
        let mut products = vec![0.0; white.order() + 1];
        for t in 0..x.len() {
            let behind = t - white.stretch(t)[0];
            for (back, sum) in products.iter_mut().enumerate().take(behind + 1) {
                *sum += x[t] * x[t - back];
            }
        }
        let log_variance = log_variance(&products)?;
        Some(Self { white, products, log_variance })
    }

    /// Twice the gain of the logarithm of the likelihood by the half wave over places of a motion; `None` where too few of its
    /// rows are there. `wave` is overwritten.
    fn gain(&self, motion: usize, places: Range<usize>, wave: &mut Vec<f64>) -> Option<f64> {
        let x = &self.white.even;
        let rows = self.white.even_half_wave(motion, &places, wave)?;
        let square: f64 = wave.iter().map(|w| w * w).sum();
        let amplitude = rows.clone().zip(&*wave).map(|(r, w)| x[r] * w).sum::<f64>() / square;
        let taken = |r: usize| if rows.contains(&r) { amplitude * wave[r - rows.start] } else { 0.0 };
        let mut products = self.products.clone();
        for t in rows.clone() {
            let [from, to] = self.white.stretch(t);
            for (back, sum) in products.iter_mut().enumerate() {
                // Pairs with this row as the later one, the wave taken out of both; and with it as the earlier one, out of it.
                if t >= from + back {
                    *sum -= taken(t) * (x[t - back] - taken(t - back));
                }
                if t + back < to {
                    *sum -= taken(t) * x[t + back];
                }
            }
        }
        Some(x.len() as f64 * (self.log_variance - log_variance(&products)?))
    }

    /// Windows near one of the grid: the gain of each, its first place and the one after its last.
    fn tried_near(&self, motion: usize, (gain, near): (f64, Range<usize>)) -> Vec<(f64, usize, usize)> {
        let reach = (near.len() / 4).max(2);
        let fine = (near.len() / (2 * SCAN_STEPS)).max(1);
        let end = self.white.motions[motion].length();
        let mut wave = Vec::new();
        let mut tried = vec![(gain, near.start, near.end)];
        for from in (near.start.saturating_sub(reach)..=near.start + reach).step_by(fine) {
            for to in (near.end.saturating_sub(reach)..=(near.end + reach).min(end)).step_by(fine) {
                if to >= from + near.len().div_ceil(2).max(2)
                    && let Some(gain) = self.gain(motion, from..to, &mut wave)
                {
                    tried.push((gain, from, to));
                }
            }
        }
        tried
    }
}

/// Logarithm of the variance that an autoregression leaves of a series with these sums of products;
/// `None` where there is none.
fn log_variance(products: &[f64]) -> Option<f64> {
    let mut left = *products.first()?;
    let mut coefficients: Vec<f64> = Vec::with_capacity(products.len());
    for _ in 1..products.len() {
        let reflection = raise_order(&mut coefficients, products, left);
        left *= 1.0 - reflection * reflection;
    }
    (left.is_finite() && left > 0.0).then(|| left.ln())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::contact::track::Track;
    use crate::testing::normal;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;
    use std::collections::HashSet;

    const STEP: f64 = 0.02;

    /// 8 s of noise that is white, with a pause, and a push of 2 s.
    fn pushed(seed: u64) -> White {
        let mut rng = Pcg64::seed_from_u64(seed);
        let half_wave = |k: usize| (std::f64::consts::PI * (k as f64 - 150.0) / 100.0).sin();
        let push = |k: usize| if (150..250).contains(&k) { half_wave(k) } else { 0.0 };
        let row = |k: usize| (k, 2.0 * push(k) + normal(&mut rng));
        let rows = (0..400).filter(|k| !(60..70).contains(k)).map(row).collect();
        let motions = vec![(true, rows)];
        let track =
            Track { joint: 0, motions, beside: vec![], sizes: vec![], columns: vec![], once: HashSet::new() };
        White::of(&track, &[]).expect("noise has a spread")
    }

    #[test]
    fn the_gain_is_that_of_a_memory_fitted_to_the_residual_without_the_half_wave() {
        let white = pushed(1);
        let remembering = Remembering::of(&white).expect("noise remembers");
        let mut wave = Vec::new();
        let rows = white.even_half_wave(0, &(140..260), &mut wave).expect("all rows are there");
        let product: f64 = rows.clone().zip(&wave).map(|(r, w)| white.even[r] * w).sum();
        let amplitude = product / wave.iter().map(|w| w * w).sum::<f64>();
        let mut without = white.clone();
        rows.zip(&wave).for_each(|(r, w)| without.even[r] -= amplitude * w);
        let left = Remembering::of(&without).expect("noise remembers").log_variance;
        let gain = remembering.gain(0, 140..260, &mut wave).expect("all rows are there");
        assert!((gain - white.even.len() as f64 * (remembering.log_variance - left)).abs() < 1e-9, "{gain}");
        assert!(gain > 30.0, "{gain}");
    }

    #[test]
    fn the_likeliest_window_is_that_of_the_push() {
        for seed in 1..10 {
            let (_, found) = likeliest(&pushed(seed), &[8, 15, 25, 50, 80], STEP, |_| true).expect("a push");
            assert!(found.from.abs_diff(150) < 25 && found.to.abs_diff(250) < 25);
        }
    }

    #[test]
    fn next_to_nothing_that_is_free_nothing_is_likely() {
        assert!(likeliest(&pushed(1), &[8, 15], STEP, |_| false).is_none());
    }
}
