//! What the standard parameters of a link and its joint are.

use crate::JointKind;
use ParameterKind::{Fc, Fcc, Fcm, Fv, Fvc, Fvm, Ia, K, KR, M, MX, MY, MZ, Off, XX, XY, XZ, YY, YZ, ZZ};
use serde::{Deserialize, Serialize};

/// What a standard parameter is, in the order of chi_st within a frame.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash, Serialize, Deserialize)]
pub enum ParameterKind {
    /// Moment of inertia about x at the origin of the frame.
    XX,
    /// Product of inertia.
    XY,
    /// Product of inertia.
    XZ,
    /// Moment of inertia about y.
    YY,
    /// Product of inertia.
    YZ,
    /// Moment of inertia about z.
    ZZ,
    /// First moment along x: mass times the x of the centre of mass.
    MX,
    /// First moment along y.
    MY,
    /// First moment along z.
    MZ,
    /// Mass.
    M,
    /// Rotor inertia, at the joint.
    Ia,
    /// Viscous friction.
    Fv,
    /// Coulomb friction.
    Fc,
    /// Constant torque, written `off`.
    #[serde(rename = "off")]
    Off,
    /// Viscous friction at motor speed, of a motor that several joints turn.
    Fvm,
    /// Coulomb friction at motor speed.
    Fcm,
    /// Viscous friction on a combination of joints.
    Fvc,
    /// Coulomb friction on a combination of joints.
    Fcc,
    /// Stiffness of a spring on a combination of joints.
    K,
    /// Stiffness times the position at rest of such a spring.
    KR,
}

impl ParameterKind {
    /// The inertial parameters that every link has, in order.
    pub const INERTIAL: [ParameterKind; 10] = [XX, XY, XZ, YY, YZ, ZZ, MX, MY, MZ, M];

    /// The parameters that every joint has beside those of its link, in order.
    pub const JOINT: [ParameterKind; 4] = [Ia, Fv, Fc, Off];

    /// The parameters of a motor with friction at motor speed, in order.
    pub const MOTOR: [ParameterKind; 2] = [Fvm, Fcm];

    /// As it is written before the number of the frame.
    pub fn symbol(self) -> &'static str {
        match self {
            XX => "XX",
            XY => "XY",
            XZ => "XZ",
            YY => "YY",
            YZ => "YZ",
            ZZ => "ZZ",
            MX => "MX",
            MY => "MY",
            MZ => "MZ",
            M => "M",
            Ia => "Ia",
            Fv => "Fv",
            Fc => "Fc",
            Off => "off",
            Fvm => "Fvm",
            Fcm => "Fcm",
            Fvc => "Fvc",
            Fcc => "Fcc",
            K => "K",
            KR => "KR",
        }
    }

    /// What it is, in the middle of a sentence.
    pub fn meaning(self) -> &'static str {
        match self {
            XX => "moment of inertia of the link about x, at the origin of its frame",
            YY => "moment of inertia about y",
            ZZ => "moment of inertia about z",
            XY => "product of inertia, -∫xy dm",
            XZ => "product of inertia, -∫xz dm",
            YZ => "product of inertia, -∫yz dm",
            MX => "first moment, mass times the x of the centre of mass",
            MY => "first moment along y",
            MZ => "first moment along z",
            M => "mass",
            Ia => "inertia of the rotor, at the joint",
            Fv => "viscous friction of the joint",
            Fc => "Coulomb friction of the joint",
            Off => "constant torque of the joint: what the sensor or the current says where there is none",
            Fvm => "viscous friction at motor speed, of a motor that several joints turn",
            Fcm => "Coulomb friction at motor speed",
            Fvc => "viscous friction between links or of a tendon, on a combination of joint speeds",
            Fcc => "Coulomb friction between links or of a tendon",
            K => "stiffness of a spring that the table names",
            KR => "stiffness of such a spring times its position at rest",
        }
    }

    /// Whether its torque is friction: viscous, or one that follows the sign of a speed.
    pub fn is_friction(self) -> bool {
        self.is_viscous() || self.is_coulomb()
    }

    /// Whether its torque is proportional to a speed: of a joint, of a motor, or of a combination of joints.
    pub fn is_viscous(self) -> bool {
        matches!(self, Fv | Fvm | Fvc)
    }

    /// Whether its torque follows the sign of a speed.
    pub fn is_coulomb(self) -> bool {
        matches!(self, Fc | Fcm | Fcc)
    }

    /// Whether it is one of a spring.
    pub fn is_spring(self) -> bool {
        matches!(self, K | KR)
    }

    /// Whether its torque is part of a joint's load: inertia, gravity, rotors and springs, which store energy.
    pub fn is_load(self) -> bool {
        self <= Ia || self.is_spring()
    }

    /// SI unit, where the frame that the parameter belongs to moves like this.
    ///
    /// ```
    /// use dynid_description::{JointKind, ParameterKind};
    ///
    /// assert_eq!(ParameterKind::Fv.unit(JointKind::Revolute), "N.m.s/rad");
    /// assert_eq!(ParameterKind::Fv.unit(JointKind::Prismatic), "N.s/m");
    /// ```
    pub fn unit(self, kind: JointKind) -> &'static str {
        match self {
            XX | XY | XZ | YY | YZ | ZZ => "kg.m2",
            MX | MY | MZ => "kg.m",
            M => "kg",
            Ia if kind == JointKind::Prismatic => "kg",
            Ia => "kg.m2",
            Fv | Fvm | Fvc => kind.viscous_unit(),
            Fc | Off | Fcm | Fcc | KR => kind.torque_unit(),
            K => kind.stiffness_unit(),
        }
    }
}
