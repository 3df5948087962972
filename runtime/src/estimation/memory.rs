//! How many successive rows say as much about the size of the noise as one independent row: noise that lasts.

use super::observe::{Observation, Rows};

/// A correlation of noise that has ended is within so many standard errors of zero.
const STANDARD_ERRORS: f64 = 2.0;
/// Rows that a memory is followed for: some seconds.
const LONGEST: usize = 200;

/// Of each equation the rows that are worth one, 1 at least, given the unknowns that fit it.
///
/// The mean square of n errors with correlations rho(l) varies as that of n / (1 + 2 sum of (1 - l/n) rho(l)^2) independent ones
/// (Bayley and Hammersley 1946). The sum ends at the first correlation that noise of the memory so far makes by chance
/// (Bartlett 1946), so that noise without memory counts as such. The correlations are those of all motions of the joint.
///
/// Ones where the rows were not kept.
pub(super) fn rows_worth_one(observation: &Observation, chi: &[Vec<f64>]) -> Vec<f64> {
    let Some(rows) = &observation.rows else { return vec![1.0; chi.len()] };
    let of = |(equation, chi): (usize, &Vec<f64>)| {
        let own: Vec<Vec<f64>> =
            rows.iter().filter(|r| r.equation == equation).filter_map(|r| residual(r, chi)).collect();
        of_series(&own)
    };
    chi.iter().enumerate().map(of).collect()
}

/// Y - W chi in units of its root mean square, zero at rows that are not used; `None` where nothing is left.
fn residual(rows: &Rows, chi: &[f64]) -> Option<Vec<f64>> {
    let mut left = rows.residual(chi);
    left.iter_mut().zip(&rows.used).filter(|(_, used)| !**used).for_each(|(e, _)| *e = 0.0);
    let used = rows.used.iter().filter(|used| **used).count().max(1) as f64;
    let size = (left.iter().map(|e| e * e).sum::<f64>() / used).sqrt();
    (size > 0.0 && size.is_finite()).then(|| left.iter().map(|e| e / size).collect())
}

fn of_series(all: &[Vec<f64>]) -> f64 {
    let product = |lag: usize| -> f64 {
        all.iter().map(|e| e.iter().zip(e.iter().skip(lag)).map(|(a, b)| a * b).sum::<f64>()).sum()
    };
    let squares = product(0);
    // In units of their size the squares of used rows are as many as the rows.
    let longest = all.iter().map(Vec::len).max().unwrap_or(0).min(LONGEST);
    let mut worth = 1.0;
    for lag in 1..longest {
        let correlation = product(lag) / squares;
        if correlation.abs() < STANDARD_ERRORS * (worth / squares).sqrt() {
            break;
        }
        worth += 2.0 * correlation * correlation;
    }
    worth
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    const SERIES: usize = 20;
    const ROWS: usize = 75;

    /// Motions with an autoregression of first order.
    fn drawn(seed: u64, coefficient: f64) -> Vec<Vec<f64>> {
        let mut random = Pcg64::seed_from_u64(seed);
        let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
        let series = |_| {
            let mut e = draw();
            let next = |_| {
                e = coefficient * e + (1.0 - coefficient * coefficient).sqrt() * draw();
                e
            };
            (0..ROWS).map(next).collect()
        };
        (0..SERIES).map(series).collect()
    }

    fn mean(seeds: u64, coefficient: f64) -> f64 {
        (0..seeds).map(|seed| of_series(&drawn(seed, coefficient))).sum::<f64>() / seeds as f64
    }

    #[test]
    fn noise_without_memory_has_rows_that_count_each() {
        let all = mean(100, 0.0);
        assert!((1.0..1.01).contains(&all), "{all}");
    }

    #[test]
    fn the_mean_square_varies_as_that_of_so_many_rows() {
        for coefficient in [0.4, 0.7, -0.6] {
            let squares: Vec<f64> = (0..100)
                .flat_map(|seed| drawn(seed, coefficient))
                .map(|e| e.iter().map(|e| e * e).sum::<f64>() / ROWS as f64)
                .collect();
            let variance = squares.iter().map(|s| (s - 1.0).powi(2)).sum::<f64>() / squares.len() as f64;
            let seen = variance * ROWS as f64 / 2.0;
            let told = mean(100, coefficient);
            assert!((told / seen - 1.0).abs() < 0.12, "{coefficient}: {told} told, {seen} seen");
        }
    }

    #[test]
    fn nothing_left_is_noise_without_memory() {
        assert_eq!(of_series(&[]), 1.0);
    }
}
