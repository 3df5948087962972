//! Noise that is not of one size: what it makes of the variance of a law.
//!
//! The noise of a torque that is a motor's current grows with the torque. A law that is large where the noise is, as of a
//! motor that saturates, gathers more of it than one variance for all rows says. The variance of an estimate whatever the
//! sizes of the noise is that of its score (White 1980), here in the direction of the law as it was found:
//! Σ d² e² / Σ d², with d the white torque of the law without what all other columns make of it, and e the white residual
//! with what the law took from it given back (HC3, MacKinnon and White 1985). It is known with the degrees of freedom of a
//! variance of equal mean and uncertainty (Satterthwaite 1946): few where few rows make the law.

use crate::diagnosis::judging::calibration::Law;
use crate::diagnosis::judging::regressors::Regressors;
use crate::diagnosis::judging::units::Units;
use crate::diagnosis::judging::wald::Wald;
use crate::diagnosis::judging::white_products::Background;
use crate::diagnosis::judging::whitening::white_with_residual;
use crate::statistics::moderation::Variance;

/// The mean statistic of a law for each of its numbers, were it only noise of the sizes that the rows show.
pub(super) fn of_noise(
    units: &Units,
    regressors: &Regressors<'_>,
    law: &Law<'_>,
    (found, background): (&Wald, &Background),
) -> Option<Variance> {
    let torque = own_torque(units, regressors, law, found);
    let of_joint = |j: usize| {
        let whitening = background.whitening(units, regressors, j, law.residual);
        white_with_residual(units, regressors, j, &whitening, [&torque, law.residual])
    };
    let joints: Vec<[Vec<f64>; 2]> = (0..regressors.of_joint.len())
        .filter(|&j| regressors.acts_on(law.columns, j))
        .map(of_joint)
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

/// Mean of the squares of residuals, weighted by the squares of the law's torque on their rows; the sum of these rows is what
/// the law is known with. `None` where there is none.
fn of_scores<R: Iterator<Item = (f64, f64)>>(rows: impl Fn() -> R) -> Option<Variance> {
    let information: f64 = rows().map(|(d, _)| d * d).sum();
    if information <= 0.0 {
        return None;
    }
    let (mut sum, mut squares) = (0.0, 0.0);
    for (d, e) in rows() {
        let leverage = d * d / information;
        // A row that alone tells the law is fitted by it.
        if leverage < 1.0 {
            let e = e / (1.0 - leverage);
            sum += leverage * e * e;
            squares += (leverage * e * e).powi(2);
        }
    }
    // The fourth moment of a normal number is three times the square of its variance, of which 2/3 are uncertainty.
    (squares > 0.0).then(|| Variance { value: sum, freedom: 3.0 * sum * sum / squares })
}
