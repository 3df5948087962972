//! What noise in the columns takes away from the parameters, given back.

use super::Factor;
use super::observe::Observation;
use nalgebra::{Cholesky, DMatrix, DVector};

/// Noise in the columns that weighted least squares is corrected for.
#[derive(Debug, Clone)]
pub(super) struct Attenuation {
    /// Part of the weighted WT W that is noise.
    pub of_information: DMatrix<f64>,
    /// The corrected parameters.
    pub chi: Vec<f64>,
    /// What that added to each.
    pub missing: Vec<f64>,
}

/// Standard deviation of a correction, as a share of it.
///
/// What the encoders add to a motion also goes through the controller: the measured position has its noise times the
/// sensitivity S of the position loop, the true one follows with S - 1, and the correction would have to be weighted with
/// the real part of S. A recording does not tell S. It is 1 above the loop's bandwidth, falls to 0 below, and is kept
/// below 2 by the modulus margin that loops are designed for (6 dB): anything between 0 and 2 is as likely, which has
/// the mean 1 and this standard deviation.
pub(super) const UNCERTAINTY: f64 = 0.577_350_269_189_625_8;

/// More than half of what tells some parameters apart is noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Drowned;

/// The parameters of least squares corrected for noise of known size in the columns (Fuller 1987, Measurement Error
/// Models, section 2.2): WT W is expected to be that of the true columns plus that of the noise, N, which pulls
/// parameters towards zero, so that (WT W - N) chi = WT Y.
///
/// `stacked` has the unknowns `active`, whose weighted least-squares solution is `chi`; `sigma` are the errors of the
/// groups. `None` where no noise is known.
///
/// # Errors
/// [`Drowned`]: WT W - 2 N is not positive definite.
pub(super) fn corrected(
    observation: &Observation,
    active: &[usize],
    sigma: &[f64],
    stacked: &Factor,
    chi: &[f64],
) -> Result<Option<Attenuation>, Drowned> {
    let Some(noise) = &observation.noise_of_columns else { return Ok(None) };
    let k = active.len();
    let mut place = vec![None; observation.unknowns.len()];
    for (p, &l) in active.iter().enumerate() {
        place[l] = Some(p);
    }
    let mut of_information = DMatrix::<f64>::zeros(k, k);
    for ((group, noise), sigma) in observation.groups.iter().zip(noise).zip(sigma) {
        let own: Vec<(usize, usize)> =
            group.columns.iter().enumerate().filter_map(|(c, &u)| place[u].map(|p| (c, p))).collect();
        for &(a, pa) in &own {
            for &(b, pb) in &own {
                of_information[(pa, pb)] += noise[(a, b)] / (sigma * sigma);
            }
        }
    }
    let r = DMatrix::from_fn(k, k, |i, l| stacked.r(i, l));
    let information = r.tr_mul(&r);
    // Unit columns: the condition is that of the scaled W, squared.
    let scale = information.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 1.0 });
    let scaled = |matrix: DMatrix<f64>| DMatrix::from_fn(k, k, |i, l| scale[i] * matrix[(i, l)] * scale[l]);
    if Cholesky::new(scaled(&information - 2.0 * &of_information)).is_none() {
        return Err(Drowned);
    }
    let pull = (&of_information * DVector::from_column_slice(chi)).component_mul(&scale);
    let Some(left) = Cholesky::new(scaled(&information - &of_information)) else { return Err(Drowned) };
    let missing = left.solve(&pull).component_mul(&scale);
    let missing = missing.as_slice().to_vec();
    let chi = chi.iter().zip(&missing).map(|(x, d)| x + d).collect();
    Ok(Some(Attenuation { of_information, chi, missing }))
}
