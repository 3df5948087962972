//! Made-up residuals for the tests of this folder.

use crate::testing::normal;
use rand_pcg::Pcg64;

/// AR(1) noise.
pub(in crate::diagnosis) fn correlated(rng: &mut Pcg64, rows: usize, rho: f64) -> Vec<f64> {
    let mut x = 0.0;
    (0..rows + 50)
        .map(|_| {
            x = rho * x + normal(rng);
            x
        })
        .skip(50)
        .collect()
}
