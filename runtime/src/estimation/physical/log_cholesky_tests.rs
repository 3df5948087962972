#![allow(clippy::unwrap_used)]
//! The same minima without any constraint: bodies by the numbers of Rucker and Wensing (2022), P = U Uᵀ with
//! U = e^α [[e^d1, s12, s13, t1], [0, e^d2, s23, t2], [0, 0, e^d3, t3], [0, 0, 0, 1]], of which every value is a body.

use super::prior_problem::Search;
use super::testing::{arm, rod, sigmas, standard};
use super::{Prior, near_prior};
use crate::model::{ParameterKind, Robot, StandardParameter};
use dynid_codegen::{base::base_set, numeric_robot, robot::parse};
use nalgebra::{DMatrix, DVector, Matrix4};
use rand::{RngExt, SeedableRng};

const STEPS: usize = 4000;

/// XX XY XZ YY YZ ZZ MX MY MZ M of α d1 d2 d3 s12 s23 s13 t1 t2 t3.
fn body(theta: &[f64]) -> [f64; 10] {
    let [d1, d2, d3] = [1, 2, 3].map(|k| theta[k].exp());
    #[rustfmt::skip]
    let u = Matrix4::new(
        d1, theta[4], theta[6], theta[7],
        0.0, d2, theta[5], theta[8],
        0.0, 0.0, d3, theta[9],
        0.0, 0.0, 0.0, 1.0,
    ) * theta[0].exp();
    let p = u * u.transpose();
    let trace = p[(0, 0)] + p[(1, 1)] + p[(2, 2)];
    let moment = |i: usize| trace - p[(i, i)];
    let products = [p[(0, 1)], p[(0, 2)], p[(1, 2)]].map(|x| -x);
    let [xy, xz, yz] = products;
    [moment(0), xy, xz, moment(1), yz, moment(2), p[(0, 3)], p[(1, 3)], p[(2, 3)], p[(3, 3)]]
}

/// Standard parameters of joints one after the other: bodies, rotors by their logarithms, friction and offsets as they are.
fn parameters(theta: &DVector<f64>) -> DVector<f64> {
    let mut x = DVector::zeros(theta.len());
    for frame in 0..theta.len() / 14 {
        let own = &theta.as_slice()[14 * frame..];
        body(&own[..10]).into_iter().enumerate().for_each(|(i, value)| x[14 * frame + i] = value);
        x[14 * frame + 10] = own[10].exp();
        (11..14).for_each(|i| x[14 * frame + i] = own[i]);
    }
    x
}

/// The objective over γ and its gradient by θ, that of x from the search.
fn value(search: &Search, gamma: f64, theta: &DVector<f64>) -> Option<(f64, DVector<f64>)> {
    let x = parameters(theta);
    let value = search.objective(gamma, &x)?;
    let (_, gradient) = search.newton(gamma, &x)?;
    let column = |k: usize| {
        let step = 1e-6;
        let at = |s: f64| {
            let mut beside = theta.clone();
            beside[k] += s;
            parameters(&beside)
        };
        (at(step) - at(-step)).dot(&gradient) / (2.0 * step)
    };
    Some((value, DVector::from_fn(theta.len(), |k, _| column(k))))
}

/// A minimum by the method of Broyden, Fletcher, Goldfarb and Shanno with backtracking.
fn minimum(search: &Search, gamma: f64, mut theta: DVector<f64>) -> (f64, DVector<f64>) {
    let (mut now, mut gradient) = value(search, gamma, &theta).unwrap();
    let n = theta.len();
    let mut inverse = DMatrix::<f64>::identity(n, n);
    for _ in 0..STEPS {
        let mut step = -(&inverse * &gradient);
        if step.dot(&gradient) >= 0.0 {
            inverse = DMatrix::identity(n, n);
            step = -&gradient;
        }
        let mut share = 1.0_f64.min(1.0 / step.amax());
        let next = loop {
            let next = &theta + &step * share;
            match value(search, gamma, &next) {
                Some((after, slope)) if after < now + 1e-4 * share * step.dot(&gradient) => {
                    break Some((next, after, slope));
                }
                _ if share < 1e-14 => break None,
                _ => share *= 0.5,
            }
        };
        let Some((next, after, slope)) = next else { break };
        let (s, y) = (&next - &theta, &slope - &gradient);
        (theta, now, gradient) = (next, after, slope);
        let curvature = s.dot(&y);
        if curvature > 1e-14 * s.norm() * y.norm() {
            let left = DMatrix::identity(n, n) - &s * y.transpose() / curvature;
            inverse = &left * inverse * left.transpose() + &s * s.transpose() / curvature;
        }
    }
    (now, parameters(&theta))
}

/// What Newton's method on bodies and the search without constraints find at a weight agree: the objective, and the base
/// parameters.
fn agrees(search: &Search, robot: &Robot, gamma: f64) {
    let mut x = search.start.clone();
    for decade in (0..4).rev() {
        x = search.minimum(gamma * 10_f64.powi(decade), x).unwrap();
    }
    let objective = search.objective(gamma, &x).unwrap();
    // From balls of 1 kg.
    let ball = [0.0, -2.0, -2.0, -2.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0];
    let start = DVector::from_fn(x.len(), |k, _| ball[k % 14]);
    let (wanted, other) = minimum(search, gamma, start);
    assert!((objective - wanted).abs() < 1e-6 * (1.0 + wanted.abs()), "{objective} {wanted}");
    let [a, b] = [&x, &other].map(|x| DVector::from_vec(robot.base_from_standard(x.as_slice())));
    assert!((&a - &b).amax() < 1e-3 * (1.0 + b.amax()), "{a} {b}");
}

#[test]
fn minima_are_those_of_bodies_without_constraints_by_their_log_cholesky_numbers() {
    let robot = arm();
    let mut random = rand_pcg::Pcg64::seed_from_u64(22);
    for _ in 0..4 {
        let mut between = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
        let rods = [rod(between(4.0, 9.0), between(0.3, 0.6)), rod(between(2.0, 4.0), between(0.2, 0.4))];
        let chi = robot.base_from_standard(&standard(&robot, rods));
        let prior = Prior {
            bodies: vec![Some(rod(6.0, 0.4)), Some(rod(3.0, 0.3))],
            attached: vec![[0.0; 10]; 2],
            rotors: vec![Some(0.3); 2],
            ellipsoids: vec![None; 2],
        };
        let search = Search::new(&robot, &chi, &sigmas(&chi, 0.05), &prior).unwrap();
        for gamma in [30.0, 3.0, 0.3] {
            agrees(&search, &robot, gamma);
        }
    }
}

/// The leg of a quadruped on which Wensing's minimal examples of inertia identification compare both ways
/// (github.com/ROAM-Lab-ND/inertia_identification_minimal_examples, Cheetah3LegModel.m, its numbers): hip roll about x, hip and
/// knee pitch, links as boxes, gears of 10.604, and an ellipsoid around each link. Their recording is not among its texts.
const LEG: &str = "
name: leg
description: hip roll, hip pitch, knee pitch
gravity: [0, 0, -9.81]
constants: {lo: 0.045, l1: 0.342}
frames:
  - {j: 1, sigma: 0, gamma: pi/2, alpha: pi/2, d: 0, theta: q1 - pi/2, r: 0}
  - {j: 2, sigma: 0, alpha: pi/2, d: 0, theta: q2, r: -lo}
  - {j: 3, sigma: 0, alpha: 0, d: l1, theta: q3, r: 0}
drive:
  gear: [10.604, 10.604, 10.604]
ellipsoids:
  - {frame: 1, centre: [0, 0.045, 0], radii: [0.081, 0.081, 0.081]}
  - {frame: 2, centre: [0.171, 0, 0], radii: [0.36936, 0.0594, 0.0594]}
  - {frame: 3, centre: [0.1725, 0, 0], radii: [0.2898, 0.042, 0.042]}
";

/// A box of these edges, m, along the axes of a frame, its centre at `at`.
fn solid(mass: f64, edges: [f64; 3], at: [f64; 3]) -> [f64; 10] {
    let square = |i: usize| mass * (edges[i] * edges[i] / 12.0 + at[i] * at[i]);
    let [x, y, z] = [0, 1, 2].map(square);
    let product = |i: usize, k: usize| -mass * at[i] * at[k];
    let [mx, my, mz] = at.map(|c| mass * c);
    [y + z, product(0, 1), product(0, 2), x + z, product(1, 2), x + y, mx, my, mz, mass]
}

#[test]
fn the_leg_of_the_published_minimal_examples_has_the_same_bodies_both_ways() {
    let table = parse("leg.yaml", LEG.as_bytes()).unwrap();
    let robot = numeric_robot(&table, &base_set(&table));
    let boxes = |masses: [f64; 3], knee: f64| {
        [
            solid(masses[0], [0.09; 3], [0.0, 0.045, 0.0]),
            solid(masses[1], [0.342, 0.06, 0.06], [0.171, 0.0, 0.0]),
            solid(masses[2], [0.345, 0.06, 0.06], [knee, 0.0, 0.0]),
        ]
    };
    // A rotor as a disc of 0.5 kg, behind its gear.
    let rotor = 0.5 / 12.0 * 2.0 * 0.09 * 0.09 * 10.604 * 10.604;
    let truth = |p: &StandardParameter| match ParameterKind::INERTIAL.iter().position(|k| *k == p.kind) {
        Some(place) => boxes([1.7, 0.8, 0.4], 0.12)[p.frame][place],
        None if p.kind == ParameterKind::Ia => 1.2 * rotor,
        None => 0.5,
    };
    let standard: Vec<f64> = robot.standard.iter().map(truth).collect();
    let chi = robot.base_from_standard(&standard);
    let prior = Prior {
        bodies: boxes([1.5, 0.5, 0.5], 0.1725).map(Some).to_vec(),
        attached: vec![[0.0; 10]; 3],
        rotors: vec![Some(rotor); 3],
        ellipsoids: vec![None; 3],
    };
    let search = Search::new(&robot, &chi, &sigmas(&chi, 0.05), &prior).unwrap();
    for gamma in [3.0, 0.3] {
        agrees(&search, &robot, gamma);
    }
    // Within the ellipsoids, and as near to the data.
    let ellipsoids = robot.ellipsoids.iter().map(|(_, ellipsoid)| Some(*ellipsoid)).collect();
    let bounded = Prior { ellipsoids, ..prior };
    let found = near_prior(&robot, &chi, &sigmas(&chi, 0.05), &bounded).unwrap();
    assert!(found.bounds.iter().flatten().count() == 3 && found.distance < chi.len() as f64, "{found:?}");
    assert!(found.bounds.iter().flatten().all(|bound| bound.margin > -1e-9), "{:?}", found.bounds);
}
