//! The standard parameters of a table, and a robot described by them alone.

use crate::{
    BaseParameter, Coupling, Drive, Frame, JointKind, Limits, ParameterKind, Robot, StandardParameter,
};
use std::borrow::Cow;

/// The standard parameters of a table in the order of chi_st.
///
/// For each frame XX XY XZ YY YZ ZZ MX MY MZ M; where the frame is a joint, Ia Fv Fc off follow, then Fvm Fcm where
/// its motor is among `coupled_friction` (0-based motors). Behind all frames come those of `couplings`, one after the other;
/// one that names no joint of the table has none.
pub fn standard_parameters(
    frames: &[Frame],
    coupled_friction: &[usize],
    couplings: &[Coupling],
) -> Vec<StandardParameter> {
    let mut standard = Vec::new();
    let mut joint = 0;
    for (frame, row) in frames.iter().enumerate() {
        let mut push = |list: &[ParameterKind]| {
            standard.extend(list.iter().map(|&kind| {
                let name = Cow::Owned(format!("{}{}", kind.symbol(), frame + 1));
                StandardParameter { name, kind, frame, coupling: None }
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
    for (k, coupling) in couplings.iter().enumerate() {
        let Some(frame) = coupling.frame(frames) else { continue };
        standard.extend(coupling.law.parameters().iter().map(|&kind| {
            let name = Cow::Owned(format!("{}{}", kind.symbol(), coupling.name));
            StandardParameter { name, kind, frame, coupling: Some(k) }
        }));
    }
    standard
}

impl Robot {
    /// The robot with these couplings in place of its own, each of their parameters its own base parameter behind all
    /// others: nothing is regrouped.
    ///
    /// ```
    /// use dynid_description::{Coupling, CouplingLaw, Drive, Frame, JointKind, Limits, Robot};
    ///
    /// let axis = Frame::on_base(JointKind::Revolute);
    /// let drive = Drive { gear: vec![1.0, 0.0, 0.0, 1.0].into(), coupled_friction: vec![].into() };
    /// let robot = Robot::with_standard_as_base("arm", [0.0; 3], vec![axis, axis], drive, Limits::default());
    /// let terms = vec![(0, 1.0), (1, -0.5)].into();
    /// let robot = robot.with_couplings(vec![Coupling { name: "_belt".into(), terms, law: CouplingLaw::Friction }]);
    ///
    /// assert_eq!(robot.base.last().map(|p| &*p.name), Some("Fcc_belt"));
    /// assert_eq!(robot.acts_on(&robot.standard[28]), [(0, 1.0), (1, -0.5)]);
    /// ```
    pub fn with_couplings(mut self, couplings: Vec<Coupling>) -> Robot {
        let standard = standard_parameters(&self.frames, &self.drive.coupled_friction, &couplings);
        self.base.to_mut().retain(|b| self.standard[b.standard].coupling.is_none());
        let of_couplings = standard.iter().enumerate().filter(|(_, p)| p.coupling.is_some());
        self.base.to_mut().extend(of_couplings.map(|(k, p)| BaseParameter {
            name: p.name.clone(),
            standard: k,
            combination: Cow::Owned(vec![(k, 1.0)]),
            relation: p.name.clone(),
            unit: Cow::Borrowed(p.unit(self.frames[p.frame].kind, &couplings)),
        }));
        self.couplings = Cow::Owned(couplings);
        self.standard = Cow::Owned(standard);
        self
    }

    /// A robot of this table and drive whose every standard parameter is its own base parameter: nothing is
    /// regrouped, so its regressor is IDM_st and it has more parameters than a recording can tell.
    pub fn with_standard_as_base(
        name: &str,
        gravity: [f64; 3],
        frames: Vec<Frame>,
        drive: Drive,
        limits: Limits,
    ) -> Robot {
        let standard = standard_parameters(&frames, &drive.coupled_friction, &[]);
        let base = standard
            .iter()
            .enumerate()
            .map(|(k, p)| BaseParameter {
                name: p.name.clone(),
                standard: k,
                combination: Cow::Owned(vec![(k, 1.0)]),
                relation: p.name.clone(),
                unit: Cow::Borrowed(p.unit(frames[p.frame].kind, &[])),
            })
            .collect();
        Robot {
            name: Cow::Owned(name.to_owned()),
            description: Cow::Borrowed("every standard parameter by itself"),
            gravity,
            frames: Cow::Owned(frames),
            dependent: Cow::Borrowed(&[]),
            drive,
            couplings: Cow::Borrowed(&[]),
            known: Cow::Borrowed(&[]),
            fixed: Cow::Borrowed(&[]),
            ellipsoids: Cow::Borrowed(&[]),
            limits,
            standard: Cow::Owned(standard),
            base: Cow::Owned(base),
            nominal: None,
        }
    }
}
