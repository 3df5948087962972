//! What a joint can do at most.

use crate::model::{JointIndex, JointKind, JointNumber, Robot};

/// What a joint can do, generously: beyond it a value is garbage, not motion.
#[derive(Debug, Clone, PartialEq)]
pub struct Reach {
    /// Number of each joint in the robot's table, for messages.
    pub joint: Vec<JointNumber>,
    /// Per joint, rad or m.
    pub position: Vec<[f64; 2]>,
    /// Per joint, magnitude, rad/s or m/s.
    pub velocity: Vec<f64>,
    /// Per joint, magnitude, N.m or N.
    pub torque: Vec<f64>,
}

impl Reach {
    /// Twice the range of the position limits about its middle, three times the velocity limit, ten times the
    /// torque limit; where the robot states none: 100 rad or 100 m, 30 rad/s or 20 m/s, 1e5 N.m or N.
    pub fn of(robot: &Robot) -> Self {
        let kinds = robot.joint_kinds();
        let magnitude = |limits: &[[f64; 2]], j: usize| {
            limits.get(j).map(|[low, high]| low.abs().max(high.abs())).filter(|m| m.is_finite() && *m > 0.0)
        };
        let position = |j: usize| match robot.limits.position.get(j) {
            Some([low, high]) if low.is_finite() && high.is_finite() && low < high => {
                let (middle, range) = (0.5 * (low + high), high - low);
                [middle - range, middle + range]
            }
            _ => [-100.0, 100.0],
        };
        let velocity = |(j, kind): (usize, &JointKind)| {
            let unknown = if *kind == JointKind::Prismatic { 20.0 } else { 30.0 };
            magnitude(&robot.limits.velocity, j).map_or(unknown, |v| 3.0 * v)
        };
        Self {
            joint: (0..kinds.len()).map(|j| robot.joint_number(JointIndex(j))).collect(),
            position: (0..kinds.len()).map(position).collect(),
            velocity: kinds.iter().enumerate().map(velocity).collect(),
            torque: (0..kinds.len())
                .map(|j| magnitude(&robot.limits.torque, j).map_or(1e5, |t| 10.0 * t))
                .collect(),
        }
    }
}
