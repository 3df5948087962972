//! What tests of several folders share.

use crate::model::{Drive, Frame, JointKind, Limits, RecursiveModel, Robot};
use rand::RngExt;
use rand_pcg::Pcg64;

/// Nearly a standard normal deviate, of at most 6: the sum of twelve uniform ones.
pub(crate) fn normal(rng: &mut Pcg64) -> f64 {
    (0..12).map(|_| rng.random_range(-0.5..0.5)).sum()
}

/// One vertical axis with these of its standard parameters as base parameters.
pub(crate) fn vertical_axis(parameters: &[&str]) -> RecursiveModel {
    let frames = vec![Frame::on_base(JointKind::Revolute)];
    let drive = Drive { gear: vec![1.0].into(), coupled_friction: vec![].into() };
    let mut robot = Robot::with_standard_as_base("axis", [0.0, 0.0, -9.81], frames, drive, Limits::default());
    robot.base = robot.base.iter().filter(|p| parameters.contains(&&*p.name)).cloned().collect();
    RecursiveModel::new(robot).expect("a valid table")
}
