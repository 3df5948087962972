//! Noise that is not of one size: what it makes of the variance of a law.
//!
//! The noise of a torque that is a motor's current grows with the torque. A law that is large where the noise is, as of a
//! motor that saturates, gathers more of it than one variance for all rows says. The variance of an estimate whatever the
//! sizes of the noise is that of its score (White 1980), here in the direction of the law as it was found:
//! Σ d² e² / Σ d², with d the white torque of the law without what all other columns make of it, and e the white residual
//! with what the law took from it given back (HC3, MacKinnon and White 1985). It is known with the degrees of freedom of a
//! variance of equal mean and uncertainty (Satterthwaite 1946): few where few rows make the law, or where a few rows on which
//! the law is nearly right make most of the variance.
//!
//! A law of many rows does not need to know it. Without the law the residual is as likely to have one sign as the other on
//! every row, so that its score Σ d e₀, e₀ = d + e, in units of the root of Σ d² e₀², has at most the tail of a normal number
//! whatever the sizes of the noise (Efron 1969; Pinelis 1994). That is never more certain than the rows are many: where they
//! are few, their variance tells more.

use crate::diagnosis::judging::calibration::Law;
use crate::diagnosis::judging::regressors::Regressors;
use crate::diagnosis::judging::units::Units;
use crate::diagnosis::judging::wald::Wald;
use crate::diagnosis::judging::whitening::{Whitening, white_with_residual};
use crate::statistics::moderation::Variance;

/// What a law is worth in noise of the sizes that the rows show.
pub(super) struct Uneven {
    /// Mean statistic of the law for each of its numbers, were it only noise.
    pub variance: Variance,
    /// Square of its score in units of what signs at random make of it, as a share of the law's statistic.
    pub of_signs: f64,
}

/// Worth of a law as it was found.
pub(super) fn of_noise(
    units: &Units,
    regressors: &Regressors<'_>,
    law: &Law<'_>,
    (found, whitening): (&Wald, &[(usize, Whitening)]),
) -> Option<Uneven> {
    let torque = own_torque(units, regressors, law, found);
    let joints: Vec<[Vec<f64>; 2]> = whitening
        .iter()
        .filter(|(j, _)| regressors.acts_on(law.columns, *j))
        .map(|(j, white)| white_with_residual(units, regressors, *j, white, [&torque, law.residual]))
        .collect();
    of_scores(|| {
        joints.iter().flat_map(|[torque, residual]| torque.iter().copied().zip(residual.iter().copied()))
    })
}

/// Torque of a law as it was found, on all rows, without what the other columns make of it.
fn own_torque(units: &Units, regressors: &Regressors<'_>, law: &Law<'_>, found: &Wald) -> Vec<f64> {
    let mut torque = vec![0.0; regressors.y.len()];
    for (column, a) in law.columns.iter().zip(&found.amplitude) {
        torque.iter_mut().zip(column).for_each(|(t, c)| *t += a * c);
    }
    if units.change() {
        for of_joint in &units.rows {
            for (rows, _) in of_joint.iter().zip(&units.units).filter(|(_, unit)| !unit.target) {
                torque[rows.clone()].fill(0.0);
            }
        }
    }
    for (column, a) in regressors.shared.iter().chain(law.columns).zip(&found.made) {
        torque.iter_mut().zip(column).for_each(|(t, c)| *t -= a * c);
    }
    torque
}

/// From white torques of a law and residuals beside it, row by row; `None` where there is no law.
fn of_scores<R: Iterator<Item = (f64, f64)>>(rows: impl Fn() -> R) -> Option<Uneven> {
    let information: f64 = rows().map(|(d, _)| d * d).sum();
    if information <= 0.0 {
        return None;
    }
    // The residual is that of ordinary least squares: what it still has of the law is not in what the law leaves.
    let still = rows().map(|(d, e)| d * e).sum::<f64>() / information;
    let (mut sum, mut squares, mut without) = (0.0, 0.0, 0.0);
    for (d, e) in rows() {
        let leverage = d * d / information;
        // A row that alone tells the law is fitted by it.
        if leverage < 1.0 {
            let e = e / (1.0 - leverage);
            sum += leverage * e * e;
            squares += (leverage * e * e).powi(2);
        }
        without += (d * (d - still * d + e)).powi(2);
    }
    // The fourth moment of a normal number is three times the square of its variance, of which 2/3 are uncertainty.
    (squares > 0.0).then(|| Uneven {
        variance: Variance { value: sum, freedom: 3.0 * sum * sum / squares },
        of_signs: if without > 0.0 { information / without } else { 0.0 },
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::diagnosis::judging::significance::Evidence;
    use crate::testing::normal;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    /// P-values by the variance and by signs of a law that is the same on all rows, given what is left without it.
    fn p_values(without: &[f64]) -> [f64; 2] {
        let amplitude = without.iter().sum::<f64>() / without.len() as f64;
        let found = of_scores(|| without.iter().map(|y| (amplitude, y - amplitude))).expect("a law");
        let squares = amplitude * amplitude * without.len() as f64;
        let Variance { value, freedom } = found.variance;
        [(squares / value, freedom), (squares * found.of_signs, f64::INFINITY)]
            .map(|(squares, freedom)| Evidence::fisher(squares, 1, freedom).p_value)
    }

    #[test]
    fn noise_of_any_sizes_is_no_law_as_often_as_its_p_values_say() {
        let mut rng = Pcg64::seed_from_u64(3);
        let (runs, level) = (100_000, 1e-3);
        // The loudest row is so many times as loud as the quietest.
        for loudest in [1.0_f64, 30.0, 1000.0] {
            let mut below = [0; 2];
            for _ in 0..runs {
                let of_row = |k: i32| normal(&mut rng) * loudest.powf(f64::from(k) / 60.0);
                let noise: Vec<f64> = (0..60).map(of_row).collect();
                for (below, p) in below.iter_mut().zip(p_values(&noise)) {
                    *below += i32::from(p < level);
                }
            }
            println!("{loudest}: {below:?} of {runs}");
            assert!(
                below.iter().all(|below| f64::from(*below) <= 1.3 * level * f64::from(runs)),
                "{below:?}"
            );
        }
    }

    #[test]
    fn a_law_that_is_not_quite_right_on_a_few_of_its_rows_is_sure_by_the_signs_of_the_others() {
        let mut rng = Pcg64::seed_from_u64(4);
        for _ in 0..100 {
            // As where a friction turns round earlier or later than the law says.
            let off = |k: usize| [20.0, -20.0, 20.0].get(k).copied().unwrap_or(0.0);
            let without: Vec<f64> = (0..120).map(|k| 3.0 + normal(&mut rng) + off(k)).collect();
            let [by_variance, by_signs] = p_values(&without);
            assert!(by_signs < 0.01 * by_variance, "{by_variance} {by_signs}");
        }
    }
}
