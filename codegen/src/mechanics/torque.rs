//! Torques tau(chi, q, dq, ddq) by a customised recursive Newton-Euler in base parameters (Khalil and Kleinfinger 1987;
//! Khalil and Dombre 2002, chapter 9).
//!
//! A column of IDM is that of one standard parameter, so IDM chi is the inverse dynamics of bodies whose kept standard
//! parameters have the values of the base parameters and whose regrouped ones are zero: this holds for every regrouping,
//! and masses and inertias that are zero take their operations with them.

use super::drive::DriveColumns;
use super::error::ModelError;
use super::forward::{Body, bodies, carried_inwards};
use super::geometry::Geometry;
use super::motion::{FrameMotion, frame_motions};
use super::vector::{self, Vector};
use crate::base::BaseSet;
use crate::robot::RobotTable;
use crate::symbolic::{Expr, Graph, OperationCounts, Symbol};
use dynid_description::ParameterKind;

/// The joint torques as one function of parameters and motion.
#[derive(Debug, Clone)]
pub struct TorqueEquations {
    /// Every expression.
    pub graph: Graph,
    /// One per joint, drive included: IDM(q, dq, ddq) chi.
    pub torques: Vec<Expr>,
}

impl TorqueEquations {
    /// Derives the torques; of the possible ways to treat parallel axes the one with fewer operations is taken.
    ///
    /// # Errors
    /// A drive without a model.
    pub fn derive(robot: &RobotTable, set: &BaseSet) -> Result<Self, ModelError> {
        let drive = DriveColumns::new(robot)?;
        let mut best = TorqueEquations::derive_as(robot, set, &drive, (true, true));
        for variant in [(true, false), (false, false)] {
            let equations = TorqueEquations::derive_as(robot, set, &drive, variant);
            if equations.counts().weighted() < best.counts().weighted() {
                best = equations;
            }
        }
        Ok(best)
    }

    /// `merge` turns parallel axes together, `compose` takes sines and cosines of sums from those of their parts.
    pub(super) fn derive_as(
        robot: &RobotTable,
        set: &BaseSet,
        drive: &DriveColumns,
        (merge, compose): (bool, bool),
    ) -> Self {
        let mut graph = if compose { Graph::composing_angles() } else { Graph::new() };
        let g = &mut graph;
        let geometry = Geometry::new(g, robot, merge);
        let mut torques = rigid_torques(g, &geometry, set);
        for (k, base) in set.base.iter().enumerate() {
            let parameter = &set.standard[base.standard];
            let joint = geometry.links[parameter.frame].joint;
            if let (true, Some(joint)) = (parameter.kind >= ParameterKind::Ia, joint) {
                let chi = g.symbol(Symbol::Parameter(k));
                for (torque, entry) in torques.iter_mut().zip(drive.column(g, &geometry, parameter, joint)) {
                    let term = g.mul(chi, entry);
                    *torque = g.add(*torque, term);
                }
            }
        }
        TorqueEquations { graph, torques }
    }

    /// What evaluating all torques costs.
    pub fn counts(&self) -> OperationCounts {
        self.graph.operation_counts(&self.torques)
    }
}

/// Torques of inertia and gravity: wrenches of the bodies, carried inwards.
fn rigid_torques(g: &mut Graph, geometry: &Geometry, set: &BaseSet) -> Vec<Expr> {
    let motions = frame_motions(g, geometry, true);
    let bodies = bodies(g, geometry.links.len(), set);
    let wrenches = motions.iter().zip(&bodies).map(|(motion, body)| wrench(g, motion, body)).collect();
    carried_inwards(g, geometry, wrenches)
}

/// Force, and moment at the origin of the frame, that the motion of one body needs: f = M a + U MS and
/// m = J dw + w x (J w) + MS x a. The moment is written in entries of U, which the force has anyway, and in differences
/// of inertias, where a zero YY leaves one parameter.
fn wrench(g: &mut Graph, motion: &FrameMotion, body: &Body) -> (Vector, Vector) {
    let translation = vector::scale(g, body.mass, motion.a);
    let rotation = motion.u.map(|row| vector::dot(g, row, body.first_moment));
    let force = vector::add(g, translation, rotation);

    let (u, [x, y, z], [dx, dy, dz]) = (&motion.u, motion.w, motion.dw);
    let [xx, xy, xz, yy, yz, zz] = body.inertia;
    let (about_x, about_y, about_z) = (g.sub(zz, yy), g.sub(xx, zz), g.sub(yy, xx));
    let [wx2, wy2, wz2] = [x, y, z].map(|w| g.mul(w, w));
    let (wyz, wxz, wxy) = (g.mul(y, z), g.mul(x, z), g.mul(x, y));
    let (y2_z2, z2_x2, x2_y2) = (g.sub(wy2, wz2), g.sub(wz2, wx2), g.sub(wx2, wy2));
    let couple = [
        [(xx, dx), (about_x, wyz), (xy, -u[2][0]), (xz, u[1][0]), (yz, y2_z2)],
        [(yy, dy), (about_y, wxz), (xy, u[2][1]), (xz, z2_x2), (yz, -u[0][1])],
        [(zz, dz), (about_z, wxy), (xy, x2_y2), (xz, -u[1][2]), (yz, u[0][2])],
    ];
    let couple = couple.map(|terms| {
        let products = terms.map(|(a, b)| g.mul(a, b));
        g.sum(&products)
    });
    let arm = vector::cross(g, body.first_moment, motion.a);
    (force, vector::add(g, couple, arm))
}
