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
    /// What the frame's own joint is; fixed where it has none.
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

impl Frame {
    /// A row whose numbers are all zero: the base frame itself, turned about or shifted along its z by the joint.
    ///
    /// ```
    /// use dynid_description::{Frame, JointKind};
    ///
    /// let shoulder = Frame::on_base(JointKind::Revolute);
    /// let elbow = Frame { parent: Some(0), d: 0.4, ..shoulder };
    /// assert_eq!((elbow.alpha, shoulder.parent), (0.0, None));
    /// ```
    pub const fn on_base(kind: JointKind) -> Self {
        Self { parent: None, kind, gamma: 0.0, b: 0.0, alpha: 0.0, d: 0.0, theta: 0.0, r: 0.0 }
    }
}

/// `sigma` of the table.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum JointKind {
    /// sigma = 0: q is added to theta.
    Revolute,
    /// sigma = 1: q is added to r.
    Prismatic,
    /// sigma = 2: no variable. In [`Frame::kind`] also a frame without a variable of its own that moves with those of
    /// others: [`Robot::motions`](crate::Robot::motions) says how.
    Fixed,
}

impl JointKind {
    /// The unit on a prismatic joint, else that on a revolute one.
    fn either(self, prismatic: &'static str, revolute: &'static str) -> &'static str {
        if self == Self::Prismatic { prismatic } else { revolute }
    }

    /// Unit of the joint's torque: N of a prismatic joint, N.m of a revolute one.
    pub fn torque_unit(self) -> &'static str {
        self.either("N", "N.m")
    }

    /// Unit of the joint's position: m or rad.
    pub fn position_unit(self) -> &'static str {
        self.either("m", "rad")
    }

    /// Unit of the joint's speed: m/s or rad/s.
    pub fn speed_unit(self) -> &'static str {
        self.either("m/s", "rad/s")
    }

    /// Unit of the joint's acceleration: m/s2 or rad/s2.
    pub fn acceleration_unit(self) -> &'static str {
        self.either("m/s2", "rad/s2")
    }

    /// Unit of viscous friction: N.s/m or N.m.s/rad.
    pub fn viscous_unit(self) -> &'static str {
        self.either("N.s/m", "N.m.s/rad")
    }

    /// Unit of an angular wave number over the position: 1/m or 1/rad.
    pub fn wave_unit(self) -> &'static str {
        self.either("1/m", "1/rad")
    }

    /// Unit of a stiffness: N/m or N.m/rad.
    pub fn stiffness_unit(self) -> &'static str {
        self.either("N/m", "N.m/rad")
    }
}
