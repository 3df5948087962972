//! What is recorded: robots, motions and noise.

use dynid::models;
use dynid_runtime::model::Model;
use dynid_runtime::recording::Trajectory;
use dynid_runtime::simulation::excitation::{ExcitationSettings, ExcitingMotion, MotionKind, excite};
use dynid_runtime::simulation::{LoopSettings, Plant, simulate};
use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

pub const ROBOTS: [&str; 4] = ["planar_2r", "scara4", "tx40", "cobot6"];

/// Control rate, Hz, and control samples for each row of the recording, as of `dynid simulate`.
const CONTROL: f64 = 5000.0;
const RECORD_EVERY: usize = 5;
/// An error of the torque forgets a factor e in 50 ms.
const MEMORY: f64 = 0.05;

/// How many motions, and how long.
pub struct Shape {
    pub name: &'static str,
    motions: usize,
    period: f64,
}

pub const SHAPES: [Shape; 4] = [
    Shape { name: "1x5s", motions: 1, period: 5.0 },
    Shape { name: "3x8s", motions: 3, period: 8.0 },
    Shape { name: "20x1.5s", motions: 20, period: 1.5 },
    // More rows than are kept; on demand only.
    Shape { name: "14x8s", motions: 14, period: 8.0 },
];
/// Those of the table.
pub const USUAL_SHAPES: [&str; 3] = ["1x5s", "3x8s", "20x1.5s"];

/// What is wrong with the measurements.
#[derive(Clone, Copy, PartialEq, Eq)]
pub enum Noise {
    /// White, of the robot's nominal size, on encoders and torques.
    White,
    /// The same, but the error of a torque depends on its past.
    Ar1,
    /// The encoders have steps, of the variance that the noise would have, and no noise.
    Quantised,
    /// None, for what is wrong without any; on demand only.
    Perfect,
    /// White, but the controller knows the true positions; on demand only.
    OpenLoop,
}

impl Noise {
    pub const ALL: [Noise; 5] = [Noise::White, Noise::Ar1, Noise::Quantised, Noise::Perfect, Noise::OpenLoop];
    /// Those of the table.
    pub const USUAL: [&str; 3] = ["white", "AR(1)", "quantised"];

    pub fn name(self) -> &'static str {
        match self {
            Noise::White => "white",
            Noise::Ar1 => "AR(1)",
            Noise::Quantised => "quantised",
            Noise::Perfect => "none",
            Noise::OpenLoop => "open loop",
        }
    }
}

/// A robot and the shape of its motions.
pub struct Case<'s> {
    pub model: &'static dyn Model,
    chi: Vec<f64>,
    shape: &'s Shape,
}

/// A recording with how it was made.
pub struct Recording {
    pub trajectories: Vec<Trajectory>,
    pub settings: Vec<LoopSettings>,
    pub motions: Vec<ExcitingMotion>,
}

impl<'s> Case<'s> {
    pub fn new(robot: &str, shape: &'s Shape) -> Self {
        let model = models::find(robot).unwrap();
        let chi = model.robot().base_from_standard(&model.robot().nominal.as_ref().unwrap().standard);
        Case { model, chi, shape }
    }

    /// Names and values of the base parameters.
    pub fn truth(&self) -> Vec<(String, f64)> {
        let names = self.model.robot().base.iter().map(|b| b.name.to_string());
        names.zip(self.chi.iter().copied()).collect()
    }

    /// The motions of a seed: others for every seed, as `dynid simulate` plans them.
    fn motions(&self, seed: u64) -> Vec<ExcitingMotion> {
        (0..self.shape.motions)
            .flat_map(|k| {
                let kind = MotionKind::Fourier { harmonics: 5, period: self.shape.period, periods: 1 };
                let seed = seed * 1009 + k as u64;
                let settings = ExcitationSettings { kind, seed, ..ExcitationSettings::default() };
                excite(self.model, Some(&self.chi), &settings, &|_| {}).unwrap().motions
            })
            .collect()
    }

    pub fn record(&self, noise: Noise, seed: u64) -> Recording {
        let motions = self.motions(seed);
        let (mut trajectories, mut all) = (Vec::new(), Vec::new());
        for (k, motion) in motions.iter().enumerate() {
            let (recorded, settings) = self.run(noise, motion, seed * 1000 + k as u64, k);
            trajectories.push(recorded);
            all.push(settings);
        }
        Recording { trajectories, settings: all, motions }
    }

    fn run(&self, noise: Noise, motion: &ExcitingMotion, seed: u64, k: usize) -> (Trajectory, LoopSettings) {
        let mut settings = LoopSettings::nominal(self.model, &self.chi, motion, CONTROL, seed);
        settings.record_every = RECORD_EVERY;
        settings.name = format!("motion {}", k + 1);
        let sensors = &mut settings.sensors;
        let (torque_noise, position_noise) = (sensors.torque_noise.clone(), sensors.position_noise.clone());
        if noise == Noise::Quantised {
            sensors.position_quantum = position_noise.iter().map(|sigma| sigma * 12f64.sqrt()).collect();
            sensors.position_noise.clear();
        }
        if matches!(noise, Noise::Ar1 | Noise::Perfect | Noise::OpenLoop) {
            sensors.torque_noise.clear();
        }
        if matches!(noise, Noise::Perfect | Noise::OpenLoop) {
            sensors.position_noise.clear();
        }
        let mut plant = Plant::new(self.model, &self.chi).unwrap();
        let mut recorded = simulate(&mut plant, motion, &settings, &mut |_| {}).unwrap().recorded;
        let mut random = Pcg64::seed_from_u64(seed ^ 0xa21);
        if noise == Noise::Ar1 {
            for (torque, sigma) in recorded.torque.iter_mut().zip(&torque_noise) {
                add_ar1(torque, *sigma, &mut random);
            }
        }
        if noise == Noise::OpenLoop {
            let channels = recorded.torque.iter_mut().chain(&mut recorded.position);
            for (channel, sigma) in channels.zip(torque_noise.iter().chain(&position_noise)) {
                for value in channel {
                    let draw: f64 = StandardNormal.sample(&mut random);
                    *value += sigma * draw;
                }
            }
        }
        (recorded, settings)
    }
}

/// Adds an error that begins as it goes on: stationary, with standard deviation `sigma`.
fn add_ar1(torque: &mut [f64], sigma: f64, random: &mut Pcg64) {
    let rho = (-(RECORD_EVERY as f64) / (CONTROL * MEMORY)).exp();
    let mut draw = || -> f64 { StandardNormal.sample(random) };
    let mut error = sigma * draw();
    for value in torque {
        *value += error;
        error = rho * error + sigma * (1.0 - rho * rho).sqrt() * draw();
    }
}
