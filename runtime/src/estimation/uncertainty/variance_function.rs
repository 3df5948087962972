//! Noise whose size changes with the motion: the variance as a function of time.

use super::autoregression::Autoregression;
use super::noise::{Fit, whitened};
use super::series::Series;

/// Rows to each side that the variance of a row is the mean over: the size of the noise changes as slowly as the robot
/// moves, and twenty rows know it to a third.
const REACH: usize = 10;
/// Fits: one with equal rows, and one with the deviations that it shows.
const FITS: usize = 2;

/// For each series the standard deviation of its noise at each row, in units of the series: squared residuals around the row
/// over the degrees of freedom that the fit leaves in them (a variance function, Davidian and Carroll 1987, estimated from
/// local means). Rows with large noise have large columns where the noise is that of the torques times the speeds, and
/// a fit takes more from them than one of equal rows is believed to.
///
/// `None` where the columns do not determine the `unknowns`.
pub(super) fn deviations(all: &[Series], unknowns: usize) -> Option<Vec<Vec<f64>>> {
    let equations = all.iter().map(|s| s.equation + 1).max()?;
    let white = vec![Autoregression::white(1.0); equations];
    let mut deviations: Vec<Vec<f64>> = all.iter().map(|s| vec![1.0; s.y.len()]).collect();
    for _ in 0..FITS {
        let even: Vec<Series> = all.iter().zip(&deviations).map(|(s, d)| s.divided_by(d)).collect();
        let fit = Fit::of(&even, &white, unknowns)?;
        deviations = all.iter().zip(&even).map(|(own, even)| of_series(own, even, &fit, &white)).collect();
    }
    Some(deviations)
}

/// Those of the rows `own`, which were fitted as `even`.
fn of_series(own: &Series, even: &Series, fit: &Fit, white: &[Autoregression]) -> Vec<f64> {
    let leverages = fit.leverages(even, &whitened(even, &white[own.equation]));
    let residual = own.residual(&fit.chi);
    let mut freedom = vec![0.0; residual.len()];
    let rows = own.segments.iter().flat_map(|s| s.clone());
    rows.zip(leverages).for_each(|(t, leverage)| freedom[t] = 1.0 - leverage);
    let around = |t: usize| t.saturating_sub(REACH)..(t + REACH + 1).min(residual.len());
    let deviation = |t: usize| {
        let squares: f64 = residual[around(t)].iter().map(|e| e * e).sum();
        let freedom: f64 = freedom[around(t)].iter().sum();
        if squares > 0.0 && freedom > 0.0 { (squares / freedom).sqrt() } else { 1.0 }
    };
    (0..residual.len()).map(deviation).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use nalgebra::DMatrix;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};
    use rand_pcg::Pcg64;

    const ROWS: usize = 400;

    #[test]
    fn noise_that_grows_with_the_columns_is_as_large_as_it_is_where_it_is() {
        let speed = |t: usize| (0.03 * t as f64).sin();
        let truth = |t: usize| 0.2 + speed(t).powi(2);
        let (mut large, mut small) = (0.0, 0.0);
        let seeds = 60;
        for seed in 0..seeds {
            let mut random = Pcg64::seed_from_u64(seed);
            let mut draw = || -> f64 { StandardNormal.sample(&mut random) };
            let series = Series {
                group: 0,
                equation: 0,
                trajectory: 0,
                places: (0..6).collect(),
                w: DMatrix::from_fn(ROWS, 6, |t, c| speed(t) * (0.01 * (c * t) as f64).cos()),
                y: (0..ROWS).map(|t| truth(t) * draw()).collect(),
                used: vec![true; ROWS],
                segments: std::iter::once(0..ROWS).collect(),
            };
            let found = &deviations(std::slice::from_ref(&series), 6).expect("independent columns")[0];
            // The speed is largest at 157 and zero at 209.
            large += found[157].powi(2) / seeds as f64;
            small += found[209].powi(2) / seeds as f64;
        }
        let mean = |at: usize| (at - 10..=at + 10).map(|t| truth(t).powi(2)).sum::<f64>() / 21.0;
        assert!((large / mean(157) - 1.0).abs() < 0.15, "{large} {}", mean(157));
        assert!((small / mean(209) - 1.0).abs() < 0.15, "{small} {}", mean(209));
    }
}
