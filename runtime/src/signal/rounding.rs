//! What rounding does to the means of a signal.
//!
//! A signal in steps of q is wrong by up to half a step for as long as it hardly changes. Noise of standard deviation s before the
//! rounding makes means better: of the error, a wave of one step, exp(-2π²(s/q)²) is left (Widrow and Kollár, Quantization Noise,
//! 2008).

use std::f64::consts::{PI, SQRT_2};

/// Gaps between neighbouring values that are whole numbers of steps, as a part of all, where a signal has steps. Judgement: some
/// samples may have been interpolated.
const WHOLE: f64 = 0.95;
/// How far from a whole number a gap in steps may be. Numerics: text with few digits.
const NEARLY_WHOLE: f64 = 0.02;
/// Values that differ by less than this part of the largest are the same. Numerics.
const SAME: f64 = 1e-9;

/// Standard deviation of the error of a mean over samples between which the signal hardly changes, in its own unit; zero where it
/// has no steps, or each value occurs about once.
pub fn rounding_of_means(x: &[f64]) -> f64 {
    let Some(step) = step(x) else { return 0.0 };
    // What neighbours differ by is noise, that of rounding in it.
    let bends: Vec<f64> = x.windows(3).map(|w| (w[1] - 0.5 * (w[0] + w[2])).powi(2)).collect();
    let variance = bends.iter().sum::<f64>() / (1.5 * bends.len().max(1) as f64);
    let before = (variance - step * step / 12.0).max(0.0) / (step * step);
    step / (PI * SQRT_2) * (-2.0 * PI * PI * before).exp()
}

/// The step that all values are whole numbers of, up to one constant.
fn step(x: &[f64]) -> Option<f64> {
    let mut values: Vec<f64> = x.iter().copied().filter(|x| x.is_finite()).collect();
    values.sort_by(f64::total_cmp);
    let largest = values.first()?.abs().max(values.last()?.abs());
    let mut gaps: Vec<f64> = values.windows(2).map(|w| w[1] - w[0]).filter(|g| *g > SAME * largest).collect();
    if gaps.is_empty() || values.len() < 2 * (gaps.len() + 1) {
        return None;
    }
    gaps.sort_by(f64::total_cmp);
    let step = gaps[gaps.len() / 20];
    let is_whole = |gap: &&f64| {
        let steps = *gap / step;
        steps > 0.5 && (steps - steps.round()).abs() < NEARLY_WHOLE * steps.max(1.0)
    };
    let whole = gaps.iter().filter(is_whole).count();
    (whole as f64 >= WHOLE * gaps.len() as f64).then_some(step)
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    /// Slow signals, one per start, with noise and in steps of one; and their means less those before both.
    fn rounded(noise: f64) -> (Vec<f64>, Vec<f64>) {
        let mut rng = Pcg64::seed_from_u64(3);
        let (mut all, mut errors) = (Vec::new(), Vec::new());
        for start in 0..400 {
            let level = 0.377 * f64::from(start);
            let mut error = 0.0;
            for t in 0..400 {
                let true_value = level + 1e-4 * f64::from(t);
                let deviate: f64 = StandardNormal.sample(&mut rng);
                let recorded = (true_value + noise * deviate).round();
                error += (recorded - true_value) / 400.0;
                all.push(recorded);
            }
            errors.push(error);
        }
        (all, errors)
    }

    #[test]
    fn means_are_as_wrong_as_is_said_and_less_so_with_more_noise() {
        for (noise, low, high) in [(0.05, 0.7, 1.3), (0.25, 0.7, 1.3), (0.35, 0.5, 1.5)] {
            let (signal, errors) = rounded(noise);
            let seen = (errors.iter().map(|e| e * e).sum::<f64>() / errors.len() as f64).sqrt();
            let of_noise = noise / 20.0;
            let said = rounding_of_means(&signal).hypot(of_noise);
            assert!((low..high).contains(&(said / seen)), "{noise}: {said}, seen {seen}");
        }
    }

    #[test]
    fn a_signal_without_steps_has_none_of_it() {
        let smooth: Vec<f64> = (0..1000).map(|k| (0.01 * f64::from(k)).sin()).collect();
        assert_eq!(rounding_of_means(&smooth), 0.0);
        assert_eq!(rounding_of_means(&[]), 0.0);
        assert_eq!(rounding_of_means(&[2.5; 50]), 0.0);
    }

    #[test]
    fn a_step_is_found_in_any_unit_and_with_samples_between() {
        let mut signal: Vec<f64> = (0..2000).map(|k| (f64::from(k) / 90.0).sin()).collect();
        signal.iter_mut().for_each(|x| *x = (*x / 0.0371).round() * 0.0371 + 5.0);
        assert!(step(&signal).is_some_and(|q| (q - 0.0371).abs() < 1e-6));
        signal[700] += 0.01;
        assert!(step(&signal).is_some_and(|q| (q - 0.0371).abs() < 1e-6));
    }
}
