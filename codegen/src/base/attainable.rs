//! What a link can be made to do: the space of its velocities and the space of its energy rows.
//!
//! The energy of a link is e . (XX .. M), with a row e that is quadratic in its velocity and linear in the gravity
//! direction and height. Which combinations of parameters an energy can show depends only on the space that e spans
//! over all motions, and this space follows from the parent's by linear algebra (the parameter nullspace recursion of
//! Wensing, Niemeyer and Slotine 2017 applied to the energies of Gautier and Khalil 1990): a joint turns e by a
//! one-parameter group, so that the span over the joint variable is the smallest space closed under the generator.

use super::placement::{Inertia, Placement};
use crate::exact::{Form, Number, Span};
use dynid_description::JointKind;

/// Length of an energy row: ten parameters, and 1 for the potential energy (0 for the kinetic).
const ROW: usize = 11;
/// Coordinate of a joint's offset torque in [`Attainable::frame`]'s second space.
pub(super) const OFFSET: usize = 10;
/// Coordinate of dq_joint dq_0 there; the other joints follow.
pub(super) const SPEEDS: usize = 11;

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
    pub fn base(gravity: [Number; 3], joints: usize) -> Attainable {
        let mut base = Attainable::default();
        let mut row = unit(ROW, ROW - 1);
        for (x, g) in row[6..9].iter_mut().zip(gravity) {
            *x = -g;
        }
        base.energy.insert(row);
        (0..joints).for_each(|k| _ = base.velocity.insert(unit(6 + joints, 6 + k)));
        base
    }

    /// A frame placed on this one (`joint`: its kind and index; `None` where it is fixed), and what its joint makes
    /// visible.
    ///
    /// The second space has coordinates: ten parameters of the link, the joint's offset torque, then for each joint k
    /// the coefficient of dq_joint dq_k. A combination of parameters, offset and rotor inertias depends on this
    /// joint's position or speed unless it is zero on all of that space.
    pub fn frame(&self, placement: &Placement, joint: Option<(JointKind, usize)>) -> (Attainable, Span) {
        let columns = parameter_columns(placement);
        let carried: Vec<Vec<Number>> =
            self.energy.vectors().map(|row| times_columns(row, &columns)).collect();
        let mut moved: Vec<Vec<Number>> =
            self.velocity.vectors().map(|v| velocity_on(placement, v)).collect();
        let mut next = Attainable::default();
        let mut visible = Span::default();
        let Some((kind, joint)) = joint else {
            carried.into_iter().for_each(|row| _ = next.energy.insert(row));
            moved.into_iter().for_each(|v| _ = next.velocity.insert(v));
            return (next, visible);
        };
        let revolute = kind == JointKind::Revolute;

        // The joint's own speed turns or shifts the frame along its z.
        let own = if revolute { 5 } else { 2 };
        moved.iter_mut().for_each(|v| v[own] = v[own] + v[6 + joint]);
        let axis = unit(6, own);
        next.velocity.insert_closed(moved, |v| velocity_rate(v, kind));
        let with_axis: Vec<Vec<Number>> = next.velocity.vectors().map(|v| product_row(v, &axis)).collect();

        // The kinetic energy that depends on the joint's speed: dq_joint times a velocity.
        for (v, row) in next.velocity.vectors().zip(&with_axis) {
            visible.insert([&row[..ROW - 1], &[Number::ZERO], &v[6..]].concat());
        }
        // The energy at q is e (1 + A q + A^2 q^2 / 2 + ..): all but the first term is visible. An offset torque has
        // the potential off q. No sine is linear in q, so beside a revolute joint it stands alone.
        let speeds = vec![Number::ZERO; axis_count(&next)];
        let rate = |row: &[Number]| energy_rate(row, kind);
        let mut later = Span::default();
        for row in &carried {
            let first = rate(row);
            let offset = if revolute { Number::ZERO } else { row[ROW - 1] };
            visible.insert([&first[..ROW - 1], &[offset], &speeds].concat());
            later.insert_closed(vec![rate(&first)], rate);
        }
        later.vectors().for_each(|row| _ = visible.insert([row.as_slice(), &speeds].concat()));
        if revolute {
            visible.insert(unit(SPEEDS + speeds.len(), OFFSET));
        }

        next.energy.insert_closed(carried, rate);
        with_axis.into_iter().for_each(|row| _ = next.energy.insert(row));
        (next, visible)
    }
}

/// The number of joints of the robot.
fn axis_count(attainable: &Attainable) -> usize {
    attainable.velocity.vectors().next().map_or(0, |v| v.len() - 6)
}

fn unit(length: usize, k: usize) -> Vec<Number> {
    (0..length).map(|i| if i == k { Number::ONE } else { Number::ZERO }).collect()
}

/// Each parameter alone, read at the parent's frame.
fn parameter_columns(placement: &Placement) -> [[Number; 10]; 10] {
    std::array::from_fn(|k| {
        let mut body: Inertia = Default::default();
        body[k] = Form::one();
        placement.on_parent(&body).map(|form| form.value())
    })
}

fn times_columns(row: &[Number], columns: &[[Number; 10]; 10]) -> Vec<Number> {
    columns.iter().map(|column| dot(&row[..10], column)).chain([row[ROW - 1]]).collect()
}

fn dot(a: &[Number], b: &[Number]) -> Number {
    a.iter().zip(b).filter(|(x, y)| !x.is_zero() && !y.is_zero()).map(|(x, y)| *x * *y).sum()
}

fn cross(a: &[Number], b: &[Number]) -> [Number; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The velocity of a frame that is fixed at `placement` on a body that moves with v.
fn velocity_on(placement: &Placement, v: &[Number]) -> Vec<Number> {
    let origin = [0, 1, 2].map(|i: usize| placement.origin[i].value());
    let swept = cross(&v[3..6], &origin);
    let linear = [0, 1, 2].map(|i: usize| v[i] + swept[i]);
    let axes = [0, 1, 2].map(|j: usize| [0, 1, 2].map(|i: usize| placement.rotation[i][j].value()));
    let turned = |x: &[Number]| axes.map(|axis| dot(&axis, x));
    [&turned(&linear)[..], &turned(&v[3..6]), &v[6..]].concat()
}

/// d/dq of a velocity in the moving frame of a joint: x z for a revolute joint; the angular velocity x z for a
/// prismatic one.
fn velocity_rate(v: &[Number], kind: JointKind) -> Vec<Number> {
    let cross_z = |x: &[Number]| [x[1], -x[0], Number::ZERO];
    let still = [Number::ZERO; 3];
    let (linear, angular) = match kind {
        JointKind::Revolute => (cross_z(&v[..3]), cross_z(&v[3..6])),
        _ => (cross_z(&v[3..6]), still),
    };
    [&linear[..], &angular, &vec![Number::ZERO; v.len() - 6]].concat()
}

/// The energy row that two velocities have in common: twice the kinetic energy of v + w is that of v, that of w, and
/// twice this.
fn product_row(v: &[Number], w: &[Number]) -> Vec<Number> {
    let (a, b) = (&v[3..6], &w[3..6]);
    let mixed = |i: usize, j: usize| a[i] * b[j] + a[j] * b[i];
    let (first, second) = (cross(&v[..3], b), cross(&w[..3], a));
    let inertias = [a[0] * b[0], mixed(0, 1), mixed(0, 2), a[1] * b[1], mixed(1, 2), a[2] * b[2]];
    let moments = [0, 1, 2].map(|i: usize| first[i] + second[i]);
    [&inertias[..], &moments, &[dot(&v[..3], &w[..3]), Number::ZERO]].concat()
}

/// d/dq of an energy row in the moving frame of a joint: the row times the generator of the parameters' motion.
fn energy_rate(row: &[Number], kind: JointKind) -> Vec<Number> {
    let [xx, xy, xz, yy, yz] = [row[0], row[1], row[2], row[3], row[4]];
    let [mx, my, mz] = [row[6], row[7], row[8]];
    let zero = Number::ZERO;
    match kind {
        // A body turned about z: dXX = -2 XY, dXY = XX - YY, dXZ = -YZ, dYY = 2 XY, dYZ = XZ, dMX = -MY, dMY = MX.
        JointKind::Revolute => {
            let difference = yy - xx;
            vec![xy, difference + difference, yz, -xy, -xz, zero, my, -mx, zero, zero, zero]
        }
        // A body shifted along z: dXX = dYY = 2 MZ, dXZ = -MX, dYZ = -MY, dMZ = M.
        _ => {
            let sum = xx + yy;
            vec![zero, zero, zero, zero, zero, zero, -xz, -yz, sum + sum, mz, zero]
        }
    }
}
