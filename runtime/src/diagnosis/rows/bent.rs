//! Columns of the base parameters where a number of the robot is far off.
//!
//! The torque of an error is the derivative of the model by it, which is made of the base parameters: of a large one the
//! parameters that were fitted without it are others than those that belong beside it. Then its torque is taken to follow them:
//! the columns of the base parameters are those of the robot that has the error (a step of Gauss and Newton). So they are where
//! the torque of a drive is recorded by a factor too large.

use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rules::{LARGE_ERROR, NEAR_ERROR};
use crate::effects::{EffectKind, Place, corrected_at};
use crate::model::RecursiveModel;
use std::sync::Arc;

/// Columns of the base parameters beside errors of a law.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Bent {
    pub law: (EffectKind, Place),
    pub errors: Vec<f64>,
    /// On the rows of a design.
    pub columns: Arc<Vec<Vec<f64>>>,
}

impl Bent {
    /// Whether these errors of a law are so near that the columns do as well: where the parameters settle does not depend on them,
    /// only how soon they do.
    pub fn is_near(&self, law: (EffectKind, Place), errors: &[f64]) -> bool {
        self.law == law
            && self.errors.len() == errors.len()
            && self.errors.iter().zip(errors).all(|(own, e)| (own - e).abs() <= NEAR_ERROR)
    }
}

impl Context<'_> {
    /// The columns of the base parameters on the rows of a design, of the robot as it is with `errors` of an effect: in all
    /// motions, or in those of the recording where it is a `change`; `plain` are those without. `None` where the errors are small,
    /// or numbers of neither the robot nor its drives.
    pub fn bent(
        &self,
        (design, plain): (&Design, &[Vec<f64>]),
        law: (EffectKind, Place),
        errors: &[f64],
        change: bool,
    ) -> Option<Bent> {
        if errors.iter().all(|e| e.abs() < LARGE_ERROR) {
            return None;
        }
        let mut columns = match (law.0, law.1.joint()) {
            (EffectKind::TorqueConstantError, Some(joint)) => {
                larger_on(design.of_joint(joint), plain, 1.0 + errors[0])
            }
            _ => self.with_errors(design, law, errors)?,
        };
        if change {
            let old = |r: &usize| !self.signals[design.rows[*r].signal].is_target;
            for r in (0..design.rows.len()).filter(old) {
                columns.iter_mut().zip(plain).for_each(|(bent, plain)| bent[r] = plain[r]);
            }
        }
        Some(Bent { law, errors: errors.to_vec(), columns: Arc::new(columns) })
    }

    /// Those of the robot whose numbers are off by so much.
    fn with_errors(
        &self,
        design: &Design,
        (effect, place): (EffectKind, Place),
        errors: &[f64],
    ) -> Option<Vec<Vec<f64>>> {
        let there = corrected_at(self.model.robot(), effect.form().sensitivity()?, place.variant()?, errors)?;
        let mut signals = self.signals.to_vec();
        signals.iter_mut().for_each(|s| s.q = there.real_positions(&s.q));
        let model = RecursiveModel::new(there.robot).ok()?;
        Some(design.columns_of(&model, &signals))
    }
}

/// Columns with those rows so many times larger.
fn larger_on(rows: std::ops::Range<usize>, plain: &[Vec<f64>], factor: f64) -> Vec<Vec<f64>> {
    let mut columns = plain.to_vec();
    for column in &mut columns {
        column[rows.clone()].iter_mut().for_each(|x| *x *= factor);
    }
    columns
}
