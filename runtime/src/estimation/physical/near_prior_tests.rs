#![allow(clippy::unwrap_used)]
use super::*;
use crate::estimation::physical::pseudo_inertia::pseudo_inertia;
use crate::estimation::physical::testing::{arm, prior, rod, sigmas, standard};
use crate::estimation::physical::{Constraint, released};
use crate::model::{Drive, Ellipsoid, Frame, JointKind, Limits};
use nalgebra::DVector;

fn is_body(near: &NearPrior, frame: usize) -> bool {
    let link: [usize; 10] = std::array::from_fn(|k| 14 * frame + k);
    nalgebra::Cholesky::new(pseudo_inertia(&link, &DVector::from_column_slice(&near.standard))).is_some()
}

#[test]
fn a_prior_that_agrees_with_the_data_is_kept() {
    let robot = arm();
    let truth = standard(&robot, [rod(6.0, 0.4), rod(3.0, 0.3)]);
    let chi = robot.base_from_standard(&truth);
    let near = near_prior(&robot, &chi, &sigmas(&chi, 0.02), &prior()).unwrap();
    assert!(near.distance <= near.determined as f64 + 1e-6, "{near:?}");
    for frame in 0..2 {
        for k in 0..10 {
            let at = 14 * frame + k;
            assert!((near.standard[at] - truth[at]).abs() < 0.05 * (0.1 + truth[at].abs()), "{k} of {frame}");
        }
    }
}

#[test]
fn what_the_data_determine_is_the_data_s_and_every_body_has_a_density() {
    let robot = arm();
    let truth = standard(&robot, [rod(9.0, 0.5), rod(1.5, 0.25)]);
    let chi = robot.base_from_standard(&truth);
    let near = near_prior(&robot, &chi, &sigmas(&chi, 1e-4), &prior()).unwrap();
    assert!(near.least < 0.1 && near.distance <= near.determined as f64 + 0.2, "{near:?}");
    for (own, wanted) in near.chi.iter().zip(&chi) {
        assert!((own - wanted).abs() < 1e-3 * (0.1 + wanted.abs()), "{:?} {chi:?}", near.chi);
    }
    assert!(is_body(&near, 0) && is_body(&near, 1));
    let share = |name: &str| near.from_data[robot.standard.iter().position(|p| p.name == name).unwrap()];
    assert!(share("MX2") > 0.99 && share("ZZ2") > 0.99 && share("M1") < 0.5, "{near:?}");
}

#[test]
fn values_that_no_body_has_are_told_by_their_distance() {
    let robot = arm();
    let truth = standard(&robot, [rod(6.0, 0.4), rod(3.0, 0.3)]);
    let mut chi = robot.base_from_standard(&truth);
    // A weight without inertia.
    chi[robot.base.iter().position(|b| b.name == "ZZ2").unwrap()] = -0.2;
    let near = near_prior(&robot, &chi, &sigmas(&chi, 0.01), &prior()).unwrap();
    assert!(near.least > 10.0 * near.determined as f64, "{near:?}");
    assert!(is_body(&near, 0) && is_body(&near, 1));
    // Without what holds the second body nothing is in the way; without what holds another part all of it is.
    let released = released(&robot, &chi, &sigmas(&chi, 0.01), &prior()).unwrap();
    assert_eq!(released.len(), 4);
    assert!(released[0].what == Constraint::Body(1) && released[0].least < 0.01 * near.least, "{released:?}");
    assert!(released[1..].iter().all(|r| r.least > 0.5 * near.least), "{released:?}");
}

#[test]
fn what_is_attached_stays_part_of_the_body() {
    let robot = arm();
    let truth = standard(&robot, [rod(6.0, 0.4), rod(3.0, 0.3)]);
    let chi = robot.base_from_standard(&truth);
    let tool = rod(1.0, 0.3);
    let bodies = vec![Some(rod(6.0, 0.4)), Some(rod(1.0, 0.3))];
    let prior = Prior {
        bodies,
        attached: vec![[0.0; 10], tool],
        rotors: vec![Some(0.3); 2],
        ellipsoids: vec![None; 2],
    };
    let near = near_prior(&robot, &chi, &sigmas(&chi, 1e-3), &prior).unwrap();
    let own: [f64; 10] = std::array::from_fn(|k| near.standard[14 + k] - tool[k]);
    let link: [usize; 10] = std::array::from_fn(|k| k);
    assert!(nalgebra::Cholesky::new(pseudo_inertia(&link, &DVector::from_column_slice(&own))).is_some());
    assert!(near.least < 0.1 && near.distance <= near.determined as f64 + 0.2, "{near:?}");
}

#[test]
fn arguments_that_do_not_belong_together_are_refused() {
    let robot = arm();
    let truth = standard(&robot, [rod(6.0, 0.4), rod(3.0, 0.3)]);
    let chi = robot.base_from_standard(&truth);
    let covariance = sigmas(&chi, 0.01);
    assert_eq!(near_prior(&robot, &chi[1..], &covariance, &prior()), Err(NearPriorError::Shape));
    assert_eq!(near_prior(&robot, &chi, &(&covariance * 0.0), &prior()), Err(NearPriorError::NoInformation));
    let mut flat = prior();
    flat.bodies[1] = Some([0.0; 10]);
    assert_eq!(near_prior(&robot, &chi, &covariance, &flat), Err(NearPriorError::Prior(1)));
}

/// A ball, or what a ball becomes when it is drawn out along the axes.
fn ellipsoid(centre: [f64; 3], radii: [f64; 3]) -> Ellipsoid {
    let entry = |i: usize, j: usize| if i == j { radii[i] * radii[i] } else { 0.0 };
    Ellipsoid { centre, shape: std::array::from_fn(|i| std::array::from_fn(|j| entry(i, j))) }
}

#[test]
fn ellipsoids_that_hold_nothing_back_change_nothing() {
    let robot = arm();
    let truth = standard(&robot, [rod(9.0, 0.5), rod(1.5, 0.25)]);
    let chi = robot.base_from_standard(&truth);
    let covariance = sigmas(&chi, 1e-3);
    let free = near_prior(&robot, &chi, &covariance, &prior()).unwrap();
    let huge = Prior { ellipsoids: vec![Some(ellipsoid([0.0; 3], [1e3; 3])); 2], ..prior() };
    let bounded = near_prior(&robot, &chi, &covariance, &huge).unwrap();
    assert_eq!(bounded.bounds.iter().flatten().filter(|b| b.is_active).count(), 0);
    for (a, b) in bounded.standard.iter().zip(&free.standard) {
        assert!((a - b).abs() <= 1e-8 * b.abs(), "{a} {b}");
    }
    assert_eq!(bounded.from_data, free.from_data);
}

#[test]
fn bodies_stay_in_ellipsoids_that_the_data_alone_would_leave() {
    use rand::{RngExt, SeedableRng};
    let robot = arm();
    let mut random = rand_pcg::Pcg64::seed_from_u64(3);
    let mut active = 0;
    for _ in 0..40 {
        let mut number = |low: f64, high: f64| low + (high - low) * random.random::<f64>();
        let rods = [rod(number(3.0, 9.0), number(0.3, 0.9)), rod(number(1.0, 4.0), number(0.2, 0.9))];
        let chi = robot.base_from_standard(&standard(&robot, rods));
        // Thin and short ones: the rods of the truth and of the prior often stick out.
        let mut one = |length: f64| {
            let radii = [number(0.3, 0.8) * length, number(0.05, 0.3), number(0.05, 0.3)];
            Some(ellipsoid([0.5 * length, number(-0.05, 0.05), 0.0], radii))
        };
        let ellipsoids = vec![one(0.4), one(0.3)];
        let prior = Prior { ellipsoids: ellipsoids.clone(), ..prior() };
        let near = near_prior(&robot, &chi, &sigmas(&chi, 0.01), &prior).unwrap();
        for frame in 0..2 {
            assert!(is_body(&near, frame));
            let own: [f64; 10] = std::array::from_fn(|k| near.standard[14 * frame + k]);
            let (e, bound) = (ellipsoids[frame].unwrap(), near.bounds[frame].unwrap());
            assert!(bound.margin > -1e-9 && bound.is_active == (bound.margin < 1e-9), "{bound:?}");
            active += usize::from(bound.is_active);
            // Centre of mass, and mean of the squared distances in units of the radii.
            let [xx, yy, zz] = [own[0], own[3], own[5]];
            let second = [yy + zz - xx, xx + zz - yy, xx + yy - zz].map(|s| 0.5 * s / own[9]);
            let (mut centre, mut mean) = (0.0, 0.0);
            for k in 0..3 {
                let (c, at, square) = (e.centre[k], own[6 + k] / own[9], e.shape[k][k]);
                centre += (at - c).powi(2) / square;
                mean += (second[k] - 2.0 * c * at + c * c) / square;
            }
            assert!(centre < 1.0 && mean < 1.0 + 1e-9 && (1.0 - mean - bound.margin).abs() < 1e-9);
        }
        assert!(near.from_data.iter().all(|part| (0.0..=1.0).contains(part)));
    }
    assert!(active > 20, "{active} of 80 bounds held a body back");
}

#[test]
fn a_prior_outside_of_its_geometry_is_begun_within_and_told() {
    let robot = arm();
    let chi = robot.base_from_standard(&standard(&robot, [rod(6.0, 0.4), rod(3.0, 0.3)]));
    // The second rod's geometry is drawn on the other side of its joint.
    let ellipsoids = vec![None, Some(ellipsoid([-0.2, 0.0, 0.0], [0.2, 0.05, 0.05]))];
    let prior = Prior { ellipsoids, ..prior() };
    let near = near_prior(&robot, &chi, &sigmas(&chi, 0.01), &prior).unwrap();
    let bound = near.bounds[1].unwrap();
    assert!(bound.of_prior < -1.0 && bound.is_active && near.bounds[0].is_none(), "{bound:?}");
    assert!(near.least > 10.0 * near.determined as f64, "its first moment is data: {near:?}");
}

#[test]
fn an_ellipsoid_without_volume_is_refused() {
    let robot = arm();
    let chi = robot.base_from_standard(&standard(&robot, [rod(6.0, 0.4), rod(3.0, 0.3)]));
    let prior = Prior { ellipsoids: vec![Some(ellipsoid([0.0; 3], [1.0, 1.0, 0.0])), None], ..prior() };
    let found = near_prior(&robot, &chi, &sigmas(&chi, 0.01), &prior);
    assert_eq!(found, Err(NearPriorError::Ellipsoid(0)));
}

#[derive(serde::Deserialize)]
struct Reference {
    problems: Vec<ReferenceProblem>,
}

/// A problem of `runtime/tests/oracles/bounded_bodies.py`, and cvxpy's solution.
#[derive(serde::Deserialize)]
struct ReferenceProblem {
    links: usize,
    gamma: f64,
    base: Vec<Vec<(usize, f64)>>,
    chi: Vec<f64>,
    sigma: Vec<f64>,
    prior: Vec<[f64; 10]>,
    ellipsoids: Vec<Ellipsoid>,
    x: Vec<f64>,
    objective: f64,
    active: Vec<bool>,
}

impl ReferenceProblem {
    /// Links without rotors, friction or offsets but in name.
    fn robot(&self) -> Robot {
        let frames: Vec<Frame> = (0..self.links)
            .map(|k| Frame { parent: k.checked_sub(1), ..Frame::on_base(JointKind::Revolute) })
            .collect();
        let gear: Vec<f64> =
            (0..self.links * self.links).map(|k| f64::from(u8::from(k % (self.links + 1) == 0))).collect();
        let drive = Drive { gear: gear.into(), coupled_friction: vec![].into() };
        let mut robot =
            Robot::with_standard_as_base("random", [0.0, 0.0, -9.81], frames, drive, Limits::default());
        let mut base = robot.base[..self.base.len()].to_vec();
        for (b, combination) in base.iter_mut().zip(&self.base) {
            b.combination = combination.iter().map(|&(k, c)| (14 * (k / 10) + k % 10, c)).collect();
        }
        robot.base = base.into();
        robot
    }

    fn prior(&self) -> Prior {
        Prior {
            bodies: self.prior.iter().map(|body| Some(*body)).collect(),
            attached: vec![[0.0; 10]; self.links],
            rotors: vec![None; self.links],
            ellipsoids: self.ellipsoids.iter().map(|e| Some(*e)).collect(),
        }
    }
}

#[test]
fn bounded_bodies_are_those_of_an_independent_convex_solver() {
    let text = include_str!("../../../tests/oracles/bounded_bodies.json");
    let reference: Reference = serde_json::from_str(text).unwrap();
    let mut held = 0;
    for problem in &reference.problems {
        let (robot, prior) = (problem.robot(), problem.prior());
        let covariance = DMatrix::from_diagonal(&DVector::from_vec(problem.sigma.clone()).map(|s| s * s));
        let search = Search::new(&robot, &problem.chi, &covariance, &prior).unwrap();
        let mut x = search.start.clone();
        for decade in (0..5).rev() {
            x = search.minimum(problem.gamma * 10_f64.powi(decade), x).unwrap();
        }
        let (step, _) = search.newton(problem.gamma, &x).unwrap();
        let divergence: f64 = search.bodies.iter().map(|body| search.divergence(body, &x).unwrap()).sum();
        let (objective, wanted) = (0.5 * search.distance(&x) + problem.gamma * divergence, problem.objective);
        assert!((objective - wanted).abs() < 1e-6 * (1.0 + wanted), "{objective} {wanted}");
        // The solver's parameters are as good as the root of what it leaves of the objective.
        for (k, wanted) in problem.x.iter().enumerate() {
            let own = x[14 * (k / 10) + k % 10];
            assert!((own - wanted).abs() < 3e-4 * (1.0 + wanted.abs()), "{k}: {own} {wanted}");
        }
        let active: Vec<bool> = step.multipliers.iter().map(|m| *m > 0.0).collect();
        assert_eq!(active, problem.active);
        held += active.iter().filter(|a| **a).count();
    }
    assert!(held >= 20, "{held} bounds held a body back");
}
