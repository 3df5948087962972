//! Gains of the drives, and the unknown rest of a payload, from a recording without and one with it.

mod errors_in_torques;
mod rows;

use nalgebra::{DMatrix, DVector};

use super::observe::{Equations, Observation};
use super::payload::{KnownPayload, KnownPayloadError, PayloadBody, base_of_body};
use super::solve::inverse_gram;
use super::uncertainty::{Solved, covariance};
use super::weights::{Weights, iterate, stack};
use crate::model::Robot;
use errors_in_torques::{Direction, direction, independent};
use rows::{Both, Values};

/// A gain less than so many standard deviations away from zero is not determined: of nothing but noise, one in four hundred
/// gets as far.
const LEAST: f64 = 3.0;
/// Rounds of weights and solution. Each divides what is left to change by the ratio of signal to noise.
const ROUNDS: usize = 5;

/// What is known of the gain of a drive.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum DriveGain {
    /// What the recorded torque is multiplied by, or its ratio to the first determined one; with its standard deviation.
    Determined {
        /// N.m or N for each unit of the recording.
        value: f64,
        /// Standard deviation; zero for the gain that the others are ratios to.
        sigma: f64,
    },
    /// The rows do not tell it: the payload does not load this joint.
    Undetermined,
    /// Certain, but below zero: the torque or the position of this joint has the other sign.
    Negative {
        /// As of a determined one.
        value: f64,
        /// Standard deviation.
        sigma: f64,
    },
    /// A recording has no rows of this joint in motion.
    NoRows,
}

/// Gains of all drives, with what was found beside them.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveGains {
    /// One for each joint.
    pub gains: Vec<DriveGain>,
    /// Whether what is known gave the scale, the payload's mass or values of the robot's table; else gains, base parameters and
    /// payload are known but for a factor.
    pub absolute: bool,
    /// Base parameters of the robot without payload; with a scale, known ones have the values of the table.
    pub base: Vec<f64>,
    /// The payload; only with a scale.
    pub payload: Option<PayloadBody>,
    /// Errors over what was recorded, of the joints that were used.
    pub relative_error: Option<f64>,
}

/// Why there are no gains.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum DriveGainsError {
    /// Power models, or another robot.
    #[error("both recordings must be observed as torques of the same robot")]
    Shape,
    /// What is known of the payload cannot be used.
    #[error(transparent)]
    Payload(#[from] KnownPayloadError),
    /// The known mass is made up by unknowns.
    #[error(
        "what is known of the payload does not show beside what is not: give its centre, and inertia, or let joints move \
         whose torque depends on its mass"
    )]
    NoScale,
    /// No joint shows the payload.
    #[error(
        "no joint shows the payload: move it where gravity and acceleration load the joints, in both recordings alike, or \
         take a heavier one"
    )]
    Nothing,
}

/// Gains of drives by total least squares (Gautier and Briot 2014, "Global identification of joint drive gains and dynamic
/// parameters of robots").
///
/// The rows `diag(i) g - W chi = 0` without and `diag(i) g - W chi - W_L p - W_Lm m = 0` with a payload, i the recorded
/// torques in whatever unit, m what is known of it, are homogeneous in gains g, base parameters chi, unknowns p of the
/// payload and the factor of m, which is one. Base parameters whose values the robot's table has count as m in both
/// recordings; without a mass of the payload they give the scale where they determine a gain, else they are not used. Only the torques have errors. Each joint is weighted by its error, at first that
/// of a fit of the joint alone, then that of this solution, over its gain; the weighted solution is that of maximum likelihood.
/// Everything is done on the orthogonal factors of the observations.
///
/// Joints that can have any gain (their torques fit both recordings whatever it is) are taken out, those first without which
/// the others are most certain. Standard deviations are those of the weighted nonlinear least squares i = W x / g, for noise
/// that lasts where the observations kept their rows.
///
/// # Errors
/// [`DriveGainsError`].
pub fn drive_gains(
    robot: &Robot,
    unloaded: &Observation,
    loaded: &Observation,
    known: &KnownPayload,
) -> Result<DriveGains, DriveGainsError> {
    let fits = |o: &Observation| o.equations == Equations::Torque && o.unknowns.len() == robot.base.len();
    if !fits(unloaded) || !fits(loaded) {
        return Err(DriveGainsError::Shape);
    }
    let (added, split, fixed) = (base_of_body(robot), known.split()?, robot.fixed_base());
    let both = Both { observations: [unloaded, loaded], added, split, fixed };
    let in_table = both.fixed.iter().any(|(_, value)| *value != 0.0);
    match known.mass {
        None if in_table => scaled(robot, &both, true).or_else(|_| scaled(robot, &both, false)),
        mass => scaled(robot, &both, mass.is_some()),
    }
}

/// Gains with a scale, or their ratios.
fn scaled(robot: &Robot, both: &Both<'_>, absolute: bool) -> Result<DriveGains, DriveGainsError> {
    let ratios = (!absolute).then(|| both.of_ratios());
    let both = ratios.as_ref().unwrap_or(both);
    let [unloaded, loaded] = both.observations;
    let has_rows = |j: &usize| {
        let rows = |o: &Observation| o.groups.iter().any(|g| g.equation == *j && g.factor.rows() > 0);
        rows(unloaded) && rows(loaded)
    };
    let moving: Vec<usize> = (0..robot.joints()).filter(has_rows).collect();
    let search = Search { both, joints: robot.joints(), absolute };
    if absolute && !moving.is_empty() && !search.shows_what_is_known(&moving) {
        return Err(DriveGainsError::NoScale);
    }
    let found = search.decided(moving.clone())?;
    let described = search.described(&found, &moving);
    let is_open = |g: &DriveGain| matches!(g, DriveGain::Undetermined | DriveGain::NoRows);
    if absolute && described.gains.iter().all(is_open) {
        return Err(DriveGainsError::Nothing);
    }
    Ok(described)
}

/// A solution, and what it was found with.
struct Found {
    joints: Vec<usize>,
    values: Values,
    weights: Weights,
    undecided: usize,
    certainty: f64,
}

struct Search<'a> {
    both: &'a Both<'a>,
    joints: usize,
    absolute: bool,
}

impl Search<'_> {
    /// Whether the column of what is known is not made up by those of base parameters and of the payload's unknowns.
    fn shows_what_is_known(&self, joints: &[usize]) -> bool {
        let last = self.both.sizes().iter().sum::<usize>();
        let rows = self.both.homogeneous(joints, &self.both.errors().sigma, &vec![1.0; self.joints]);
        independent(&rows, last + 1).contains(&last)
    }

    /// The solution of as many joints as have gains that can be told.
    fn decided(&self, mut joints: Vec<usize>) -> Result<Found, DriveGainsError> {
        let least = if self.absolute { 1 } else { 2 };
        let mut found = self.solve(&joints);
        while joints.len() > least && found.as_ref().is_none_or(|f| f.undecided > 0) {
            let without = |out: usize| joints.iter().copied().filter(|&j| j != out).collect::<Vec<_>>();
            let tried = joints.iter().filter_map(|&out| self.solve(&without(out)));
            let better = |a: &Found, b: &Found| {
                b.undecided.cmp(&a.undecided).then(a.certainty.total_cmp(&b.certainty))
            };
            let best = tried.max_by(better).ok_or(DriveGainsError::Nothing)?;
            joints.clone_from(&best.joints);
            found = Some(best);
        }
        let found = found.filter(|f| f.undecided == 0).ok_or(DriveGainsError::Nothing)?;
        if joints.len() < least { Err(DriveGainsError::Nothing) } else { Ok(found) }
    }

    /// The solution with these joints, its weights iterated.
    fn solve(&self, joints: &[usize]) -> Option<Found> {
        let [base, free] = self.both.sizes();
        let exact = base + free + 1;
        let mut weights = self.both.errors();
        let mut gains = vec![1.0; self.joints];
        let mut found = None;
        for _ in 0..ROUNDS {
            let rows = self.both.homogeneous(joints, &weights.sigma, &gains);
            let of = |j: &usize| {
                let own = self.both.groups().zip(&weights.freedom).filter(|((_, g), _)| g.equation == *j);
                own.map(|(_, freedom)| freedom).sum::<f64>() / gains[*j].powi(2)
            };
            let squares: Vec<f64> = joints.iter().map(of).collect();
            let Direction { mut x, undecided, certainty } = direction(&rows, exact, &squares)?;
            let scale = self.scale(&x, exact, joints.len())?;
            x.iter_mut().for_each(|x| *x /= scale);
            let values = self.values(&x, joints);
            for &j in joints {
                gains[j] = values.gains[j].abs();
            }
            if !gains.iter().all(|g| g.is_finite() && *g > 0.0) {
                return None;
            }
            found = Some(Found {
                joints: joints.to_vec(),
                values,
                weights: weights.clone(),
                undecided,
                certainty,
            });
            let linearised = self.linearised(found.as_ref()?);
            let active = stack(&linearised, &weights.sigma).solve().kept;
            weights = iterate(&linearised, &active, &weights);
        }
        found
    }

    /// What the direction is divided by: the factor of what is known, or the first gain.
    fn scale(&self, x: &[f64], exact: usize, joints: usize) -> Option<f64> {
        let scale = if self.absolute { x[exact - 1] } else { x[exact] };
        let largest = x[exact..exact + joints].iter().fold(0.0_f64, |m, g| m.max(g.abs()));
        (scale.abs() > f64::EPSILON * largest).then_some(scale)
    }

    fn values(&self, x: &[f64], joints: &[usize]) -> Values {
        let [base, free] = self.both.sizes();
        let mut gains = vec![1.0; self.joints];
        for (&j, g) in joints.iter().zip(&x[base + free + 1..]) {
            gains[j] = *g;
        }
        let of_base = |l: usize| self.both.known_value(l).map_or(x[l], |value| value * x[base + free]);
        Values {
            gains,
            base: DVector::from_fn(base, |l, _| of_base(l)),
            free: DVector::from_column_slice(&x[base..base + free]),
        }
    }

    fn linearised(&self, found: &Found) -> Observation {
        let fixed = found.joints.first().copied().filter(|_| !self.absolute);
        self.both.linearised(&found.joints, fixed, &found.values)
    }

    /// Standard deviations, and words of what they mean.
    fn described(&self, found: &Found, moving: &[usize]) -> DriveGains {
        let linearised = self.linearised(found);
        let stacked = stack(&linearised, &found.weights.sigma);
        let solution = stacked.solve();
        let active = solution.kept;
        let together = covariance(&Solved {
            observation: &linearised,
            unknowns: &active,
            instruments: &active,
            noise_of_columns: None,
            weights: &found.weights.sigma,
            errors: &found.weights.sigma,
        });
        let together = together.unwrap_or_else(|| inverse_gram(&stacked.select(&active)));
        let place = |l: usize| active.binary_search(&l).ok();
        let gain = |j: usize| {
            if !moving.contains(&j) {
                return DriveGain::NoRows;
            }
            let Some(own) = found.joints.iter().position(|&k| k == j) else { return DriveGain::Undetermined };
            let value = found.values.gains[j];
            if !self.absolute && own == 0 {
                return DriveGain::Determined { value, sigma: 0.0 };
            }
            let Some(p) = place(own) else { return DriveGain::Undetermined };
            let sigma = value.abs() * together[(p, p)].sqrt();
            match value.abs() > LEAST * sigma {
                false => DriveGain::Undetermined,
                true if value < 0.0 => DriveGain::Negative { value, sigma },
                true => DriveGain::Determined { value, sigma },
            }
        };
        DriveGains {
            gains: (0..self.joints).map(gain).collect(),
            absolute: self.absolute,
            base: found.values.base.as_slice().to_vec(),
            payload: self.absolute.then(|| self.payload(found, &together, &solution.dependent, &active)),
            relative_error: relative_error(&linearised, found),
        }
    }

    /// The payload with what was known of it; what can be exchanged for something else is not determined.
    fn payload(
        &self,
        found: &Found,
        together: &DMatrix<f64>,
        dependent: &[Vec<usize>],
        active: &[usize],
    ) -> PayloadBody {
        let split = &self.both.split;
        let [base, free] = self.both.sizes();
        let first = found.joints.len() + base;
        let covariance = DMatrix::from_fn(free, free, |a, b| {
            match (active.binary_search(&(first + a)), active.binary_search(&(first + b))) {
                (Ok(a), Ok(b)) => together[(a, b)],
                _ => 0.0,
            }
        });
        let open = |f: usize| dependent.iter().any(|group| group.contains(&(first + f)));
        let is_determined = |k: usize| (0..free).all(|f| split.free[(k, f)] == 0.0 || !open(f));
        let determined: Vec<bool> = (0..10).map(is_determined).collect();
        let parameters = &split.known + &split.free * &found.values.free;
        PayloadBody::new(&parameters, &(&split.free * covariance * split.free.transpose()), &determined)
    }
}

/// Errors of the recorded torques over those torques, in units of their errors, of a solution.
fn relative_error(linearised: &Observation, found: &Found) -> Option<f64> {
    let stacked = stack(linearised, &found.weights.sigma);
    let mut x = vec![0.0; found.joints.len()];
    x.extend(found.values.base.iter().chain(found.values.free.iter()));
    let size = stacked.norm_y();
    (size > 0.0).then(|| stacked.residual_norm(&x) / size)
}
