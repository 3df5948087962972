//! What the runtime knows about a robot: its numeric table, its drive, and its parameters by name.

use std::borrow::Cow;

/// A robot as numbers: the modified-DH table evaluated, the drive, and the names and order of its parameters.
///
/// Generated for the robots of `robots/` as a `static`, built at run time for a robot given by path.
#[derive(Debug, Clone, PartialEq)]
pub struct Robot {
    /// The name it is called by on the command line.
    pub name: Cow<'static, str>,
    /// One line for a person.
    pub description: Cow<'static, str>,
    /// Gravity in frame 0, m/s2.
    pub gravity: [f64; 3],
    /// One row per frame, base first, parents before children.
    pub frames: Cow<'static, [Frame]>,
    /// Transmission between motors and joints.
    pub drive: Drive,
    /// Limits per joint, SI.
    pub limits: Limits,
    /// The standard parameters (3) in the order of chi_st: for each frame XX XY XZ YY YZ ZZ MX MY MZ M, then,
    /// where the frame is a joint, Ia Fv Fc off, then Fvm Fcm where its motor has coupled friction.
    pub standard: Cow<'static, [StandardParameter]>,
    /// The base parameters in the order of chi, joint after joint in the same order.
    pub base: Cow<'static, [BaseParameter]>,
    /// Values for simulation, where the YAML gives them.
    pub nominal: Option<Nominal>,
}

/// One row of the modified-DH table (Khalil and Kleinfinger 1986), evaluated; angles in rad, lengths in m.
///
/// The transformation from the parent frame is Rot(z, gamma) Trans(z, b) Rot(x, alpha) Trans(x, d)
/// Rot(z, theta) Trans(z, r); the joint variable is added to `theta` (revolute) or `r` (prismatic).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Frame {
    /// Index of the parent in `Robot::frames`; `None` for the base (frame 0).
    pub parent: Option<usize>,
    /// Revolute, prismatic or fixed.
    pub kind: JointKind,
    /// Branch angle, rad.
    pub gamma: f64,
    /// Branch offset, m.
    pub b: f64,
    /// Angle between z of the parent and z, rad.
    pub alpha: f64,
    /// Distance between z of the parent and z, m.
    pub d: f64,
    /// Constant part of theta, rad.
    pub theta: f64,
    /// Constant part of r, m.
    pub r: f64,
}

/// `sigma` of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum JointKind {
    /// sigma = 0: q is added to theta.
    Revolute,
    /// sigma = 1: q is added to r.
    Prismatic,
    /// sigma = 2: no variable.
    Fixed,
}

/// Motors and transmission: motor speed = gear * joint speed, joint torque = gearT * motor torque.
#[derive(Debug, Clone, PartialEq)]
pub struct Drive {
    /// n x n, row-major (row = motor, column = joint).
    pub gear: Cow<'static, [f64]>,
    /// Motors (0-based) whose viscous and Coulomb friction also act at motor speed (Fvm, Fcm).
    pub coupled_friction: Cow<'static, [usize]>,
}

/// `[low, high]` per joint, SI; empty where the YAML does not say.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Limits {
    /// rad or m.
    pub position: Cow<'static, [[f64; 2]]>,
    /// rad/s or m/s.
    pub velocity: Cow<'static, [[f64; 2]]>,
    /// rad/s2 or m/s2.
    pub acceleration: Cow<'static, [[f64; 2]]>,
    /// N.m or N.
    pub torque: Cow<'static, [[f64; 2]]>,
}

/// A standard parameter of (3).
#[derive(Debug, Clone, PartialEq)]
pub struct StandardParameter {
    /// `ZZ1`, `Ia3`, `Fvm6`, ...
    pub name: Cow<'static, str>,
    /// What it is.
    pub kind: ParameterKind,
    /// Frame it belongs to, 0-based index in `Robot::frames`.
    pub frame: usize,
}

/// What a parameter is, in the order of (3).
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
#[allow(missing_docs)]
pub enum ParameterKind {
    XX,
    XY,
    XZ,
    YY,
    YZ,
    ZZ,
    MX,
    MY,
    MZ,
    M,
    Ia,
    Fv,
    Fc,
    Off,
    Fvm,
    Fcm,
}

/// A base parameter: a standard parameter with what was regrouped into it.
#[derive(Debug, Clone, PartialEq)]
pub struct BaseParameter {
    /// Standard name, with an R when something was regrouped into it (`ZZ1R`).
    pub name: Cow<'static, str>,
    /// Index in `Robot::standard` of the parameter whose column of IDM_st is kept.
    pub standard: usize,
    /// chi = sum of coefficient * `chi_st[index]`; the kept parameter itself has coefficient 1.
    pub combination: Cow<'static, [(usize, f64)]>,
    /// The relation in symbols of the table: `ZZ1 + Ia1 + d3^2*M3 + ...`.
    pub relation: Cow<'static, str>,
    /// SI unit: `kg.m2`, `N.m.s/rad`, ...
    pub unit: Cow<'static, str>,
}

/// Values for simulation.
#[derive(Debug, Clone, PartialEq)]
pub struct Nominal {
    /// chi_st, in the order of `Robot::standard`.
    pub standard: Cow<'static, [f64]>,
    /// Proportional gain per joint, N.m/rad or N/m; empty where the YAML does not say.
    pub kp: Cow<'static, [f64]>,
    /// Derivative gain per joint, N.m.s/rad or N.s/m.
    pub kd: Cow<'static, [f64]>,
    /// Integral gain per joint.
    pub ki: Cow<'static, [f64]>,
    /// Encoder noise per joint, 1 sigma, rad or m at the joint.
    pub position_noise: Cow<'static, [f64]>,
    /// Torque noise per joint, 1 sigma, N.m or N.
    pub torque_noise: Cow<'static, [f64]>,
}

impl Robot {
    /// Number of joints n (fixed frames do not count).
    pub fn joints(&self) -> usize {
        self.frames.iter().filter(|f| f.kind != JointKind::Fixed).count()
    }

    /// Standard parameters, by index, that no base parameter holds: they have no effect on any torque.
    pub fn without_effect(&self) -> Vec<usize> {
        let held = |k: usize| self.base.iter().any(|b| b.combination.iter().any(|&(column, _)| column == k));
        (0..self.standard.len()).filter(|&k| !held(k)).collect()
    }

    /// chi from chi_st: every base parameter as its combination of standard parameters.
    pub fn base_from_standard(&self, standard: &[f64]) -> Vec<f64> {
        self.base.iter().map(|p| p.combination.iter().map(|&(k, c)| c * standard[k]).sum()).collect()
    }
}
