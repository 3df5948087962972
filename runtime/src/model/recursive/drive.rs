//! Columns of rotor inertias, friction, offsets and springs, with any transmission matrix: (3), (9), (25) and (26).
//! Equation numbers are those of Gautier and Briot.

use super::distance::Distance;
use super::error::RecursiveModelError;
use crate::model::{Between, Number, ParameterKind, Robot};
use nalgebra::DMatrix;

/// What an entry is a function of.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Law {
    /// A linear form of ddq.
    Acceleration,
    /// A linear form of dq.
    Speed,
    /// The sign of a linear form of dq.
    Direction,
    /// A linear form of q, less where it is at rest.
    Stretch(f64),
    /// 1.
    Constant,
    /// The slope of the distance of two points times what it is longer than at rest; without a rest the slope alone, which
    /// is that of KR but for its sign.
    Distance(Option<f64>),
}

impl Law {
    /// Of a parameter of a spring between two points.
    fn of_distance(kind: ParameterKind, between: &Between) -> Law {
        Law::Distance((kind == ParameterKind::K).then(|| between.rest.unwrap_or(0.0)))
    }
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
    /// What a spring between two points acts on.
    distance: Option<Distance>,
    /// Whether it holds the energy of its column, where that is no sum over rows.
    holds_energy: bool,
    /// Its torque has a potential that the energy row holds, and belongs to the bias of M ddq + N.
    pub is_spring: bool,
}

impl DriveEntry {
    /// The entry of IDM.
    #[inline(always)]
    pub fn value<T: Number>(&self, q: &[T], dq: &[T], ddq: &[T]) -> T {
        let scale = T::constant(self.scale);
        match self.law {
            Law::Acceleration => scale * self.form_of(ddq),
            Law::Speed => scale * self.form_of(dq),
            Law::Direction => scale * self.form_of(dq).sign(),
            Law::Stretch(rest) => scale * (self.form_of(q) - T::constant(rest)),
            Law::Constant => scale,
            Law::Distance(rest) => {
                let Some(distance) = &self.distance else { return T::constant(0.0) };
                let (square, slope) = distance.square_and_slope(q, self.row);
                scale * slope * level(square, rest)
            }
        }
    }

    /// Twice the entry's share of its column's energy: dq_row * sum_s A[row][s] dq_s, of a spring the share of the row in
    /// s (s - 2 s0), or in -2 s; zero for friction and offsets.
    #[inline(always)]
    pub fn twice_energy<T: Number>(&self, q: &[T], dq: &[T]) -> T {
        let scale = T::constant(self.scale);
        match self.law {
            Law::Acceleration => dq[self.row] * scale * self.form_of(dq),
            Law::Stretch(rest) => q[self.row] * scale * (self.form_of(q) - T::constant(2.0 * rest)),
            Law::Constant if self.is_spring => q[self.row] * scale * T::constant(2.0),
            Law::Distance(rest) if self.holds_energy => {
                let Some(distance) = &self.distance else { return T::constant(0.0) };
                let (square, _) = distance.square_and_slope(q, self.row);
                let twice_length = T::constant(2.0) * square * square.inverse_root();
                scale * rest.map_or(twice_length, |rest| square - T::constant(rest) * twice_length)
            }
            _ => T::constant(0.0),
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
    let joint_of_frame = robot.joint_of_frame();
    let mut entries: Vec<DriveEntry> = Vec::new();
    for (column, base) in robot.base.iter().enumerate() {
        let standard = &robot.standard[base.standard];
        let Some(j) = joint_of_frame[standard.frame] else { continue };
        let is_spring = standard.kind.is_spring();
        let law = standard.coupling.and_then(|k| robot.couplings.get(k)).map(|c| c.law);
        let plain = |row, law, scale, form| DriveEntry {
            row,
            column,
            law,
            scale,
            form,
            distance: None,
            holds_energy: false,
            is_spring,
        };
        if let Some(between) = law.and_then(|law| law.between()) {
            let of_row = |row, holds_energy| DriveEntry {
                distance: Some(Distance::new(robot, &between)),
                holds_energy,
                ..plain(row, Law::of_distance(standard.kind, &between), sign(standard.kind), Vec::new())
            };
            let rows = robot.acts_on(standard).into_iter().enumerate();
            entries.extend(rows.map(|(place, (row, _))| of_row(row, place == 0)));
            continue;
        }
        let rest = law.and_then(|law| law.rest()).unwrap_or(0.0);
        let mut push = |row, law, scale, form| entries.push(plain(row, law, scale, form));
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
            ParameterKind::Off => push(j, Law::Constant, 1.0, Vec::new()),
            kind => {
                let form = robot.acts_on(standard);
                for &(row, share) in &form {
                    match kind {
                        ParameterKind::K => push(row, Law::Stretch(rest), share, form.clone()),
                        ParameterKind::KR => push(row, Law::Constant, -share, Vec::new()),
                        _ if kind.is_viscous() => push(row, Law::Speed, share, form.clone()),
                        _ => push(row, Law::Direction, share, form.clone()),
                    }
                }
            }
        }
    }
    Ok(entries)
}

/// The pull of a spring per unit of K, and against it of KR.
fn sign(kind: ParameterKind) -> f64 {
    if kind == ParameterKind::KR { -1.0 } else { 1.0 }
}

/// Torque over l dl/dq of a distance l, per unit of K with a length at rest, or of -KR.
#[inline(always)]
fn level<T: Number>(square: T, rest: Option<f64>) -> T {
    let inverse = square.inverse_root();
    rest.map_or(inverse, |rest| T::constant(1.0) - T::constant(rest) * inverse)
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
