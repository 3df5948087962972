//! Recordings that are made up as they are needed, of any length.

use dynid_runtime::model::{Model, StateSlices, torques};
use dynid_runtime::recording::Trajectory;

/// Samples a second, Hz.
pub const RATE: f64 = 1000.0;
/// Torque noise, N.m or N: evenly spread, this from end to end.
const NOISE: f64 = 0.1;

/// Samples `first..first + count` of a smooth motion, and the torques of the model with noise.
pub fn trajectory(model: &dyn Model, chi: &[f64], first: usize, count: usize) -> Trajectory {
    let n = model.robot().joints();
    let mut signals = [vec![vec![0.0; count]; n], vec![vec![0.0; count]; n], vec![vec![0.0; count]; n]];
    let time: Vec<f64> = (first..first + count).map(|k| k as f64 / RATE).collect();
    let [q, dq, ddq] = &mut signals;
    for j in 0..n {
        for harmonic in 1..=4 {
            let w = (1.1 + 0.37 * j as f64) * harmonic as f64;
            let a = 1.2 / (harmonic * harmonic) as f64;
            for (k, t) in time.iter().enumerate() {
                let (s, c) = (w * t + harmonic as f64 * 0.7 * j as f64).sin_cos();
                q[j][k] += a * s;
                dq[j][k] += a * w * c;
                ddq[j][k] -= a * w * w * s;
            }
        }
    }
    let exact = torques(model, chi, StateSlices::new(&signals[0], &signals[1], &signals[2]).states());
    let mut torque = vec![Vec::with_capacity(count); n];
    let mut random = first as u64 ^ 0x9e37_79b9_7f4a_7c15;
    for t in 0..count {
        for (torque, exact) in torque.iter_mut().zip(&exact) {
            random = random.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            torque.push(exact[t] + NOISE * ((random >> 11) as f64 / (1u64 << 53) as f64 - 0.5));
        }
    }
    let [position, ..] = signals;
    Trajectory { name: "made up".into(), time, position, velocity: None, torque, fixed: Vec::new() }
}
