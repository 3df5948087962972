//! How far a line of a spectrum of noise stands above the lines on both sides of it.

use statrs::function::beta::beta_reg;
use std::f64::consts::{LN_2, PI};

/// Powers that are integrated over, in units of their mean: from one that is below every median of any use to one beyond which
/// none is.
const POWERS: [f64; 2] = [1e-6, 60.0];
/// Steps of the logarithm of the power: the integrand is smooth and ends in nothing, where the trapezoidal rule is exact to
/// rounding.
const STEPS: usize = 800;

/// Probability that the amplitude of noise at one frequency is more than `above` times the larger one of the medians of so many
/// amplitudes on either side of it; a side of none counts for nothing.
///
/// The powers of noise are exponentially distributed; so is their level the same on both sides at best. Where it is not, the
/// louder side decides, so that an edge of the spectrum is no line: greatest-of detection (Hansen and Sawyers 1980) with
/// ordered statistics (Rohling 1983). With X the power in question, Z the larger median and F1, F2 the distributions of both,
/// P(X > a^2 Z) = E exp(-a^2 Z) = integral of a^2 exp(-a^2 z) F1(z) F2(z) dz.
fn p_value(above: f64, sides: [usize; 2]) -> f64 {
    if sides == [0, 0] {
        return 1.0;
    }
    let factor = above * above;
    let [low, high] = POWERS.map(f64::ln);
    let step = (high - low) / STEPS as f64;
    let integrand = |k: usize| {
        let power = (low + step * k as f64).exp();
        let below: f64 = sides.iter().map(|&count| median_below(power, count)).product();
        factor * power * (-factor * power).exp() * below
    };
    ((0..=STEPS).map(integrand).sum::<f64>() * step).min(1.0)
}

/// The same of the highest amplitude in a range of frequencies, `width` of them times the standard deviation of the places
/// over which each is made (time for a frequency, angle for an order).
///
/// The amplitude of noise is an envelope, which rises through a power x of mean 1 at sqrt(x / pi) exp(-x) for each such unit
/// (Rice 1944): besides being above it at the first frequency, it may come above it at any other (Davies 1987).
pub(crate) fn highest_p_value(above: f64, sides: [usize; 2], width: f64) -> f64 {
    let power = above * above * LN_2;
    (p_value(above, sides) * (1.0 + width.max(0.0) * (power / PI).sqrt())).min(1.0)
}

/// Probability that the median of so many exponentially distributed powers of mean 1 is below a power; 1 where there are none.
fn median_below(power: f64, count: usize) -> f64 {
    if count == 0 {
        return 1.0;
    }
    // The upper median, see `statistics::median`.
    let rank = count / 2 + 1;
    beta_reg(rank as f64, (count + 1 - rank) as f64, -(-power).exp_m1())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::statistics::median::median;
    use crate::testing::normal;
    use approx::assert_relative_eq;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;
    use std::f64::consts::TAU;

    #[test]
    fn one_side_alone_has_the_closed_form_of_ordered_statistics() {
        // Rohling 1983: the product of (n - i) / (n - i + T) over the values up to the one that is compared with.
        for (above, count) in [(3.0_f64, 12), (5.0, 12), (4.0, 5)] {
            let factor = above * above;
            let closed: f64 =
                (0..=count / 2).map(|i| f64::from(count - i) / (f64::from(count - i) + factor)).product();
            assert_relative_eq!(p_value(above, [count as usize, 0]), closed, max_relative = 1e-6);
        }
    }

    #[test]
    fn both_sides_are_as_scipy_integrates_them() {
        // scipy.integrate.quad of scipy.special.betainc, as in the module's formula.
        assert_relative_eq!(p_value(4.0, [12, 12]), 3.910599751e-05, max_relative = 1e-6);
        assert_relative_eq!(p_value(6.0, [4, 12]), 2.187041698e-07, max_relative = 1e-6);
    }

    #[test]
    fn noise_comes_as_far_as_often_as_it_says() {
        let mut rng = Pcg64::seed_from_u64(31);
        let (runs, above, sides) = (200_000, 2.5, [6, 12]);
        let mut power = || -rng.random_range(f64::MIN_POSITIVE..1.0_f64).ln();
        let mut beyond = 0;
        for _ in 0..runs {
            let own = power();
            let medians = sides.map(|count| {
                let mut side: Vec<f64> = (0..count).map(|_| power()).collect();
                median(&mut side)
            });
            beyond += u32::from(own > above * above * medians[0].max(medians[1]));
        }
        let expected = p_value(above, sides) * f64::from(runs);
        assert!((f64::from(beyond) - expected).abs() < 4.0 * expected.sqrt(), "{beyond} of {expected}");
    }

    #[test]
    fn the_highest_of_a_range_comes_as_far_as_often_as_it_says() {
        // Noise at 128 places between 0 and 2 pi: amplitudes at whole frequencies are independent.
        let mut rng = Pcg64::seed_from_u64(32);
        let (runs, above, places) = (40_000, 2.5, 128);
        let angle = |k: usize| TAU * k as f64 / places as f64;
        let turns: Vec<Vec<(f64, f64)>> = (0..=8)
            .map(|f| (0..places).map(|k| ((f as f64 / 8.0 + 20.0) * angle(k)).sin_cos()).collect())
            .collect();
        let spread = TAU / 12.0_f64.sqrt();
        let mut beyond = 0;
        for _ in 0..runs {
            let noise: Vec<f64> = (0..places).map(|_| normal(&mut rng)).collect();
            let power = |turns: &Vec<(f64, f64)>| {
                let sums =
                    turns.iter().zip(&noise).fold((0.0, 0.0), |(a, b), (t, x)| (a + t.0 * x, b + t.1 * x));
                (sums.0 * sums.0 + sums.1 * sums.1) / places as f64
            };
            let highest = turns.iter().map(power).fold(0.0, f64::max);
            let mut median_of = |count: usize| {
                let mut side: Vec<f64> =
                    (0..count).map(|_| -rng.random_range(f64::MIN_POSITIVE..1.0_f64).ln()).collect();
                median(&mut side)
            };
            let level = median_of(16).max(median_of(16));
            beyond += u32::from(highest > above * above * level);
        }
        let [once, expected] = [p_value(above, [16, 16]), highest_p_value(above, [16, 16], spread)];
        let seen = f64::from(beyond) / f64::from(runs);
        assert!(
            seen > 2.0 * once && (seen / expected - 1.0).abs() < 0.1,
            "{seen} of {expected}, once {once}"
        );
    }

    #[test]
    fn a_line_that_nothing_is_compared_with_stands_above_nothing() {
        assert_eq!(p_value(9.0, [0, 0]), 1.0);
    }
}
