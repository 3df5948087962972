//! The distance of two points that are fixed in frames, and how it changes with the joints.

use super::geometry::Geometry;
use super::vector::{self, Vector};
use crate::symbolic::{Expr, Graph, Symbol};
use dynid_description::Between;

/// A distance l of two points.
pub(super) struct Distance {
    /// l^2.
    pub square: Expr,
    /// 1 / l, 0 where the points meet.
    pub inverse: Expr,
    /// l dl/dq of each joint.
    pub half_gradient: Vec<Expr>,
}

impl Distance {
    /// `terms`: the joints that it changes with.
    pub fn new(g: &mut Graph, geometry: &Geometry, between: &Between, terms: &[(usize, f64)]) -> Distance {
        let common = common_frame(geometry, between.frames);
        let [from, to] =
            [0, 1].map(|end| place(g, geometry, between.frames[end], between.points[end], common));
        let apart = vector::add(g, to, vector::negate(from));
        let square = vector::dot(g, apart, apart);
        let mut half_gradient = vec![Graph::ZERO; geometry.joint_frames.len()];
        for &(joint, _) in terms {
            let rate = apart.map(|x| g.partial(x, Symbol::Position(joint)));
            half_gradient[joint] = vector::dot(g, apart, rate);
        }
        Distance { square, inverse: g.inverse_root(square), half_gradient }
    }

    /// l.
    pub fn length(&self, g: &mut Graph) -> Expr {
        g.mul(self.square, self.inverse)
    }

    /// (K - KR / l) l dl/dq per unit of K with a length at rest, `rest`, or of -KR, `None`: torques over l dl/dq.
    pub fn level(&self, g: &mut Graph, rest: Option<f64>) -> Expr {
        match rest {
            None => -self.inverse,
            Some(rest) => {
                let share = g.scale(rest, self.inverse);
                g.sub(Graph::ONE, share)
            }
        }
    }
}

/// The last frame that both are on; `None` is the base.
fn common_frame(geometry: &Geometry, frames: [Option<usize>; 2]) -> Option<usize> {
    let [first, second] = frames;
    let mut at = first;
    while let (Some(k), Some(other)) = (at, second) {
        if geometry.carries(k, other) {
            return Some(k);
        }
        at = geometry.links[k].parent;
    }
    None
}

/// A point of a frame, seen from another one that carries it.
fn place(
    g: &mut Graph,
    geometry: &Geometry,
    frame: Option<usize>,
    point: [f64; 3],
    seen_from: Option<usize>,
) -> Vector {
    let mut place = point.map(|x| g.constant(x));
    let mut at = frame;
    while let (Some(k), true) = (at, at != seen_from) {
        let link = &geometry.links[k];
        let turned = link.from_parent.outward(g, place);
        place = vector::add(g, turned, link.position);
        at = link.parent;
    }
    place
}
