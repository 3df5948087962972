//! Channels that no robot can have recorded, whatever its parameters are.

use crate::model::{JointIndex, Robot};
use crate::signal::Motion;
use crate::statistics::median::median;

/// Rows that are farther apart cannot hold even the narrowest band that equations have, 2 Hz.
const SLOWEST: f64 = 4.0;
/// A joint beyond its limit by this factor for half of the time is in another unit: what is between a unit and the next is
/// 57 at least, and a robot that is pushed hard passes its limits by less than two.
const BEYOND: f64 = 5.0;

/// What is wrong with the channels themselves.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum ChannelFault {
    /// The torque of a joint that moves never changes.
    ConstantTorque {
        /// Which joint.
        joint: JointIndex,
        /// Its torque, N.m or N.
        value: f64,
    },
    /// Two joints have the same torque in every row.
    SameTorque {
        /// Which.
        joints: [JointIndex; 2],
    },
    /// Two joints have the same position in every row.
    SamePosition {
        /// Which.
        joints: [JointIndex; 2],
    },
    /// Rows are so far apart that no motion of a robot is seen.
    Slow {
        /// Seconds between rows.
        step: f64,
    },
    /// A joint is much faster than it can be for half of the time.
    TooFast {
        /// Which joint.
        joint: JointIndex,
        /// Its median speed, rad/s or m/s.
        speed: f64,
        /// Its limit.
        limit: f64,
    },
    /// The torque of a joint is much larger than it can be for half of the time.
    TooStrong {
        /// Which joint.
        joint: JointIndex,
        /// Its median torque, N.m or N.
        torque: f64,
        /// Its limit.
        limit: f64,
    },
}

/// What is wrong with the channels of motions; the first of what is found.
pub fn faulty_channel(robot: &Robot, motions: &[Motion]) -> Option<ChannelFault> {
    if let Some(motion) = motions.iter().find(|m| m.rate < SLOWEST) {
        return Some(ChannelFault::Slow { step: 1.0 / motion.rate });
    }
    let n = robot.joints();
    let torque = |j: usize| motions.iter().filter_map(move |m| m.torque.get(j)).flatten().copied();
    let position = |j: usize| motions.iter().filter_map(move |m| m.q.get(j)).flatten().copied();
    for joint in 0..n {
        let moves = motions.iter().any(|m| !m.fixed.contains(&joint)) && !constant(position(joint));
        if moves && constant(torque(joint)) {
            let value = torque(joint).next()?;
            return Some(ChannelFault::ConstantTorque { joint: JointIndex(joint), value });
        }
    }
    for a in 0..n {
        for b in a + 1..n {
            let joints = [JointIndex(a), JointIndex(b)];
            if !constant(torque(a)) && torque(a).eq(torque(b)) {
                return Some(ChannelFault::SameTorque { joints });
            }
            if !constant(position(a)) && position(a).eq(position(b)) {
                return Some(ChannelFault::SamePosition { joints });
            }
        }
    }
    let largest = |limits: &[[f64; 2]], j: usize| limits.get(j).map(|[low, high]| low.abs().max(high.abs()));
    for j in 0..n {
        let joint = JointIndex(j);
        let typical =
            |values: &mut dyn Iterator<Item = f64>| median(&mut values.map(f64::abs).collect::<Vec<_>>());
        let speed = typical(&mut motions.iter().filter_map(|m| m.dq.get(j)).flatten().copied());
        if let Some(limit) = largest(&robot.limits.velocity, j).filter(|limit| speed > BEYOND * limit) {
            return Some(ChannelFault::TooFast { joint, speed, limit });
        }
        let torque = typical(&mut torque(j));
        if let Some(limit) = largest(&robot.limits.torque, j).filter(|limit| torque > BEYOND * limit) {
            return Some(ChannelFault::TooStrong { joint, torque, limit });
        }
    }
    None
}

/// Whether a channel has one value only.
fn constant(mut values: impl Iterator<Item = f64>) -> bool {
    let Some(first) = values.next() else { return false };
    values.all(|value| value == first)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::{Drive, Frame, JointKind, Limits};

    fn robot() -> Robot {
        let frame = Frame::on_base(JointKind::Revolute);
        let second = Frame { parent: Some(0), d: 0.5, ..frame };
        let drive = Drive { gear: vec![1.0, 0.0, 0.0, 1.0].into(), coupled_friction: vec![].into() };
        let limits = Limits {
            velocity: vec![[-5.0, 5.0]; 2].into(),
            torque: vec![[-50.0, 50.0]; 2].into(),
            ..Limits::default()
        };
        Robot::with_standard_as_base("arm", [0.0, 0.0, -9.81], vec![frame, second], drive, limits)
    }

    fn motion() -> Motion {
        let wave = |w: f64, size: f64| (0..1000).map(|k| size * (w * f64::from(k) / 100.0).sin()).collect();
        Motion {
            name: "run".into(),
            rate: 100.0,
            start: 0.0,
            q: vec![wave(2.0, 1.0), wave(3.0, 1.0)],
            dq: vec![wave(2.1, 2.0), wave(3.1, 3.0)],
            ddq: vec![wave(2.2, 4.0), wave(3.2, 9.0)],
            torque: vec![wave(2.3, 20.0), wave(3.3, 8.0)],
            fixed: vec![],
            edge_samples: 0,
        }
    }

    fn fault(change: impl Fn(&mut Motion)) -> Option<ChannelFault> {
        let mut motion = motion();
        change(&mut motion);
        faulty_channel(&robot(), &[motion])
    }

    #[test]
    fn channels_of_a_robot_are_not_doubted() {
        assert_eq!(fault(|_| {}), None);
    }

    #[test]
    fn a_torque_that_never_changes_is_named_unless_the_joint_stands_still() {
        let constant = |m: &mut Motion| m.torque[1].fill(0.0);
        let found = ChannelFault::ConstantTorque { joint: JointIndex(1), value: 0.0 };
        assert_eq!(fault(constant), Some(found));
        let resting = |m: &mut Motion| {
            constant(m);
            m.fixed = vec![1];
        };
        assert_eq!(fault(resting), None);
    }

    #[test]
    fn a_column_that_is_given_twice_is_named() {
        let joints = [JointIndex(0), JointIndex(1)];
        assert_eq!(fault(|m| m.torque[1] = m.torque[0].clone()), Some(ChannelFault::SameTorque { joints }));
        assert_eq!(fault(|m| m.q[1] = m.q[0].clone()), Some(ChannelFault::SamePosition { joints }));
    }

    #[test]
    fn times_and_torques_in_another_unit_are_named() {
        assert!(matches!(fault(|m| m.rate = 0.1), Some(ChannelFault::Slow { .. })));
        let faster = |m: &mut Motion| m.dq.iter_mut().flatten().for_each(|v| *v *= 1000.0);
        assert!(matches!(fault(faster), Some(ChannelFault::TooFast { .. })));
        let stronger = |m: &mut Motion| m.torque[1].iter_mut().for_each(|t| *t *= 1000.0);
        let found = fault(stronger);
        assert!(matches!(found, Some(ChannelFault::TooStrong { joint: JointIndex(1), .. })), "{found:?}");
    }
}
