//! The standard parameters of a table, and a robot described by them alone.

use super::{BaseParameter, Drive, Frame, JointKind, Limits, ParameterKind, Robot, StandardParameter};
use std::borrow::Cow;

const INERTIAL: [(ParameterKind, &str); 10] = [
    (ParameterKind::XX, "XX"),
    (ParameterKind::XY, "XY"),
    (ParameterKind::XZ, "XZ"),
    (ParameterKind::YY, "YY"),
    (ParameterKind::YZ, "YZ"),
    (ParameterKind::ZZ, "ZZ"),
    (ParameterKind::MX, "MX"),
    (ParameterKind::MY, "MY"),
    (ParameterKind::MZ, "MZ"),
    (ParameterKind::M, "M"),
];

const DRIVE: [(ParameterKind, &str); 4] = [
    (ParameterKind::Ia, "Ia"),
    (ParameterKind::Fv, "Fv"),
    (ParameterKind::Fc, "Fc"),
    (ParameterKind::Off, "off"),
];

const COUPLED: [(ParameterKind, &str); 2] = [(ParameterKind::Fvm, "Fvm"), (ParameterKind::Fcm, "Fcm")];

/// The standard parameters of a table in the order of chi_st.
pub fn standard_parameters(frames: &[Frame], coupled_friction: &[usize]) -> Vec<StandardParameter> {
    let mut standard = Vec::new();
    let mut joint = 0;
    for (frame, row) in frames.iter().enumerate() {
        let mut push = |list: &[(ParameterKind, &str)]| {
            standard.extend(list.iter().map(|&(kind, name)| StandardParameter {
                name: Cow::Owned(format!("{name}{}", frame + 1)),
                kind,
                frame,
            }));
        };
        push(&INERTIAL);
        if row.kind != JointKind::Fixed {
            push(&DRIVE);
            if coupled_friction.contains(&joint) {
                push(&COUPLED);
            }
            joint += 1;
        }
    }
    standard
}

impl Robot {
    /// A robot of this table and drive whose every standard parameter is its own base parameter: nothing is
    /// regrouped, so its regressor is IDM_st and it has more parameters than a recording can tell.
    pub fn with_standard_as_base(
        name: &str,
        gravity: [f64; 3],
        frames: Vec<Frame>,
        drive: Drive,
        limits: Limits,
    ) -> Robot {
        let standard = standard_parameters(&frames, &drive.coupled_friction);
        let base = standard
            .iter()
            .enumerate()
            .map(|(k, p)| BaseParameter {
                name: p.name.clone(),
                standard: k,
                combination: Cow::Owned(vec![(k, 1.0)]),
                relation: p.name.clone(),
                unit: Cow::Borrowed(unit(p.kind, frames[p.frame].kind)),
            })
            .collect();
        Robot {
            name: Cow::Owned(name.to_owned()),
            description: Cow::Borrowed("every standard parameter by itself"),
            gravity,
            frames: Cow::Owned(frames),
            drive,
            limits,
            standard: Cow::Owned(standard),
            base: Cow::Owned(base),
            nominal: None,
        }
    }

    /// Joint number of each frame, `None` for a fixed one.
    pub fn joint_of_frame(&self) -> Vec<Option<usize>> {
        let mut joint = 0;
        self.frames
            .iter()
            .map(|f| {
                let moves = f.kind != JointKind::Fixed;
                joint += usize::from(moves);
                moves.then(|| joint - 1)
            })
            .collect()
    }
}

/// SI unit of a standard parameter on a joint of this kind.
pub fn unit(kind: ParameterKind, joint: JointKind) -> &'static str {
    use ParameterKind::{Fc, Fcm, Fv, Fvm, Ia, M, MX, MY, MZ, Off};
    let prismatic = joint == JointKind::Prismatic;
    match kind {
        MX | MY | MZ => "kg.m",
        M => "kg",
        Ia if prismatic => "kg",
        Fv | Fvm if prismatic => "N.s/m",
        Fc | Fcm | Off if prismatic => "N",
        Fv | Fvm => "N.m.s/rad",
        Fc | Fcm | Off => "N.m",
        _ => "kg.m2",
    }
}
