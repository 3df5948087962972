//! A robot as numbers.

use crate::{
    BaseParameter, Coupling, DependentFrame, Drive, Ellipsoid, Frame, JointIndex, JointKind, JointNumber,
    Limits, Motion, Nominal, ParameterKind, StandardParameter, motions,
};
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A robot as numbers: the modified-DH table evaluated, the drive, and the names and order of its parameters.
///
/// Generated code holds it as a `static`; for a robot that is read at run time it is built then.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Robot {
    /// The name it is called by on the command line.
    pub name: Cow<'static, str>,
    /// One line for a person.
    pub description: Cow<'static, str>,
    /// Gravity in frame 0, m/s2.
    pub gravity: [f64; 3],
    /// One row per frame, base first, parents before children.
    pub frames: Cow<'static, [Frame]>,
    /// The frames that move with other variables than their own joint's alone, ascending; none in most robots.
    #[serde(default, skip_serializing_if = "<[_]>::is_empty")]
    pub dependent: Cow<'static, [DependentFrame]>,
    /// Transmission between motors and joints.
    pub drive: Drive,
    /// Friction and springs on combinations of joints; none in most robots.
    #[serde(default, skip_serializing_if = "<[_]>::is_empty")]
    pub couplings: Cow<'static, [Coupling]>,
    /// Standard parameters, by index, that are known to be 0; none in most robots.
    #[serde(default, skip_serializing_if = "<[_]>::is_empty")]
    pub known: Cow<'static, [usize]>,
    /// Standard parameters, by index, that are known to have another value, ascending. Where torques can tell them from the
    /// rest, base parameters hold known ones only: [`Robot::fixed_base`].
    #[serde(default, skip_serializing_if = "<[_]>::is_empty")]
    pub fixed: Cow<'static, [(usize, f64)]>,
    /// Ellipsoids that hold the mass of links, by index of the frame and in that frame, ascending; none where nothing is known.
    /// Torques do not depend on them.
    #[serde(default, skip_serializing_if = "<[_]>::is_empty")]
    pub ellipsoids: Cow<'static, [(usize, Ellipsoid)]>,
    /// Limits per joint, SI.
    pub limits: Limits,
    /// The standard parameters in the order of chi_st: for each frame XX XY XZ YY YZ ZZ MX MY MZ M, then,
    /// where the frame is a joint, Ia Fv Fc off, then Fvm Fcm where its motor has coupled friction. Behind all frames: for
    /// each of `couplings` Fvc Fcc, or K KR (K alone where its position at rest is known).
    pub standard: Cow<'static, [StandardParameter]>,
    /// The base parameters in the order of chi, joint after joint in the same order.
    pub base: Cow<'static, [BaseParameter]>,
    /// Values for simulation, where the YAML gives them.
    pub nominal: Option<Nominal>,
}

impl Robot {
    /// Number of joints n (fixed frames do not count).
    pub fn joints(&self) -> usize {
        self.joint_frames().count()
    }

    /// How each frame moves on its parent.
    ///
    /// ```
    /// use dynid_description::{DependentFrame, Drive, Frame, JointKind, Limits, Robot};
    ///
    /// // Two axes on the base, and a bar on the second one that the first keeps parallel to itself.
    /// let axis = Frame::on_base(JointKind::Revolute);
    /// let bar = Frame { parent: Some(1), kind: JointKind::Fixed, ..axis };
    /// let drive = Drive { gear: vec![1.0, 0.0, 0.0, 1.0].into(), coupled_friction: vec![].into() };
    /// let gravity = [0.0, -9.81, 0.0];
    /// let mut robot = Robot::with_standard_as_base("bars", gravity, vec![axis, axis, bar], drive, Limits::default());
    /// let terms = vec![(0, 1.0), (1, -1.0)].into();
    /// robot.dependent = vec![DependentFrame { frame: 2, kind: JointKind::Revolute, terms }].into();
    ///
    /// assert_eq!(robot.joints(), 2);
    /// assert_eq!(robot.motions()[1].terms, [(1, 1.0)]);
    /// assert_eq!(robot.motions()[2].terms, [(0, 1.0), (1, -1.0)]);
    /// ```
    pub fn motions(&self) -> Vec<Motion> {
        motions(self.frames.iter().map(|f| f.kind), &self.dependent)
    }

    /// How each joint moves, in the order of the joints: revolute or prismatic, never fixed.
    pub fn joint_kinds(&self) -> Vec<JointKind> {
        self.joint_frames().map(|frame| self.frames[frame].kind).collect()
    }

    /// The joint whose own frame each frame is, as a 0-based index; `None` for a fixed frame, and for one that moves with the
    /// variables of other frames only.
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

    /// The number j that a joint has in the table.
    ///
    /// An index past the last joint gets a number past the last frame, which no joint has.
    ///
    /// ```
    /// use dynid_description::{Drive, Frame, JointIndex, JointKind, JointNumber, Limits, Robot};
    ///
    /// // Revolute, fixed, revolute.
    /// let row = |parent, kind| Frame { parent, kind, gamma: 0.0, b: 0.0, alpha: 0.0, d: 0.3, theta: 0.0, r: 0.0 };
    /// let frames = vec![
    ///     row(None, JointKind::Revolute),
    ///     row(Some(0), JointKind::Fixed),
    ///     row(Some(1), JointKind::Revolute),
    /// ];
    /// let drive = Drive { gear: vec![1.0, 0.0, 0.0, 1.0].into(), coupled_friction: vec![].into() };
    /// let robot = Robot::with_standard_as_base("arm", [0.0, -9.81, 0.0], frames, drive, Limits::default());
    ///
    /// assert_eq!(robot.joint_number(JointIndex(1)), JointNumber(3));
    /// assert_eq!(robot.joint_index(JointNumber(3)), Some(JointIndex(1)));
    /// assert_eq!(robot.joint_index(JointNumber(2)), None);
    /// ```
    pub fn joint_number(&self, joint: JointIndex) -> JointNumber {
        let past = || self.frames.len().saturating_add(joint.0.saturating_sub(self.joints()));
        JointNumber(self.joint_frames().nth(joint.0).unwrap_or_else(past).saturating_add(1))
    }

    /// The joint that has the number j in the table; `None` for a fixed frame and for a number that no frame has.
    pub fn joint_index(&self, number: JointNumber) -> Option<JointIndex> {
        let frame = number.0.checked_sub(1)?;
        self.joint_frames().position(|known| known == frame).map(JointIndex)
    }

    /// Index of the frame that a payload is on: the last one of the table, of those that have a joint or are fixed. Bars
    /// without a joint of their own carry none.
    pub fn flange(&self) -> Option<usize> {
        let is_bar =
            |k: usize| self.frames[k].kind == JointKind::Fixed && self.dependent.iter().any(|d| d.frame == k);
        (0..self.frames.len()).rev().find(|&k| !is_bar(k))
    }

    /// Standard parameters, by index, that no base parameter holds, but for those that are known to be 0: they have no effect
    /// on any torque.
    pub fn without_effect(&self) -> Vec<usize> {
        let held = |k: usize| self.base.iter().any(|b| b.combination.iter().any(|&(column, _)| column == k));
        (0..self.standard.len()).filter(|&k| !held(k) && !self.known.contains(&k)).collect()
    }

    /// The combination of joints that a friction parameter or a spring acts on, joint index and coefficient: the joint alone
    /// for Fv and Fc, the motor's speed in units of its own joint for Fvm and Fcm, what the table says for a coupling. Empty
    /// for other parameters.
    ///
    /// The torque on joint i is the coefficient of i times that on the combination.
    pub fn acts_on(&self, parameter: &StandardParameter) -> Vec<(usize, f64)> {
        if let Some(coupling) = parameter.coupling {
            return self.couplings.get(coupling).map_or_else(Vec::new, |c| c.terms.to_vec());
        }
        let joint = self.joint_of_frame().get(parameter.frame).copied().flatten();
        let (Some(joint), true) = (joint, parameter.kind.is_friction()) else { return Vec::new() };
        if matches!(parameter.kind, ParameterKind::Fv | ParameterKind::Fc) {
            return vec![(joint, 1.0)];
        }
        let n = self.joints();
        let Some(row) = self.drive.gear.get(joint * n..(joint + 1) * n) else { return Vec::new() };
        row.iter().enumerate().filter(|(_, g)| **g != 0.0).map(|(s, g)| (s, g / row[joint])).collect()
    }

    /// The base parameters, by index, whose values are known: only `fixed` parameters are part of them.
    pub fn fixed_base(&self) -> Vec<(usize, f64)> {
        let value = |k: usize| self.fixed.iter().find(|(fixed, _)| *fixed == k).map(|(_, value)| *value);
        let of = |base: &BaseParameter| -> Option<f64> {
            base.combination.iter().map(|&(k, c)| Some(c * value(k)?)).sum()
        };
        self.base.iter().enumerate().filter_map(|(k, base)| Some((k, of(base)?))).collect()
    }

    /// chi from chi_st: every base parameter as its combination of standard parameters.
    pub fn base_from_standard(&self, standard: &[f64]) -> Vec<f64> {
        self.base.iter().map(|p| p.combination.iter().map(|&(k, c)| c * standard[k]).sum()).collect()
    }

    /// Standard parameters of a body on a frame (0-based) and nothing else: `inertial` are its XX XY XZ YY YZ ZZ MX MY MZ M at
    /// the frame's origin, SI. All zero for a frame that the robot has not.
    pub fn standard_of_body(&self, frame: usize, inertial: &[f64]) -> Vec<f64> {
        let value = |parameter: &StandardParameter| {
            let place = ParameterKind::INERTIAL.iter().position(|kind| *kind == parameter.kind);
            place.filter(|_| parameter.frame == frame).and_then(|k| inertial.get(k)).copied()
        };
        self.standard.iter().map(|parameter| value(parameter).unwrap_or(0.0)).collect()
    }

    /// What such a body adds to each base parameter: base parameters are linear in standard ones. `None` where they cannot
    /// hold it: the robot has no such frame, or says that something of it is 0.
    pub fn base_of_body(&self, frame: usize, inertial: &[f64]) -> Option<Vec<f64>> {
        let standard = self.standard_of_body(frame, inertial);
        let is_lost = |&k: &usize| standard.get(k).is_some_and(|value| *value != 0.0);
        let is_held = frame < self.frames.len() && !self.known.iter().any(is_lost);
        is_held.then(|| self.base_from_standard(&standard))
    }

    /// Indices in `frames` of the frames that move, in order.
    fn joint_frames(&self) -> impl Iterator<Item = usize> + '_ {
        (0..self.frames.len()).filter(|&k| self.frames[k].kind != JointKind::Fixed)
    }
}
