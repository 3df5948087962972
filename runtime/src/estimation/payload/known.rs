//! What is known of a payload, and which numbers of it are left to be found.

use nalgebra::{DMatrix, DVector};

use crate::model::Robot;

/// What a person knows of a payload: SI units, in the last frame of the table.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct KnownPayload {
    /// kg.
    pub mass: Option<f64>,
    /// Centre of mass, m.
    pub centre: Option<[f64; 3]>,
    /// Entries XX XY XZ YY YZ ZZ of the inertia matrix about the centre of mass, axes of the frame, kg.m²; XY is -∫xy dm.
    pub inertia: Option<[f64; 6]>,
}

/// Why what is said to be known of a payload cannot be used.
#[derive(Debug, Clone, Copy, PartialEq, Eq, thiserror::Error)]
pub enum KnownPayloadError {
    /// A number that is infinite or none.
    #[error("a number is not finite")]
    NotFinite,
    /// No mass.
    #[error("the mass must be above zero; leave it out where it is not known")]
    Mass,
    /// The inertia at the frame's origin follows from that about the centre and from where the centre is.
    #[error(
        "an inertia about the centre of mass says nothing without mass and centre: give them too, or leave it out"
    )]
    InertiaAlone,
}

/// The ten inertial parameters XX XY XZ YY YZ ZZ MX MY MZ M of a payload as known + free f.
#[derive(Debug, Clone, PartialEq)]
pub(in crate::estimation) struct Split {
    /// 10 values, zero where the mass is not known.
    pub known: DVector<f64>,
    /// 10 rows, a column for each unknown.
    pub free: DMatrix<f64>,
}

impl KnownPayload {
    /// Checks it, and says what is left.
    ///
    /// # Errors
    /// What cannot be, or does not help.
    pub(in crate::estimation) fn split(&self) -> Result<Split, KnownPayloadError> {
        let numbers =
            self.mass.iter().chain(self.centre.iter().flatten()).chain(self.inertia.iter().flatten());
        if numbers.into_iter().any(|x| !x.is_finite()) {
            return Err(KnownPayloadError::NotFinite);
        }
        if self.mass.is_some_and(|m| m <= 0.0) {
            return Err(KnownPayloadError::Mass);
        }
        let mut unit = DVector::zeros(10);
        unit[9] = 1.0;
        let mut columns: Vec<usize> = (0..9).collect();
        if let Some(centre) = self.centre {
            unit.rows_mut(6, 3).copy_from_slice(&centre);
            columns.truncate(6);
        }
        match (self.mass, self.centre, self.inertia) {
            (Some(_), Some([x, y, z]), Some(inertia)) => {
                let steiner = [y * y + z * z, -x * y, -x * z, x * x + z * z, -y * z, x * x + y * y];
                unit.rows_mut(0, 6).copy_from_slice(&steiner);
                let mut known = unit * self.mass.unwrap_or(0.0);
                for k in 0..6 {
                    known[k] += inertia[k];
                }
                return Ok(Split { known, free: DMatrix::zeros(10, 0) });
            }
            (_, _, Some(_)) => return Err(KnownPayloadError::InertiaAlone),
            _ => {}
        }
        let mut free = DMatrix::zeros(10, columns.len() + usize::from(self.mass.is_none()));
        for &k in &columns {
            free[(k, k)] = 1.0;
        }
        if self.mass.is_none() {
            free.set_column(columns.len(), &unit);
        }
        Ok(Split { known: unit * self.mass.unwrap_or(0.0), free })
    }
}

/// What each of the ten inertial parameters of a body on the flange, [`Robot::flange`], adds to each base parameter: base
/// parameters x 10.
///
/// Such a body changes the standard parameters of that frame and nothing else, so that its columns of the regressor are
/// those of the base parameters times this matrix.
pub(in crate::estimation) fn base_of_body(robot: &Robot) -> DMatrix<f64> {
    let mut added = DMatrix::zeros(robot.base.len(), 10);
    let Some(frame) = robot.flange() else { return added };
    for k in 0..10 {
        let mut unit = [0.0; 10];
        unit[k] = 1.0;
        let standard = robot.standard_of_body(frame, &unit);
        added.set_column(k, &DVector::from_vec(robot.base_from_standard(&standard)));
    }
    added
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_known_and_what_is_free_make_up_every_body_that_agrees() {
        let known = KnownPayload { mass: Some(2.0), centre: Some([0.1, 0.2, 0.3]), inertia: None };
        let split = known.split().expect("it is one");
        assert_eq!((split.free.ncols(), split.known[9], split.known[8]), (6, 2.0, 0.6));
        let all = KnownPayload { inertia: Some([0.01, 0.0, 0.0, 0.02, 0.0, 0.025]), ..known };
        let split = all.split().expect("it is one");
        assert_eq!(split.free.ncols(), 0);
        approx::assert_relative_eq!(split.known[0], 0.01 + 2.0 * (0.04 + 0.09), epsilon = 1e-12);
        approx::assert_relative_eq!(split.known[1], -2.0 * 0.02, epsilon = 1e-12);
        assert_eq!(KnownPayload::default().split().expect("it is one").free.ncols(), 10);
        let line = KnownPayload { mass: None, ..known }.split().expect("it is one");
        assert_eq!((line.free.ncols(), line.free[(8, 6)], line.free[(9, 6)]), (7, 0.3, 1.0));
    }

    #[test]
    fn what_cannot_be_or_does_not_help_is_refused() {
        let of = |mass, centre, inertia| KnownPayload { mass, centre, inertia }.split().err();
        assert_eq!(of(Some(0.0), None, None), Some(KnownPayloadError::Mass));
        assert_eq!(of(Some(f64::NAN), None, None), Some(KnownPayloadError::NotFinite));
        assert_eq!(of(Some(1.0), None, Some([0.0; 6])), Some(KnownPayloadError::InertiaAlone));
    }
}
