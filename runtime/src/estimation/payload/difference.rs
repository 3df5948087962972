//! A payload by itself: what a recording with it says beyond a model without it.

use std::borrow::Cow;

use nalgebra::{Cholesky, DMatrix, DVector};

use super::known::base_of_body;
use super::quantities::PayloadBody;
use crate::estimation::observe::{Equations, Observation};
use crate::estimation::physical::nearest_body;
use crate::estimation::uncertainty::{Solved, covariance};
use crate::estimation::weights::{from_own_fits, iterate, stack};
use crate::model::Robot;

/// A direction among the scaled numbers of the payload with less information than this, relative to the most, is not
/// determined.
const DETERMINED: f64 = 1e-10;
/// A number of which this share lies in directions that are not determined is not determined itself.
const SHARE: f64 = 1e-6;
/// A payload lies within so many times the lengths of the robot's table of its last frame: what is farther away than the
/// robot reaches from end to end and back is not carried by it.
const REACH: f64 = 2.0;

/// A model without the payload.
#[derive(Debug, Clone, PartialEq)]
pub struct ReferenceModel {
    /// Base parameters.
    pub chi: Vec<f64>,
    /// Their covariance; a row and column of zeros is of one that the model does not determine, or whose value the robot's
    /// table has.
    pub covariance: DMatrix<f64>,
}

/// The payload that was found.
#[derive(Debug, Clone, PartialEq)]
pub struct PayloadFit {
    /// The nearest body that can be, with the standard deviations of the free fit.
    pub body: PayloadBody,
    /// Ten numbers as they were fitted: XX XY XZ YY YZ ZZ MX MY MZ M.
    pub free: [f64; 10],
    /// Squared distance of these numbers from the body, in the metric of their information: about as many as numbers that
    /// are determined, where they are one.
    pub cost: f64,
    /// Directions among the ten numbers that the rows determine.
    pub determined: usize,
    /// Base parameters of the robot with the payload, as the rows and the model together have them.
    pub chi: Vec<f64>,
}

/// Why there is no payload.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum PayloadError {
    /// A power model, or another robot.
    #[error("the recording must be observed as torques of the model's robot")]
    Shape,
    /// The model's covariance is none.
    #[error("the covariance of the model is not positive definite: identify the model again")]
    Covariance,
    /// Nothing is known of any number.
    #[error(
        "the recording and the model have no parameter in common that shows a payload: move the joints that the model was \
         identified with"
    )]
    Nothing,
}

/// The payload on the last link from a recording with it, the effects of the model taken out of its torques.
///
/// Base parameters of the robot as it was, chi, are known with their covariance; the ten numbers p of the payload add B p to
/// them (`base_of_body`). The weighted rows and the model are combined as information, so that neither need determine
/// everything, and chi is eliminated: J p = r with J = BT P (P + A)^-1 A B, P the information of the model and A that of the
/// rows. Values that the robot's table has are known for certain: they are not eliminated, and of these only what the payload
/// adds is looked for. Standard deviations are those of noise that lasts, where the observation kept its rows. What is then told is the
/// nearest body that can be ([`nearest_body`]).
///
/// # Errors
/// [`PayloadError`].
pub fn payload_of(
    robot: &Robot,
    loaded: &Observation,
    reference: &ReferenceModel,
) -> Result<PayloadFit, PayloadError> {
    let k = robot.base.len();
    let fits = loaded.equations == Equations::Torque && loaded.unknowns.len() == k;
    if !fits || reference.chi.len() != k || reference.covariance.shape() != (k, k) {
        return Err(PayloadError::Shape);
    }
    let added = base_of_body(robot);
    let rows = Information::of(&without_known(loaded, &added)).ok_or(PayloadError::Nothing)?;
    let (prior, known) = inverse_of_known(&reference.covariance).ok_or(PayloadError::Covariance)?;
    let mut chi = DVector::from_column_slice(&reference.chi);
    robot.fixed_base().into_iter().for_each(|(l, value)| chi[l] = value);
    let Elimination { inverse, scores } = Elimination::of(robot, &prior, &rows.information);
    let to_payload = added.transpose() * scores;
    let information = &to_payload * &rows.information * &added;
    let information = (&information + information.transpose()) * 0.5;
    let right = &to_payload * (&rows.right - &rows.information * &chi);
    let of_scores = &rows.spread + &rows.information * known * &rows.information;
    let spread = &to_payload * of_scores * to_payload.transpose();
    let found = pseudo_inverse(&information, DETERMINED);
    if found.rank == 0 {
        return Err(PayloadError::Nothing);
    }
    let numbers = &found.inverse * right;
    let covariance = &found.inverse * &spread * found.inverse.transpose();
    let metric = &information * pseudo_inverse(&spread, DETERMINED).inverse * &information;
    let body = nearest_body(&((&metric + metric.transpose()) * 0.5), &numbers, reach(robot))
        .ok_or(PayloadError::Nothing)?;
    let parameters = DVector::from_column_slice(&body.parameters);
    let with_payload = &chi + &added * &parameters;
    let left = &rows.right - &rows.information * &with_payload;
    Ok(PayloadFit {
        body: PayloadBody::new(&parameters, &covariance, &found.determined),
        free: std::array::from_fn(|i| numbers[i]),
        cost: body.cost,
        determined: found.rank,
        chi: (with_payload + inverse * left).as_slice().to_vec(),
    })
}

/// The equations less what is known in them, but for parameters that a payload adds to.
fn without_known<'a>(loaded: &'a Observation, added: &DMatrix<f64>) -> Cow<'a, Observation> {
    let stays = |l: usize| added.row(l).iter().all(|x| *x == 0.0);
    let fixed: Vec<(usize, f64)> = loaded.fixed.iter().copied().filter(|&(l, _)| stays(l)).collect();
    if fixed.is_empty() {
        return Cow::Borrowed(loaded);
    }
    let known = Observation { fixed, ..loaded.clone() };
    known.without_fixed().map_or(Cow::Owned(known), Cow::Owned)
}

/// Base parameters taken out of the equations, all but those whose values the robot's table has.
struct Elimination {
    /// From the scores of all base parameters to changes of those that are not known.
    inverse: DMatrix<f64>,
    /// From the scores of the rows to those of what is added to each base parameter, all that is not known being free.
    scores: DMatrix<f64>,
}

impl Elimination {
    /// `prior` and `rows`: information on all base parameters.
    fn of(robot: &Robot, prior: &DMatrix<f64>, rows: &DMatrix<f64>) -> Self {
        let k = rows.nrows();
        let fixed: Vec<usize> = robot.fixed_base().into_iter().map(|(l, _)| l).collect();
        let free: Vec<usize> = (0..k).filter(|l| !fixed.contains(l)).collect();
        let of_free = |all: &DMatrix<f64>| all.select_rows(&free).select_columns(&free);
        // What no one determines has no say: it is zero in both.
        let inverse = pseudo_inverse(&(of_free(prior) + of_free(rows)), f64::EPSILON * k as f64).inverse;
        let own = of_free(prior) * &inverse;
        let beside = rows.select_rows(&fixed).select_columns(&free) * &inverse;
        let mut all = Self { inverse: DMatrix::zeros(k, k), scores: DMatrix::zeros(k, k) };
        for (c, &l) in free.iter().enumerate() {
            for (r, &m) in free.iter().enumerate() {
                all.inverse[(m, l)] = inverse[(r, c)];
                all.scores[(m, l)] = own[(r, c)];
            }
            for (r, &m) in fixed.iter().enumerate() {
                all.scores[(m, l)] = -beside[(r, c)];
            }
        }
        fixed.iter().for_each(|&l| all.scores[(l, l)] = 1.0);
        all
    }
}

/// How far a payload can be from the last frame, m; nothing is known where the table has no lengths.
fn reach(robot: &Robot) -> Option<f64> {
    let length: f64 = robot.frames.iter().map(|f| f.d.abs() + f.b.abs() + f.r.abs()).sum();
    (length > 0.0).then_some(REACH * length)
}

/// WT V W of weighted rows, WT V Y, and the covariance of WT V e.
struct Information {
    information: DMatrix<f64>,
    right: DVector<f64>,
    spread: DMatrix<f64>,
}

impl Information {
    fn of(observation: &Observation) -> Option<Self> {
        let first = from_own_fits(observation);
        let active = stack(observation, &first.sigma).solve().kept;
        if active.is_empty() {
            return None;
        }
        let weights = iterate(observation, &active, &first);
        let all = stack(observation, &weights.sigma);
        let k = all.unknowns();
        let r = DMatrix::from_fn(k + 1, k, |i, l| all.r(i, l));
        let y = DVector::from_fn(k + 1, |i, _| all.r(i, k));
        let information = r.tr_mul(&r);
        let spread = covariance(&Solved {
            observation,
            unknowns: &active,
            instruments: &active,
            noise_of_columns: None,
            weights: &weights.sigma,
            errors: &weights.sigma,
        })
        .and_then(|all| spread_of_scores(&r, &active, &all));
        let spread = spread.unwrap_or_else(|| information.clone());
        Some(Self { right: r.tr_mul(&y), information, spread })
    }
}

/// Covariance of the scores of all columns of R from that of the estimate of independent ones: all columns are W_a T.
fn spread_of_scores(r: &DMatrix<f64>, active: &[usize], estimate: &DMatrix<f64>) -> Option<DMatrix<f64>> {
    let own = r.select_columns(active);
    let qr = own.qr();
    let made_of = qr.r().solve_upper_triangular(&(qr.q().tr_mul(r)))?;
    let scores = qr.r().tr_mul(&qr.r());
    let scores = &scores * estimate * &scores;
    Some(made_of.tr_mul(&(scores * &made_of)))
}

/// Information of what is known, zero elsewhere, and its covariance alike; `None` where that is not positive definite.
fn inverse_of_known(covariance: &DMatrix<f64>) -> Option<(DMatrix<f64>, DMatrix<f64>)> {
    let k = covariance.nrows();
    let variance = |l: usize| covariance[(l, l)];
    let known: Vec<usize> = (0..k).filter(|&l| variance(l) > 0.0 && variance(l).is_finite()).collect();
    let own = covariance.select_rows(&known).select_columns(&known);
    let scale = own.diagonal().map(|d| 1.0 / d.sqrt());
    let m = known.len();
    let scaled = DMatrix::from_fn(m, m, |i, l| scale[i] * own[(i, l)] * scale[l]);
    let inverse = Cholesky::new(scaled)?.inverse();
    let (mut information, mut kept) = (DMatrix::zeros(k, k), DMatrix::zeros(k, k));
    for (i, &a) in known.iter().enumerate() {
        for (l, &b) in known.iter().enumerate() {
            information[(a, b)] = scale[i] * inverse[(i, l)] * scale[l];
            kept[(a, b)] = own[(i, l)];
        }
    }
    Some((information, kept))
}

/// The inverse of a positive semidefinite matrix in the directions that it determines.
struct PseudoInverse {
    inverse: DMatrix<f64>,
    rank: usize,
    /// Whether each unknown lies in these directions.
    determined: Vec<bool>,
}

/// By way of a matrix with a unit diagonal; eigenvalues below `least` times the largest count as zero.
fn pseudo_inverse(matrix: &DMatrix<f64>, least: f64) -> PseudoInverse {
    let k = matrix.nrows();
    let scale = matrix.diagonal().map(|d| if d > 0.0 { 1.0 / d.sqrt() } else { 0.0 });
    let scaled = DMatrix::from_fn(k, k, |i, l| scale[i] * matrix[(i, l)] * scale[l]);
    let eigen = scaled.symmetric_eigen();
    let largest = eigen.eigenvalues.max();
    let mut inverse = DMatrix::zeros(k, k);
    let mut part = DVector::<f64>::zeros(k);
    let mut rank = 0;
    for (value, v) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
        if *value > least * largest {
            inverse += v * v.transpose() / *value;
            part += v.component_mul(&v);
            rank += 1;
        }
    }
    let inverse = DMatrix::from_fn(k, k, |i, l| scale[i] * inverse[(i, l)] * scale[l]);
    PseudoInverse { inverse, rank, determined: part.iter().map(|p| *p > 1.0 - SHARE).collect() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_matrix_is_inverted_where_it_says_something_and_nowhere_else() {
        // A direction of the last two is not there; units differ by orders of magnitude.
        let root = DMatrix::from_row_slice(2, 3, &[2.0, 0.0, 0.0, 0.0, 1e6, 1e3]);
        let found = pseudo_inverse(&root.tr_mul(&root), 1e-10);
        assert_eq!((found.rank, found.determined), (2, vec![true, false, false]));
        approx::assert_relative_eq!(found.inverse[(0, 0)], 0.25, epsilon = 1e-12);
    }

    #[test]
    fn what_a_model_does_not_determine_has_no_information() {
        let covariance = DMatrix::from_diagonal(&DVector::from_vec(vec![4.0, 0.0, f64::INFINITY]));
        let (information, known) = inverse_of_known(&covariance).expect("it is positive");
        assert_eq!(information, DMatrix::from_diagonal(&DVector::from_vec(vec![0.25, 0.0, 0.0])));
        assert_eq!(known[(0, 0)], 4.0);
        let none = DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 1.0]);
        assert!(inverse_of_known(&none).is_none());
    }

    #[test]
    fn scores_of_columns_that_depend_on_others_are_made_of_theirs() {
        let r = DMatrix::from_row_slice(2, 3, &[1.0, 0.5, 2.5, 0.0, 2.0, 2.0]);
        let scores = r.tr_mul(&r);
        // The estimate of independent columns under white noise has the inverse of their information as covariance.
        let own = r.columns(0, 2).into_owned();
        let estimate = own.tr_mul(&own).try_inverse().expect("independent");
        let spread = spread_of_scores(&r, &[0, 1], &estimate).expect("independent");
        approx::assert_relative_eq!(spread, scores, epsilon = 1e-9);
    }
}
