//! Links between joints about one axis, which are there because a URDF joint mimics one other joint only: a frame that moves with
//! q3 - q2 is two joints there, and what stands between them is no body.

use crate::document::Urdf;
use crate::joint::JointType;
use crate::tree::{Moving, Tree};

/// How far axes may be apart to be one, m, and the sine of the angle between them.
const APART: f64 = 1e-9;

/// The bodies of the tree without any `<inertial>` that carry one joint alone, about or along the axis of their own, where one
/// of the two joints mimics another: they have no inertia.
pub(crate) fn links_between(urdf: &Urdf, tree: &Tree) -> Vec<usize> {
    (0..tree.bodies.len()).filter(|&k| stands_between(urdf, tree, k)).collect()
}

fn stands_between(urdf: &Urdf, tree: &Tree, k: usize) -> bool {
    let body = &tree.bodies[k];
    let mut carried = tree.bodies.iter().filter(|other| other.parent == Some(k));
    let (Some(next), None) = (carried.next(), carried.next()) else { return false };
    let empty = body.links.iter().all(|(link, _)| urdf.links[*link].inertial.is_none());
    let follows = body.follows.is_some() || next.follows.is_some();
    empty && follows && is_one_axis(urdf, body, next)
}

/// Whether the joint of `next` moves about or along the axis of `body`, which carries it.
fn is_one_axis(urdf: &Urdf, body: &Moving, next: &Moving) -> bool {
    let (own, other) = (&urdf.joints[body.joint], &urdf.joints[next.joint]);
    let slides = |kind: JointType| kind == JointType::Prismatic;
    let axis = next.origin.rotation * other.axis;
    let apart = own.axis.cross(&next.origin.translation).norm();
    slides(own.kind) == slides(other.kind)
        && own.axis.cross(&axis).norm() < APART
        && (slides(own.kind) || apart < APART)
}
