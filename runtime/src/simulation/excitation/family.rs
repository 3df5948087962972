//! From points of a search space to motions.

use rand::{RngExt, SeedableRng};

use super::fourier::{FourierJoint, FourierMotion};
use super::limits::Limits;
use super::motion::ExcitingMotion;
use super::point_to_point::PointToPointMotion;
use super::settings::MotionKind;

/// How a point of the search space becomes a motion within the limits.
pub(super) struct Family<'a> {
    pub kind: MotionKind,
    pub limits: &'a Limits,
    /// Joints 0 .. fixed stand still.
    pub fixed: usize,
}

impl Family<'_> {
    fn unknowns(&self) -> usize {
        let n = self.limits.position.len();
        let moving = n - self.fixed;
        match self.kind {
            // Where the fixed joints stand, then for each moving one its series, its place and its size.
            MotionKind::Fourier { harmonics, .. } => self.fixed + moving * (2 * (harmonics - 1) + 2),
            MotionKind::PointToPoint { points, .. } => self.fixed + moving * points,
        }
    }

    /// A random point of the search space.
    pub fn random_start(&self, seed: u64) -> Vec<f64> {
        let mut random = rand_pcg::Pcg64::seed_from_u64(seed);
        (0..self.unknowns()).map(|_| random.random_range(-1.0..1.0)).collect()
    }

    /// The motion that a point of the search space stands for.
    pub fn motion(&self, unknowns: &[f64]) -> ExcitingMotion {
        let n = self.limits.position.len();
        let (stands, series) = unknowns.split_at(self.fixed);
        let place = |j: usize, x: f64| {
            let [low, high] = self.limits.position[j];
            0.5 * (low + high) + 0.5 * (high - low) * x.tanh()
        };
        match self.kind {
            MotionKind::Fourier { harmonics, period, periods } => {
                let each = 2 * (harmonics - 1) + 2;
                let joints = (0..n)
                    .map(|j| match j.checked_sub(self.fixed) {
                        None => {
                            FourierJoint { center: place(j, stands[j]), cosine: Vec::new(), sine: Vec::new() }
                        }
                        Some(k) => self.fourier_joint(j, period, &series[k * each..][..each]),
                    })
                    .collect();
                ExcitingMotion::Fourier(FourierMotion { period, periods, joints })
            }
            MotionKind::PointToPoint { points, profile, pause } => {
                let list = (0..points)
                    .map(|p| {
                        (0..n)
                            .map(|j| match j.checked_sub(self.fixed) {
                                None => place(j, stands[j]),
                                Some(k) => place(j, series[k * points + p]),
                            })
                            .collect()
                    })
                    .collect();
                ExcitingMotion::PointToPoint(PointToPointMotion::within(
                    list,
                    profile,
                    pause,
                    &self.limits.velocity,
                    &self.limits.acceleration,
                ))
            }
        }
    }

    /// A series whose rigorous bounds fill a part of the limits that is itself searched.
    fn fourier_joint(&self, j: usize, period: f64, unknowns: &[f64]) -> FourierJoint {
        let (coefficients, rest) = unknowns.split_at(unknowns.len() - 2);
        let (cosine, sine) = coefficients.split_at(coefficients.len() / 2);
        let mut joint = FourierJoint::at_rest_at_start(0.0, cosine, sine);
        let shape = joint.bounds(period);
        let [low, high] = self.limits.position[j];
        let reach = 0.5 * (shape.position[1] - shape.position[0]);
        let largest = (0.5 * (high - low) / reach)
            .min(self.limits.velocity[j] / shape.velocity)
            .min(self.limits.acceleration[j] / shape.acceleration);
        if !largest.is_finite() {
            joint.scale(0.0);
            joint.center = 0.5 * (low + high);
            return joint;
        }
        let size = largest * (0.1 + 0.9 / (1.0 + (-rest[1] - 1.0).exp()));
        joint.scale(size);
        let middle = 0.5 * (shape.position[0] + shape.position[1]) * size;
        let room = (0.5 * (high - low) - reach * size).max(0.0);
        joint.center = 0.5 * (low + high) + room * rest[0].tanh() - middle;
        joint
    }
}
