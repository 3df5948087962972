//! What a link can be made to do: the space of its velocities and the space of its energy rows.
//!
//! The energy of a link is e . (XX .. M), with a row e that is quadratic in its velocity and linear in the gravity
//! direction and height. Which combinations of parameters an energy can show depends only on the space that e spans
//! over all motions, and this space follows from the parent's by linear algebra (the parameter nullspace recursion of
//! Wensing, Niemeyer and Slotine 2017 applied to the energies of Gautier and Khalil 1990): a joint turns e by a
//! one-parameter group, so that the span over the joint variable is the smallest space closed under the generator.

use super::placement::{Inertia, Placement};
use crate::exact::{Form, Span, Surd};
use crate::robot::JointKind;

/// Length of an energy row: ten parameters, and 1 for the potential energy (0 for the kinetic).
pub(super) const ROW: usize = 11;

/// What the motions of one frame span.
#[derive(Clone, Default)]
pub(super) struct Attainable {
    /// Rows of the energy, `ROW` long.
    energy: Span,
    /// Velocities of the origin (3), angular velocities (3), and the joint velocities dq that go with them (n).
    velocity: Span,
}

impl Attainable {
    /// The base: it stands still, and gravity is what it is.
    pub fn base(gravity: &[Surd; 3], joints: usize) -> Attainable {
        let mut base = Attainable::default();
        let mut row = vec![Surd::zero(); ROW];
        for i in 0..3 {
            row[6 + i] = -&gravity[i];
        }
        row[ROW - 1] = Surd::one();
        base.energy.insert(row);
        for k in 0..joints {
            base.velocity.insert(unit(6 + joints, 6 + k));
        }
        base
    }

    /// A frame placed on this one, and what its joint makes visible.
    ///
    /// The second space has coordinates: ten parameters of the link, the joint's offset torque, then for each joint k
    /// the coefficient of dq_joint dq_k. A combination of parameters and rotor inertias depends on this joint's
    /// position or speed unless it is zero on all of that space.
    pub fn frame(&self, placement: &Placement, kind: JointKind, joint: Option<usize>) -> (Attainable, Span) {
        let matrix = parameter_matrix(placement);
        let carried: Vec<Vec<Surd>> = self.energy.vectors().map(|row| times_matrix(row, &matrix)).collect();
        let mut moved: Vec<Vec<Surd>> = self.velocity.vectors().map(|v| velocity_on(placement, v)).collect();
        let mut next = Attainable::default();
        let mut visible = Span::default();
        let Some(joint) = joint else {
            carried.into_iter().for_each(|row| _ = next.energy.insert(row));
            moved.into_iter().for_each(|v| _ = next.velocity.insert(v));
            return (next, visible);
        };

        // This joint's own speed turns or shifts the frame along its z.
        let own = if kind == JointKind::Revolute { 5 } else { 2 };
        let mut axis = unit(moved.first().map_or(0, Vec::len), own);
        for v in &mut moved {
            v[own] = &v[own] + &v[6 + joint];
        }
        axis[6 + joint] = Surd::one();
        next.velocity.insert_closed(moved, |v| velocity_rate(v, kind));
        let with_axis: Vec<Vec<Surd>> = next.velocity.vectors().map(|v| product_row(v, &axis)).collect();

        let joints = axis.len() - 6;
        let extended = |row: &[Surd], offset: &Surd| -> Vec<Surd> {
            let mut coordinates = row[..10].to_vec();
            coordinates.push(offset.clone());
            coordinates.resize(ROW + joints, Surd::zero());
            coordinates
        };
        for (v, row) in next.velocity.vectors().zip(&with_axis) {
            let mut coordinates = extended(row, &Surd::zero());
            coordinates[ROW..].clone_from_slice(&v[6..]);
            visible.insert(coordinates);
        }
        // The energy at q is e (1 + A q + A^2 q^2 / 2 + ..): all but the first term is visible. An offset torque has
        // the potential off q. No sine is linear in q, so beside a revolute joint it stands alone.
        let rate = |row: &[Surd]| parameter_rate(row, kind);
        let mut changes = Span::default();
        for row in &carried {
            let first = rate(row);
            let linear = if kind == JointKind::Prismatic { row[ROW - 1].clone() } else { Surd::zero() };
            visible.insert(extended(&first, &linear));
            changes.insert_closed(vec![rate(&first)], rate);
        }
        if kind == JointKind::Revolute {
            visible.insert(unit(ROW + joints, ROW - 1));
        }
        changes.vectors().for_each(|row| _ = visible.insert(extended(row, &Surd::zero())));

        next.energy.insert_closed(carried, rate);
        with_axis.into_iter().for_each(|row| _ = next.energy.insert(row));
        (next, visible)
    }
}

fn unit(length: usize, k: usize) -> Vec<Surd> {
    (0..length).map(|i| if i == k { Surd::one() } else { Surd::zero() }).collect()
}

/// Ten columns: each parameter alone, read at the parent's frame.
fn parameter_matrix(placement: &Placement) -> Vec<[Surd; 10]> {
    (0..10)
        .map(|k| {
            let mut body: Inertia = Default::default();
            body[k] = Form::one();
            placement.on_parent(&body).map(|form| form.value().clone())
        })
        .collect()
}

fn times_matrix(row: &[Surd], columns: &[[Surd; 10]]) -> Vec<Surd> {
    let mut result: Vec<Surd> = columns.iter().map(|column| dot(&row[..10], column)).collect();
    result.push(row[ROW - 1].clone());
    result
}

fn dot(a: &[Surd], b: &[Surd]) -> Surd {
    let products = a.iter().zip(b).filter(|(x, y)| !x.is_zero() && !y.is_zero()).map(|(x, y)| x * y);
    products.fold(Surd::zero(), |sum, x| &sum + &x)
}

fn cross(a: &[Surd], b: &[Surd]) -> [Surd; 3] {
    [0, 1, 2].map(|i: usize| {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        &(&a[j] * &b[k]) - &(&a[k] * &b[j])
    })
}

/// The velocity of a frame that is fixed at `placement` on a body that moves with v.
fn velocity_on(placement: &Placement, v: &[Surd]) -> Vec<Surd> {
    let origin: Vec<Surd> = placement.origin.iter().map(|form| form.value().clone()).collect();
    let swept = cross(&v[3..6], &origin);
    let linear: Vec<Surd> = (0..3).map(|i| &v[i] + &swept[i]).collect();
    let column = |j: usize| [0, 1, 2].map(|i: usize| placement.rotation[i][j].value().clone());
    let mut moved: Vec<Surd> = (0..3).map(|j| dot(&column(j), &linear)).collect();
    moved.extend((0..3).map(|j| dot(&column(j), &v[3..6])));
    moved.extend_from_slice(&v[6..]);
    moved
}

/// d/dq of a velocity in the moving frame of a joint.
fn velocity_rate(v: &[Surd], kind: JointKind) -> Vec<Surd> {
    let turn = |x: &[Surd]| [x[1].clone(), -&x[0], Surd::zero()];
    let mut rate = vec![Surd::zero(); v.len()];
    match kind {
        JointKind::Revolute => {
            rate[..3].clone_from_slice(&turn(&v[..3]));
            rate[3..6].clone_from_slice(&turn(&v[3..6]));
        }
        // omega x z
        _ => rate[..3].clone_from_slice(&turn(&v[3..6])),
    }
    rate
}

/// The energy row that two velocities have in common: T of v + w is that of v, that of w, and this.
fn product_row(v: &[Surd], w: &[Surd]) -> Vec<Surd> {
    let (a, b) = (&v[3..6], &w[3..6]);
    let mixed = |i: usize, j: usize| &(&a[i] * &b[j]) + &(&a[j] * &b[i]);
    let mut row = vec![&a[0] * &b[0], mixed(0, 1), mixed(0, 2), &a[1] * &b[1], mixed(1, 2), &a[2] * &b[2]];
    let (first, second) = (cross(&v[..3], b), cross(&w[..3], a));
    row.extend((0..3).map(|i| &first[i] + &second[i]));
    row.push(dot(&v[..3], &w[..3]));
    row.push(Surd::zero());
    row
}

/// d/dq of an energy row in the moving frame of a joint: the row times the generator of the parameters' motion.
fn parameter_rate(row: &[Surd], kind: JointKind) -> Vec<Surd> {
    let [xx, xy, xz, yy, yz] = [0, 1, 2, 3, 4].map(|k: usize| &row[k]);
    let [mx, my, mz] = [6, 7, 8].map(|k: usize| &row[k]);
    let twice = |x: &Surd| x + x;
    let mut rate = vec![Surd::zero(); ROW];
    match kind {
        // Body turned about z: dXX = -2 XY, dXY = XX - YY, dXZ = -YZ, dYY = 2 XY, dYZ = XZ, dMX = -MY, dMY = MX.
        JointKind::Revolute => {
            rate[0] = xy.clone();
            rate[1] = twice(&(yy - xx));
            rate[2] = yz.clone();
            rate[3] = -xy;
            rate[4] = -xz;
            rate[6] = my.clone();
            rate[7] = -mx;
        }
        // Body shifted along z: dXX = dYY = 2 MZ, dXZ = -MX, dYZ = -MY, dMZ = M.
        _ => {
            rate[6] = -xz;
            rate[7] = -yz;
            rate[8] = twice(&(xx + yy));
            rate[9] = mz.clone();
        }
    }
    rate
}
