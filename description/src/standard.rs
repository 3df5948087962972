//! The standard parameters of a table, and a robot described by them alone.

use crate::{BaseParameter, Drive, Frame, JointKind, Limits, ParameterKind, Robot, StandardParameter};
use std::borrow::Cow;

/// The standard parameters of a table in the order of chi_st.
///
/// For each frame XX XY XZ YY YZ ZZ MX MY MZ M; where the frame is a joint, Ia Fv Fc off follow, then Fvm Fcm where
/// its motor is among `coupled_friction` (0-based motors).
pub fn standard_parameters(frames: &[Frame], coupled_friction: &[usize]) -> Vec<StandardParameter> {
    let mut standard = Vec::new();
    let mut joint = 0;
    for (frame, row) in frames.iter().enumerate() {
        let mut push = |list: &[ParameterKind]| {
            standard.extend(list.iter().map(|&kind| {
                let name = Cow::Owned(format!("{}{}", kind.symbol(), frame + 1));
                StandardParameter { name, kind, frame }
            }));
        };
        push(&ParameterKind::INERTIAL);
        if row.kind != JointKind::Fixed {
            push(&ParameterKind::JOINT);
            if coupled_friction.contains(&joint) {
                push(&ParameterKind::MOTOR);
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
                unit: Cow::Borrowed(p.kind.unit(frames[p.frame].kind)),
            })
            .collect();
        Robot {
            name: Cow::Owned(name.to_owned()),
            description: Cow::Borrowed("every standard parameter by itself"),
            gravity,
            frames: Cow::Owned(frames),
            dependent: Cow::Borrowed(&[]),
            drive,
            known: Cow::Borrowed(&[]),
            limits,
            standard: Cow::Owned(standard),
            base: Cow::Owned(base),
            nominal: None,
        }
    }
}
