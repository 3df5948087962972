//! Inverse dynamic rows: the wrench of every parameter on every joint axis below it.

use super::columns::{Wrench, body_wrench};
use super::geometry::Geometry;
use super::motion::{FrameMotion, Screw};
use super::vector;
use crate::symbolic::{Expr, Graph};
use dynid_description::JointKind;
use dynid_description::StandardParameter;

/// How the wrench of a column reaches the axes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Derivation {
    /// The joint screws are carried outwards into the frame of the link, once for all of its columns.
    ScrewsOutward,
    /// The wrench of each column is carried inwards, frame by frame.
    WrenchesInward,
}

/// Torques of all joints per unit of one inertial parameter.
pub fn inertial_column(
    g: &mut Graph,
    geometry: &Geometry,
    motions: &[FrameMotion],
    screws: &[Vec<Screw>],
    parameter: &StandardParameter,
    derivation: Derivation,
) -> Vec<Expr> {
    let mut column = vec![Graph::ZERO; geometry.joint_frames.len()];
    let wrench = body_wrench(g, &motions[parameter.frame], parameter.kind);
    match derivation {
        Derivation::ScrewsOutward => {
            for screw in &screws[parameter.frame] {
                let turning = vector::dot(g, screw.axis, wrench.moment);
                let moving = vector::dot(g, screw.lever, wrench.force);
                column[screw.joint] = g.add(turning, moving);
            }
        }
        Derivation::WrenchesInward => carry_inward(g, geometry, parameter.frame, wrench, &mut column),
    }
    column
}

fn carry_inward(g: &mut Graph, geometry: &Geometry, frame: usize, wrench: Wrench, column: &mut [Expr]) {
    let mut at = Some(frame);
    let mut wrench = wrench;
    while let Some(k) = at {
        let link = &geometry.links[k];
        let on_axis = match link.kind {
            JointKind::Prismatic => wrench.force[2],
            _ => wrench.moment[2],
        };
        for &(joint, k) in &link.terms {
            let share = g.scale(k, on_axis);
            column[joint] = g.add(column[joint], share);
        }
        let force = link.from_parent.outward(g, wrench.force);
        let moment = link.from_parent.outward(g, wrench.moment);
        let lever = vector::cross(g, link.position, force);
        wrench = Wrench { force, moment: vector::add(g, moment, lever) };
        at = link.parent;
    }
}
