//! One motion ready for a model: filtered and differentiated on a uniform grid.

use crate::model::StateSlices;

/// Filtered positions, their derivatives and the torques of one motion at the full rate. `q[j][t]`.
#[derive(Debug, Clone, PartialEq)]
pub struct Motion {
    /// Name of the trajectory it was made from.
    pub name: String,
    /// Samples a second, Hz.
    pub rate: f64,
    /// Time of the first sample, s, in the recording's time.
    pub start: f64,
    /// Zero-phase low-pass filtered positions, rad or m.
    pub q: Vec<Vec<f64>>,
    /// Central differences of `q`.
    pub dq: Vec<Vec<f64>>,
    /// Central differences of `dq`.
    pub ddq: Vec<Vec<f64>>,
    /// Torques as measured, on the same grid; the parallel decimation filters them with the columns of W.
    pub torque: Vec<Vec<f64>>,
    /// Joints (0-based) that stand still in this motion.
    pub fixed: Vec<usize>,
    /// Samples at each end that the filters' edge effects reach; no row uses them.
    pub edge_samples: usize,
}

impl Motion {
    /// The same motion in a time that runs so many times faster.
    pub fn faster(&self, factor: f64) -> Self {
        let scaled = |x: &[Vec<f64>], by: f64| -> Vec<Vec<f64>> {
            x.iter().map(|of_joint| of_joint.iter().map(|v| by * v).collect()).collect()
        };
        Self {
            rate: factor * self.rate,
            start: self.start / factor,
            dq: scaled(&self.dq, factor),
            ddq: scaled(&self.ddq, factor * factor),
            ..self.clone()
        }
    }

    /// Positions, velocities and accelerations as a model takes them.
    pub fn state_slices(&self) -> StateSlices<'_> {
        StateSlices::new(&self.q, &self.dq, &self.ddq)
    }
}
