//! Made-up residuals for the tests of this folder.

use rand::RngExt;
use rand_pcg::Pcg64;

/// AR(1) noise.
pub(super) fn correlated(rng: &mut Pcg64, rows: usize, rho: f64) -> Vec<f64> {
    let mut x = 0.0;
    (0..rows + 50)
        .map(|_| {
            let new: f64 = (0..12).map(|_| rng.random_range(-0.5..0.5)).sum();
            x = rho * x + new;
            x
        })
        .skip(50)
        .collect()
}
