//! What is measured of a simulated robot: quantised, noisy encoders and noisy torques.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

use super::SimulationError;
use crate::model::Robot;

/// Settings of the sensors, per joint and on the joint side; an empty list means none of it.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SensorSettings {
    /// Smallest step of an encoder, rad or m.
    pub position_quantum: Vec<f64>,
    /// Encoder noise, 1 sigma, rad or m.
    pub position_noise: Vec<f64>,
    /// Noise of the recorded torque, 1 sigma, N.m or N.
    pub torque_noise: Vec<f64>,
    /// The same seed gives the same recording, digit for digit.
    pub seed: u64,
}

impl SensorSettings {
    /// The robot's nominal noise, without quantisation.
    pub fn nominal(robot: &Robot, seed: u64) -> Self {
        let nominal = robot.nominal.as_ref();
        Self {
            position_quantum: Vec::new(),
            position_noise: nominal.map_or(Vec::new(), |x| x.position_noise.to_vec()),
            torque_noise: nominal.map_or(Vec::new(), |x| x.torque_noise.to_vec()),
            seed,
        }
    }

    pub(crate) fn check(&self, n: usize) -> Result<(), SimulationError> {
        for (what, list) in [
            ("encoder steps", &self.position_quantum),
            ("encoder noise levels", &self.position_noise),
            ("torque noise levels", &self.torque_noise),
        ] {
            if !list.is_empty() && list.len() != n {
                return Err(SimulationError::Length { what, expected: n, found: list.len() });
            }
            if let Some(&found) = list.iter().find(|x| !(x.is_finite() && **x >= 0.0)) {
                return Err(SimulationError::Setting { what, expected: "zero or positive", found });
            }
        }
        Ok(())
    }
}

/// Sensors at work. Positions and torques draw from their own random streams, so that changing the noise of one
/// leaves the other as it was.
pub(crate) struct Sensors<'a> {
    settings: &'a SensorSettings,
    position_stream: Pcg64,
    torque_stream: Pcg64,
}

impl<'a> Sensors<'a> {
    pub fn new(settings: &'a SensorSettings) -> Self {
        Self {
            settings,
            position_stream: Pcg64::seed_from_u64(settings.seed),
            torque_stream: Pcg64::seed_from_u64(settings.seed ^ 0x746f_7271_7565_0000),
        }
    }

    /// The encoder's reading of joint j at position q.
    pub fn position(&mut self, j: usize, q: f64) -> f64 {
        let noisy = q + noise(&self.settings.position_noise, j, &mut self.position_stream);
        match self.settings.position_quantum.get(j) {
            Some(&quantum) if quantum > 0.0 => {
                // Steps beyond all numbers are finer than the reading itself.
                let steps = (noisy / quantum).round();
                if steps.is_finite() { steps * quantum } else { noisy }
            }
            _ => noisy,
        }
    }

    /// The recorded torque of joint j.
    pub fn torque(&mut self, j: usize, torque: f64) -> f64 {
        torque + noise(&self.settings.torque_noise, j, &mut self.torque_stream)
    }
}

/// The recording that other noise would have made of the same run.
#[cfg(test)]
pub(crate) fn measured(
    settings: &SensorSettings,
    truth: &crate::signal::Motion,
    recorded: &crate::recording::Trajectory,
) -> crate::recording::Trajectory {
    let mut sensors = Sensors::new(settings);
    let mut again = recorded.clone();
    for t in 0..again.time.len() {
        for j in 0..truth.q.len() {
            again.position[j][t] = sensors.position(j, truth.q[j][t]);
            again.torque[j][t] = sensors.torque(j, truth.torque[j][t]);
        }
    }
    again
}

fn noise(sigma: &[f64], j: usize, stream: &mut Pcg64) -> f64 {
    match sigma.get(j) {
        Some(&sigma) if sigma > 0.0 => {
            let standard: f64 = StandardNormal.sample(stream);
            sigma * standard
        }
        _ => 0.0,
    }
}
