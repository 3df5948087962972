//! One motion ready for a model: filtered and differentiated on a uniform grid.

use crate::model::StateSlices;

/// A joint that travels less than this in a motion, rad or m, stands still in it: some counts of an encoder, within which
/// controllers hold a joint, and too little to change what others feel of it.
const STANDS: f64 = 5e-4;

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
    /// Joints (0-based) that stand still in this motion: they have no equation, and [`Self::hold`] has been called.
    pub fixed: Vec<usize>,
    /// Samples at each end that the filters' edge effects reach; no row uses them.
    pub edge_samples: usize,
}

impl Motion {
    /// Whether a joint stands still: because it is said, or because it travels less than half a milliradian or millimetre.
    fn stands(&self, joint: usize) -> bool {
        let positions = self.q.get(joint).map_or(&[][..], Vec::as_slice);
        let [low, high] =
            positions.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], &x| [a.min(x), b.max(x)]);
        self.fixed.contains(&joint) || high - low < STANDS
    }

    /// Holds the joints that stand still: their position is its mean, their derivatives are zero. What they seem to do is
    /// noise, whose products with the accelerations of the others would count as motion.
    pub fn hold(&mut self) {
        for joint in (0..self.q.len()).filter(|&j| self.stands(j)).collect::<Vec<_>>() {
            let q = &mut self.q[joint];
            let mean = q.iter().sum::<f64>() / q.len().max(1) as f64;
            q.fill(mean);
            for derivatives in [&mut self.dq, &mut self.ddq] {
                if let Some(x) = derivatives.get_mut(joint) {
                    x.fill(0.0);
                }
            }
        }
    }

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
