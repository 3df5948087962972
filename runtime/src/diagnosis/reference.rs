//! What a model that was identified before says of a robot: its parameters and laws with their covariance.
//!
//! A recording that is judged against a reference has no rows of the robot before it changed. In their place stands what
//! the reference knows: its laws are taken out of the recorded torques, and the standard parameters and the amplitudes of
//! these laws are drawn to the reference's values by (x - x_ref)ᵀ Σ⁻¹ (x - x_ref), Σ their covariance. With weights that
//! are the inverse of the noise this is the normal equation of rows of the earlier recording that nobody has kept
//! (recursive least squares; Ljung, System Identification, 11.2).

use super::outcome::{BetweenMotions, Diagnosis};
use super::rows::prior::Prior;
use super::rules::DELAY_THERE;
use crate::effects::EffectTerm;
use crate::model::{ParameterKind, Robot};
use nalgebra::DMatrix;

/// A model of the robot before it changed.
#[derive(Debug, Clone, PartialEq)]
pub struct Reference {
    chi: Vec<f64>,
    effects: Vec<EffectTerm>,
    delay: f64,
    /// Its standard deviation, s; zero where nobody knows.
    delay_sigma: f64,
    covariance: DMatrix<f64>,
    /// Unknowns of `covariance` that the reference determines.
    known: Vec<usize>,
    diagonal: bool,
    /// Speeds below which a joint stands, rad/s or m/s, where they are known.
    standstill: Option<Vec<f64>>,
    /// How much each joint's torques differ between motions; empty where nobody knows.
    between_motions: Vec<Option<BetweenMotions>>,
}

/// Why a model cannot be a reference.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{what}")]
pub struct NoReference {
    /// What is wrong.
    pub what: String,
}

impl Reference {
    /// From base parameters `chi` (SI, the robot's order), effects that belong to the model, the skew of its torques (s) and
    /// the covariance of the base parameters followed by the amplitudes of all effects, in their order. Unknowns whose
    /// variance is not finite or not positive are not determined. `diagonal`: only variances were known.
    ///
    /// # Errors
    /// [`NoReference`] where the size of the covariance is another, or it is none.
    pub fn new(
        chi: Vec<f64>,
        effects: Vec<EffectTerm>,
        delay: f64,
        covariance: DMatrix<f64>,
        diagonal: bool,
    ) -> Result<Self, NoReference> {
        let unknowns = chi.len() + effects.iter().map(|e| e.amplitude.len()).sum::<usize>();
        if covariance.nrows() != unknowns || covariance.ncols() != unknowns {
            let size = covariance.nrows();
            return Err(NoReference { what: format!("a covariance of {size} numbers for {unknowns}") });
        }
        let known: Vec<usize> =
            (0..unknowns).filter(|&k| covariance[(k, k)].is_finite() && covariance[(k, k)] > 0.0).collect();
        let reference = Self {
            chi,
            effects,
            delay,
            delay_sigma: 0.0,
            covariance,
            known,
            diagonal,
            standstill: None,
            between_motions: Vec::new(),
        };
        let all: Vec<usize> = (0..unknowns).collect();
        if reference.prior(&all).is_none() {
            return Err(NoReference { what: "its covariance is not positive definite".to_owned() });
        }
        Ok(reference)
    }

    /// The model that a diagnosis ended with; `None` where it has no covariance.
    pub fn of(diagnosis: &Diagnosis) -> Option<Self> {
        let upper = diagnosis.covariance.as_ref()?;
        let n = ((8 * upper.len() + 1).isqrt() - 1) / 2;
        let covariance = DMatrix::from_fn(n, n, |i, k| {
            let (i, k) = (i.min(k), i.max(k));
            upper.get(i * n + k - i * (i + 1) / 2).copied().unwrap_or(0.0)
        });
        let (chi, delay) = (diagnosis.model.chi.clone(), diagnosis.delay);
        let reference = Self::new(chi, diagnosis.terms(), delay, covariance, false).ok()?;
        let reference = reference.delay_known_to(diagnosis.delay_sigma);
        let reference = reference.standing_below(diagnosis.sampling.standstill_speeds.clone());
        Some(reference.differing_by(diagnosis.between_motions.clone()))
    }

    /// The same with a delay that is known to this standard deviation, s. One that may be none is not taken out of other motion,
    /// which may show by how much it is wrong.
    pub fn delay_known_to(self, sigma: f64) -> Self {
        let is_there = self.delay.abs() > DELAY_THERE * sigma;
        Self { delay: if is_there { self.delay } else { 0.0 }, delay_sigma: sigma, ..self }
    }

    /// The same with the speeds below which each joint stood in its recording, rad/s or m/s: one in which nothing moves does
    /// not show them.
    pub fn standing_below(self, speeds: Vec<f64>) -> Self {
        Self { standstill: Some(speeds), ..self }
    }

    /// The same with how much each joint's torques differ from one motion to the next where nothing has changed, in the robot's
    /// order of joints.
    pub fn differing_by(self, between_motions: Vec<Option<BetweenMotions>>) -> Self {
        Self { between_motions, ..self }
    }

    /// How much each joint's torques differ between motions; empty where nobody knows.
    pub(super) fn between_motions(&self) -> &[Option<BetweenMotions>] {
        &self.between_motions
    }

    /// Its base parameters.
    pub fn chi(&self) -> &[f64] {
        &self.chi
    }

    /// Its laws.
    pub fn effects(&self) -> &[EffectTerm] {
        &self.effects
    }

    /// Skew of the torques behind the positions, s.
    pub fn delay(&self) -> f64 {
        self.delay
    }

    /// Its standard deviation, s; zero where nobody knows.
    pub(super) fn delay_sigma(&self) -> f64 {
        self.delay_sigma
    }

    /// Whether only variances are known, no covariances.
    pub fn is_diagonal(&self) -> bool {
        self.diagonal
    }

    /// Speeds below which a joint stands, where it knows them.
    pub(super) fn standstill(&self) -> Option<&[f64]> {
        self.standstill.as_deref()
    }

    /// Whether it knows the dry friction of each joint.
    pub(super) fn knows_friction(&self, robot: &Robot) -> Vec<bool> {
        let joint_of = robot.joint_of_frame();
        let is_known = |j: usize| {
            self.known.iter().filter_map(|&k| robot.base.get(k)).any(|base| {
                let parameter = &robot.standard[base.standard];
                parameter.kind == ParameterKind::Fc && joint_of[parameter.frame] == Some(j)
            })
        };
        (0..robot.joints()).map(is_known).collect()
    }

    /// Laws whose columns stand beside those of the model: those with free amplitudes that are torques of the robot.
    pub(super) fn standing(&self) -> impl Iterator<Item = &EffectTerm> {
        self.effects.iter().filter(|term| is_column(term))
    }

    /// What is known of the base parameters alone, beside values that the robot's table has.
    pub(super) fn prior_of_parameters(&self, known: &[(usize, f64)]) -> Option<Prior> {
        let places: Vec<usize> = (0..self.chi.len()).collect();
        Some(self.prior(&places)?.given(known))
    }

    /// What is known of the base parameters and of what the amplitudes of the standing laws differ by from those that were
    /// taken out of the torques, whose columns are `first` and following; beside values that the robot's table has.
    pub(super) fn prior_with_laws(&self, first: usize, known: &[(usize, f64)]) -> Option<Prior> {
        let mut places: Vec<usize> = (0..self.chi.len()).collect();
        let (mut from, mut columns) = (self.chi.len(), self.chi.len()..self.chi.len());
        let mut at: Vec<usize> = places.clone();
        let mut next = first;
        for term in &self.effects {
            columns = columns.end..from + term.amplitude.len();
            if is_column(term) {
                at.extend(next..next + columns.len());
                next += columns.len();
                places.extend(columns.clone());
            }
            from = columns.end;
        }
        Some(self.prior(&places)?.at(&places, &at).given(known))
    }

    /// Of some unknowns, whatever the others are.
    fn prior(&self, places: &[usize]) -> Option<Prior> {
        let known: Vec<usize> = places.iter().copied().filter(|k| self.known.contains(k)).collect();
        let covariance = self.covariance.select_rows(&known).select_columns(&known);
        // The amplitudes have been taken out of the torques: what they differ by is zero.
        let mean = known.iter().map(|&k| self.chi.get(k).copied().unwrap_or(0.0)).collect();
        Prior::of_covariance(&covariance, mean, known)
    }
}

/// Whether a law is a torque with amplitudes that are fitted: pushes and what is wrong with a recording are not, and the
/// amplitudes of a transmission say what it is made of.
fn is_column(term: &EffectTerm) -> bool {
    term.distortion().is_none() && term.transmission().is_none() && term.wrenches.is_empty()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_covariance_of_another_size_or_that_is_none_is_refused_and_what_is_not_determined_has_no_say() {
        let of = |covariance| Reference::new(vec![1.0, 2.0], Vec::new(), 0.0, covariance, false);
        assert!(of(DMatrix::identity(3, 3)).is_err());
        assert!(of(DMatrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 1.0])).is_err());
        let reference =
            of(DMatrix::from_row_slice(2, 2, &[0.25, 0.0, 0.0, f64::INFINITY])).expect("half of it is known");
        let (mut g, mut v) = (DMatrix::zeros(2, 2), nalgebra::DVector::zeros(2));
        reference.prior_of_parameters(&[]).expect("it is positive").add_to(&mut g, &mut v);
        assert_eq!((g[(0, 0)], g[(1, 1)], v[0], v[1]), (4.0, 0.0, 4.0, 0.0));
    }
}
