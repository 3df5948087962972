//! What a prior of a robot's bodies is worth, and what a wrong one costs, on new motions of simulated robots whose bodies are
//! known: `cargo test -p dynid-runtime --test prior_weight -- --nocapture` prints the table.
#![allow(clippy::unwrap_used)]

use dynid_codegen::{base::base_set, numeric_robot, robot::parse};
use dynid_runtime::estimation::observe::{Equations, ObserveSettings, Standstill, observe};
use dynid_runtime::estimation::{Estimate, EstimateSettings, Prior, estimate, near_prior};
use dynid_runtime::model::{JointKind, ParameterKind, RecursiveModel, Robot, torques_at};
use dynid_runtime::signal::Motion;
use nalgebra::{DMatrix, Matrix4, SymmetricEigen};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const RATE: f64 = 100.0;
const SECONDS: f64 = 20.0;
/// The noise's standard deviation as a part of each joint's torque.
const NOISE: f64 = 0.1;
const ROBOTS: [&str; 4] = ["scara4", "puma560", "ur10e", "stanford"];
const SEEDS: u64 = 6;

/// Nearly a standard normal number.
fn normal(random: &mut Pcg64) -> f64 {
    (0..12).map(|_| random.random::<f64>() - 0.5).sum()
}

/// Pseudo-inertia of XX XY XZ YY YZ ZZ MX MY MZ M.
fn pseudo([xx, xy, xz, yy, yz, zz, mx, my, mz, m]: [f64; 10]) -> Matrix4<f64> {
    let half = 0.5 * (xx + yy + zz);
    #[rustfmt::skip]
    let rows = [half - xx, -xy, -xz, mx, -xy, half - yy, -yz, my, -xz, -yz, half - zz, mz, mx, my, mz, m];
    Matrix4::from_row_slice(&rows)
}

fn ten(p: &Matrix4<f64>) -> [f64; 10] {
    let trace = p[(0, 0)] + p[(1, 1)] + p[(2, 2)];
    let moment = |i: usize| trace - p[(i, i)];
    let [xx, yy, zz] = [0, 1, 2].map(moment);
    [xx, -p[(0, 1)], -p[(0, 2)], yy, -p[(1, 2)], zz, p[(0, 3)], p[(1, 3)], p[(2, 3)], p[(3, 3)]]
}

/// The body drawn out, sheared, shifted and made heavier, each by about this part of its size: a body again.
fn changed(body: [f64; 10], by: f64, random: &mut Pcg64) -> [f64; 10] {
    let p = pseudo(body);
    let centre = [0, 1, 2].map(|i| p[(i, 3)] / p[(3, 3)]);
    let size = (p.fixed_view::<3, 3>(0, 0).trace() / p[(3, 3)]).sqrt();
    let mut affine = Matrix4::<f64>::identity();
    for i in 0..3 {
        for k in 0..3 {
            let part = 0.6 * by * normal(random);
            affine[(i, k)] += part;
            affine[(i, 3)] -= part * centre[k];
        }
        affine[(i, 3)] += 0.3 * by * size * normal(random);
    }
    ten(&(affine * p * affine.transpose() * (by * normal(random)).exp()))
}

/// A random motion of sines, without torques.
fn motion(robot: &Robot, random: &mut Pcg64) -> Motion {
    let samples = (SECONDS * RATE) as usize;
    let moving = robot.joint_of_frame().into_iter().enumerate().filter(|(_, joint)| joint.is_some());
    let (mut q, mut dq, mut ddq) = (Vec::new(), Vec::new(), Vec::new());
    for (frame, _) in moving {
        let scale = if robot.frames[frame].kind == JointKind::Prismatic { 0.06 } else { 0.4 };
        let waves: Vec<[f64; 3]> = (1..=5)
            .map(|h| {
                let w = 0.63 * (f64::from(h) + 0.3 * random.random::<f64>());
                [
                    scale * normal(random) / f64::from(h).sqrt(),
                    w,
                    std::f64::consts::TAU * random.random::<f64>(),
                ]
            })
            .collect();
        let sum = |value: &dyn Fn(f64, &[f64; 3]) -> f64| -> Vec<f64> {
            (0..samples).map(|k| waves.iter().map(|wave| value(k as f64 / RATE, wave)).sum()).collect()
        };
        q.push(sum(&|t, [a, w, p]| a * (w * t + p).sin()));
        dq.push(sum(&|t, [a, w, p]| a * w * (w * t + p).cos()));
        ddq.push(sum(&|t, [a, w, p]| -a * w * w * (w * t + p).sin()));
    }
    let torque = vec![vec![0.0; samples]; q.len()];
    Motion { name: "m".into(), rate: RATE, start: 0.0, q, dq, ddq, torque, fixed: vec![], edge_samples: 0 }
}

/// Torques of base parameters along a motion, joint by joint.
fn torques(model: &RecursiveModel, chi: &[f64], motion: &Motion) -> Vec<Vec<f64>> {
    let at = |x: &[Vec<f64>], k: usize| x.iter().map(|of| of[k]).collect::<Vec<f64>>();
    let rows = (0..motion.q[0].len())
        .map(|k| torques_at(model, chi, &at(&motion.q, k), &at(&motion.dq, k), &at(&motion.ddq, k)));
    let rows: Vec<Vec<f64>> = rows.collect();
    (0..motion.q.len()).map(|j| rows.iter().map(|row| row[j]).collect()).collect()
}

fn deviation(of: &[f64]) -> f64 {
    (of.iter().map(|x| x * x).sum::<f64>() / of.len() as f64).sqrt()
}

/// A robot with its own bodies, and what was identified of it.
struct Recorded {
    robot: Robot,
    model: RecursiveModel,
    truth: Vec<f64>,
    bodies: Vec<Option<[f64; 10]>>,
    estimate: Estimate,
    new: Motion,
}

impl Recorded {
    fn new(name: &str, random: &mut Pcg64) -> Self {
        let path = format!("{}/../robots/{name}.yaml", env!("CARGO_MANIFEST_DIR"));
        let table = parse(name, &std::fs::read(path).unwrap()).unwrap();
        let robot = numeric_robot(&table, &base_set(&table));
        let model = RecursiveModel::new(robot.clone()).unwrap();
        let mut truth = robot.nominal.as_ref().unwrap().standard.to_vec();
        let mut bodies = Vec::new();
        for frame in 0..robot.frames.len() {
            let own = Self::places(&robot, frame);
            let mut body = own.map(|k| truth[k]);
            // As thick in every direction as a tenth of its length.
            let thick = body[9] * 1e-3;
            [0, 3, 5].into_iter().for_each(|k| body[k] += 2.0 * thick);
            let known = Some(body).filter(|body| body[9] > 0.0).map(|body| changed(body, 0.2, random));
            own.iter().enumerate().for_each(|(i, &k)| truth[k] = known.map_or(0.0, |body| body[i]));
            bodies.push(known);
        }
        let chi = robot.base_from_standard(&truth);
        let [mut recorded, new] = [motion(&robot, random), motion(&robot, random)];
        recorded.torque = torques(&model, &chi, &recorded);
        for torque in &mut recorded.torque {
            // Noise that lasts for a fifth of a second.
            let sigma = NOISE * deviation(torque);
            let mut noise = sigma * normal(random);
            for value in torque {
                noise = 0.95 * noise + (1.0_f64 - 0.95 * 0.95).sqrt() * sigma * normal(random);
                *value += noise;
            }
        }
        let settings = ObserveSettings {
            band: 10.0,
            standstill: Standstill::Keep,
            keep_rows: true,
            ..Default::default()
        };
        let seen = observe(&model, &[recorded], Equations::Torque, None, &settings, None).unwrap();
        let estimate = estimate(&seen, &EstimateSettings { r_sigma: None, ..Default::default() });
        Self { robot, model, truth, bodies, estimate, new }
    }

    fn places(robot: &Robot, frame: usize) -> [usize; 10] {
        ParameterKind::INERTIAL
            .map(|kind| robot.standard.iter().position(|p| p.frame == frame && p.kind == kind).unwrap())
    }

    fn covariance(&self) -> DMatrix<f64> {
        let n = self.robot.base.len();
        let mut upper = self.estimate.covariance.iter().flatten();
        let mut matrix = DMatrix::zeros(n, n);
        for i in 0..n {
            for k in i..n {
                matrix[(i, k)] = *upper.next().unwrap();
                matrix[(k, i)] = matrix[(i, k)];
            }
        }
        matrix
    }

    /// Mean square of the error of the torques of a new motion, in units of the noise, every joint counting the same.
    fn error(&self, chi: &[f64]) -> f64 {
        let truth = torques(&self.model, &self.robot.base_from_standard(&self.truth), &self.new);
        let own = torques(&self.model, chi, &self.new);
        let of_joint = |(own, truth): (&Vec<f64>, &Vec<f64>)| {
            let off: Vec<f64> = own.iter().zip(truth).map(|(a, b)| a - b).collect();
            (deviation(&off) / (NOISE * deviation(truth))).powi(2)
        };
        own.iter().zip(&truth).map(of_joint).sum::<f64>() / own.len() as f64
    }

    /// How far bodies are from the true ones: root mean square of the logarithms of the ratios of their second moments.
    fn far(&self, bodies: &[Option<[f64; 10]>]) -> f64 {
        let mut logarithms = Vec::new();
        for (own, truth) in bodies.iter().zip(&self.bodies).filter_map(|(a, b)| Some(((*a)?, (*b)?))) {
            let root = nalgebra::Cholesky::new(pseudo(truth)).unwrap().l().try_inverse().unwrap();
            let ratio = root * pseudo(own) * root.transpose();
            let eigen = SymmetricEigen::new((ratio + ratio.transpose()) * 0.5);
            logarithms.extend(eigen.eigenvalues.iter().map(|x| x.max(1e-12).ln()));
        }
        deviation(&logarithms)
    }
}

/// Ratio of the new motion's squared error with bodies to that without, in the geometric mean; greatest loss of the torques'
/// relative error, %; how far the bodies and the prior are from the truth.
fn row(by: f64, one_link: bool) -> [f64; 4] {
    let (mut sums, mut count) = ([0.0, f64::NEG_INFINITY, 0.0, 0.0], 0.0);
    for name in ROBOTS {
        for seed in 0..SEEDS {
            let mut random = Pcg64::seed_from_u64(seed);
            let recorded = Recorded::new(name, &mut random);
            let robot = &recorded.robot;
            let mut change = |frame: usize, body: [f64; 10]| {
                let part = if one_link && frame != 2 { 0.0 } else { by };
                changed(body, part, &mut random)
            };
            let bodies: Vec<_> =
                recorded.bodies.iter().enumerate().map(|(f, b)| b.map(|body| change(f, body))).collect();
            let prior = Prior {
                attached: vec![[0.0; 10]; bodies.len()],
                rotors: vec![None; robot.joints()],
                ellipsoids: vec![None; bodies.len()],
                bodies,
            };
            let chi = recorded.estimate.chi();
            let near = near_prior(robot, &chi, &recorded.covariance(), &prior).unwrap();
            let [own, free] = [recorded.error(&near.chi), recorded.error(&chi)];
            let body = |frame: usize| Recorded::places(robot, frame).map(|k| near.standard[k]);
            let found: Vec<_> = (0..robot.frames.len()).map(|f| prior.bodies[f].map(|_| body(f))).collect();
            sums[0] += (own / free).ln();
            sums[1] = sums[1].max(100.0 * (((1.0 + own) / (1.0 + free)).sqrt() - 1.0));
            sums[2] += recorded.far(&found);
            sums[3] += recorded.far(&prior.bodies);
            count += 1.0;
        }
    }
    [(sums[0] / count).exp(), sums[1], sums[2] / count, sums[3] / count]
}

#[test]
fn a_right_prior_spares_torques_their_error_and_a_wrong_one_costs_them_next_to_nothing() {
    println!(
        "prior off by | squared error, bodies / free | greatest loss of the torques, % | bodies off by | prior off by"
    );
    let told = |name: &str, [ratio, loss, bodies, prior]: [f64; 4]| {
        println!("{name:12} | {ratio:.3} | {loss:.2} | {bodies:.3} | {prior:.3}");
    };
    for (name, by, one, most, loss) in [
        ("nothing", 0.0, false, 0.5, 4.0),
        ("10 %", 0.1, false, 0.5, 4.0),
        ("30 %", 0.3, false, 0.6, 5.0),
        ("100 %", 1.0, false, 0.7, 8.0),
        ("one link", 1.0, true, 0.6, 10.0),
    ] {
        let found = row(by, one);
        told(name, found);
        assert!(found[0] < most && found[1] < loss, "{name}: {found:?}");
        // Bodies do not end farther from the truth than they began.
        assert!(found[2] < 1.1 * found[3] + 0.2, "{name}: {found:?}");
    }
}
