//! Motions that a controller can be asked to follow.

/// A planned motion of all joints.
pub trait Reference: Send + Sync {
    /// Number of joints.
    fn joints(&self) -> usize;

    /// Length of the motion, s.
    fn duration(&self) -> f64;

    /// Positions, velocities and accelerations at time t in [0, duration]; slices of n values.
    fn at(&self, t: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]);

    /// Joints (0-based) that stand still throughout.
    fn fixed(&self) -> Vec<usize> {
        Vec::new()
    }
}

/// A motion given by samples, as read from a file; between them quintic polynomials through position, velocity
/// and acceleration, so that the torque has no steps.
#[derive(Debug, Clone, PartialEq)]
pub struct SampledReference {
    /// Time between samples, s.
    pub step: f64,
    /// `q[j][k]`, rad or m.
    pub q: Vec<Vec<f64>>,
    /// Velocities.
    pub dq: Vec<Vec<f64>>,
    /// Accelerations.
    pub ddq: Vec<Vec<f64>>,
    /// Joints that stand still.
    pub fixed: Vec<usize>,
}

/// Samples that are no motion.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SampledReferenceError {
    /// Fewer than two samples.
    #[error("a motion needs two rows at least")]
    TooShort,
    /// A sample (from 0) at another distance than the mean from the one before.
    #[error("the rows must be equally spaced in time, every {step:.6} s")]
    Spacing {
        /// The sample.
        sample: usize,
        /// The mean distance, s.
        step: f64,
    },
}

impl SampledReference {
    /// A motion that was sampled at `time`, s, which begins at its first sample; `[q, dq, ddq]` with `signal[joint][sample]`,
    /// as many samples each. Joints whose position is one number stand still.
    ///
    /// # Errors
    /// Samples that are too few or not equally spaced.
    pub fn new(time: &[f64], [q, dq, ddq]: [Vec<Vec<f64>>; 3]) -> Result<Self, SampledReferenceError> {
        let ([first, .., last], samples) = (time, time.len()) else {
            return Err(SampledReferenceError::TooShort);
        };
        let step = (last - first) / (samples - 1) as f64;
        let uneven = |pair: &[f64]| (pair[1] - pair[0] - step).abs() > 1e-3 * step || step <= 0.0;
        if let Some(k) = time.windows(2).position(uneven) {
            return Err(SampledReferenceError::Spacing { sample: k + 1, step });
        }
        let still = |positions: &Vec<f64>| positions.iter().all(|&x| x == positions[0]);
        let fixed = (0..q.len()).filter(|&j| still(&q[j])).collect();
        Ok(Self { step, q, dq, ddq, fixed })
    }
}

impl Reference for SampledReference {
    fn joints(&self) -> usize {
        self.q.len()
    }

    fn duration(&self) -> f64 {
        self.q.first().map_or(0.0, |q| q.len().saturating_sub(1) as f64 * self.step)
    }

    fn at(&self, t: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]) {
        let samples = self.q.first().map_or(0, Vec::len);
        if samples == 0 {
            return;
        }
        let place = (t / self.step).clamp(0.0, (samples - 1) as f64);
        let k = (place as usize).min(samples.saturating_sub(2));
        let next = (k + 1).min(samples - 1);
        for j in 0..self.q.len() {
            let from = [self.q[j][k], self.dq[j][k], self.ddq[j][k]];
            let to = [self.q[j][next], self.dq[j][next], self.ddq[j][next]];
            [q[j], dq[j], ddq[j]] = quintic(self.step, from, to, place - k as f64);
        }
    }

    fn fixed(&self) -> Vec<usize> {
        self.fixed.clone()
    }
}

/// Position, velocity and acceleration at `s` in [0, 1] of the quintic over `duration` between two states.
pub(crate) fn quintic(duration: f64, from: [f64; 3], to: [f64; 3], s: f64) -> [f64; 3] {
    let h = duration;
    let (c0, c1, c2) = (from[0], h * from[1], 0.5 * h * h * from[2]);
    // What is left of the end state after the start's second-order expansion.
    let p = to[0] - c0 - c1 - c2;
    let v = h * to[1] - c1 - 2.0 * c2;
    let a = h * h * to[2] - 2.0 * c2;
    let c3 = 10.0 * p - 4.0 * v + 0.5 * a;
    let c4 = -15.0 * p + 7.0 * v - a;
    let c5 = 6.0 * p - 3.0 * v + 0.5 * a;
    [
        c0 + s * (c1 + s * (c2 + s * (c3 + s * (c4 + s * c5)))),
        (c1 + s * (2.0 * c2 + s * (3.0 * c3 + s * (4.0 * c4 + s * 5.0 * c5)))) / h,
        (2.0 * c2 + s * (6.0 * c3 + s * (12.0 * c4 + s * 20.0 * c5))) / (h * h),
    ]
}
