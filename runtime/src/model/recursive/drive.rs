//! Columns of rotor inertias, friction and offsets, with any transmission matrix: (3), (9), (25) and (26).
//! Equation numbers are those of Gautier and Briot.

use super::error::RecursiveModelError;
use crate::model::{Number, ParameterKind, Robot};
use nalgebra::DMatrix;

/// What an entry is a function of.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Law {
    /// A linear form of ddq.
    Acceleration,
    /// A linear form of dq.
    Speed,
    /// The sign of a linear form of dq.
    Direction,
    /// 1.
    Constant,
}

/// One entry of IDM that does not come from a rigid body: scale * law(sum of coefficient * signal).
#[derive(Debug, Clone)]
pub(super) struct DriveEntry {
    /// Joint of the row.
    pub row: usize,
    /// Base parameter.
    pub column: usize,
    law: Law,
    scale: f64,
    form: Vec<(usize, f64)>,
}

impl DriveEntry {
    /// The entry of IDM.
    #[inline(always)]
    pub fn value<T: Number>(&self, dq: &[T], ddq: &[T]) -> T {
        let scale = T::constant(self.scale);
        match self.law {
            Law::Acceleration => scale * self.form_of(ddq),
            Law::Speed => scale * self.form_of(dq),
            Law::Direction => scale * self.form_of(dq).sign(),
            Law::Constant => scale,
        }
    }

    /// Twice the entry's share of its column's energy: dq_row * sum_s A[row][s] dq_s; zero for friction.
    #[inline(always)]
    pub fn twice_energy<T: Number>(&self, dq: &[T]) -> T {
        if self.law == Law::Acceleration {
            dq[self.row] * T::constant(self.scale) * self.form_of(dq)
        } else {
            T::constant(0.0)
        }
    }

    /// The entry's row of rotor inertia per unit parameter, where it is one: (joint, inertia).
    pub fn inertia(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        let form = if self.law == Law::Acceleration { self.form.as_slice() } else { &[] };
        form.iter().map(|&(s, c)| (s, self.scale * c))
    }

    #[inline(always)]
    fn form_of<T: Number>(&self, signal: &[T]) -> T {
        let mut sum = T::constant(0.0);
        for &(s, c) in &self.form {
            sum += T::constant(c) * signal[s];
        }
        sum
    }
}

/// The drive entries of every base column of the robot, rows ascending within a column.
pub(super) fn drive_entries(robot: &Robot) -> Result<Vec<DriveEntry>, RecursiveModelError> {
    let n = robot.joints();
    let gear = checked_gear(robot)?;
    let inertias = rotor_inertia_matrices(&gear);
    // N[m][s] / N[m][m]: the speed of motor m in units of its own joint.
    let relative = |m: usize, s: usize| gear[(m, s)] / gear[(m, m)];
    let speed_of_motor = |m: usize| -> Vec<(usize, f64)> {
        (0..n).map(|s| (s, relative(m, s))).filter(|&(_, c)| c != 0.0).collect()
    };
    let joint_of_frame = robot.joint_of_frame();
    let mut entries = Vec::new();
    for (column, base) in robot.base.iter().enumerate() {
        let standard = &robot.standard[base.standard];
        let Some(j) = joint_of_frame[standard.frame] else { continue };
        let mut push = |row, law, scale, form| entries.push(DriveEntry { row, column, law, scale, form });
        match standard.kind {
            ParameterKind::Ia => {
                for row in 0..n {
                    let form: Vec<_> =
                        (0..n).map(|s| (s, inertias[j][(row, s)])).filter(|&(_, c)| c != 0.0).collect();
                    if !form.is_empty() {
                        push(row, Law::Acceleration, 1.0, form);
                    }
                }
            }
            ParameterKind::Fv => push(j, Law::Speed, 1.0, vec![(j, 1.0)]),
            ParameterKind::Fc => push(j, Law::Direction, 1.0, vec![(j, 1.0)]),
            ParameterKind::Off => push(j, Law::Constant, 1.0, Vec::new()),
            ParameterKind::Fvm | ParameterKind::Fcm => {
                let law = if standard.kind == ParameterKind::Fvm { Law::Speed } else { Law::Direction };
                for (row, share) in speed_of_motor(j) {
                    push(row, law, share, speed_of_motor(j));
                }
            }
            _ => {}
        }
    }
    Ok(entries)
}

fn checked_gear(robot: &Robot) -> Result<DMatrix<f64>, RecursiveModelError> {
    let n = robot.joints();
    if robot.drive.gear.len() != n * n {
        return Err(RecursiveModelError::GearShape { found: robot.drive.gear.len(), joints: n });
    }
    let gear = DMatrix::from_row_slice(n, n, &robot.drive.gear);
    for m in 0..n {
        if gear[(m, m)] == 0.0 || !gear.row(m).iter().all(|g| g.is_finite()) {
            return Err(RecursiveModelError::GearDiagonal { motor: m + 1 });
        }
    }
    Ok(gear)
}

/// The matrix A_j with Ia_j A_j ddq the torque of rotor inertia, for each joint j.
///
/// Ia_j = sum_m N_mj^2 Ja_m (26) is inverted for the rotor inertias Ja. Where N∘N is singular, Ia_m stands for
/// N_mm^2 Ja_m.
fn rotor_inertia_matrices(gear: &DMatrix<f64>) -> Vec<DMatrix<f64>> {
    let n = gear.nrows();
    let largest = gear.amax();
    let unit = gear / largest;
    let squared = unit.component_mul(&unit).transpose();
    let svd = squared.clone().svd(false, false);
    let smallest = svd.singular_values.iter().copied().fold(f64::INFINITY, f64::min);
    let regular = n > 0 && smallest > 1e-12 * svd.singular_values.max();
    let rotors = squared
        .try_inverse()
        .filter(|_| regular)
        .unwrap_or_else(|| DMatrix::from_fn(n, n, |m, j| if m == j { unit[(m, m)].powi(-2) } else { 0.0 }));
    (0..n)
        .map(|j| {
            let mut a = DMatrix::zeros(n, n);
            for m in 0..n {
                a += rotors[(m, j)] * unit.row(m).transpose() * unit.row(m);
            }
            let scale = a.amax();
            // The inverse leaves rounding errors where the exact value is zero.
            a.map(|x: f64| if x.abs() < 1e-13 * scale { 0.0 } else { x })
        })
        .collect()
}
