//! Columns of the base parameters where a number of the robot is far off.
//!
//! The torque of an error is the derivative of the model by it, which is made of the base parameters: of a large one the
//! parameters that were fitted without it are others than those that belong beside it. Then its torque is taken to follow them:
//! the columns of the base parameters are those of the robot that has the error (a step of Gauss and Newton). So they are where
//! the torque of a drive is recorded by a factor too large.

use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::signals::Signals;
use crate::diagnosis::rules::LARGE_ERROR;
use crate::effects::{EffectKind, Form, Place, corrected, numbers_at};
use crate::model::RecursiveModel;

impl Context<'_> {
    /// The columns of the base parameters on the rows of a design, of the robot as it is with `errors` of an effect: in all
    /// motions, or in those of the recording where it is a `change`. `None` where the errors are small, or numbers of neither the
    /// robot nor its drives.
    pub fn bent_columns(
        &self,
        design: &Design,
        (effect, place): (EffectKind, Place),
        errors: &[f64],
        change: bool,
    ) -> Option<Vec<Vec<f64>>> {
        if errors.iter().all(|e| e.abs() < LARGE_ERROR) {
            return None;
        }
        if let (EffectKind::TorqueConstantError, Some(joint)) = (effect, place.joint()) {
            return Some(self.larger_on(design, joint, 1.0 + errors[0], change));
        }
        let (Form::Sensitivity(law), Some(v)) = (effect.form(), place.variant()) else { return None };
        if law.in_recording(errors).is_some() {
            return None;
        }
        let robot = self.model.robot();
        let errors: Vec<_> = numbers_at(law, robot, v).into_iter().zip(errors.iter().copied()).collect();
        let there = corrected(robot, law, &errors);
        let model = RecursiveModel::new(there.robot).ok()?;
        let mut columns = design.columns_of(&model, &self.seen_beyond(&there.beyond_encoder));
        if change {
            let before =
                design.rows.iter().enumerate().filter(|(_, row)| !self.signals[row.signal].is_target);
            let before: Vec<usize> = before.map(|(r, _)| r).collect();
            let plain = design.columns_of(self.model, self.signals);
            for (bent, plain) in columns.iter_mut().zip(&plain) {
                before.iter().for_each(|&r| bent[r] = plain[r]);
            }
        }
        Some(columns)
    }

    /// The columns of the base parameters with those of one joint so many times larger.
    fn larger_on(&self, design: &Design, joint: usize, factor: f64, change: bool) -> Vec<Vec<f64>> {
        let mut columns = design.columns_of(self.model, self.signals);
        let is_larger = |&r: &usize| !change || self.signals[design.rows[r].signal].is_target;
        for column in &mut columns {
            design.of_joint(joint).filter(is_larger).for_each(|r| column[r] *= factor);
        }
        columns
    }

    /// The signals with each joint so much beyond where its encoder sees it.
    fn seen_beyond(&self, beyond: &[f64]) -> Vec<Signals> {
        let mut signals = self.signals.to_vec();
        for q in signals.iter_mut().flat_map(|s| s.q.iter_mut().zip(beyond)) {
            q.0.iter_mut().for_each(|x| *x += q.1);
        }
        signals
    }
}
