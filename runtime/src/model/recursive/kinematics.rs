//! The forward recursion over the table: velocities and accelerations of every frame, in that frame.
//!
//! Luh, Walker and Paul 1980 in the modified notation of Khalil and Kleinfinger 1986.

use super::error::MAX_FRAMES;
use super::vector::{Mat3, Vec3, add, apply, apply_transposed, cross, dot, multiply, scale};
use crate::model::{Frame, JointKind, Motion, Number, Robot};
use dynid_description::MAX_TERMS;

/// One row of the table, prepared for evaluation: the constant part of the transformation from the parent.
#[derive(Debug, Clone, Copy)]
pub struct Link<T> {
    parent: Option<usize>,
    /// Revolute where theta moves, prismatic where r does.
    kind: JointKind,
    terms: Terms,
    /// Rot(z, gamma) Rot(x, alpha).
    orientation: Mat3<T>,
    /// Trans(z, b), then d along the turned x axis, in the parent.
    offset: Vec3<T>,
    theta: T,
    r: T,
}

/// The numbers of one row of the table in any number type: a dual number makes the model differentiable with
/// respect to it. Angles in rad, lengths in m; meaning as in [`Frame`].
#[derive(Debug, Clone, Copy)]
#[allow(missing_docs)]
pub struct Row<T> {
    pub gamma: T,
    pub b: T,
    pub alpha: T,
    pub d: T,
    pub theta: T,
    pub r: T,
}

impl<T: Number> Row<T> {
    /// The row as the table has it.
    pub fn new(frame: &Frame) -> Row<T> {
        Row {
            gamma: T::constant(frame.gamma),
            b: T::constant(frame.b),
            alpha: T::constant(frame.alpha),
            d: T::constant(frame.d),
            theta: T::constant(frame.theta),
            r: T::constant(frame.r),
        }
    }
}

/// The joints that move a frame on its parent, with their coefficients; most frames have one with 1.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Terms {
    list: [(usize, f64); MAX_TERMS],
    count: usize,
}

impl Terms {
    fn of(motion: &Motion) -> Terms {
        let mut terms = Terms::default();
        for (own, &term) in terms.list.iter_mut().zip(&motion.terms) {
            *own = term;
            terms.count += 1;
        }
        terms
    }

    /// Joints and coefficients.
    #[inline(always)]
    pub fn each(&self) -> &[(usize, f64)] {
        &self.list[..self.count]
    }

    /// The variable of the frame from those of the joints.
    #[inline(always)]
    fn combined<T: Number>(&self, joints: &[T]) -> T {
        match self.each() {
            [] => T::constant(0.0),
            [(joint, 1.0)] => joints[*joint],
            [(joint, c), more @ ..] => {
                let first = T::constant(*c) * joints[*joint];
                more.iter().fold(first, |sum, &(joint, c)| sum + T::constant(c) * joints[joint])
            }
        }
    }
}

/// Whether every frame moves with one joint's variable as it is, and every joint moves one frame.
#[inline(always)]
pub(super) fn is_independent<T>(links: &[Link<T>]) -> bool {
    let mut seen = 0_u32;
    links.iter().all(|link| match link.terms.each() {
        [] => true,
        [(joint, 1.0)] => {
            let new = seen & (1 << joint) == 0;
            seen |= 1 << joint;
            new
        }
        _ => false,
    })
}

impl<T: Number> Link<T> {
    /// Prepares the rows of a robot with other numbers, one per frame.
    pub fn with_rows(robot: &Robot, rows: &[Row<T>]) -> Vec<Link<T>> {
        let links = robot.frames.iter().zip(rows).zip(robot.motions());
        links
            .map(|((frame, row), motion)| {
                let (gamma, alpha) = (row.gamma.sin_cos(), row.alpha.sin_cos());
                Link::from_trigonometry((frame, &motion), row, gamma, alpha)
            })
            .collect()
    }

    /// The rows of a robot as they are, with exact zeros where an angle is a multiple of a right angle.
    pub fn of(robot: &Robot) -> Vec<Link<T>> {
        let exact = |angle: f64| {
            let (sine, cosine) = angle.sin_cos();
            let snap = |x: f64| if (x - x.round()).abs() < 1e-15 { x.round() } else { x };
            (T::constant(snap(sine)), T::constant(snap(cosine)))
        };
        let links = robot.frames.iter().zip(robot.motions());
        links
            .map(|(f, motion)| {
                Link::from_trigonometry((f, &motion), &Row::new(f), exact(f.gamma), exact(f.alpha))
            })
            .collect()
    }

    /// The same row in another number type.
    pub(super) fn lift(link: &Link<f64>) -> Link<T> {
        Link {
            parent: link.parent,
            kind: link.kind,
            terms: link.terms,
            orientation: link.orientation.map(|row| row.map(T::constant)),
            offset: link.offset.map(T::constant),
            theta: T::constant(link.theta),
            r: T::constant(link.r),
        }
    }

    fn from_trigonometry(
        (frame, motion): (&Frame, &Motion),
        row: &Row<T>,
        (sg, cg): (T, T),
        (sa, ca): (T, T),
    ) -> Link<T> {
        let zero = T::constant(0.0);
        Link {
            parent: frame.parent,
            kind: motion.kind,
            terms: Terms::of(motion),
            orientation: [[cg, -(sg * ca), sg * sa], [sg, cg * ca, -(cg * sa)], [zero, sa, ca]],
            offset: [row.d * cg, row.d * sg, row.b],
            theta: row.theta,
            r: row.r,
        }
    }

    /// Rotation from this frame to its parent, and its origin in the parent, at these joint positions.
    #[inline(always)]
    pub(super) fn transform_at(&self, joints: &[T]) -> (Mat3<T>, Vec3<T>) {
        self.transform(self.terms.combined(joints))
    }

    /// The same for the frame's own variable.
    #[inline(always)]
    fn transform(&self, q: T) -> (Mat3<T>, Vec3<T>) {
        let o = &self.orientation;
        let theta = if self.kind == JointKind::Revolute { self.theta + q } else { self.theta };
        let r = if self.kind == JointKind::Prismatic { self.r + q } else { self.r };
        let (s, c) = theta.sin_cos();
        let turned = |row: [T; 3]| [row[0] * c + row[1] * s, row[1] * c - row[0] * s, row[2]];
        let rotation = [turned(o[0]), turned(o[1]), turned(o[2])];
        let origin = add(self.offset, scale(r, [o[0][2], o[1][2], o[2][2]]));
        (rotation, origin)
    }

    pub(super) fn parent(&self) -> Option<usize> {
        self.parent
    }

    pub(super) fn kind(&self) -> JointKind {
        self.kind
    }

    pub(super) fn terms(&self) -> &Terms {
        &self.terms
    }
}

/// Motion of one frame, in its own coordinates unless said otherwise.
#[derive(Debug, Clone, Copy)]
pub(super) struct Body<T> {
    pub parent: Option<usize>,
    pub kind: JointKind,
    /// Joints that move the frame on its parent.
    pub terms: Terms,
    /// Orientation in frame 0.
    pub rotation: Mat3<T>,
    /// Origin in frame 0.
    pub origin: Vec3<T>,
    /// Angular velocity.
    pub w: Vec3<T>,
    /// Angular acceleration.
    pub dw: Vec3<T>,
    /// Velocity of the origin.
    pub v: Vec3<T>,
    /// Acceleration of the origin minus gravity.
    pub dv: Vec3<T>,
}

/// The forward recursion. Only the first `links.len()` bodies mean something.
#[inline(always)]
pub(super) fn propagate<T: Number>(
    links: &[Link<T>],
    gravity: [T; 3],
    q: &[T],
    dq: &[T],
    ddq: &[T],
) -> [Body<T>; MAX_FRAMES] {
    let zero = T::constant(0.0);
    let one = T::constant(1.0);
    let two = T::constant(2.0);
    let base = Body {
        parent: None,
        kind: JointKind::Fixed,
        terms: Terms::default(),
        rotation: [[one, zero, zero], [zero, one, zero], [zero, zero, one]],
        origin: [zero; 3],
        w: [zero; 3],
        dw: [zero; 3],
        v: [zero; 3],
        dv: [-gravity[0], -gravity[1], -gravity[2]],
    };
    let mut bodies = [base; MAX_FRAMES];
    for (k, link) in links.iter().enumerate() {
        let [qj, dqj, ddqj] = [q, dq, ddq].map(|joints| link.terms.combined(joints));
        let (rotation, origin) = link.transform(qj);
        let a = link.parent.map_or(base, |p| bodies[p]);
        let mut w = apply_transposed(&rotation, a.w);
        let mut dw = apply_transposed(&rotation, a.dw);
        let lever = cross(a.w, origin);
        let mut v = apply_transposed(&rotation, add(a.v, lever));
        let at_origin = add(a.dv, add(cross(a.dw, origin), cross(a.w, lever)));
        let mut dv = apply_transposed(&rotation, at_origin);
        match link.kind {
            JointKind::Revolute => {
                dw = add(dw, [w[1] * dqj, -(w[0] * dqj), ddqj]);
                w[2] += dqj;
            }
            JointKind::Prismatic => {
                let twice = two * dqj;
                dv = add(dv, [w[1] * twice, -(w[0] * twice), ddqj]);
                v[2] += dqj;
            }
            JointKind::Fixed => {}
        }
        bodies[k] = Body {
            parent: link.parent,
            kind: link.kind,
            terms: link.terms,
            rotation: multiply(&a.rotation, &rotation),
            origin: add(a.origin, apply(&a.rotation, origin)),
            w,
            dw,
            v,
            dv,
        };
    }
    bodies
}

impl<T: Number> Body<T> {
    /// The unit twist of the motion of frame `joint_frame` at this frame's origin, in this frame's coordinates:
    /// angular part, and velocity of the origin.
    #[inline(always)]
    pub fn twist_of(&self, joint_frame: &Body<T>) -> (Vec3<T>, Vec3<T>) {
        let axis = [joint_frame.rotation[0][2], joint_frame.rotation[1][2], joint_frame.rotation[2][2]];
        let along = apply_transposed(&self.rotation, axis);
        if joint_frame.kind == JointKind::Prismatic {
            return ([T::constant(0.0); 3], along);
        }
        let arm = super::vector::sub(self.origin, joint_frame.origin);
        (along, apply_transposed(&self.rotation, cross(axis, arm)))
    }

    /// Gravity's potential per unit mass at the origin, m2/s2.
    #[inline(always)]
    pub fn potential(&self, gravity: [T; 3]) -> T {
        -dot(gravity, self.origin)
    }
}
