//! Energy functions h of (10) by the recursive equations (Gautier and Khalil 1990), and their total time derivative.

use super::geometry::{Geometry, angle_rate};
use super::motion::FrameMotion;
use super::vector::{self, Vector};
use crate::symbolic::{Expr, Graph, Symbol};
use dynid_description::JointKind;
use dynid_description::{ParameterKind, StandardParameter};

/// What the energy of one frame needs, in its axes.
#[derive(Debug, Clone, Copy)]
pub struct FrameEnergy {
    /// Velocity of the origin.
    pub v: Vector,
    /// Time derivative of the components of `v`, minus gravity.
    pub b: Vector,
    /// Gravity.
    pub gravity: Vector,
    /// gravity . position of the origin.
    pub fall: Expr,
}

/// Velocities and gravity in every frame.
pub fn frame_energies(g: &mut Graph, geometry: &Geometry, motions: &[FrameMotion]) -> Vec<FrameEnergy> {
    let gravity = geometry.gravity.map(|x| g.constant(x));
    let rest = FrameEnergy { v: vector::ZERO, b: vector::negate(gravity), gravity, fall: Graph::ZERO };
    let mut all: Vec<FrameEnergy> = Vec::with_capacity(geometry.links.len());
    for link in &geometry.links {
        let parent = link.parent.map_or(rest, |p| all[p]);
        let reference = link.reference.map_or(rest, |p| all[p]);
        let (w, dw) = link.parent.map_or((vector::ZERO, vector::ZERO), |p| (motions[p].w, motions[p].dw));
        let swept = vector::cross(g, w, link.position);
        let v = vector::add(g, parent.v, swept);
        let mut v = link.from_parent.inward(g, v);
        let swept = vector::cross(g, dw, link.position);
        let mut b = vector::add(g, parent.b, swept);
        let dr = link.length_rate(g, Symbol::Velocity);
        if link.kind == JointKind::Prismatic {
            let along = link.along.map(|x| g.scale(x, dr));
            let turned = vector::cross(g, w, along);
            b = vector::add(g, b, turned);
        }
        let mut b = link.from_parent.inward(g, b);
        let rate = angle_rate(g, &link.from_parent.angle, Symbol::Velocity);
        let turned = [g.mul(rate, v[1]), -g.mul(rate, v[0]), Graph::ZERO];
        b = vector::add(g, b, turned);
        let ddr = link.length_rate(g, Symbol::Acceleration);
        v[2] = g.add(v[2], dr);
        b[2] = g.add(b[2], ddr);
        let gravity = link.from_reference.inward(g, reference.gravity);
        let drop = vector::dot(g, parent.gravity, link.position);
        let fall = g.add(parent.fall, drop);
        vector::name(g, v, &format!("v{}_", link.j));
        vector::name(g, b, &format!("b{}_", link.j));
        vector::name(g, gravity, &format!("g{}_", link.j));
        all.push(FrameEnergy { v, b, gravity, fall });
    }
    all
}

/// Kinetic and potential energy per unit of one inertial parameter.
pub fn energy(
    g: &mut Graph,
    motion: &FrameMotion,
    energy: &FrameEnergy,
    parameter: &StandardParameter,
) -> Expr {
    let [x, y, z] = motion.w;
    let half_square = |g: &mut Graph, e: Expr| {
        let square = g.mul(e, e);
        g.scale(0.5, square)
    };
    match parameter.kind {
        ParameterKind::XX => half_square(g, x),
        ParameterKind::YY => half_square(g, y),
        ParameterKind::ZZ => half_square(g, z),
        ParameterKind::XY => g.mul(x, y),
        ParameterKind::XZ => g.mul(x, z),
        ParameterKind::YZ => g.mul(y, z),
        ParameterKind::MX | ParameterKind::MY | ParameterKind::MZ => {
            let axis = parameter.kind as usize - ParameterKind::MX as usize;
            let coupling = vector::cross(g, energy.v, motion.w)[axis];
            g.sub(coupling, energy.gravity[axis])
        }
        ParameterKind::M => {
            let square = vector::dot(g, energy.v, energy.v);
            let kinetic = g.scale(0.5, square);
            g.sub(kinetic, energy.fall)
        }
        _ => Graph::ZERO,
    }
}

/// Total time derivative of [`energy`]: dw is the derivative of the components of w, b that of v with gravity.
pub fn power(
    g: &mut Graph,
    motion: &FrameMotion,
    energy: &FrameEnergy,
    parameter: &StandardParameter,
) -> Expr {
    let (w, dw, v, b) = (motion.w, motion.dw, energy.v, energy.b);
    let mixed = |g: &mut Graph, i: usize, k: usize| {
        let (left, right) = (g.mul(w[i], dw[k]), g.mul(w[k], dw[i]));
        g.add(left, right)
    };
    match parameter.kind {
        ParameterKind::XX => g.mul(w[0], dw[0]),
        ParameterKind::YY => g.mul(w[1], dw[1]),
        ParameterKind::ZZ => g.mul(w[2], dw[2]),
        ParameterKind::XY => mixed(g, 0, 1),
        ParameterKind::XZ => mixed(g, 0, 2),
        ParameterKind::YZ => mixed(g, 1, 2),
        ParameterKind::MX | ParameterKind::MY | ParameterKind::MZ => {
            let axis = parameter.kind as usize - ParameterKind::MX as usize;
            let moved = vector::cross(g, b, w)[axis];
            let turned = vector::cross(g, v, dw)[axis];
            g.add(moved, turned)
        }
        ParameterKind::M => vector::dot(g, v, b),
        _ => Graph::ZERO,
    }
}
