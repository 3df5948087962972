//! Columns of the ten inertial parameters of every frame: IDM_st rows, power, and energy.
//!
//! The wrench that moves a link is linear in its ten parameters (Gautier and Khalil 1990); a row of IDM_st is its
//! product with the twist that a joint gives the link, and the power is its product with the link's own twist.

use super::kinematics::{Body, Link, is_independent, propagate};
use super::vector::{Mat3, Vec3, add, apply_transposed, cross, dot, scale};
use crate::model::{JointKind, Number};

/// The wrench at the origin of a frame per unit of each of its parameters.
struct Wrench<T> {
    /// Moments of XX XY XZ YY YZ ZZ.
    moments: [Vec3<T>; 6],
    /// Forces of MX MY MZ as columns: dw^ + w^ w^.
    forces: Mat3<T>,
    /// Force of M.
    dv: Vec3<T>,
}

impl<T: Number> Wrench<T> {
    #[inline(always)]
    fn new(body: &Body<T>) -> Wrench<T> {
        let zero = T::constant(0.0);
        let [x, y, z] = body.w;
        let [dx, dy, dz] = body.dw;
        let (xx, yy, zz) = (x * x, y * y, z * z);
        let (xy, xz, yz) = (x * y, x * z, y * z);
        Wrench {
            moments: [
                [dx, xz, -xy],
                [dy - xz, dx + yz, xx - yy],
                [dz + xy, zz - xx, dx - yz],
                [-yz, dy, xy],
                [yy - zz, dz - xy, dy + xz],
                [yz, -xz, dz],
            ],
            forces: [
                [zero - yy - zz, xy - dz, xz + dy],
                [xy + dz, zero - xx - zz, yz - dx],
                [xz - dy, yz + dx, zero - xx - yy],
            ],
            dv: body.dv,
        }
    }

    /// Product with the twist (w, v): the ten columns.
    #[inline(always)]
    fn on(&self, w: Vec3<T>, v: Vec3<T>) -> [T; 10] {
        let m = &self.moments;
        let first = add(apply_transposed(&self.forces, v), cross(self.dv, w));
        [
            dot(w, m[0]),
            dot(w, m[1]),
            dot(w, m[2]),
            dot(w, m[3]),
            dot(w, m[4]),
            dot(w, m[5]),
            first[0],
            first[1],
            first[2],
            dot(v, self.dv),
        ]
    }

    /// Product with the unit twist of the frame's own joint.
    #[inline(always)]
    fn on_own_axis(&self, kind: JointKind) -> [T; 10] {
        let zero = T::constant(0.0);
        let m = &self.moments;
        if kind == JointKind::Prismatic {
            let f = &self.forces[2];
            return [zero, zero, zero, zero, zero, zero, f[0], f[1], f[2], self.dv[2]];
        }
        let [dvx, dvy, _] = self.dv;
        [m[0][2], m[1][2], m[2][2], m[3][2], m[4][2], m[5][2], dvy, -dvx, zero, zero]
    }
}

/// Rows of IDM_st, rigid bodies only: calls `visit(joint, frame, columns)` for every frame and every joint between
/// it and the base, frames ascending, joints from the frame towards the base. `columns` are those of the frame's
/// XX XY XZ YY YZ ZZ MX MY MZ M in the row of the joint; blocks that are not visited are zero.
///
/// `q`, `dq`, `ddq` have one value per joint; at most [`super::MAX_FRAMES`] links.
#[inline(always)]
pub fn standard_idm<T: Number>(
    links: &[Link<T>],
    gravity: [T; 3],
    q: &[T],
    dq: &[T],
    ddq: &[T],
    mut visit: impl FnMut(usize, usize, &[T; 10]),
) {
    let bodies = propagate(links, gravity, q, dq, ddq);
    if !is_independent(links) {
        return dependent_idm(&bodies[..links.len()], q.len(), visit);
    }
    for (k, body) in bodies[..links.len()].iter().enumerate() {
        let wrench = Wrench::new(body);
        let mut at = Some(k);
        while let Some(a) = at {
            let ancestor = &bodies[a];
            if let [(joint, _)] = ancestor.terms.each() {
                let row = if a == k {
                    wrench.on_own_axis(ancestor.kind)
                } else {
                    let (w, v) = body.twist_of(ancestor);
                    wrench.on(w, v)
                };
                visit(*joint, k, &row);
            }
            at = ancestor.parent;
        }
    }
}

/// [`standard_idm`] of frames that move with several joints, or several with one: the twist that a joint gives a link is
/// the sum over the frames that it moves on the way to the base. Each joint and frame is visited once.
#[inline(always)]
fn dependent_idm<T: Number>(
    bodies: &[Body<T>],
    joints: usize,
    mut visit: impl FnMut(usize, usize, &[T; 10]),
) {
    let zero = [T::constant(0.0); 3];
    for (k, body) in bodies.iter().enumerate() {
        let wrench = Wrench::new(body);
        for joint in (0..joints).rev() {
            let (mut w, mut v) = (zero, zero);
            let mut moves = false;
            let mut at = Some(k);
            while let Some(a) = at {
                let ancestor = &bodies[a];
                if let Some(&(_, c)) = ancestor.terms.each().iter().find(|term| term.0 == joint) {
                    let (turned, swept) = body.twist_of(ancestor);
                    w = add(w, scale(T::constant(c), turned));
                    v = add(v, scale(T::constant(c), swept));
                    moves = true;
                }
                at = ancestor.parent;
            }
            if moves {
                visit(joint, k, &wrench.on(w, v));
            }
        }
    }
}

/// Power row dh_st of (10), rigid bodies only: calls `visit(frame, columns)` for every frame, ascending.
#[inline(always)]
pub fn standard_power<T: Number>(
    links: &[Link<T>],
    gravity: [T; 3],
    q: &[T],
    dq: &[T],
    ddq: &[T],
    mut visit: impl FnMut(usize, &[T; 10]),
) {
    let bodies = propagate(links, gravity, q, dq, ddq);
    for (k, body) in bodies[..links.len()].iter().enumerate() {
        visit(k, &Wrench::new(body).on(body.w, body.v));
    }
}

/// Energy row h_st of (10), rigid bodies only: calls `visit(frame, columns)` for every frame, ascending.
/// The potential is zero at the origin of frame 0.
#[inline(always)]
pub fn standard_energy<T: Number>(
    links: &[Link<T>],
    gravity: [T; 3],
    q: &[T],
    dq: &[T],
    mut visit: impl FnMut(usize, &[T; 10]),
) {
    let half = T::constant(0.5);
    // The accelerations of this recursion are not read.
    let bodies = propagate(links, gravity, q, dq, dq);
    for (k, body) in bodies[..links.len()].iter().enumerate() {
        let [x, y, z] = body.w;
        let kinetic = cross(body.v, body.w);
        let weight = apply_transposed(&body.rotation, gravity);
        visit(
            k,
            &[
                half * x * x,
                x * y,
                x * z,
                half * y * y,
                y * z,
                half * z * z,
                kinetic[0] - weight[0],
                kinetic[1] - weight[1],
                kinetic[2] - weight[2],
                half * dot(body.v, body.v) + body.potential(gravity),
            ],
        );
    }
}
