//! A planar arm with two axes (`robots/planar_2r.yaml`), its exciting motion, and its identification.

use crate::Failure;
use dynid_codegen::{base::base_set, numeric_robot, robot::parse};
use dynid_runtime::estimation::observe::{Equations, ObserveSettings, observe};
use dynid_runtime::estimation::{EstimateSettings, estimate};
use dynid_runtime::model::{Model, RecursiveModel, StateSlices, torques};
use dynid_runtime::recording::Trajectory;
use dynid_runtime::signal::{Preparation, prepare};
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64;

const TABLE: &[u8] = include_bytes!("../../../../robots/planar_2r.yaml");
/// Samples a second and samples of the motion: eight seconds.
const RATE: f64 = 200.0;
const SAMPLES: usize = 1600;
/// Noise of the torques, N.m.
const NOISE: [f64; 2] = [0.9, 0.3];
/// Identifications from whose errors those of simulated estimates are drawn.
const IDENTIFICATIONS: usize = 1000;
/// What a swapped motor of the second joint gives for the same current.
const OTHER_MOTOR: f64 = 1.06;

pub struct Arm {
    model: RecursiveModel,
    /// Standard parameters of a new robot.
    pub standard: Vec<f64>,
    time: Vec<f64>,
    q: Vec<Vec<f64>>,
    dq: Vec<Vec<f64>>,
    ddq: Vec<Vec<f64>>,
    /// Errors and stated standard deviations of identifications of one robot.
    pub errors: Vec<Estimates>,
    /// What identification makes of a swapped motor, parameter by parameter.
    pub swapped: Vec<f64>,
}

/// Values and standard deviations.
pub type Estimates = Vec<(f64, f64)>;

impl Arm {
    pub fn new() -> Result<Self, Failure> {
        let table = parse("planar_2r.yaml", TABLE).map_err(|_| "the table has mistakes")?;
        let robot = numeric_robot(&table, &base_set(&table));
        let standard = robot.nominal.as_ref().ok_or("no nominal values")?.standard.to_vec();
        let time: Vec<f64> = (0..SAMPLES).map(|k| k as f64 / RATE).collect();
        let [q, dq, ddq] = motion(&time);
        let model = RecursiveModel::new(robot)?;
        let mut arm = Self { model, standard, time, q, dq, ddq, errors: vec![], swapped: vec![] };
        let chi = arm.chi(&arm.standard);
        let mut rng = rand::SeedableRng::seed_from_u64(7);
        let exact = arm.fit(&chi, [1.0; 2], None)?;
        for _ in 0..IDENTIFICATIONS {
            let found = arm.fit(&chi, [1.0; 2], Some(&mut rng))?;
            arm.errors.push(found.iter().zip(&exact).map(|(a, b)| (a.0 - b.0, a.1)).collect());
        }
        let other = arm.fit(&chi, [1.0, OTHER_MOTOR], None)?;
        arm.swapped = exact.iter().zip(&other).map(|(a, b)| b.0 / a.0).collect();
        Ok(arm)
    }

    pub fn chi(&self, standard: &[f64]) -> Vec<f64> {
        self.model.robot().base_from_standard(standard)
    }

    pub fn names(&self) -> Vec<String> {
        self.model.robot().base.iter().map(|p| p.name.to_string()).collect()
    }

    /// Index of a standard parameter.
    pub fn place(&self, name: &str) -> usize {
        self.model.robot().standard.iter().position(|p| &*p.name == name).unwrap()
    }

    /// Identifies a recording with these parameters; the second joint's motor may be another one.
    pub fn identify(&self, chi: &[f64], swapped: bool, rng: &mut Pcg64) -> Result<Estimates, Failure> {
        self.fit(chi, [1.0, if swapped { OTHER_MOTOR } else { 1.0 }], Some(rng))
    }

    fn fit(&self, chi: &[f64], gain: [f64; 2], rng: Option<&mut Pcg64>) -> Result<Estimates, Failure> {
        let states = StateSlices::new(&self.q, &self.dq, &self.ddq);
        let mut torque = torques(&self.model, chi, states.states());
        torque.iter_mut().zip(gain).for_each(|(joint, g)| joint.iter_mut().for_each(|t| *t *= g));
        if let Some(rng) = rng {
            for (joint, sigma) in torque.iter_mut().zip(NOISE) {
                joint.iter_mut().for_each(|t| *t += sigma * normal(rng));
            }
        }
        let trajectory = Trajectory {
            name: "day".into(),
            time: self.time.clone(),
            position: self.q.clone(),
            velocity: None,
            torque,
            fixed: vec![],
        };
        let motion = prepare(&trajectory, &Preparation::default())?;
        let settings = ObserveSettings { band: 20.0, threads: 1, ..ObserveSettings::default() };
        let observation = observe(&self.model, &[motion], Equations::Torque, None, &settings, None)?;
        let found = estimate(&observation, &EstimateSettings::default());
        Ok(found.parameters.iter().map(|p| (p.value, p.sigma.unwrap_or(0.0))).collect())
    }
}

pub fn normal(rng: &mut Pcg64) -> f64 {
    StandardNormal.sample(rng)
}

/// Sums of three sines an axis: positions, speeds, accelerations.
fn motion(time: &[f64]) -> [Vec<Vec<f64>>; 3] {
    let sines = [[(0.8, 1.9), (0.4, 4.3), (0.15, 8.8)], [(0.9, 2.7), (0.35, 5.9), (0.12, 11.3)]];
    let each = |of: &dyn Fn(f64, f64, f64) -> f64| -> Vec<Vec<f64>> {
        sines
            .iter()
            .map(|s| time.iter().map(|t| s.iter().map(|(a, w)| of(*a, *w, *t)).sum()).collect())
            .collect()
    };
    [
        each(&|a, w, t| a * (w * t).sin()),
        each(&|a, w, t| a * w * (w * t).cos()),
        each(&|a, w, t| -a * w * w * (w * t).sin()),
    ]
}
