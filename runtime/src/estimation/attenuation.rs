//! What noise in the columns takes away from the parameters, given back.

use super::Factor;
use super::observe::Observation;
use nalgebra::{Cholesky, DMatrix, DVector, SymmetricEigen};

/// Noise in the columns that weighted least squares is corrected for.
#[derive(Debug, Clone)]
pub(super) struct Attenuation {
    /// Part of the weighted WT W that is noise.
    pub of_information: DMatrix<f64>,
    /// The corrected parameters.
    pub chi: Vec<f64>,
    /// What that added to each.
    pub missing: Vec<f64>,
    /// Standard deviation of each parameter that is due to the noise in the columns.
    pub deviation: Vec<f64>,
    /// Whether noise hides some directions: parameters that it alone tells apart.
    pub hides_some: bool,
}

/// Standard deviation of a correction, as a share of it.
///
/// What the encoders add to a motion also goes through the controller: the measured position has its noise times the
/// sensitivity S of the position loop, the true one follows with S - 1, and the correction would have to be weighted with
/// the real part of S. A recording does not tell S. It is 1 above the loop's bandwidth, falls to 0 below, and is kept
/// below 2 by the modulus margin that loops are designed for (6 dB): anything between 0 and 2 is as likely, which has
/// the mean 1 and this standard deviation.
pub(super) const UNCERTAINTY: f64 = 0.577_350_269_189_625_8;

/// Share of a direction's information that noise may be for it to be corrected.
const MOST: f64 = 0.5;

/// The parameters of least squares corrected for noise of known size in the columns (Fuller 1987, Measurement Error
/// Models, section 2.2): WT W is expected to be that of the true columns plus that of the noise, N, which pulls
/// parameters towards zero, so that (WT W - N) chi = WT Y.
///
/// `stacked` has the unknowns `active`, whose weighted least-squares solution is `chi`; `sigma` are the errors of the
/// groups. `None` where no noise is known. Nothing is added in directions of which noise is more
/// than half.
pub(super) fn corrected(
    observation: &Observation,
    active: &[usize],
    sigma: &[f64],
    stacked: &Factor,
    chi: &[f64],
) -> Option<Attenuation> {
    let noise = observation.noise_of_columns.as_ref()?;
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
    given_back(of_information, stacked, chi)
}

/// The same from the part of the weighted WT W that is noise.
pub(super) fn given_back(of_information: DMatrix<f64>, stacked: &Factor, chi: &[f64]) -> Option<Attenuation> {
    let k = chi.len();
    let r = DMatrix::from_fn(k, k, |i, l| stacked.r(i, l));
    let information = r.tr_mul(&r);
    // Unit columns: the condition is that of the scaled W, squared.
    let scale = information.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 1.0 });
    let scaled = |matrix: &DMatrix<f64>| DMatrix::from_fn(k, k, |i, l| scale[i] * matrix[(i, l)] * scale[l]);
    let directions = if Cholesky::new(scaled(&(&information - 2.0 * &of_information))).is_none() {
        Some(Directions::new(&scaled(&information), &scaled(&of_information))?)
    } else {
        None
    };
    let of_information = match &directions {
        Some(directions) => {
            let noise = directions.visible_noise();
            DMatrix::from_fn(k, k, |i, l| noise[(i, l)] / (scale[i] * scale[l]))
        }
        None => of_information,
    };
    let pull = (&of_information * DVector::from_column_slice(chi)).component_mul(&scale);
    let left = Cholesky::new(scaled(&(&information - &of_information)))?;
    let missing = left.solve(&pull).component_mul(&scale);
    let deviation = match &directions {
        Some(directions) => {
            let freedom = stacked.rows().saturating_sub(k).max(1) as f64;
            let variance = stacked.residual_norm(chi).powi(2) / freedom;
            let estimate = DVector::from_column_slice(chi).component_div(&scale);
            directions.deviation(&estimate, variance).component_mul(&scale)
        }
        None => UNCERTAINTY * missing.abs(),
    };
    let list = |of: &DVector<f64>| of.as_slice().to_vec();
    let chi = chi.iter().zip(&missing).map(|(x, d)| x + d).collect();
    Some(Attenuation {
        of_information,
        chi,
        missing: list(&missing),
        deviation: list(&deviation),
        hides_some: directions.is_some(),
    })
}

/// The directions among unknowns which are independent in the estimate and in the noise of the columns.
struct Directions {
    /// Lower triangular root of the information.
    root: DMatrix<f64>,
    /// Unknowns by direction, each as large as one unit of information.
    unknowns: DMatrix<f64>,
    /// Directions by unit information.
    turn: DMatrix<f64>,
    /// Of the information of each the share that is noise; more than all of it where less noise than is expected is there.
    shares: DVector<f64>,
}

impl Directions {
    fn new(information: &DMatrix<f64>, noise: &DMatrix<f64>) -> Option<Self> {
        let root = Cholesky::new(information.clone())?.l();
        let inverse = root.clone().try_inverse()?;
        let of_unit = SymmetricEigen::new(&inverse * noise * inverse.transpose());
        let unknowns = inverse.tr_mul(&of_unit.eigenvectors);
        Some(Self { root, unknowns, turn: of_unit.eigenvectors, shares: of_unit.eigenvalues })
    }

    /// The noise in the directions that it does not hide.
    ///
    /// Where all that there is in a direction is noise, the noise that is expected is as likely more than what there
    /// is: a correction has no moments there (Fuller 1987, section 2.5).
    fn visible_noise(&self) -> DMatrix<f64> {
        let visible = self.shares.map(|share| if share > MOST { 0.0 } else { share });
        let turn = &self.root * &self.turn;
        &turn * DMatrix::from_diagonal(&visible) * turn.transpose()
    }

    /// Standard deviation of unknowns that is due to the noise of the columns: of a correction as of what an estimate has
    /// in a direction that noise hides, which is anything between nothing and twice as much.
    ///
    /// Every direction has noise of other joints at other frequencies, for which S is another. What it has of the
    /// estimate is more than what is true by the estimate's own errors, of `variance` for a unit of information.
    fn deviation(&self, estimate: &DVector<f64>, variance: f64) -> DVector<f64> {
        let found = self.turn.tr_mul(&self.root.tr_mul(estimate));
        let uncertain = self.shares.zip_map(&found, |share, found| {
            let corrected = if share > MOST { 1.0 } else { share / (1.0 - share) };
            corrected.powi(2) * (found.powi(2) - variance)
        });
        let variance = self.unknowns.component_mul(&self.unknowns) * uncertain;
        variance.map(|v| UNCERTAINTY * v.max(0.0).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::estimation::observe::{Equations, ObserveSettings, Standstill, observe};
    use crate::estimation::weights::equal;
    use crate::estimation::weights::stack;
    use crate::signal::Motion;
    use crate::testing::vertical_axis;
    use rand::SeedableRng;
    use rand_distr::{Distribution, StandardNormal};

    /// One vertical axis with an inertia of 2 and viscous friction 0.7, whose acceleration is measured with noise of
    /// standard deviation `noise` in its rows.
    fn observed(noise: f64, known: f64) -> Observation {
        let model = vertical_axis(&["ZZ1", "Fv1"]);
        let rate = 100.0;
        let mut random = rand_pcg::Pcg64::seed_from_u64(9);
        let time: Vec<f64> = (0..20_000).map(|k| f64::from(k) / rate).collect();
        let speed: Vec<f64> = time.iter().map(|t| (2.0 * t).cos() + 1.5 * (5.1 * t).cos()).collect();
        let true_acceleration: Vec<f64> =
            time.iter().map(|t| -2.0 * (2.0 * t).sin() - 7.65 * (5.1 * t).sin()).collect();
        let torque = true_acceleration.iter().zip(&speed).map(|(a, v)| 2.0 * a + 0.7 * v).collect();
        let measured = true_acceleration
            .iter()
            .map(|a| {
                let draw: f64 = StandardNormal.sample(&mut random);
                a + noise * draw
            })
            .collect();
        let motion = Motion {
            name: "axis".into(),
            rate,
            start: 0.0,
            q: vec![vec![0.0; time.len()]],
            dq: vec![speed],
            ddq: vec![measured],
            torque: vec![torque],
            fixed: vec![],
            edge_samples: 0,
        };
        let settings = ObserveSettings {
            band: 50.0,
            standstill: Standstill::Keep,
            acceleration_noise: vec![known * known],
            ..ObserveSettings::default()
        };
        observe(&model, &[motion], Equations::Torque, None, &settings, None).expect("rows")
    }

    #[test]
    fn an_inertia_that_noise_has_made_smaller_is_given_back() {
        let observation = observed(3.0, 3.0);
        let sigma = equal(&observation).sigma;
        let stacked = stack(&observation, &sigma);
        let biased = stacked.solve().chi;
        assert!(biased[0] < 1.6, "{biased:?}");
        let found = corrected(&observation, &[0, 1], &sigma, &stacked, &biased).expect("known noise").chi;
        assert!((found[0] - 2.0).abs() < 0.05 && (found[1] - 0.7).abs() < 0.1, "{found:?}");
    }

    #[test]
    fn what_noise_drowns_is_left_as_it_is_and_is_anything_up_to_twice_as_much() {
        let observation = observed(3.0, 9.0);
        let sigma = equal(&observation).sigma;
        let stacked = stack(&observation, &sigma);
        let chi = stacked.solve().chi;
        let found = corrected(&observation, &[0, 1], &sigma, &stacked, &chi).expect("known noise");
        assert!(found.hides_some);
        assert!((found.chi[0] / chi[0] - 1.0).abs() < 0.01, "{chi:?} {:?}", found.chi);
        assert!((found.deviation[0] / (UNCERTAINTY * chi[0]) - 1.0).abs() < 0.01);
        assert!(found.deviation[1] < 0.1 * chi[1]);
    }

    #[test]
    fn what_an_estimate_owes_to_its_own_errors_makes_no_direction_uncertain() {
        // Two unknowns of unit information: all of the first, and a tenth of the second is noise.
        let shares = DVector::from_row_slice(&[1.2, 0.1]);
        let directions =
            Directions::new(&DMatrix::identity(2, 2), &DMatrix::from_diagonal(&shares)).expect("root");
        let deviation = |found: [f64; 2]| directions.deviation(&DVector::from_row_slice(&found), 1.0);
        assert_eq!(deviation([1.0, 1.0]).as_slice(), [0.0, 0.0]);
        let far = deviation([3.0, 3.0]);
        let beyond = 8_f64.sqrt();
        assert!((far[0] - UNCERTAINTY * beyond).abs() < 1e-12, "hidden: anything up to twice as much");
        assert!((far[1] - UNCERTAINTY * beyond / 9.0).abs() < 1e-12, "corrected by 0.1 / (1 - 0.1)");
        let seen = directions.visible_noise();
        assert!(seen[(0, 0)].abs() < 1e-12 && (seen[(1, 1)] - 0.1).abs() < 1e-12);
    }
}
