//! The standard parameters (3) of a robot, in the order of chi_st.

use super::{Drive, Frame, JointKind};
use ParameterKind::{Fc, Fcm, Fv, Fvm, Ia, M, MX, MY, MZ, Off, XX, XY, XZ, YY, YZ, ZZ};

/// What a standard parameter is, in the order of (3).
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

/// A standard parameter of a robot.
#[derive(Debug, Clone, PartialEq)]
pub struct StandardParameter {
    /// `ZZ1`, `Ia3`, `Fvm6`: kind and number j of the frame.
    pub name: String,
    /// What it is.
    pub kind: ParameterKind,
    /// Index of its frame in `Robot::frames`.
    pub frame: usize,
}

/// The ten inertial parameters of a link, in order.
pub(crate) const INERTIAL: [ParameterKind; 10] = [XX, XY, XZ, YY, YZ, ZZ, MX, MY, MZ, M];

/// The standard parameters of a table: for each frame XX XY XZ YY YZ ZZ MX MY MZ M; where it is a joint Ia Fv Fc off
/// follow, then Fvm Fcm where its motor has coupled friction.
pub fn standard_parameters(frames: &[Frame], drive: &Drive) -> Vec<StandardParameter> {
    let mut parameters = Vec::new();
    let mut joint = 0;
    for (frame, row) in frames.iter().enumerate() {
        let mut push = |kind: ParameterKind| {
            parameters.push(StandardParameter { name: format!("{}{}", kind.symbol(), row.j), kind, frame });
        };
        INERTIAL.into_iter().for_each(&mut push);
        if row.kind == JointKind::Fixed {
            continue;
        }
        [Ia, Fv, Fc, Off].into_iter().for_each(&mut push);
        if drive.coupled_friction.contains(&joint) {
            [Fvm, Fcm].into_iter().for_each(&mut push);
        }
        joint += 1;
    }
    parameters
}

impl ParameterKind {
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
        }
    }

    /// SI unit, for the parameters of a joint that depend on how it moves (`kind`).
    pub fn unit(self, kind: JointKind) -> &'static str {
        let prismatic = kind == JointKind::Prismatic;
        match self {
            XX | XY | XZ | YY | YZ | ZZ => "kg.m2",
            MX | MY | MZ => "kg.m",
            M => "kg",
            Ia if prismatic => "kg",
            Ia => "kg.m2",
            Fv | Fvm if prismatic => "N.s/m",
            Fv | Fvm => "N.m.s/rad",
            Fc | Off | Fcm if prismatic => "N",
            Fc | Off | Fcm => "N.m",
        }
    }
}
