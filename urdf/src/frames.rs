//! The choice of frames: the modified-DH table (Khalil and Kleinfinger 1986) of joint axes as they stand in space.
//!
//! Frame 0 is the base link's own frame, so that gravity is known in it; the first row has gamma and b where its axis needs
//! them. The z axis of frame j is the axis of joint j, in its direction, so that joint variables are those of the URDF.
//! Where the URDF's own frame has this z axis and is a frame of such a table already, it is kept. Otherwise x of frame j
//! is the common normal of axes j and j + 1, towards the side on which theta has the smaller offset; a last frame, and one
//! whose next axis is the same line, has neither offset nor height. A link with several joints has one x only: those that
//! it does not suit have gamma and b.

use std::f64::consts::{FRAC_PI_2, PI};

use nalgebra::{Matrix3, Vector3};

use crate::document::Urdf;
use crate::joint::JointType;
use crate::pose::Pose;
use crate::screw::{EXACT, Normal, Screw, normal};
use crate::tree::{Moving, Tree};
use dynid_description::JointKind;

/// One row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Row {
    /// Number of the parent's row, from 1; 0 is the base.
    pub parent: usize,
    pub kind: JointKind,
    pub screw: Screw,
    /// What moves with it; `None` for a frame that only carries the next one.
    pub body: Option<usize>,
}

/// Rows, and where the frames of the moving bodies are.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Frames {
    pub rows: Vec<Row>,
    /// Number of the row of each body.
    pub number: Vec<usize>,
    /// Pose of the table's frame in the frame of each body's first link.
    pub in_link: Vec<Pose>,
}

/// An axis in space, all joints at 0.
struct Line {
    point: Vector3<f64>,
    axis: Vector3<f64>,
}

struct Chooser<'a> {
    /// Frames of the bodies' first links in frame 0.
    links: Vec<Pose>,
    lines: Vec<Line>,
    bodies: &'a [Moving],
    /// Whether the axis of each joint is the z axis of its link.
    own: Vec<bool>,
}

/// The table of a tree.
pub(crate) fn frames(urdf: &Urdf, tree: &Tree) -> Frames {
    let mut links: Vec<Pose> = Vec::new();
    for moving in &tree.bodies {
        let carrier = moving.parent.map_or_else(Pose::identity, |p| links[p]);
        links.push(carrier.then(&moving.origin));
    }
    let axis = |moving: &Moving| urdf.joints[moving.joint].axis;
    let lines = tree.bodies.iter().zip(&links);
    let lines =
        lines.map(|(m, link)| Line { point: link.translation, axis: link.rotation * axis(m) }).collect();
    let own = tree.bodies.iter().map(|m| axis(m) == Vector3::z()).collect();
    let chooser = Chooser { links, lines, bodies: &tree.bodies, own };
    let mut result = Frames { rows: Vec::new(), number: Vec::new(), in_link: Vec::new() };
    let mut chosen: Vec<Pose> = Vec::new();
    for (k, moving) in tree.bodies.iter().enumerate() {
        let mut parent = moving.parent.map_or(0, |p| result.number[p]);
        let mut carrier = moving.parent.map_or_else(Pose::identity, |p| chosen[p]);
        if chooser.normal_from(&carrier, k).is_none() {
            // A frame square to the parent's, from which the axis has a normal nearby.
            let screw = Screw { alpha: FRAC_PI_2, ..ZERO };
            result.rows.push(Row { parent, kind: JointKind::Fixed, screw, body: None });
            parent = result.rows.len();
            carrier = carrier.then(&screw.pose());
        }
        let frame = chooser.frame(&carrier, k);
        let screw = Screw::of(&carrier.inverse().then(&frame)).unwrap_or(ZERO);
        let kind = match urdf.joints[moving.joint].kind {
            JointType::Prismatic => JointKind::Prismatic,
            _ => JointKind::Revolute,
        };
        result.rows.push(Row { parent, kind, screw: tidied(screw), body: Some(k) });
        result.number.push(result.rows.len());
        result.in_link.push(chooser.links[k].inverse().then(&frame));
        chosen.push(frame);
    }
    result
}

const ZERO: Screw = Screw { gamma: 0.0, b: 0.0, alpha: 0.0, d: 0.0, theta: 0.0, r: 0.0 };

/// The row with what is zero to rounding as zero.
fn tidied(screw: Screw) -> Screw {
    let zero = |x: f64| if x.abs() <= EXACT { 0.0 } else { x };
    // Half a turn is the same in both directions.
    let angle = |x: f64| if (x + PI).abs() <= EXACT { PI } else { zero(x) };
    let Screw { gamma, b, alpha, d, theta, r } = screw;
    Screw {
        gamma: angle(gamma),
        b: zero(b),
        alpha: angle(alpha),
        d: zero(d),
        theta: angle(theta),
        r: zero(r),
    }
}

impl Chooser<'_> {
    /// The common normal of the z axis of a frame and the axis of a body, seen from the frame.
    fn normal_from(&self, frame: &Pose, body: usize) -> Option<Normal> {
        let line = &self.lines[body];
        let back = frame.inverse();
        let point = back.rotation * line.point + back.translation;
        normal(&point, &(back.rotation * line.axis))
    }

    /// Frame of a body seen from its carrier's.
    fn frame(&self, carrier: &Pose, body: usize) -> Pose {
        let next: Vec<usize> =
            (0..self.bodies.len()).filter(|&k| self.bodies[k].parent == Some(body)).collect();
        let only = if let [only] = next[..] { Some(only) } else { None };
        if self.own[body] && only.is_none_or(|child| self.is_serial(&self.links[body], child)) {
            return self.links[body];
        }
        let plain = self.plain(carrier, body);
        let Some(child) = next.first() else { return plain };
        // From a frame on the axis, the normal to the next one.
        let (x, origin) = match self.normal_from(&plain, *child) {
            None | Some(Normal::Same) => return plain,
            Some(Normal::Parallel(apart)) => (apart / apart.norm(), plain.translation),
            Some(Normal::Skew { along, on_axis, .. }) => {
                (along, plain.translation + plain.rotation * Vector3::new(0.0, 0.0, on_axis))
            }
        };
        let x = plain.rotation * x;
        let towards =
            |x: Vector3<f64>| Pose { rotation: axes(x, self.lines[body].axis), translation: origin };
        let offset =
            |pose: &Pose| Screw::of(&carrier.inverse().then(pose)).map_or(f64::MAX, |s| s.theta.abs());
        let (there, back) = (towards(x), towards(-x));
        if offset(&back) < offset(&there) - 1e-9 { back } else { there }
    }

    /// The frame of an axis that has neither offset in theta nor in r.
    fn plain(&self, carrier: &Pose, body: usize) -> Pose {
        let line = &self.lines[body];
        let axis = carrier.rotation.transpose() * line.axis;
        let (x, origin) = match self.normal_from(carrier, body) {
            Some(Normal::Parallel(apart)) => (apart / apart.norm(), apart),
            Some(Normal::Skew { along, on_line, .. }) => {
                let point =
                    carrier.inverse().then(&Pose { translation: line.point, ..Pose::identity() }).translation;
                (along, point + axis * on_line)
            }
            _ => (Vector3::x(), Vector3::zeros()),
        };
        let x = if x.x < -EXACT || (x.x.abs() <= EXACT && x.y < 0.0) { -x } else { x };
        carrier.then(&Pose { rotation: axes(x, axis), translation: origin })
    }

    /// Whether the axis of a child needs no gamma and b from this frame.
    fn is_serial(&self, frame: &Pose, child: usize) -> bool {
        match self.normal_from(frame, child) {
            Some(Normal::Same) => true,
            Some(Normal::Parallel(apart)) => apart.y.abs() <= EXACT,
            Some(Normal::Skew { along, on_axis, .. }) => along.y.abs() <= EXACT && on_axis.abs() <= EXACT,
            None => true,
        }
    }
}

/// Axes x, z cross x, z as columns; x is made square to z.
fn axes(x: Vector3<f64>, z: Vector3<f64>) -> Matrix3<f64> {
    let x = x - z * x.dot(&z);
    let x = x / x.norm();
    Matrix3::from_columns(&[x, z.cross(&x), z])
}
