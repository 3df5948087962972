//! Motion of every frame: angular velocity and acceleration, acceleration of the origin, and the joint screws.

use super::geometry::{Geometry, Link, angle_rate};
use super::vector::{self, Vector};
use crate::symbolic::{Angle, Expr, Graph, Symbol};
use dynid_description::JointKind;

/// Motion of one frame, in its own axes.
#[derive(Debug, Clone, Copy)]
pub struct FrameMotion {
    /// Angular velocity w.
    pub w: Vector,
    /// Angular acceleration.
    pub dw: Vector,
    /// Acceleration of the origin minus gravity.
    pub a: Vector,
    /// U = skew(dw) + skew(w)^2: what turns a first moment into a force.
    pub u: [Vector; 3],
}

/// A joint as seen from a frame it carries: the velocity that a unit joint rate gives.
#[derive(Debug, Clone, Copy)]
pub struct Screw {
    /// The joint.
    pub joint: usize,
    /// Angular velocity, in the axes of the frame.
    pub axis: Vector,
    /// Velocity of the origin of the frame.
    pub lever: Vector,
}

/// Motions of all frames. Without accelerations, ddq is zero.
pub fn frame_motions(g: &mut Graph, geometry: &Geometry, accelerations: bool) -> Vec<FrameMotion> {
    let base_acceleration = geometry.gravity.map(|x| g.constant(-x));
    let rest = FrameMotion { w: vector::ZERO, dw: vector::ZERO, a: base_acceleration, u: [vector::ZERO; 3] };
    let mut motions: Vec<FrameMotion> = Vec::with_capacity(geometry.links.len());
    for link in &geometry.links {
        let parent = link.parent.map_or(rest, |p| motions[p]);
        let reference = link.reference.map_or(rest, |p| motions[p]);
        let (angular, linear) = accelerations_of(g, link, accelerations);
        let rate = angle_rate(g, &link.from_reference.angle, Symbol::Velocity);
        let mut w = link.from_reference.inward(g, reference.w);
        w[2] = g.add(w[2], rate);
        let mut dw = link.from_reference.inward(g, reference.dw);
        let turned = [g.mul(rate, w[1]), -g.mul(rate, w[0]), angular];
        dw = vector::add(g, dw, turned);

        let mut a = parent.u.map(|row| vector::dot(g, row, link.position));
        a = vector::add(g, parent.a, a);
        a = link.from_parent.inward(g, a);
        if link.kind == JointKind::Prismatic {
            let dq = link.length_rate(g, Symbol::Velocity);
            let twice = g.scale(2.0, dq);
            let coriolis = [g.mul(twice, w[1]), -g.mul(twice, w[0]), linear];
            a = vector::add(g, a, coriolis);
        }
        vector::name(g, w, &format!("w{}_", link.j));
        vector::name(g, dw, &format!("dw{}_", link.j));
        vector::name(g, a, &format!("a{}_", link.j));
        let u = u_matrix(g, w, dw, link.j);
        motions.push(FrameMotion { w, dw, a, u });
    }
    motions
}

/// Angular acceleration about z within the reference frame, and acceleration along z where r moves.
fn accelerations_of(g: &mut Graph, link: &Link, accelerations: bool) -> (Expr, Expr) {
    if !accelerations {
        return (Graph::ZERO, Graph::ZERO);
    }
    let angular = angle_rate(g, &link.from_reference.angle, Symbol::Acceleration);
    (angular, link.length_rate(g, Symbol::Acceleration))
}

fn u_matrix(g: &mut Graph, w: Vector, dw: Vector, j: usize) -> [Vector; 3] {
    let [x, y, z] = w;
    let (xx, yy, zz) = (g.mul(x, x), g.mul(y, y), g.mul(z, z));
    let (xy, xz, yz) = (g.mul(x, y), g.mul(x, z), g.mul(y, z));
    let u = [
        [-g.add(yy, zz), g.sub(xy, dw[2]), g.add(xz, dw[1])],
        [g.add(xy, dw[2]), -g.add(xx, zz), g.sub(yz, dw[0])],
        [g.sub(xz, dw[1]), g.add(yz, dw[0]), -g.add(xx, yy)],
    ];
    for (row, i) in u.iter().zip(1..) {
        for (&e, k) in row.iter().zip(1..) {
            g.name(e, &format!("u{j}_{i}{k}"));
        }
    }
    u
}

/// For every frame, the screws of the joints that move it, from the base outwards.
pub fn screws(g: &mut Graph, geometry: &Geometry) -> Vec<Vec<Screw>> {
    let mut all: Vec<Vec<Screw>> = Vec::with_capacity(geometry.links.len());
    for link in &geometry.links {
        let mut own = Vec::new();
        for k in 0..link.parent.map_or(0, |p| all[p].len()) {
            let Some(parent) = link.parent else { continue };
            let outer = all[parent][k];
            let from_reference =
                link.reference.and_then(|r| all[r].iter().find(|s| s.joint == outer.joint).copied());
            let (mut axis, turn) = match from_reference {
                Some(screw) => (
                    link.from_reference.inward(g, screw.axis),
                    turn_of(&link.from_reference.angle, outer.joint),
                ),
                None => (link.from_parent.inward(g, outer.axis), link.own_velocity(outer.joint).0),
            };
            let turn = g.constant(turn);
            axis[2] = g.add(axis[2], turn);
            let swept = vector::cross(g, outer.axis, link.position);
            let lever = vector::add(g, outer.lever, swept);
            let mut lever = link.from_parent.inward(g, lever);
            let shift = g.constant(link.own_velocity(outer.joint).1);
            lever[2] = g.add(lever[2], shift);
            let number = geometry.links[geometry.joint_frames[outer.joint]].j;
            vector::name(g, axis, &format!("z{number}_{}", link.j));
            vector::name(g, lever, &format!("v{number}_{}", link.j));
            own.push(Screw { joint: outer.joint, axis, lever });
        }
        for &(joint, _) in &link.terms {
            if own.iter().all(|screw| screw.joint != joint) {
                let (turn, shift) = link.own_velocity(joint);
                let z = |g: &mut Graph, x: f64| [Graph::ZERO, Graph::ZERO, g.constant(x)];
                own.push(Screw { joint, axis: z(g, turn), lever: z(g, shift) });
            }
        }
        all.push(own);
    }
    all
}

/// How often a joint turns an angle.
fn turn_of(angle: &Angle, joint: usize) -> f64 {
    angle.terms.iter().find(|t| t.0 == joint).map_or(0.0, |t| f64::from(t.1))
}
