//! A robot as its YAML says: the modified-DH table in symbols.
//!
//! ```yaml
//! name: arm                         # a Rust identifier
//! description: one line             # optional
//! gravity: [0, 0, -9.81]            # m/s2, in frame 0; this where it is not given
//! constants: {d3: 0.225}            # optional; a constant may use those above it
//! frames:                           # angles in rad, lengths in m
//!   - {j: 1, sigma: 0, alpha: 0,     d: 0,  theta: q1,        r: 0}
//!   - {j: 2, sigma: 0, alpha: -pi/2, d: 0,  theta: q2 - pi/2, r: 0}
//!   - {j: 3, parent: 1, sigma: 1, gamma: pi/4, b: 0.1, alpha: 0, d: d3, theta: 0, r: q3}
//! drive:                            # optional
//!   gear: [32, 32, 400]             # one ratio a joint, or a matrix: motor speed = gear * joint speed
//!   coupled_friction: [2]           # motors with friction at motor speed (Fvm2, Fcm2)
//! limits:                           # optional, each of them; x stands for [-x, x], one value for every joint
//!   position: [pi, [-1, 2], 0.2]
//!   velocity: 3
//!   acceleration: 50
//!   torque: [100, 80, 200]
//! nominal:                          # optional, each of them
//!   parameters: {ZZ1: 0.35, Fv1: 7.9}              # standard parameters by name; others are 0
//!   controller: {kp: [900, 700, 5000], kd: 20, ki: 0}  # joint side
//!   noise: {position: 1e-6, torque: 0.3}           # one sigma, joint side
//! ```
//!
//! Wherever a number stands there may be an expression of numbers, `pi` and constants with + - * / and parentheses.
//! theta of a revolute joint and r of a prismatic one are `q<j>` plus such an expression, in any order.

mod diagnostic;
mod document;
mod drive;
mod expression;
mod formula;
mod parse;
mod reader;
mod simulation_values;
mod standard;
mod table;

pub use diagnostic::Diagnostic;
pub use expression::Expression;
pub use parse::{parse, parse_with_doubts};
pub(crate) use standard::INERTIAL;
pub use standard::{ParameterKind, StandardParameter, standard_parameters};

/// A robot read from its YAML, checked.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// A Rust identifier in snake case.
    pub name: String,
    /// One line for a person.
    pub description: String,
    /// Gravity in frame 0, m/s2.
    pub gravity: [f64; 3],
    /// Named constants in the order of the file.
    pub constants: Vec<(String, f64)>,
    /// The table: parents before children.
    pub frames: Vec<Frame>,
    /// Motors and transmission.
    pub drive: Drive,
    /// Limits per joint.
    pub limits: Limits,
    /// Values for simulation.
    pub nominal: Option<Nominal>,
}

/// One row of the table. Transformation from the parent: Rot(z, gamma) Trans(z, b) Rot(x, alpha) Trans(x, d)
/// Rot(z, theta) Trans(z, r).
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Number of the frame, from 1, as in the YAML.
    pub j: usize,
    /// Number of the parent frame; 0 is the base.
    pub parent: usize,
    /// `sigma`.
    pub kind: JointKind,
    /// Branch angle, rad.
    pub gamma: Expression,
    /// Branch offset, m.
    pub b: Expression,
    /// Angle between the z axes about the parent's x, rad.
    pub alpha: Expression,
    /// Distance between the z axes along the parent's x, m.
    pub d: Expression,
    /// Constant part of theta, rad: q_j is added for a revolute joint.
    pub theta: Expression,
    /// Constant part of r, m: q_j is added for a prismatic joint.
    pub r: Expression,
}

/// `sigma` of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// sigma = 0.
    Revolute,
    /// sigma = 1.
    Prismatic,
    /// sigma = 2.
    Fixed,
}

/// Motors and transmission: motor speed = gear * joint speed.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// n x n, row = motor, column = joint; identity where the YAML does not say.
    pub gear: Vec<Vec<f64>>,
    /// Motors, as 0-based joint indices, with friction at motor speed.
    pub coupled_friction: Vec<usize>,
}

/// `[low, high]` per joint, SI; empty where the YAML does not say.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Limits {
    /// rad or m.
    pub position: Vec<[f64; 2]>,
    /// rad/s or m/s.
    pub velocity: Vec<[f64; 2]>,
    /// rad/s2 or m/s2.
    pub acceleration: Vec<[f64; 2]>,
    /// N.m or N.
    pub torque: Vec<[f64; 2]>,
}

/// Values for simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Nominal {
    /// Standard parameters by name (`ZZ1`, `Ia1`, `Fvm6`); a parameter that is not named is zero.
    pub standard: Vec<(String, f64)>,
    /// Proportional gains per joint; empty where not given. N.m/rad or N/m at the joint.
    pub kp: Vec<f64>,
    /// Derivative gains per joint.
    pub kd: Vec<f64>,
    /// Integral gains per joint.
    pub ki: Vec<f64>,
    /// Encoder noise at the joint, 1 sigma, rad or m.
    pub position_noise: Vec<f64>,
    /// Torque noise, 1 sigma, N.m or N.
    pub torque_noise: Vec<f64>,
}

impl Robot {
    /// The frames that are joints, in order: index in `frames` of joint 0, 1, ...
    pub fn joint_frames(&self) -> Vec<usize> {
        (0..self.frames.len()).filter(|&k| self.frames[k].kind != JointKind::Fixed).collect()
    }
}
