//! A plant under control follows a planned motion and is recorded.

use super::SimulationError;
use super::controller::{Controller, ControllerSettings};
use super::plant::Plant;
use super::reference::Reference;
use super::sensors::{SensorSettings, Sensors};
use super::state::State;
use crate::model::Model;
use crate::recording::Trajectory;
use crate::signal::Motion;

/// How a closed loop is run and recorded.
#[derive(Debug, Clone, PartialEq)]
pub struct LoopSettings {
    /// The controller.
    pub controller: ControllerSettings,
    /// The sensors.
    pub sensors: SensorSettings,
    /// Control samples for each recorded row; 1 records every one.
    pub record_every: usize,
    /// Longest integration step, s; the control period is divided evenly into steps no longer than this.
    pub longest_step: f64,
    /// Name of the recorded trajectory.
    pub name: String,
}

impl LoopSettings {
    /// The robot's nominal controller and sensors for base parameters `chi`, recorded at every control sample.
    pub fn nominal(model: &dyn Model, chi: &[f64], reference: &dyn Reference, rate: f64, seed: u64) -> Self {
        let robot = model.robot();
        let n = robot.joints();
        let (mut q, mut dq, mut ddq) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
        reference.at(0.0, &mut q, &mut dq, &mut ddq);
        let (mut mass, mut bias) = (vec![0.0; n * n], vec![0.0; n]);
        model.mass_and_bias(chi, &q, &dq, &mut mass, &mut bias);
        Self {
            controller: ControllerSettings::nominal(robot, chi, &mass, rate),
            sensors: SensorSettings::nominal(robot, seed),
            record_every: 1,
            longest_step: 5e-4,
            name: "simulated".to_string(),
        }
    }
}

/// What a closed loop gives.
#[derive(Debug, Clone, PartialEq)]
pub struct Simulation {
    /// What was measured.
    pub recorded: Trajectory,
    /// What was: positions, velocities and accelerations of the motor side without noise, and the motor torques,
    /// at the recorded rows.
    pub truth: Motion,
    /// Control samples at which each joint's torque was at its limit.
    pub limited: Vec<usize>,
    /// Largest |planned - actual| position of each joint, as its encoder would see it without noise, rad or m.
    pub tracking_error: Vec<f64>,
}

/// Lets a plant follow `reference` from its start to its end.
///
/// The torque of control sample k is held until sample k + 1. The recorded torque at a sample is the mean of the
/// torques held before and after it, as a drive measures that averages its current over a control period: the
/// torque channel then has no delay to the positions. `progress` is called with the share done, now and then.
///
/// # Errors
/// Settings that do not fit the robot; see [`SimulationError`].
pub fn simulate(
    plant: &mut Plant<'_>,
    reference: &dyn Reference,
    settings: &LoopSettings,
    progress: &mut dyn FnMut(f64),
) -> Result<Simulation, SimulationError> {
    let n = plant.joints();
    let model = plant.model();
    let mut controller = Controller::new(&settings.controller, model)?;
    check(settings, reference, n)?;
    let mut sensors = Sensors::new(&settings.sensors);
    let period = 1.0 / settings.controller.rate;
    let samples = (reference.duration() * settings.controller.rate + 1e-6).floor() as usize + 1;
    let parts = (period / settings.longest_step).ceil().max(1.0) as usize;
    let rows = samples.div_ceil(settings.record_every);
    let (mut q, mut dq, mut ddq) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    reference.at(0.0, &mut q, &mut dq, &mut ddq);
    let mut state = plant.state_seen_at(&q, &dq);
    let mut here = state.clone();
    let mut log = Log::new(n, rows);
    let mut reading = vec![0.0; n];
    let (mut torque, mut held, mut real) = (vec![0.0; n], vec![0.0; n], vec![0.0; n]);
    let mut acceleration = vec![0.0; state.q.len()];
    let mut tracking_error = vec![0.0_f64; n];
    for k in 0..samples {
        let t = k as f64 * period;
        state.time = t;
        reference.at(t, &mut q, &mut dq, &mut ddq);
        for j in 0..n {
            let position = plant.encoder(&state, j);
            reading[j] = sensors.position(j, position);
            tracking_error[j] = tracking_error[j].max((q[j] - position).abs());
        }
        std::mem::swap(&mut torque, &mut held);
        controller.command(&reading, &q, &dq, &ddq, &mut torque);
        if k == 0 {
            held.copy_from_slice(&torque);
        }
        if k % settings.record_every == 0 {
            // With the mean torque: the acceleration has a step at the sample, and this is its middle.
            log.mean.iter_mut().zip(held.iter().zip(&torque)).for_each(|(m, (a, b))| *m = 0.5 * (a + b));
            here.copy_from(&state);
            plant.real_torques(&log.mean, &mut real);
            plant.acceleration(&mut here, &real, &mut acceleration)?;
            let sample =
                Sample { state: &state, acceleration: &acceleration, reading: &reading, torque: &real };
            log.record(plant, &sample, &mut sensors);
        }
        if k + 1 < samples {
            plant.real_torques(&torque, &mut real);
            for _ in 0..parts {
                plant.advance(&mut state, &real, period / parts as f64)?;
            }
        }
        if k % 1024 == 0 {
            progress(k as f64 / samples as f64);
        }
    }
    progress(1.0);
    let rate = settings.controller.rate / settings.record_every as f64;
    let (recorded, truth) = log.finish(settings.name.clone(), rate, reference.fixed());
    Ok(Simulation { recorded, truth, limited: controller.limited, tracking_error })
}

/// Rows that fit into the memory of a small machine, with all that is logged of each.
const MOST_ROWS: f64 = 1e7;

fn check(settings: &LoopSettings, reference: &dyn Reference, n: usize) -> Result<(), SimulationError> {
    settings.sensors.check(n)?;
    if reference.joints() != n {
        let found = reference.joints();
        return Err(SimulationError::Length { what: "joints in the motion", expected: n, found });
    }
    if settings.record_every == 0 {
        let what = "control samples for each recorded row";
        return Err(SimulationError::Setting { what, expected: "1 or more", found: 0.0 });
    }
    let found = settings.longest_step;
    if !(found > 0.0 && found.is_finite()) {
        return Err(SimulationError::Setting { what: "integration step", expected: "positive", found });
    }
    let found = reference.duration();
    if !(found > 0.0 && found.is_finite()) {
        return Err(SimulationError::Setting { what: "duration of the motion", expected: "positive", found });
    }
    // Compared before anything is counted in integers or made room for.
    let found = found * settings.controller.rate / settings.record_every as f64;
    if !(1.0..=MOST_ROWS).contains(&found) {
        let what = "the duration of the motion times the rate of the rows";
        return Err(SimulationError::Setting { what, expected: "1 to 10 million rows", found });
    }
    let found = settings.longest_step * settings.controller.rate;
    if found < 1e-6 {
        let what = "the integration step in control periods";
        return Err(SimulationError::Setting { what, expected: "a millionth at least", found });
    }
    Ok(())
}

/// What there is to record at a control sample.
struct Sample<'a> {
    /// The plant, at the time of the sample.
    state: &'a State,
    /// Its accelerations.
    acceleration: &'a [f64],
    /// What the encoders say, per joint.
    reading: &'a [f64],
    /// Real torques, per joint.
    torque: &'a [f64],
}

/// Signals of the rows so far, joint by joint.
struct Log {
    time: Vec<f64>,
    position: Vec<Vec<f64>>,
    torque: Vec<Vec<f64>>,
    q: Vec<Vec<f64>>,
    dq: Vec<Vec<f64>>,
    ddq: Vec<Vec<f64>>,
    true_torque: Vec<Vec<f64>>,
    mean: Vec<f64>,
}

impl Log {
    fn new(n: usize, rows: usize) -> Self {
        let signals = || vec![Vec::with_capacity(rows); n];
        Self {
            time: Vec::with_capacity(rows),
            position: signals(),
            torque: signals(),
            q: signals(),
            dq: signals(),
            ddq: signals(),
            true_torque: signals(),
            mean: vec![0.0; n],
        }
    }

    fn record(&mut self, plant: &Plant<'_>, sample: &Sample<'_>, sensors: &mut Sensors<'_>) {
        let &Sample { state, acceleration, reading, torque } = sample;
        self.time.push(state.time);
        for (j, &read) in reading.iter().enumerate() {
            self.position[j].push(read);
            self.torque[j].push(sensors.torque(j, self.mean[j]));
            self.q[j].push(plant.motor_position(state, j));
            self.dq[j].push(plant.motor_velocity(state, j));
            self.ddq[j].push(plant.motor_acceleration(acceleration, j));
            self.true_torque[j].push(torque[j]);
        }
    }

    fn finish(self, name: String, rate: f64, fixed: Vec<usize>) -> (Trajectory, Motion) {
        let truth = Motion {
            name: name.clone(),
            rate,
            start: 0.0,
            q: self.q,
            dq: self.dq,
            ddq: self.ddq,
            torque: self.true_torque,
            fixed: fixed.clone(),
            edge_samples: 0,
        };
        let recorded = Trajectory {
            name,
            time: self.time,
            position: self.position,
            velocity: None,
            torque: self.torque,
            fixed,
        };
        (recorded, truth)
    }
}
