//! The force on one link that explains the residuals of all joints at an instant.

use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::signals::Signals;
use crate::diagnosis::rules::{FORCE_RIDGE, FORCE_RIDGE_ABSOLUTE};
use crate::effects::unit_force_torques;
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
        g.try_inverse().map_or_else(Vector3::zeros, |inverse| inverse * b)
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
