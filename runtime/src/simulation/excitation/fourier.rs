//! Periodic motions as finite Fourier series that start and end at rest (Swevers and others 1997).

use std::f64::consts::{PI, TAU};

use crate::simulation::Reference;

/// One joint: velocity = Σ a_l·cos(l·w·t) + b_l·sin(l·w·t) about a middle position.
#[derive(Debug, Clone, PartialEq)]
pub struct FourierJoint {
    /// Position that the series is added to, rad or m.
    pub center: f64,
    /// a_1 .. a_L, rad/s or m/s; their sum is zero, so that the velocity is zero at the start.
    pub cosine: Vec<f64>,
    /// b_1 .. b_L; Σ l·b_l is zero, so that the acceleration is zero at the start.
    pub sine: Vec<f64>,
}

/// A periodic motion of all joints.
#[derive(Debug, Clone, PartialEq)]
pub struct FourierMotion {
    /// Length of a period, s.
    pub period: f64,
    /// How many periods the motion lasts.
    pub periods: usize,
    /// The joints; one without coefficients stands still.
    pub joints: Vec<FourierJoint>,
}

/// Peaks that a joint's motion cannot pass, between samples neither.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Bounds {
    /// Lowest and highest position, rad or m.
    pub position: [f64; 2],
    /// Largest |velocity|.
    pub velocity: f64,
    /// Largest |acceleration|.
    pub acceleration: f64,
}

impl FourierJoint {
    /// A joint with free coefficients a_1 .. a_{L-1} and b_1 .. b_{L-1}; the last ones make it start at rest.
    pub fn at_rest_at_start(center: f64, cosine: &[f64], sine: &[f64]) -> Self {
        let mut cosine = cosine.to_vec();
        let mut sine = sine.to_vec();
        cosine.push(-cosine.iter().sum::<f64>());
        let harmonics = (sine.len() + 1) as f64;
        let moment: f64 = sine.iter().enumerate().map(|(k, b)| (k + 1) as f64 * b).sum();
        sine.push(-moment / harmonics);
        Self { center, cosine, sine }
    }

    /// Position, velocity and acceleration at phase w·t for base frequency w.
    fn at(&self, w: f64, phase: f64) -> [f64; 3] {
        let (mut q, mut dq, mut ddq) = (self.center, 0.0, 0.0);
        for (k, (a, b)) in self.cosine.iter().zip(&self.sine).enumerate() {
            let l = (k + 1) as f64;
            let (s, c) = (l * phase).sin_cos();
            q += (a * s - b * c) / (l * w);
            dq += a * c + b * s;
            ddq += l * w * (b * c - a * s);
        }
        [q, dq, ddq]
    }

    /// Multiplies the series.
    pub fn scale(&mut self, factor: f64) {
        self.cosine.iter_mut().chain(&mut self.sine).for_each(|x| *x *= factor);
    }

    /// Bounds that hold at every instant, not only at samples: a trigonometric polynomial of degree L that is
    /// sampled at m > 2L points a period exceeds its largest sample by a factor 1 / cos(π·L/m) at most (Ehlich
    /// and Zeller 1964).
    pub fn bounds(&self, period: f64) -> Bounds {
        let degree = self.cosine.len();
        if degree == 0 {
            return Bounds { position: [self.center; 2], velocity: 0.0, acceleration: 0.0 };
        }
        let samples = 64 * degree;
        let excess = 1.0 / (PI * degree as f64 / samples as f64).cos();
        let w = TAU / period;
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        let (mut velocity, mut acceleration) = (0.0_f64, 0.0_f64);
        for k in 0..samples {
            let [q, dq, ddq] = self.at(w, TAU * k as f64 / samples as f64);
            low = low.min(q);
            high = high.max(q);
            velocity = velocity.max(dq.abs());
            acceleration = acceleration.max(ddq.abs());
        }
        let (middle, reach) = (0.5 * (low + high), 0.5 * (high - low) * excess);
        Bounds {
            position: [middle - reach, middle + reach],
            velocity: velocity * excess,
            acceleration: acceleration * excess,
        }
    }
}

impl Reference for FourierMotion {
    fn joints(&self) -> usize {
        self.joints.len()
    }

    fn duration(&self) -> f64 {
        self.period * self.periods as f64
    }

    fn at(&self, t: f64, q: &mut [f64], dq: &mut [f64], ddq: &mut [f64]) {
        let w = TAU / self.period;
        let phase = TAU * (t / self.period).fract();
        for (j, joint) in self.joints.iter().enumerate() {
            [q[j], dq[j], ddq[j]] = joint.at(w, phase);
        }
    }

    fn fixed(&self) -> Vec<usize> {
        let still = |joint: &FourierJoint| joint.cosine.iter().chain(&joint.sine).all(|&x| x == 0.0);
        (0..self.joints.len()).filter(|&j| still(&self.joints[j])).collect()
    }
}
