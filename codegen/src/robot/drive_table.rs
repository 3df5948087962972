//! Motors and transmission as the YAML says, and what rotor inertias act on.
//! Equation numbers are those of Gautier and Briot.

use crate::exact::{decimal, inverse};
use num_rational::BigRational;
use num_traits::Zero;

/// Motors and transmission: motor speed = gear * joint speed.
#[derive(Debug, Clone, PartialEq)]
pub struct DriveTable {
    /// n x n, row = motor, column = joint; identity where the YAML does not say.
    pub gear: Vec<Vec<f64>>,
    /// Motors, as 0-based joint indices, with friction at motor speed.
    pub coupled_friction: Vec<usize>,
}

impl DriveTable {
    /// Every motor drives its own joint one to one.
    pub fn direct(joints: usize) -> DriveTable {
        let gear = (0..joints).map(|m| (0..joints).map(|k| f64::from(u8::from(k == m))).collect()).collect();
        DriveTable { gear, coupled_friction: Vec::new() }
    }

    /// For each joint j the symmetric n x n matrix A_j of its rotor inertia: Ia_j contributes Ia_j * A_j * ddq to the
    /// joint torques and Ia_j * dqT A_j dq / 2 to the energy.
    ///
    /// Rotor m has the inertia Ja_m and the speed N_m dq (row m of the gear). As in (26), Ia_j = sum_m N_mj^2 Ja_m, so
    /// A_j = sum_m `(inverse of (N o N)^T)[m][j]` N_m^T N_m. Where N o N is singular (a differential), Ia_m stands
    /// for N_mm^2 Ja_m alone and A_m = N_m^T N_m / N_mm^2.
    pub(crate) fn rotor_matrices(&self) -> Vec<Vec<Vec<BigRational>>> {
        let gear = exact(&self.gear);
        let n = gear.len();
        let squares: Vec<Vec<_>> =
            (0..n).map(|j| (0..n).map(|m| &gear[m][j] * &gear[m][j]).collect()).collect();
        let share = inverse(&squares).unwrap_or_else(|| {
            let alone = |m: usize, j: usize| if m == j { squares[m][m].recip() } else { BigRational::zero() };
            (0..n).map(|m| (0..n).map(|j| alone(m, j)).collect()).collect()
        });
        let entry = |j: usize, i: usize, k: usize| {
            (0..n)
                .filter(|&m| !share[m][j].is_zero())
                .map(|m| &share[m][j] * &gear[m][i] * &gear[m][k])
                .fold(BigRational::zero(), |sum, x| sum + x)
        };
        (0..n).map(|j| (0..n).map(|i| (0..n).map(|k| entry(j, i, k)).collect()).collect()).collect()
    }
}

/// The gear in exact numbers.
pub(super) fn exact(gear: &[Vec<f64>]) -> Vec<Vec<BigRational>> {
    gear.iter().map(|row| row.iter().map(|&x| decimal(x)).collect()).collect()
}
