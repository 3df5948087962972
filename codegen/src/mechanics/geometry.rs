//! The table in a form that saves operations: exact constant rotations, and parallel axes turned together.

use super::vector::{self, Vector};
use crate::robot::RobotTable;
use crate::symbolic::{Angle, ConstantAngle, Expr, Graph, Symbol};
use dynid_description::JointKind;

/// A rotation C Rz(angle): a constant part, then a turn about the new z axis.
#[derive(Debug, Clone, PartialEq)]
pub struct Rotation {
    /// C, row-major; its entries are exactly 0 and +-1 where the table turns by multiples of pi/2.
    pub fixed: [[f64; 3]; 3],
    /// The turn about z.
    pub angle: Angle,
}

/// A frame of the table.
#[derive(Debug, Clone)]
pub struct Link {
    /// Number of the frame, from 1.
    pub j: usize,
    /// Revolute where theta moves, prismatic where r does, fixed where nothing does.
    pub kind: JointKind,
    /// Index of the joint whose own frame it is.
    pub joint: Option<usize>,
    /// Joints that move it on its parent, with their coefficients.
    pub terms: Vec<(usize, f64)>,
    /// z of the frame, along which r moves, in the parent frame.
    pub along: [f64; 3],
    /// Index of the parent frame; `None` is the base.
    pub parent: Option<usize>,
    /// Orientation in the parent frame.
    pub from_parent: Rotation,
    /// Origin in the parent frame, m.
    pub position: Vector,
    /// The nearest ancestor in which the orientation is one turn of a constant rotation: consecutive parallel axes
    /// share it, and the sines and cosines of their angles merge into those of the sum.
    pub reference: Option<usize>,
    /// Orientation in the reference frame.
    pub from_reference: Rotation,
}

/// The kinematic tree.
#[derive(Debug, Clone)]
pub struct Geometry {
    /// One per frame of the table, parents first.
    pub links: Vec<Link>,
    /// Frame of each joint.
    pub joint_frames: Vec<usize>,
    /// Gravity in frame 0, m/s2.
    pub gravity: [f64; 3],
}

impl Rotation {
    /// Components in the outer frame of a vector given in the turned frame.
    pub fn outward(&self, g: &mut Graph, v: Vector) -> Vector {
        let (s, c) = g.sin_cos(&self.angle);
        let (cx, sy) = (g.mul(c, v[0]), g.mul(s, v[1]));
        let (sx, cy) = (g.mul(s, v[0]), g.mul(c, v[1]));
        let turned = [g.sub(cx, sy), g.add(sx, cy), v[2]];
        vector::apply(g, &self.fixed, turned)
    }

    /// Components in the turned frame of a vector given in the outer frame.
    pub fn inward(&self, g: &mut Graph, v: Vector) -> Vector {
        let v = vector::apply(g, &transposed(&self.fixed), v);
        let (s, c) = g.sin_cos(&self.angle);
        let (cx, sy) = (g.mul(c, v[0]), g.mul(s, v[1]));
        let (sx, cy) = (g.mul(s, v[0]), g.mul(c, v[1]));
        [g.add(cx, sy), g.sub(cy, sx), v[2]]
    }
}

impl Geometry {
    /// The tree of a robot. `merge` turns consecutive parallel axes together.
    pub fn new(g: &mut Graph, robot: &RobotTable, merge: bool) -> Self {
        let mut links: Vec<Link> = Vec::with_capacity(robot.frames.len());
        let mut joint_frames = Vec::new();
        for (frame, motion) in robot.frames.iter().zip(robot.motions()) {
            let joint = (frame.kind != JointKind::Fixed).then(|| {
                joint_frames.push(links.len());
                joint_frames.len() - 1
            });
            let parent = robot.frames[..links.len()].iter().position(|f| f.j == frame.parent);
            let gamma = ConstantAngle::from_radians(frame.gamma.value());
            let alpha = ConstantAngle::from_radians(frame.alpha.value());
            let mut theta = Angle::constant(ConstantAngle::from_radians(frame.theta.value()));
            let mut r = g.constant(frame.r.value());
            match motion.kind {
                // Coefficients of angles are whole numbers.
                JointKind::Revolute => {
                    for &(joint, k) in &motion.terms {
                        theta = &theta + &Angle { terms: vec![(joint, k as i32)], ..Angle::default() };
                    }
                }
                JointKind::Prismatic => {
                    let q = weighted(g, &motion.terms, Symbol::Position);
                    r = g.add(r, q);
                    g.name(r, &format!("r{}", frame.j));
                }
                JointKind::Fixed => {}
            }
            let turn = about_z(gamma);
            let fixed = product(&turn, &about_x(alpha));
            let along_z = [0.0, 0.0, 1.0];
            let lever = fixed.map(|row| row.iter().zip(along_z).map(|(a, b)| a * b).sum::<f64>());
            let d = frame.d.value();
            let offset = [turn[0][0] * d, turn[1][0] * d, frame.b.value()];
            let position: Vector = std::array::from_fn(|k| {
                let (constant, variable) = (g.constant(offset[k]), g.scale(lever[k], r));
                g.add(constant, variable)
            });
            let from_parent = Rotation { fixed, angle: theta };
            let (reference, from_reference) = match parent {
                Some(p) if merge => merged(&links[p], p, gamma, alpha, &from_parent),
                None => (None, from_parent.clone()),
                Some(p) => (Some(p), from_parent.clone()),
            };
            links.push(Link {
                j: frame.j,
                kind: motion.kind,
                joint,
                terms: motion.terms,
                along: lever,
                parent,
                from_parent,
                position,
                reference,
                from_reference,
            });
        }
        Geometry { links, joint_frames, gravity: robot.gravity }
    }

    /// Whether frame `ancestor` is on the way from the base to `frame`, `frame` itself included.
    pub fn carries(&self, ancestor: usize, frame: usize) -> bool {
        let mut at = Some(frame);
        while let Some(k) = at {
            if k == ancestor {
                return true;
            }
            at = self.links[k].parent;
        }
        false
    }
}

/// Reference and orientation of a frame whose parent is `parent`, with everything constant or parallel folded in.
fn merged(
    parent: &Link,
    index: usize,
    gamma: ConstantAngle,
    alpha: ConstantAngle,
    own: &Rotation,
) -> (Option<usize>, Rotation) {
    let outer = &parent.from_reference;
    if outer.angle.is_constant() {
        let fixed = product(&product(&outer.fixed, &about_z(outer.angle.constant)), &own.fixed);
        return (parent.reference, Rotation { fixed, angle: own.angle.clone() });
    }
    let before = &outer.angle + &Angle::constant(gamma);
    if alpha == ConstantAngle::default() {
        let angle = &before + &own.angle;
        return (parent.reference, Rotation { fixed: outer.fixed, angle });
    }
    if alpha.is_exact() && alpha.quarter_turns == 2 {
        // Rz(a) Rx(pi) = Rx(pi) Rz(-a).
        let fixed = product(&outer.fixed, &about_x(alpha));
        return (parent.reference, Rotation { fixed, angle: &-&before + &own.angle });
    }
    (Some(index), own.clone())
}

fn about_z(angle: ConstantAngle) -> [[f64; 3]; 3] {
    let (s, c) = angle.sin_cos();
    [[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]]
}

fn about_x(angle: ConstantAngle) -> [[f64; 3]; 3] {
    let (s, c) = angle.sin_cos();
    [[1.0, 0.0, 0.0], [0.0, c, -s], [0.0, s, c]]
}

/// Product of two rotations. An entry that differs from 0 or +-1 by rounding only is that number, so that the products
/// it would spoil vanish.
fn product(a: &[[f64; 3]; 3], b: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let entry = |i: usize, j: usize| {
        let exact: f64 = (0..3).map(|k| a[i][k] * b[k][j]).sum();
        if (exact - exact.round()).abs() < 4.0 * f64::EPSILON { exact.round() } else { exact }
    };
    std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j)))
}

fn transposed(m: &[[f64; 3]; 3]) -> [[f64; 3]; 3] {
    std::array::from_fn(|i| std::array::from_fn(|j| m[j][i]))
}

/// Sum of k_j times a rate of joint j, for the joints of an angle.
pub fn angle_rate(g: &mut Graph, angle: &Angle, rate: impl Fn(usize) -> Symbol) -> Expr {
    let terms: Vec<(usize, f64)> = angle.terms.iter().map(|&(joint, k)| (joint, f64::from(k))).collect();
    weighted(g, &terms, rate)
}

/// Sum of coefficient times a symbol of joints.
fn weighted(g: &mut Graph, terms: &[(usize, f64)], symbol: impl Fn(usize) -> Symbol) -> Expr {
    let mut total = Graph::ZERO;
    for &(joint, k) in terms {
        let symbol = g.symbol(symbol(joint));
        let term = g.scale(k, symbol);
        total = g.add(total, term);
    }
    total
}

impl Link {
    /// The rate at which r moves; 0 where it does not.
    pub fn length_rate(&self, g: &mut Graph, rate: impl Fn(usize) -> Symbol) -> Expr {
        if self.kind == JointKind::Prismatic { weighted(g, &self.terms, rate) } else { Graph::ZERO }
    }

    /// Velocity of the frame on its parent per unit of one of its joints' speeds: about z, and along z.
    pub fn own_velocity(&self, joint: usize) -> (f64, f64) {
        let k = self.terms.iter().find(|t| t.0 == joint).map_or(0.0, |t| t.1);
        match self.kind {
            JointKind::Prismatic => (0.0, k),
            _ => (k, 0.0),
        }
    }
}
