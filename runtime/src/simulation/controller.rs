//! A sampled joint controller: PID on encoder readings with a model's torque fed forward.

use super::SimulationError;
use super::drive::DriveFriction;
use crate::model::{Model, Robot};

/// Settings of the controller, joint side.
#[derive(Debug, Clone, PartialEq)]
pub struct ControllerSettings {
    /// Samples a second, Hz.
    pub rate: f64,
    /// N.m/rad or N/m.
    pub kp: Vec<f64>,
    /// N.m.s/rad or N.s/m.
    pub kd: Vec<f64>,
    /// N.m/(rad.s) or N/(m.s).
    pub ki: Vec<f64>,
    /// Cut-off of the first-order filter on the differentiated encoder reading, Hz.
    pub velocity_cutoff: f64,
    /// Base parameters of the model that is fed forward; `None` feeds nothing forward.
    pub feed_forward: Option<Vec<f64>>,
    /// `[low, high]` per joint, N.m or N; empty for none.
    pub torque_limits: Vec<[f64; 2]>,
}

impl ControllerSettings {
    /// The robot's nominal gains, limits and feed-forward; gains that the robot does not give place each joint's
    /// poles at 8 Hz with damping 1, for its own inertia in `mass` (n x n) and without integral action.
    pub fn nominal(robot: &Robot, chi: &[f64], mass: &[f64], rate: f64) -> Self {
        let n = robot.joints();
        let nominal = robot.nominal.as_ref();
        let given = |gains: Option<&[f64]>, standard: &dyn Fn(f64) -> f64| match gains {
            Some(gains) if gains.len() == n => gains.to_vec(),
            _ => (0..n).map(|j| standard(mass[j * n + j])).collect(),
        };
        let w = 8.0 * std::f64::consts::TAU;
        Self {
            rate,
            kp: given(nominal.map(|x| &*x.kp), &|inertia| w * w * inertia),
            kd: given(nominal.map(|x| &*x.kd), &|inertia| 2.0 * w * inertia),
            ki: given(nominal.map(|x| &*x.ki), &|_| 0.0),
            velocity_cutoff: 200.0,
            feed_forward: Some(chi.to_vec()),
            torque_limits: robot.limits.torque.to_vec(),
        }
    }

    fn check(&self, n: usize) -> Result<(), SimulationError> {
        for (what, gains) in [("gains kp", &self.kp), ("gains kd", &self.kd), ("gains ki", &self.ki)] {
            if gains.len() != n {
                return Err(SimulationError::Length { what, expected: n, found: gains.len() });
            }
            if gains.iter().any(|x| !x.is_finite()) {
                return Err(SimulationError::NotFinite { name: what.to_string() });
            }
        }
        if !self.torque_limits.is_empty() && self.torque_limits.len() != n {
            let found = self.torque_limits.len();
            return Err(SimulationError::Length { what: "torque limits", expected: n, found });
        }
        if let Some(limit) = self.torque_limits.iter().find(|x| x[0].is_nan() || x[1].is_nan() || x[0] > x[1])
        {
            let found = limit[0];
            return Err(SimulationError::Setting {
                what: "a low torque limit",
                expected: "below the high one",
                found,
            });
        }
        for (what, found) in [("controller rate", self.rate), ("velocity cut-off", self.velocity_cutoff)] {
            if !(found > 0.0 && found <= 1e6) {
                return Err(SimulationError::Setting { what, expected: "positive, at most 1 MHz", found });
            }
        }
        Ok(())
    }
}

/// A controller at work.
pub(crate) struct Controller<'a> {
    settings: &'a ControllerSettings,
    model: &'a dyn Model,
    friction: Option<DriveFriction>,
    /// Smoothing factor of the velocity filter.
    smoothing: f64,
    last_reading: Vec<f64>,
    velocity: Vec<f64>,
    integral: Vec<f64>,
    mass: Vec<f64>,
    bias: Vec<f64>,
    started: bool,
    /// Control samples at which each joint's torque was limited.
    pub limited: Vec<usize>,
}

impl<'a> Controller<'a> {
    pub fn new(settings: &'a ControllerSettings, model: &'a dyn Model) -> Result<Self, SimulationError> {
        let robot = model.robot();
        let n = robot.joints();
        settings.check(n)?;
        let friction = match &settings.feed_forward {
            None => None,
            Some(chi) if chi.len() != robot.base.len() => {
                let (expected, found) = (robot.base.len(), chi.len());
                return Err(SimulationError::Length { what: "parameters to feed forward", expected, found });
            }
            Some(chi) => {
                let joints: Vec<usize> = (0..n).collect();
                let kept = robot.base.iter().zip(chi).map(|(p, &value)| {
                    let standard = &robot.standard[p.standard];
                    (&*p.name, standard, value)
                });
                Some(DriveFriction::new(robot, kept, &joints, false)?)
            }
        };
        let period = 1.0 / settings.rate;
        Ok(Self {
            settings,
            model,
            friction,
            smoothing: 1.0 - (-std::f64::consts::TAU * settings.velocity_cutoff * period).exp(),
            last_reading: vec![0.0; n],
            velocity: vec![0.0; n],
            integral: vec![0.0; n],
            mass: vec![0.0; n * n],
            bias: vec![0.0; n],
            started: false,
            limited: vec![0; n],
        })
    }

    /// Torques for an encoder reading and the planned state, at the next control sample.
    pub fn command(&mut self, reading: &[f64], q: &[f64], dq: &[f64], ddq: &[f64], torque: &mut [f64]) {
        let n = torque.len();
        let period = 1.0 / self.settings.rate;
        if !self.started {
            self.started = true;
            self.last_reading.copy_from_slice(reading);
            self.velocity.copy_from_slice(dq);
        }
        torque.fill(0.0);
        self.feed_forward(q, dq, ddq, torque);
        for j in 0..n {
            let difference = (reading[j] - self.last_reading[j]) * self.settings.rate;
            self.velocity[j] += self.smoothing * (difference - self.velocity[j]);
            self.last_reading[j] = reading[j];
            let error = q[j] - reading[j];
            let integral = self.integral[j] + period * error;
            let wanted = torque[j]
                + self.settings.kp[j] * error
                + self.settings.kd[j] * (dq[j] - self.velocity[j])
                + self.settings.ki[j] * integral;
            let [low, high] = self.settings.torque_limits.get(j).copied().unwrap_or([f64::MIN, f64::MAX]);
            torque[j] = wanted.clamp(low, high);
            if torque[j] == wanted {
                self.integral[j] = integral;
            } else {
                // The integral waits while the torque is limited.
                self.limited[j] += 1;
            }
        }
    }

    fn feed_forward(&mut self, q: &[f64], dq: &[f64], ddq: &[f64], torque: &mut [f64]) {
        let (Some(chi), Some(friction)) = (&self.settings.feed_forward, &self.friction) else { return };
        let n = torque.len();
        self.model.mass_and_bias(chi, q, dq, &mut self.mass, &mut self.bias);
        for j in 0..n {
            torque[j] = self.bias[j] + (0..n).map(|s| self.mass[j * n + s] * ddq[s]).sum::<f64>();
        }
        for &(joint, offset) in &friction.offset {
            torque[joint] += offset;
        }
        for &(row, column, coefficient) in &friction.viscous {
            torque[row] += coefficient * dq[column];
        }
        for element in &friction.elements {
            let slip = element.slip(dq);
            if slip != 0.0 {
                element.add(element.level * slip.signum(), torque);
            }
        }
    }
}
