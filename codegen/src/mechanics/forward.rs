//! Mass matrix and bias for given base parameters, for simulation: composite bodies (Walker and Orin 1982) and
//! recursive Newton-Euler without accelerations (Luh, Walker and Paul 1980).

use super::geometry::{Geometry, Link};
use super::motion::{Screw, frame_motions};
use super::vector::{self, Vector};
use crate::base::BaseSet;
use crate::symbolic::{Expr, Graph, Symbol};
use dynid_description::JointKind;
use dynid_description::ParameterKind;

/// Inertial parameters of one body, symbols for the base parameters and zero for what was regrouped away.
#[derive(Debug, Clone, Copy)]
pub(super) struct Body {
    /// XX XY XZ YY YZ ZZ at the origin of the frame.
    pub inertia: [Expr; 6],
    pub first_moment: Vector,
    pub mass: Expr,
}

impl Body {
    const NONE: Body = Body { inertia: [Graph::ZERO; 6], first_moment: vector::ZERO, mass: Graph::ZERO };

    fn rows(&self) -> [Vector; 3] {
        let [xx, xy, xz, yy, yz, zz] = self.inertia;
        [[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]]
    }
}

pub(super) fn bodies(g: &mut Graph, frames: usize, set: &BaseSet) -> Vec<Body> {
    let mut bodies = vec![Body::NONE; frames];
    for (k, parameter) in set.base.iter().enumerate() {
        let standard = &set.standard[parameter.standard];
        let body = &mut bodies[standard.frame];
        let slot = match standard.kind {
            ParameterKind::XX => &mut body.inertia[0],
            ParameterKind::XY => &mut body.inertia[1],
            ParameterKind::XZ => &mut body.inertia[2],
            ParameterKind::YY => &mut body.inertia[3],
            ParameterKind::YZ => &mut body.inertia[4],
            ParameterKind::ZZ => &mut body.inertia[5],
            ParameterKind::MX => &mut body.first_moment[0],
            ParameterKind::MY => &mut body.first_moment[1],
            ParameterKind::MZ => &mut body.first_moment[2],
            ParameterKind::M => &mut body.mass,
            _ => continue,
        };
        *slot = g.symbol(Symbol::Parameter(k));
    }
    bodies
}

/// Lower triangle of M, row by row: entry (i, k), k <= i, at i (i + 1) / 2 + k. Rotor inertias are not included.
pub fn mass_matrix(g: &mut Graph, geometry: &Geometry, set: &BaseSet, screws: &[Vec<Screw>]) -> Vec<Expr> {
    let mut composite = bodies(g, geometry.links.len(), set);
    let n = geometry.joint_frames.len();
    let mut mass = vec![Graph::ZERO; n * (n + 1) / 2];
    for (index, link) in geometry.links.iter().enumerate().rev() {
        let body = composite[index];
        for (axis, e) in ["xx", "xy", "xz", "yy", "yz", "zz"].iter().zip(body.inertia) {
            g.name(e, &format!("j{}_{axis}", link.j));
        }
        vector::name(g, body.first_moment, &format!("ms{}_", link.j));
        for entry in momentum_products(g, link, &body, &screws[index]) {
            let ([i, k], product) = entry;
            let place = &mut mass[i * (i + 1) / 2 + k];
            *place = g.add(*place, product);
        }
        if let Some(parent) = link.parent {
            let carried = carried_inward(g, link, &body);
            let outer = &mut composite[parent];
            for k in 0..6 {
                outer.inertia[k] = g.add(outer.inertia[k], carried.inertia[k]);
            }
            outer.first_moment = vector::add(g, outer.first_moment, carried.first_moment);
            outer.mass = g.add(outer.mass, carried.mass);
        }
    }
    mass
}

/// What the momentum of a composite body, for a unit rate of its own axis, is worth on the joints that move it: entries
/// [i, k], k <= i, of the mass matrix.
///
/// With the frames' own mass matrix F and the frames' rates G dq it is GT F G: the frame's row of F on the joints of the
/// frame, and its column, without the diagonal, on those of the frames that carry it.
fn momentum_products(g: &mut Graph, link: &Link, body: &Body, screws: &[Screw]) -> Vec<([usize; 2], Expr)> {
    let [mx, my, _] = body.first_moment;
    let (force, moment) = match link.kind {
        JointKind::Prismatic => ([Graph::ZERO, Graph::ZERO, body.mass], [my, -mx, Graph::ZERO]),
        _ => ([-my, mx, Graph::ZERO], [body.inertia[2], body.inertia[4], body.inertia[5]]),
    };
    let worth = |g: &mut Graph, axis: Vector, lever: Vector| {
        let turning = vector::dot(g, axis, moment);
        let moving = vector::dot(g, lever, force);
        g.add(turning, moving)
    };
    let mut entries = Vec::new();
    for &(joint, k) in &link.terms {
        for screw in screws {
            let all = worth(g, screw.axis, screw.lever);
            if screw.joint <= joint {
                entries.push(([joint, screw.joint], g.scale(k, all)));
            }
            if screw.joint >= joint {
                let (turn, shift) = link.own_velocity(screw.joint);
                let (mut axis, mut lever) = (screw.axis, screw.lever);
                let (turn, shift) = (g.constant(turn), g.constant(shift));
                (axis[2], lever[2]) = (g.sub(axis[2], turn), g.sub(lever[2], shift));
                let carried = worth(g, axis, lever);
                entries.push(([screw.joint, joint], g.scale(k, carried)));
            }
        }
    }
    entries
}

/// The parameters of a body in the frame of its parent.
fn carried_inward(g: &mut Graph, link: &Link, body: &Body) -> Body {
    let rotation = &link.from_parent;
    // R J RT: first the columns of JT = J, then the rows.
    let half = body.rows().map(|row| rotation.outward(g, row));
    let columns: [Vector; 3] =
        std::array::from_fn(|k| rotation.outward(g, [half[0][k], half[1][k], half[2][k]]));
    let turned_moment = rotation.outward(g, body.first_moment);
    let p = link.position;
    let shifted = vector::scale(g, body.mass, p);
    let first_moment = vector::add(g, turned_moment, shifted);
    // Steiner with both moments: (2 p.s) 1 - p sT - s pT with s = MS + M p / 2.
    let half_mass = g.scale(0.5, body.mass);
    let half_shift = vector::scale(g, half_mass, p);
    let s = vector::add(g, turned_moment, half_shift);
    let products: [Vector; 3] = p.map(|a| s.map(|b| g.mul(a, b)));
    let mut entry = |i: usize, k: usize| {
        let steiner = if i == k {
            let (a, b) = ((i + 1) % 3, (i + 2) % 3);
            let total = g.add(products[a][a], products[b][b]);
            g.scale(2.0, total)
        } else {
            -g.add(products[i][k], products[k][i])
        };
        g.add(columns[k][i], steiner)
    };
    let inertia = [entry(0, 0), entry(0, 1), entry(0, 2), entry(1, 1), entry(1, 2), entry(2, 2)];
    Body { inertia, first_moment, mass: body.mass }
}

/// Centrifugal, Coriolis and gravity torques.
pub fn bias(g: &mut Graph, geometry: &Geometry, set: &BaseSet) -> Vec<Expr> {
    let motions = frame_motions(g, geometry, false);
    let bodies = bodies(g, geometry.links.len(), set);
    let mut wrenches = Vec::with_capacity(bodies.len());
    for (motion, body) in motions.iter().zip(&bodies) {
        let translation = vector::scale(g, body.mass, motion.a);
        let rotation = motion.u.map(|row| vector::dot(g, row, body.first_moment));
        let force = vector::add(g, translation, rotation);
        let rows = body.rows();
        let euler = rows.map(|row| vector::dot(g, row, motion.dw));
        let momentum = rows.map(|row| vector::dot(g, row, motion.w));
        let gyroscopic = vector::cross(g, motion.w, momentum);
        let arm = vector::cross(g, body.first_moment, motion.a);
        let moment = vector::add(g, euler, gyroscopic);
        wrenches.push((force, vector::add(g, moment, arm)));
    }
    carried_inwards(g, geometry, wrenches)
}

/// Joint torques of the wrenches that the bodies need: forces and moments at the origins of the frames, which are carried
/// from the tips to the base.
pub(super) fn carried_inwards(
    g: &mut Graph,
    geometry: &Geometry,
    mut wrenches: Vec<(Vector, Vector)>,
) -> Vec<Expr> {
    let mut torques = vec![Graph::ZERO; geometry.joint_frames.len()];
    for (index, link) in geometry.links.iter().enumerate().rev() {
        let (force, moment) = wrenches[index];
        vector::name(g, force, &format!("f{}_", link.j));
        vector::name(g, moment, &format!("m{}_", link.j));
        let on_axis = if link.kind == JointKind::Prismatic { force[2] } else { moment[2] };
        for &(joint, k) in &link.terms {
            let share = g.scale(k, on_axis);
            torques[joint] = g.add(torques[joint], share);
        }
        if let Some(parent) = link.parent {
            let force = link.from_parent.outward(g, force);
            let moment = link.from_parent.outward(g, moment);
            let lever = vector::cross(g, link.position, force);
            let moment = vector::add(g, moment, lever);
            let outer = wrenches[parent];
            wrenches[parent] = (vector::add(g, outer.0, force), vector::add(g, outer.1, moment));
        }
    }
    torques
}
