//! A row of the table.

use serde::{Deserialize, Serialize};

/// One row of the modified-DH table (Khalil and Kleinfinger 1986), evaluated; angles in rad, lengths in m.
///
/// The transformation from the parent frame is Rot(z, gamma) Trans(z, b) Rot(x, alpha) Trans(x, d)
/// Rot(z, theta) Trans(z, r); the joint variable is added to `theta` (revolute) or `r` (prismatic).
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
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
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum JointKind {
    /// sigma = 0: q is added to theta.
    Revolute,
    /// sigma = 1: q is added to r.
    Prismatic,
    /// sigma = 2: no variable.
    Fixed,
}
