//! Outside forces on links.

use crate::model::{Link, Robot, standard_idm};
use serde::{Deserialize, Serialize};

/// A force that acted on a link while a window of time lasted.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct ContactForce {
    /// Motion it happened in.
    pub motion: String,
    /// First and last instant, s.
    pub window: [f64; 2],
    /// Number j of the frame of the link that was touched: the force acts at its origin or beyond.
    pub link: usize,
    /// Largest force in frame 0, N.
    pub force: [f64; 3],
    /// Mean force over the window in frame 0, N.
    pub mean_force: [f64; 3],
    /// Standard deviations of the mean force, N, where known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub force_sigma: Option<[f64; 3]>,
    /// Numbers j of the frames of other links on which a force explains as much.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub or_links: Vec<usize>,
    /// One minus the probability that any window of the recording comes as far by accident, where it was worked out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confidence: Option<f64>,
    /// Standard deviations of the first and the last instant, s, where known.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub edges: Option<[f64; 2]>,
    /// Torques of the joints that the contact was seen on, where it was looked for joint by joint. Where only one
    /// joint saw it there is no telling force and lever apart, and the force is left at zero.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub joint_torques: Vec<JointTorque>,
}

/// What one joint feels of a contact.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct JointTorque {
    /// Number j of the joint.
    pub joint: usize,
    /// Mean over the window, N.m or N.
    pub mean: f64,
    /// Largest, N.m or N.
    pub largest: f64,
    /// Standard deviation of both.
    pub sigma: f64,
}

/// Motor torques that a force of 1 N along x, y, z of frame 0 at the origin of `frame` asks for: `out[axis][joint]`.
///
/// By virtual work they are -JT f: what a mass point of 1 kg at that origin asks for in a gravity of f at rest.
pub fn unit_force_torques(
    robot: &Robot,
    links: &[Link<f64>],
    frame: usize,
    q: &[f64],
    out: &mut [Vec<f64>; 3],
) {
    let rest = vec![0.0; q.len()];
    for (axis, torques) in out.iter_mut().enumerate() {
        torques.clear();
        torques.resize(robot.joints(), 0.0);
        let mut gravity = [0.0; 3];
        gravity[axis] = 1.0;
        standard_idm(links, gravity, q, &rest, &rest, |joint, k, columns| {
            if k == frame {
                torques[joint] = columns[9];
            }
        });
    }
}
