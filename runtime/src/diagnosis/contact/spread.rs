//! The spread of numbers that are mostly noise.

use crate::diagnosis::rules::SIGMA_PER_MAD;

/// Upper quartile of the absolute values of normal numbers of variance one.
const UPPER_QUARTILE: f64 = 1.150_35;

/// Standard deviation of numbers around zero, of which a few are no noise: from the median of their absolute values, or their
/// upper quartile where that tells of more, as where a torque is recorded in steps and most of it is one step; 0 of none.
pub(super) fn spread(values: impl Iterator<Item = f64>) -> f64 {
    let mut absolute: Vec<f64> = values.map(f64::abs).collect();
    if absolute.is_empty() {
        return 0.0;
    }
    let (half, quartile) = (absolute.len() / 2, absolute.len() * 3 / 4);
    let upper = *absolute.select_nth_unstable_by(quartile, f64::total_cmp).1;
    let middle = *absolute.select_nth_unstable_by(half, f64::total_cmp).1;
    (SIGMA_PER_MAD * middle).max(upper / UPPER_QUARTILE)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::normal;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    #[test]
    fn noise_with_a_few_pushes_spreads_as_the_noise_does() {
        let mut rng = Pcg64::seed_from_u64(1);
        let values: Vec<f64> =
            (0..4000).map(|k| if k < 100 { 50.0 } else { 0.3 * normal(&mut rng) }).collect();
        assert!((spread(values.into_iter()) / 0.3 - 1.0).abs() < 0.07);
    }

    #[test]
    fn torques_that_are_mostly_one_step_spread_by_the_others() {
        let steps = (0..100).map(|k| if k % 10 < 6 { 1e-9 } else { 0.5 });
        assert!(spread(steps) > 0.4);
        assert_eq!(spread(std::iter::empty()), 0.0);
    }
}
