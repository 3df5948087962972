//! The robots as tables, and what moves them.

use dynid_codegen::base::base_set;
use dynid_codegen::numeric_robot;
use dynid_codegen::robot::parse;
use dynid_runtime::model::{Model, RecursiveModel};
use dynid_runtime::recording::Trajectory;
use dynid_runtime::simulation::excitation::{ExcitationSettings, ExcitingMotion, MotionKind, excite};
use dynid_runtime::simulation::{LoopSettings, World, simulate};

use super::Hidden;

/// Two revolute axes in a vertical plane.
const PLANAR: &str = "
name: planar
gravity: [0, -9.81, 0]
constants: {d2: 0.5}
frames:
  - {j: 1, sigma: 0, alpha: 0, d: 0,  theta: q1, r: 0}
  - {j: 2, sigma: 0, alpha: 0, d: d2, theta: q2, r: 0}
drive: {gear: [50, 50]}
limits:
  position: [pi, 150*pi/180]
  velocity: [5, 7]
  acceleration: [30, 50]
nominal:
  parameters: {
    XX1: 0.0018, YY1: 0.334233, ZZ1: 0.334233, MX1: 1, M1: 4,
    Ia1: 0.12, Fv1: 2.5, Fc1: 3, off1: 0.2,
    XX2: 0.000625, YY2: 0.106979, ZZ2: 0.106979, MX2: 0.4, M2: 2,
    Ia2: 0.04, Fv2: 1.2, Fc2: 1.5, off2: -0.1,
  }
  controller: {kp: [2500, 600], kd: [90, 22], ki: [4000, 1000]}
  noise: {position: [2e-5, 2e-5], torque: [0.3, 0.1]}
";

/// Two vertical revolute axes and a vertical slide.
const SCARA: &str = "
name: scara
gravity: [0, 0, -9.81]
constants: {d2: 0.325, d3: 0.275, r1: 0.2}
frames:
  - {j: 1, sigma: 0, alpha: 0, d: 0,  theta: q1, r: r1}
  - {j: 2, sigma: 0, alpha: 0, d: d2, theta: q2, r: 0}
  - {j: 3, sigma: 1, alpha: 0, d: d3, theta: 0,  r: q3}
drive: {gear: [80, 50, 400]}
limits:
  position: [170*pi/180, 150*pi/180, 0.2]
  velocity: [8, 10, 1.5]
  acceleration: [60, 80, 20]
nominal:
  parameters: {
    XX1: 0.0126, YY1: 0.278833, ZZ1: 0.278833, MX1: 1.12, M1: 7,
    Ia1: 0.35, Fv1: 5, Fc1: 6, off1: 0.3,
    XX2: 0.0135, XZ2: -0.018, YY2: 0.132042, ZZ2: 0.127542, MX2: 0.6, MZ2: 0.15, M2: 5,
    Ia2: 0.12, Fv2: 2.2, Fc2: 3, off2: -0.2,
    XX3: 0.0152932, YY3: 0.0152932, ZZ3: 8.64e-5, MZ3: 0.06, M3: 1.2,
    Ia3: 2, Fv3: 25, Fc3: 12, off3: 0.5,
  }
  controller: {kp: [9000, 2500, 25000], kd: [220, 65, 450], ki: [20000, 6000, 60000]}
  noise: {position: [2e-5, 2e-5, 2e-6], torque: [0.4, 0.2, 0.4]}
";

/// The closed loop that a robot is recorded in.
pub struct Loop {
    /// Control rate, Hz.
    pub rate: f64,
    /// Control samples for each recorded row.
    pub record_every: usize,
}

impl Loop {
    /// What is fast enough to simulate: torques that follow the load are those of one sample before.
    pub const COARSE: Self = Self { rate: 1000.0, record_every: 2 };
    /// The same rows of a loop in which a sample is as good as none.
    pub const FINE: Self = Self { rate: 5000.0, record_every: 10 };
}

/// A robot that exists only as numbers.
pub struct SimulatedRobot {
    /// What the diagnosis is given.
    pub model: RecursiveModel,
    /// Standard parameters chi_st of the robot when nothing is hidden in it.
    pub standard: Vec<f64>,
}

/// The planar arm.
pub fn planar() -> SimulatedRobot {
    SimulatedRobot::of(PLANAR)
}

/// The planar arm, its table with another line.
pub fn planar_that_knows(line: &str) -> SimulatedRobot {
    planar_with(line, "")
}

/// The planar arm, its table with more lines, and more nominal parameters.
pub fn planar_with(lines: &str, parameters: &str) -> SimulatedRobot {
    let table = PLANAR.replace("limits:", &format!("{lines}\nlimits:"));
    SimulatedRobot::of(&table.replace("parameters: {", &format!("parameters: {{{parameters}")))
}

/// The arm with a slide.
pub fn scara() -> SimulatedRobot {
    SimulatedRobot::of(SCARA)
}

impl SimulatedRobot {
    fn of(table: &str) -> Self {
        let table = parse("table", table.as_bytes()).expect("the table is right");
        let robot = numeric_robot(&table, &base_set(&table));
        let standard = robot.nominal.as_ref().expect("it has nominal values").standard.to_vec();
        Self { model: RecursiveModel::new(robot).expect("the table is right"), standard }
    }

    /// Random Fourier motions of `length` seconds within 80 % of the limits. Other seeds give other motions.
    pub fn motions(&self, count: u64, length: f64, seed: u64) -> Vec<ExcitingMotion> {
        self.motions_within(0.8, count, length, seed)
    }

    /// The same within another share of the limits.
    pub fn motions_within(&self, share: f64, count: u64, length: f64, seed: u64) -> Vec<ExcitingMotion> {
        let chi = self.model.robot().base_from_standard(&self.standard);
        let motion = |k: u64| {
            let kind = MotionKind::Fourier { harmonics: 5 + k as usize, period: length, periods: 1 };
            let settings = ExcitationSettings { kind, share, seed: 1000 * seed + k, ..Default::default() };
            excite(&self.model, Some(&chi), &settings, &|_| {}).expect("the robot has limits").motions
        };
        (0..count).flat_map(motion).collect()
    }

    /// Records motions in closed loop at 500 Hz with the nominal noise. The controller knows nothing of effects.
    pub fn record(&self, motions: &[ExcitingMotion], hidden: &Hidden, seed: u64) -> Vec<Trajectory> {
        self.record_in(&Loop::COARSE, motions, hidden, seed)
    }

    /// The same in another loop.
    pub fn record_in(
        &self,
        of: &Loop,
        motions: &[ExcitingMotion],
        hidden: &Hidden,
        seed: u64,
    ) -> Vec<Trajectory> {
        let mut world = World::from_standard(&self.model, &self.standard);
        (hidden.put)(&mut world);
        assert_eq!(world.left_out(), [], "the simulation has to have what is hidden");
        let record = |(k, motion): (usize, &ExcitingMotion)| {
            let name = format!("motion {}", k + 1);
            let noise = 100 * seed + k as u64;
            let mut settings = LoopSettings::nominal(world.model(), &world.chi(), motion, of.rate, noise);
            settings.record_every = of.record_every;
            let mut plant = world.plant(&name).expect("the robot can exist");
            settings.name = name;
            let run = simulate(&mut plant, motion, &settings, &mut |_| {}).expect("the loop is stable");
            let mut recorded = run.recorded;
            (hidden.distort)(&mut recorded);
            recorded
        };
        motions.iter().enumerate().map(record).collect()
    }
}
