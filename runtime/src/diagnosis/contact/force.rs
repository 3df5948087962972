//! The force on one link that explains the residuals of all joints at an instant.

use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::signals::Signals;
use crate::diagnosis::rules::{FORCE_RIDGE, FORCE_RIDGE_ABSOLUTE, INNER_LINK_BETTER};
use crate::effects::{ContactForce, JointTorque, unit_force_torques};
use crate::model::Robot;
use nalgebra::{Matrix3, Vector3};

/// One joint's row at an instant.
#[derive(Debug, Clone, Copy)]
pub(in crate::diagnosis) struct JointRow {
    pub joint: usize,
    pub residual: f64,
    /// Torque.
    pub y: f64,
    /// Standard deviation of the residual.
    pub sigma: f64,
}

/// Torques of the unit forces along x, y and z of frame 0 at the origin of a link's frame, per joint.
pub(in crate::diagnosis) struct UnitForces([Vec<f64>; 3]);

impl UnitForces {
    /// In the pose of an instant.
    pub fn at(context: &Context<'_>, frame: usize, s: &Signals, t: usize) -> Self {
        let q: Vec<f64> = s.q.iter().map(|x| x[t]).collect();
        let mut out = [Vec::new(), Vec::new(), Vec::new()];
        unit_force_torques(context.model.robot(), context.tables(), frame, &q, &mut out);
        Self(out)
    }

    /// Weighted least-squares force.
    pub fn force(&self, rows: &[JointRow]) -> Vector3<f64> {
        self.with_covariance(rows).map_or_else(Vector3::zeros, |(force, _)| force)
    }

    /// Weighted least-squares force and its covariance, where the rows' residuals are independent.
    pub fn with_covariance(&self, rows: &[JointRow]) -> Option<(Vector3<f64>, Matrix3<f64>)> {
        let unit = &self.0;
        let mut g = Matrix3::zeros();
        let mut b = Vector3::zeros();
        for row in rows {
            let w = 1.0 / (row.sigma * row.sigma);
            let c = Vector3::new(unit[0][row.joint], unit[1][row.joint], unit[2][row.joint]);
            g += w * c * c.transpose();
            b += w * c * row.residual;
        }
        g += Matrix3::identity() * (FORCE_RIDGE * g.trace() + FORCE_RIDGE_ABSOLUTE);
        g.try_inverse().map(|inverse| (inverse * b, inverse))
    }

    /// Squares that a force leaves, in units of the noise.
    pub fn left(&self, rows: &[JointRow], f: &Vector3<f64>) -> f64 {
        let unit = &self.0;
        rows.iter()
            .map(|row| {
                let j = row.joint;
                let left = row.residual - unit[0][j] * f[0] - unit[1][j] * f[1] - unit[2][j] * f[2];
                (left / row.sigma).powi(2)
            })
            .sum()
    }
}

/// A link with the force on it that explains a push.
pub(in crate::diagnosis) struct PushedLink {
    /// Squares that the forces leave, in units of the noise.
    pub left: f64,
    /// Its frame, counted from 0.
    pub frame: usize,
    /// At each instant, N, in frame 0.
    pub forces: Vec<Vector3<f64>>,
}

/// The link whose forces leave least of the residual at these instants of a motion.
pub(in crate::diagnosis) fn best_link<'r>(
    context: &Context<'_>,
    s: &Signals,
    instants: impl Iterator<Item = (usize, &'r [JointRow])> + Clone,
) -> Option<PushedLink> {
    let joint_of_frame = context.model.robot().joint_of_frame();
    let mut best: Option<PushedLink> = None;
    for frame in (0..joint_of_frame.len()).rev().filter(|&f| joint_of_frame[f].is_some()) {
        let mut link = PushedLink { left: 0.0, frame, forces: Vec::new() };
        for (t, rows) in instants.clone() {
            let unit = UnitForces::at(context, frame, s, t);
            let force = unit.force(rows);
            link.left += unit.left(rows, &force);
            link.forces.push(force);
        }
        // A link further in must be clearly better: the same force seen from the next link is nearly as good.
        if best.as_ref().is_none_or(|best| link.left < INNER_LINK_BETTER * best.left) {
            best = Some(link);
        }
    }
    best
}

/// A push as the torques that its joints (counted from 0) feel, on the innermost of their links, without a force.
pub(in crate::diagnosis) fn as_torques(
    robot: &Robot,
    motion: &str,
    window: [f64; 2],
    edges: [f64; 2],
    felt: Vec<JointTorque>,
) -> ContactForce {
    let joint_of_frame = robot.joint_of_frame();
    let number = |joint: usize| joint_of_frame.iter().position(|f| *f == Some(joint)).unwrap_or(joint) + 1;
    let innermost = felt.iter().map(|torque| torque.joint).min().unwrap_or(0);
    ContactForce {
        motion: motion.to_owned(),
        window,
        link: number(innermost),
        force: [0.0; 3],
        mean_force: [0.0; 3],
        edges: Some(edges),
        joint_torques: felt
            .into_iter()
            .map(|torque| JointTorque { joint: number(torque.joint), ..torque })
            .collect(),
        ..ContactForce::default()
    }
}
