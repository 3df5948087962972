//! Joint torques of rigid bodies by recursive Newton-Euler (Luh, Walker and Paul 1980).

use super::composite::Inertia;
use super::error::MAX_FRAMES;
use super::kinematics::{Link, is_independent, propagate};
use super::vector::{Vec3, add, apply, cross, dot, sub};
use crate::model::{JointKind, Number};

/// The joint torques that the motion of the bodies needs, by joint: N.m or N. `bodies` are the links' own.
///
/// Wrenches are summed in frame 0, at its origin, so that the transformations of the forward recursion serve again.
#[inline(always)]
pub(super) fn rigid_torques<T: Number>(
    (links, bodies): (&[Link<T>], &[Inertia; MAX_FRAMES]),
    gravity: [T; 3],
    [q, dq, ddq]: [&[T]; 3],
    mut emit: impl FnMut(usize, T),
) {
    let motion = propagate(links, gravity, q, dq, ddq);
    let mut carried: [(Vec3<T>, Vec3<T>); MAX_FRAMES] =
        [([T::constant(0.0); 3], [T::constant(0.0); 3]); MAX_FRAMES];
    let plain = is_independent(links);
    // Several frames may move with one joint.
    let mut torques = [T::constant(0.0); MAX_FRAMES];
    for k in (0..links.len()).rev() {
        let frame = &motion[k];
        let (force, moment) = bodies[k].wrench(frame.w, frame.dw, frame.dv);
        let force = apply(&frame.rotation, force);
        let moment = add(apply(&frame.rotation, moment), cross(frame.origin, force));
        let (force, moment) = (add(carried[k].0, force), add(carried[k].1, moment));
        let axis = frame.rotation.map(|row| row[2]);
        let on_axis = match frame.kind {
            JointKind::Revolute => dot(axis, sub(moment, cross(frame.origin, force))),
            JointKind::Prismatic => dot(axis, force),
            JointKind::Fixed => T::constant(0.0),
        };
        match frame.terms.each() {
            [(joint, _)] if plain => emit(*joint, on_axis),
            terms => terms.iter().for_each(|&(joint, c)| torques[joint] += T::constant(c) * on_axis),
        }
        if let Some(p) = frame.parent {
            carried[p] = (add(carried[p].0, force), add(carried[p].1, moment));
        }
    }
    if !plain {
        torques.iter().take(q.len()).enumerate().for_each(|(joint, torque)| emit(joint, *torque));
    }
}
