//! Columns of the base parameters where a number of the robot is far off.
//!
//! The torque of an error is the derivative of the model by it, which is made of the base parameters: of a large one the
//! parameters that were fitted without it are others than those that belong beside it. Then its torque is taken to follow them:
//! the columns of the base parameters are those of the robot that has the error (a step of Gauss and Newton). So they are where
//! the torque of a drive is recorded by a factor too large.

use crate::diagnosis::rows::additions::NumberError;
use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::design::Design;
use crate::diagnosis::rows::signals::Signals;
use crate::diagnosis::rules::NEAR_ERROR;
use crate::effects::EffectKind;
use crate::model::RecursiveModel;
use std::sync::Arc;

/// Columns of the base parameters beside errors of some laws.
#[derive(Debug, Clone)]
pub(in crate::diagnosis) struct Bent {
    pub errors: Vec<NumberError>,
    /// On the rows of a design.
    pub columns: Arc<Vec<Vec<f64>>>,
}

impl Bent {
    /// Whether these errors are so near that the columns do as well: where the parameters settle does not depend on them, only how
    /// soon they do.
    pub fn is_near(&self, errors: &[NumberError]) -> bool {
        self.errors.len() == errors.len() && self.errors.iter().zip(errors).all(|(own, e)| own.is_near(e))
    }
}

impl NumberError {
    fn is_near(&self, other: &Self) -> bool {
        (self.effect, self.place, self.in_baseline) == (other.effect, other.place, other.in_baseline)
            && self.errors.len() == other.errors.len()
            && self.errors.iter().zip(&other.errors).all(|(own, e)| (own - e).abs() <= NEAR_ERROR)
    }
}

impl Context<'_> {
    /// The columns of the base parameters on the rows of a design, of the robot and its drives as they are with `errors`, each of
    /// them large; of a parameter that is known, what the errors add to its column. `plain` are those without. `None` where there
    /// are no errors of these.
    pub fn bent(&self, (design, plain): (&Design, &[Vec<f64>]), errors: Vec<NumberError>) -> Option<Bent> {
        // All of them are changes, or none is.
        let is_change = !errors.first()?.in_baseline;
        // The design has no columns of known parameters.
        let whole = (!design.known.is_empty()).then(|| design.columns_of(self.model, self.signals));
        let plain = whole.as_deref().unwrap_or(plain);
        let mut columns = match NumberError::put_in(self.model.robot(), errors.iter()) {
            Some(there) => {
                let signals: Vec<Signals> = self.signals.iter().map(|s| s.seen_by(&there)).collect();
                design.columns_of(&RecursiveModel::new(there.robot).ok()?, &signals)
            }
            None => plain.to_vec(),
        };
        let of_drives = errors.iter().filter(|e| e.effect == EffectKind::TorqueConstantError);
        for (joint, error) in of_drives.filter_map(|e| e.place.joint().zip(e.errors.first())) {
            for column in &mut columns {
                column[design.of_joint(joint)].iter_mut().for_each(|x| *x *= 1.0 + error);
            }
        }
        if is_change {
            let old = |r: &usize| !self.signals[design.rows[*r].signal].is_target;
            for r in (0..design.rows.len()).filter(old) {
                columns.iter_mut().zip(plain).for_each(|(bent, plain)| bent[r] = plain[r]);
            }
        }
        for &(k, _) in &design.known {
            columns[k].iter_mut().zip(&plain[k]).for_each(|(bent, plain)| *bent -= plain);
        }
        Some(Bent { errors, columns: Arc::new(columns) })
    }
}
