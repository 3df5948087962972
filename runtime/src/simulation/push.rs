//! A push from outside, in a simulated robot.

use super::extra::{ExtraTorque, Instant};
use crate::effects::{ContactForce, unit_force_torques};
use crate::model::{Link, Robot};

/// A force, or torques about single joints, that rise and fall in a time window.
pub(super) struct Push<'m> {
    robot: &'m Robot,
    links: Vec<Link<f64>>,
    /// 0-based frame at whose origin the force acts.
    frame: usize,
    /// Largest force in frame 0, N.
    force: [f64; 3],
    /// Joint, 0-based, and largest torque, N.m or N.
    torques: Vec<(usize, f64)>,
    /// From, to, s.
    window: [f64; 2],
}

impl<'m> Push<'m> {
    /// With a force, or without one by the largest torques of the joints. `None` where the robot has no such link.
    pub(super) fn new(robot: &'m Robot, contact: &ContactForce) -> Option<Self> {
        let frame = contact.link.checked_sub(1).filter(|k| *k < robot.frames.len())?;
        let links = Link::of(robot);
        let joint_of = robot.joint_of_frame();
        let joint = |number: usize| joint_of.get(number.checked_sub(1)?).copied().flatten();
        // Where there is a force, the torques are what it does to the joints.
        let felt = contact.joint_torques.iter().filter(|_| contact.force == [0.0; 3]);
        let torques = felt.filter_map(|t| Some((joint(t.joint)?, t.largest))).collect();
        Some(Self { robot, links, frame, force: contact.force, torques, window: contact.window })
    }
}

impl ExtraTorque for Push<'_> {
    fn torque(&self, at: &Instant<'_>, out: &mut [f64]) {
        let [from, to] = self.window;
        if at.time <= from || at.time >= to {
            return;
        }
        let height = (std::f64::consts::PI * (at.time - from) / (to - from)).sin().powi(2);
        for &(joint, largest) in &self.torques {
            out[joint] += height * largest;
        }
        if !self.torques.is_empty() {
            return;
        }
        let mut unit = [Vec::new(), Vec::new(), Vec::new()];
        unit_force_torques(self.robot, &self.links, self.frame, at.q, &mut unit);
        for (axis, force) in unit.iter().zip(self.force) {
            for (torque, column) in out.iter_mut().zip(axis) {
                *torque += height * force * column;
            }
        }
    }
}
