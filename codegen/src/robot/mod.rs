//! A robot as its YAML says: the modified-DH table in symbols.

mod diagnostic;
mod document;
mod drive;
mod expression;
mod formula;
mod parse;
mod reader;
mod simulation_values;
mod table;

pub use diagnostic::Diagnostic;
pub use expression::Expression;
pub use parse::parse;

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
