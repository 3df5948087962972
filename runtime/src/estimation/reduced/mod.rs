//! What is kept of the torque equations of a recording for a fleet: one triangle, its rows divided by their errors.
//!
//! An [`Observation`] keeps a triangle for each joint, motion and block of time, from which weights and the spread of the
//! blocks are found. When they are found, the rows divided by their standard deviations are one system of equations, whose
//! triangle is all that its solution needs, and triangles of several recordings of one robot merge. What noise in the
//! columns adds to it, and by how much errors that last make the variances larger than those of independent ones, goes
//! with it, so that values and standard deviations of one recording are those of [`estimate`](super::estimate()).

mod bytes;
mod solve;
#[cfg(test)]
mod tests;

use nalgebra::DMatrix;

use super::Factor;
use super::attenuation::UNCERTAINTY;
use super::observe::Observation;
use super::outcome::Estimate;
use crate::model::Robot;
use crate::model_file::fingerprint;

pub use solve::ReducedEstimate;

/// The weighted torque equations of motions of one robot.
///
/// Merging is associative and commutative up to rounding: in another order, parameters differ by less than a millionth of
/// their standard deviations.
#[derive(Debug, Clone, PartialEq)]
pub struct Reduced {
    /// Which robot's table it is of.
    fingerprint: String,
    /// Name and unit of each unknown.
    parameters: Vec<(String, String)>,
    /// Unknowns whose values are known beforehand; their torques are not in Y.
    fixed: Vec<(usize, f64)>,
    /// R of the rows divided by the standard deviations of their errors.
    factor: Factor,
    /// Part of WT W that is noise in the columns; `None` where it is not known of every motion.
    noise: Option<DMatrix<f64>>,
    /// For each unknown the sum over rows of what errors that last multiply its variance by; rows of recordings that do
    /// not determine it count in `known`, which has the rows that do.
    inflation: Vec<f64>,
    known: Vec<f64>,
    samples: usize,
}

/// Why triangles cannot be merged or read.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum ReducedError {
    /// They are of two robots.
    #[error(
        "factors of two robots ({own} and {other}): group by robot, and reduce recordings of a robot with one table"
    )]
    OtherRobot {
        /// Fingerprint of one.
        own: String,
        /// Fingerprint of the other.
        other: String,
    },
    /// Bytes that [`Reduced::to_bytes`] did not write.
    #[error("these are no factors: {0}")]
    NoFactors(&'static str),
}

impl Reduced {
    /// The equations of one motion of an observation of torques, or of all of them, divided by the errors that an estimate
    /// from all of them found.
    pub fn of(
        observation: &Observation,
        estimate: &Estimate,
        robot: &Robot,
        motion: Option<usize>,
    ) -> Reduced {
        let free = observation.without_fixed();
        let free = free.as_ref().unwrap_or(observation);
        let count = robot.base.len();
        let mut factor = Factor::new(count);
        let mut noise = free.noise_of_columns.as_ref().map(|_| DMatrix::zeros(count, count));
        for (k, group) in free.groups.iter().enumerate() {
            let asked = motion.is_none_or(|motion| motion == group.trajectory);
            let sigma = estimate
                .errors
                .iter()
                .find(|e| (e.trajectory, e.equation) == (group.trajectory, group.equation) && e.rows > 0);
            let Some(sigma) = sigma.and_then(|e| e.sigma).filter(|_| asked && group.factor.rows() > 0) else {
                continue;
            };
            factor.merge_weighted(&group.factor, &group.columns, 1.0 / sigma);
            let own = free.noise_of_columns.as_ref().and_then(|all| all.get(k));
            if let (Some(all), Some(own)) = (&mut noise, own) {
                add_noise(all, own, &group.columns, sigma);
            }
        }
        let rows = factor.rows() as f64;
        let inflation: Vec<Option<f64>> = (0..count).map(|l| inflation(estimate, l)).collect();
        let samples = if motion.is_none_or(|motion| motion == 0) { observation.samples } else { 0 };
        Reduced {
            fingerprint: fingerprint(robot),
            parameters: robot.base.iter().map(|b| (b.name.to_string(), b.unit.to_string())).collect(),
            fixed: observation.fixed.clone(),
            factor,
            noise,
            inflation: inflation.iter().map(|i| i.map_or(0.0, |i| rows * i)).collect(),
            known: inflation.iter().map(|i| i.map_or(0.0, |_| rows)).collect(),
            samples,
        }
    }

    /// Takes in the equations of other motions of the same robot.
    ///
    /// # Errors
    /// [`ReducedError::OtherRobot`].
    pub fn merge(&mut self, other: &Reduced) -> Result<(), ReducedError> {
        if self.fingerprint != other.fingerprint || self.parameters.len() != other.parameters.len() {
            let (own, other) = (self.fingerprint.clone(), other.fingerprint.clone());
            return Err(ReducedError::OtherRobot { own, other });
        }
        self.factor.merge(&other.factor);
        self.noise = match (self.noise.take(), &other.noise) {
            (Some(own), Some(other)) => Some(own + other),
            _ => None,
        };
        for (own, other) in [(&mut self.inflation, &other.inflation), (&mut self.known, &other.known)] {
            own.iter_mut().zip(other).for_each(|(own, other)| *own += other);
        }
        self.samples += other.samples;
        Ok(())
    }

    /// Fingerprint of the robot's table, as [`fingerprint`] makes it.
    pub fn fingerprint(&self) -> &str {
        &self.fingerprint
    }

    /// Name and unit of each parameter.
    pub fn parameters(&self) -> &[(String, String)] {
        &self.parameters
    }

    /// Equations of all joints.
    pub fn rows(&self) -> usize {
        self.factor.rows()
    }

    /// Samples of the recordings that were read, all joints counted once.
    pub fn samples(&self) -> usize {
        self.samples
    }

    /// ||Y - W chi||, each row divided by its standard deviation, for any parameters in the order of
    /// [`Reduced::parameters`]: about the square root of the rows for those of the recording itself.
    ///
    /// # Errors
    /// Another number of parameters.
    pub fn residual_norm(&self, chi: &[f64]) -> Result<f64, ReducedError> {
        if chi.len() != self.parameters.len() {
            return Err(ReducedError::NoFactors("another number of parameters"));
        }
        Ok(self.factor.residual_norm(chi))
    }
}

/// Adds the noise in the columns of a group, whose rows are divided by `sigma`.
fn add_noise(all: &mut DMatrix<f64>, own: &DMatrix<f64>, columns: &[usize], sigma: f64) {
    for (a, &i) in columns.iter().enumerate() {
        for (b, &l) in columns.iter().enumerate() {
            all[(i, l)] += own[(a, b)] / (sigma * sigma);
        }
    }
}

/// How many times the variance of a parameter for errors that are independent from row to row its variance is, without
/// that of what was added for noise in its columns. `None` where it is not determined.
fn inflation(estimate: &Estimate, l: usize) -> Option<f64> {
    let parameter = estimate.parameters.get(l)?;
    let (sigma, white) = (parameter.sigma?, parameter.sigma_white.filter(|white| *white > 0.0)?);
    let of_correction = UNCERTAINTY * parameter.correction.unwrap_or(0.0);
    let variance = (sigma.powi(2) - of_correction.powi(2)).max(0.0);
    Some(variance / white.powi(2)).filter(|inflation| inflation.is_finite())
}
