//! Springs between two points: torques are those of MuJoCo's spatial tendons (`benches/peers/between_reference.py`) and of
//! differences of their energy, by the closed form and by the recursive engine; which of their constants torques tell; and
//! what a recording says of them.
#![allow(clippy::unwrap_used)]

mod common;

use common::{Hidden, SimulatedRobot};
use dynid_codegen::base::{BaseSet, base_set};
use dynid_codegen::mechanics::Equations;
use dynid_codegen::numeric_robot;
use dynid_codegen::robot::{RobotTable, parse};
use dynid_codegen::symbolic::Point;
use dynid_runtime::diagnosis::{Settings, Silent, diagnose};
use dynid_runtime::model::{
    BaseParameter, Between, Frame, JointKind, Model, Motion, RecursiveModel, Robot, StateSlices, torques,
    torques_at,
};
use dynid_runtime::model_file::{fingerprint, to_yaml};
use nalgebra::{DMatrix, Isometry3, Point3, Translation3, UnitQuaternion, Vector3};

fn cases() -> Vec<serde_json::Value> {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/between.json");
    serde_json::from_str(&std::fs::read_to_string(path).unwrap()).unwrap()
}

fn read(yaml: &str) -> (RobotTable, BaseSet, RecursiveModel) {
    let table = parse("table.yaml", yaml.as_bytes()).unwrap_or_else(|m| panic!("{m:?}\n{yaml}"));
    let set = base_set(&table);
    let model = RecursiveModel::new(numeric_robot(&table, &set)).unwrap();
    (table, set, model)
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64, what: &str) {
    assert_eq!(found.len(), expected.len());
    let largest = expected.iter().fold(1.0_f64, |most, x| most.max(x.abs()));
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() < tolerance * largest, "{what}: {found} and {expected}");
    }
}

#[test]
fn torques_are_those_of_spatial_tendons_in_mujoco() {
    let cases = cases();
    assert_eq!(cases.len(), 16);
    for (number, case) in cases.iter().enumerate() {
        let yaml = case["yaml"].as_str().unwrap();
        let what = format!("table {number}\n{yaml}");
        let (table, set, model) = read(yaml);
        let equations = Equations::derive(&table, &set).unwrap();
        let chi = model.robot().base_from_standard(&model.robot().nominal.as_ref().unwrap().standard);
        let states: Vec<[Vec<f64>; 3]> = serde_json::from_value(case["states"].clone()).unwrap();
        let expected: Vec<Vec<f64>> = serde_json::from_value(case["torques"].clone()).unwrap();
        for ([q, dq, ddq], expected) in states.into_iter().zip(&expected) {
            assert_close(&torques_at(&model, &chi, &q, &dq, &ddq), expected, 1e-12, &what);
            let point = Point { q, dq, ddq, chi: chi.clone() };
            let graph = &equations.torque.graph;
            assert_close(&graph.evaluate(&equations.torque.torques, &point), expected, 1e-12, &what);
            let rows = equations.idm.iter().map(|row| equations.graph.evaluate(row, &point));
            let product = |row: Vec<f64>| row.iter().zip(&chi).map(|(w, chi)| w * chi).sum();
            assert_close(&rows.map(product).collect::<Vec<f64>>(), expected, 1e-12, &what);
            same_as_recursive(&equations, &model, &point, &what);
        }
    }
}

/// h, dh and M, N of the closed form and of the recursive engine; dh is the rate of h.
fn same_as_recursive(equations: &Equations, model: &RecursiveModel, point: &Point, what: &str) {
    let (n, columns) = (point.q.len(), point.chi.len());
    let (mut h, mut dh) = (vec![0.0; columns], vec![0.0; columns]);
    model.energy(&point.q, &point.dq, &mut h);
    model.power(&point.q, &point.dq, &point.ddq, &mut dh);
    assert_close(&h, &equations.graph.evaluate(&equations.energy, point), 1e-12, what);
    assert_close(&dh, &equations.graph.evaluate(&equations.power, point), 1e-12, what);
    let (mut mass, mut bias) = (vec![0.0; n * n], vec![0.0; n]);
    model.mass_and_bias(&point.chi, &point.q, &point.dq, &mut mass, &mut bias);
    assert_close(&bias, &equations.graph.evaluate(&equations.bias, point), 1e-12, what);
    let mut springs = 0;
    for (k, base) in model.robot().base.iter().enumerate() {
        if model.robot().standard[base.standard].kind.is_spring() {
            let mut derived = equations.clone();
            let rate = derived.graph.time_derivative(equations.energy[k]);
            assert_close(&derived.graph.evaluate(&[rate], point), &[dh[k]], 1e-12, what);
            springs += 1;
        }
    }
    assert!(springs > 0, "{what}");
    // Four lanes at a time, and joint by joint.
    let samples = |x: &[f64]| x.iter().map(|&x| vec![x; 5]).collect::<Vec<_>>();
    let (q, dq, ddq) = (samples(&point.q), samples(&point.dq), samples(&point.ddq));
    let block = torques(model, &point.chi, StateSlices::new(&q, &dq, &ddq).states());
    let one = torques_at(model, &point.chi, &point.q, &point.dq, &point.ddq);
    let last: Vec<f64> = block.iter().map(|joint| joint[4]).collect();
    assert_close(&last, &one, 1e-12, what);
}

/// A branched table: points on two branches, on a frame that moves with two joints, on a slide and on the base.
const TREE: &str = "
name: tree
gravity: [0.3, -9.7, 1.1]
frames:
  - {j: 1, parent: 0, sigma: 0, alpha: 0.3, d: 0.1, theta: q1 + 0.2, r: 0.4}
  - {j: 2, parent: 1, sigma: 0, alpha: -pi/2, d: 0.3, theta: q2, r: 0.1}
  - {j: 3, parent: 2, sigma: 1, alpha: 0.7, d: 0.2, theta: 0.3, r: q3 + 0.1}
  - {j: 4, parent: 1, sigma: 0, gamma: 0.4, b: 0.2, alpha: 1.2, d: 0.25, theta: q4, r: 0.2}
  - {j: 5, parent: 4, sigma: 0, alpha: 0, d: 0.3, theta: q2 - q4 + 0.5, r: 0}
springs:
  - {between: [{frame: 0, point: [0.1, 0.6, -0.2]}, {frame: 3, point: [0.2, 0, 0.3]}], name: far}
  - {between: [{frame: 2, point: [0.3, 0.1, 0]}, {frame: 5, point: [0.1, -0.2, 0.2]}], name: across, rest: 0.15}
  - {between: [{frame: 4, point: [0, 0.2, 0.1]}, {frame: 1, point: [0.4, 0, 0.3]}], name: near}
  - {joint: 1}
";

/// Where a point of a frame is, by products of transformations.
fn place(robot: &Robot, motions: &[Motion], frame: Option<usize>, point: [f64; 3], q: &[f64]) -> Point3<f64> {
    let Some(k) = frame else { return point.into() };
    let Frame { gamma, b, alpha, d, theta, r, parent, .. } = robot.frames[k];
    let moved: f64 = motions[k].terms.iter().map(|&(joint, c)| c * q[joint]).sum();
    let (turned, shifted) = match motions[k].kind {
        JointKind::Revolute => (moved, 0.0),
        JointKind::Prismatic => (0.0, moved),
        JointKind::Fixed => (0.0, 0.0),
    };
    let along = |x: f64, z: f64| Translation3::new(x, 0.0, z);
    let about = |axis: Vector3<f64>, angle: f64| UnitQuaternion::new(axis * angle);
    let pose: Isometry3<f64> = (along(0.0, b) * about(Vector3::z(), gamma))
        * (about(Vector3::x(), alpha) * along(d, 0.0))
        * (about(Vector3::z(), theta + turned) * along(0.0, r + shifted));
    place(robot, motions, parent, (pose * Point3::from(point)).coords.into(), q)
}

/// Energies of all parameters of springs between points.
fn energies(robot: &Robot, q: &[f64]) -> Vec<(usize, f64)> {
    let motions = robot.motions();
    let of = |(k, p): (usize, &dynid_runtime::model::StandardParameter)| {
        let Between { frames, points, rest } = robot.couplings[p.coupling?].law.between()?;
        let [a, b] = [0, 1].map(|end| place(robot, &motions, frames[end], points[end], q));
        let length = (a - b).norm();
        let is_stiffness = p.name.starts_with("K_");
        Some((k, if is_stiffness { 0.5 * length * length - rest.unwrap_or(0.0) * length } else { -length }))
    };
    robot.standard.iter().enumerate().filter_map(of).collect()
}

fn states(n: usize, count: usize) -> Vec<[Vec<f64>; 3]> {
    let mut x = 5_u64;
    let mut next = || {
        x = x.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        3.0 * ((x >> 11) as f64 / (1_u64 << 53) as f64 - 0.5)
    };
    (0..count).map(|_| [0, 1, 2].map(|_| (0..n).map(|_| next()).collect())).collect()
}

/// The robot with every standard parameter as a base parameter.
fn as_standard(robot: &Robot) -> RecursiveModel {
    let base: Vec<BaseParameter> = robot
        .standard
        .iter()
        .enumerate()
        .map(|(k, p)| BaseParameter {
            name: p.name.clone(),
            standard: k,
            combination: vec![(k, 1.0)].into(),
            relation: p.name.clone(),
            unit: "".into(),
        })
        .collect();
    RecursiveModel::new(Robot { base: base.into(), ..robot.clone() }).unwrap()
}

#[test]
fn columns_are_the_slopes_of_energies_that_know_only_where_the_points_are() {
    let (table, set, model) = read(TREE);
    let equations = Equations::derive(&table, &set).unwrap();
    let robot = as_standard(model.robot());
    let n = robot.robot().joints();
    for [q, dq, ddq] in states(n, 12) {
        let zeros = vec![0.0; robot.robot().standard.len()];
        let mut h = zeros.clone();
        robot.energy(&q, &dq, &mut h);
        for (k, energy) in energies(robot.robot(), &q) {
            let mut unit = zeros.clone();
            unit[k] = 1.0;
            let name = &robot.robot().standard[k].name;
            assert_close(&[h[k]], &[energy], 1e-12, name);
            let slope = |joint: usize| {
                let step = 1e-6;
                let at = |by: f64| {
                    let mut moved = q.clone();
                    moved[joint] += by;
                    energies(robot.robot(), &moved).iter().find(|e| e.0 == k).unwrap().1
                };
                (at(step) - at(-step)) / (2.0 * step)
            };
            let slopes: Vec<f64> = (0..n).map(slope).collect();
            assert_close(&torques_at(&robot, &unit, &q, &dq, &ddq), &slopes, 1e-8, name);
        }
        // In base parameters the closed form says the same as the recursive engine.
        let chi: Vec<f64> = (0..set.base.len()).map(|k| 0.3 + 0.1 * k as f64).collect();
        let point = Point { q, dq, ddq, chi };
        same_as_recursive(&equations, &model, &point, "tree");
        let expected = torques_at(&model, &point.chi, &point.q, &point.dq, &point.ddq);
        assert_close(
            &equations.torque.graph.evaluate(&equations.torque.torques, &point),
            &expected,
            1e-12,
            "tree",
        );
    }
    let units: Vec<(&str, &str)> =
        set.base.iter().map(|b| (&*b.name, &*b.unit)).filter(|b| b.0.starts_with('K')).collect();
    assert!(units.contains(&("KR_far", "N")) && units.contains(&("K_across", "N/m")), "{units:?}");
}

/// Rank of the regressor of all standard parameters.
fn rank(robot: &Robot) -> usize {
    let model = as_standard(robot);
    let (n, columns) = (robot.joints(), robot.standard.len());
    let states = states(n, 3 * columns);
    let mut rows = DMatrix::zeros(n * states.len(), columns);
    for k in 0..columns {
        let mut unit = vec![0.0; columns];
        unit[k] = 1.0;
        for (s, [q, dq, ddq]) in states.iter().enumerate() {
            rows.view_mut((s * n, k), (n, 1)).copy_from_slice(&torques_at(&model, &unit, q, dq, ddq));
        }
    }
    // Columns of what has no effect are rounding.
    let largest = rows.column_iter().map(|c| c.norm()).fold(0.0, f64::max);
    for mut column in rows.column_iter_mut() {
        let norm = column.norm();
        column.scale_mut(if norm > 1e-10 * largest { 1.0 / norm } else { 0.0 });
    }
    let values = rows.svd(false, false).singular_values;
    values.iter().filter(|&&s| s > 1e-9 * values.max()).count()
}

#[test]
fn base_parameters_are_as_many_as_torques_tell() {
    let mut all: Vec<String> = cases().iter().map(|case| case["yaml"].as_str().unwrap().to_owned()).collect();
    all.push(TREE.to_owned());
    all.push(TREE.replace("springs:", "massless: [3]\nknown: {Ia2: 0.2, KR_far: 12, off1: 0}\nsprings:"));
    for yaml in all {
        let (_, set, model) = read(&yaml);
        let robot = model.robot();
        let zero = robot.known.len();
        let mut free = robot.clone();
        free.known = Vec::new().into();
        if zero == 0 {
            assert_eq!(set.base.len(), rank(&free), "{yaml}");
        } else {
            let known: Vec<(&str, f64)> =
                robot.fixed_base().into_iter().map(|(k, value)| (&*robot.base[k].name, value)).collect();
            assert_eq!(known, [("KR_far", 12.0)]);
        }
        // Whatever was regrouped, torques of standard parameters are those of base parameters.
        let standard: Vec<f64> = (0..robot.standard.len())
            .map(|k| if robot.known.contains(&k) { 0.0 } else { 0.5 + 0.07 * k as f64 })
            .collect();
        let (whole, chi) = (as_standard(robot), robot.base_from_standard(&standard));
        for [q, dq, ddq] in states(robot.joints(), 3) {
            let expected = torques_at(&whole, &standard, &q, &dq, &ddq);
            assert_close(&torques_at(&model, &chi, &q, &dq, &ddq), &expected, 1e-10, &yaml);
        }
    }
}

#[test]
fn of_a_spring_that_balances_gravity_the_stiffness_is_part_of_first_moments() {
    // A spring of no free length between a point above the axis and one on the link: l^2 / 2 is the height of that point.
    let yaml = "
name: balanced
gravity: [-9.81, 0, 0]
frames:
  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}
springs:
  - {between: [{frame: 0, point: [0.4, 0, 0]}, {frame: 1, point: [0.5, 0, 0]}], rest: 0, name: balancer}
";
    let (_, set, model) = read(yaml);
    let relation =
        |of: &str| set.base.iter().find(|b| b.relation.contains(of)).map(|b| b.relation.to_string());
    let with = relation("K_balancer").unwrap();
    assert!(with.starts_with("MX1 - ") && set.base.len() == rank(model.robot()), "{with}");
    // K a b = m g: 0.4 * 0.5 / 9.81.
    let combination = &set.base.iter().find(|b| *b.relation == *with).unwrap().combination;
    assert!((combination.last().unwrap().1 + 0.4 * 0.5 / 9.81).abs() < 1e-12, "{combination:?}");
    let free = yaml.replace("rest: 0, ", "");
    let (_, set, model) = read(&free);
    assert!(set.base.iter().any(|b| &*b.relation == "KR_balancer") && set.base.len() == rank(model.robot()));
}

#[test]
fn a_constant_force_is_a_spring_whose_stiffness_is_known_to_be_zero() {
    let (_, set, model) = read(&TREE.replace("springs:", "known: {K_far: 0}\nsprings:"));
    let names: Vec<&str> = set.base.iter().map(|b| &*b.name).collect();
    assert!(names.contains(&"KR_far") && !set.base.iter().any(|b| b.relation.contains("K_far")), "{names:?}");
    let k = names.iter().position(|name| *name == "KR_far").unwrap();
    let mut chi = vec![0.0; set.base.len()];
    chi[k] = -25.0;
    // Its power is its force times the speed of its length, wherever it is.
    for [q, dq, ddq] in states(model.robot().joints(), 6) {
        let torque = torques_at(&model, &chi, &q, &dq, &ddq);
        let power: f64 = torque.iter().zip(&dq).map(|(torque, dq)| torque * dq).sum();
        let length = |t: f64| {
            let moved: Vec<f64> = q.iter().zip(&dq).map(|(q, dq)| q + t * dq).collect();
            let standard = model.robot().standard.iter().position(|p| p.name == "KR_far").unwrap();
            -energies(model.robot(), &moved).iter().find(|e| e.0 == standard).unwrap().1
        };
        let speed = (length(1e-6) - length(-1e-6)) / 2e-6;
        assert_close(&[power], &[25.0 * speed], 1e-8, "constant force");
    }
}

#[test]
fn the_table_of_a_model_says_what_its_yaml_said() {
    let (_, _, model) = read(TREE);
    let robot = model.robot();
    let (_, _, again) = read(&to_yaml(robot));
    assert_eq!(again.robot().couplings, robot.couplings);
    assert_eq!(fingerprint(again.robot()), fingerprint(robot));
    let (_, _, other) = read(&TREE.replace("0.2, 0, 0.3", "0.2, 0, 0.31"));
    assert_ne!(fingerprint(other.robot()), fingerprint(robot));
    let json = serde_json::to_string(robot).unwrap();
    assert_eq!(serde_json::from_str::<Robot>(&json).unwrap().couplings, robot.couplings);
}

#[test]
fn where_the_points_meet_the_force_counts_as_none_and_every_number_is_finite() {
    let yaml = "
name: meeting
frames:
  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}
  - {j: 2, sigma: 1, alpha: pi/2, d: 0, theta: 0, r: q2}
springs:
  - {between: [{frame: 0, point: [0.3, 0, 0]}, {frame: 2, point: [0.3, 0, 0]}], name: s}
";
    let (table, set, model) = read(yaml);
    let equations = Equations::derive(&table, &set).unwrap();
    let chi = vec![1.0; set.base.len()];
    let zeros = vec![0.0; 2];
    let torque = torques_at(&model, &chi, &zeros, &zeros, &zeros);
    assert!(torque.iter().all(|x| x.is_finite()), "{torque:?}");
    let point = Point { q: zeros.clone(), dq: zeros.clone(), ddq: zeros, chi };
    let outputs = [equations.energy.clone(), equations.power.clone(), equations.idm.concat()].concat();
    assert!(equations.graph.evaluate(&outputs, &point).iter().all(|x| x.is_finite()));
    let k = model.robot().base.iter().position(|b| b.name == "KR_s").unwrap();
    assert!(equations.idm.iter().all(|row| equations.graph.evaluate(&[row[k]], &point)[0] == 0.0));
}

#[test]
fn what_torques_would_not_tell_is_refused_at_its_place() {
    let with = |springs: &str| {
        let text = format!(
            "name: arm\nframes:\n  - {{j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}}\n  \
             - {{j: 2, sigma: 1, alpha: pi/2, d: 0, theta: 0, r: q2}}\nsprings:\n{springs}"
        );
        let found = parse("arm.yaml", text.as_bytes()).expect_err("it is refused");
        assert_eq!(found.len(), 1, "{found:?}");
        found[0].to_string()
    };
    let cases = [
        (
            "  - {between: [{frame: 0, point: [0, 0, 1]}, {frame: 1, point: [0, 0, 0.2]}]}\n",
            "no joint changes",
        ),
        (
            "  - {between: [{frame: 1, point: [0, 0, 1]}, {frame: 1, point: [0.3, 0, 0.2]}]}\n",
            "no joint changes",
        ),
        (
            "  - {between: [{frame: 1, point: [0, 0, 0]}, {frame: 2, point: [0, 0, 0.2]}]}\n",
            "linear in the position",
        ),
        (
            "  - {between: [{frame: 0, point: [0, 0, 0]}, {frame: 7, point: [0, 0, 0.2]}]}\n",
            "there is no frame 7",
        ),
        ("  - {between: [{frame: 0, point: [0, 0, 0]}]}\n", "expected two points"),
        ("  - {between: [{frame: 0, point: [1, 0]}, {frame: 2, point: [0, 0, 0.2]}]}\n", "point"),
        (
            "  - {joint: 1, between: [{frame: 0, point: [1, 0, 0]}, {frame: 2, point: [0, 0, 0.2]}]}\n",
            "expected a spring",
        ),
        (
            "  - {between: [{frame: 0, point: [1, 0, 0]}, {frame: 1, point: [0, 1, 0]}]}\n  \
             - {between: [{frame: 1, point: [0, 2, 0]}, {frame: 0, point: [2, 0, 0]}], name: b}\n",
            "the distance of another spring",
        ),
    ];
    for (springs, words) in cases {
        let message = with(springs);
        assert!(
            message.contains(words)
                && (message.starts_with("arm.yaml:6:") || message.starts_with("arm.yaml:7:")),
            "{message}"
        );
    }
}

/// The planar arm with a coil spring from the base to its forearm and a gas spring under its upper arm.
fn sprung() -> SimulatedRobot {
    common::planar_with(
        "springs:\n  - {between: [{frame: 0, point: [0.2, 0.5, 0]}, {frame: 2, point: [0.15, 0, 0]}], name: coil}\n  \
         - {between: [{frame: 0, point: [0, -0.35, 0]}, {frame: 1, point: [0.25, -0.05, 0]}], name: gas}",
        "K_coil: 60, KR_coil: 18, K_gas: 35, KR_gas: 90,",
    )
}

#[test]
fn constants_of_a_coil_and_of_a_gas_spring_are_identified_and_no_spring_is_found_missing() {
    let robot = sprung();
    let recording = robot.record(&robot.motions(3, 4.5, 1), &Hidden::nothing(), 1);
    let mut settings = Settings::default();
    settings.threads = 1;
    let found = diagnose(&robot.model, &recording, &[], &settings, &Silent).unwrap();
    let named: Vec<&str> = found.findings.iter().map(|f| f.effect.as_str()).collect();
    assert!(named.is_empty(), "{named:?}");
    let (base, truth) = (&robot.model.robot().base, robot.model.robot().base_from_standard(&robot.standard));
    let mut springs = 0;
    for (k, base) in base.iter().enumerate() {
        let (value, sigma) = (found.model.chi[k], found.model.sigma[k]);
        if base.relation.contains("K_") || base.relation.contains("KR_") {
            println!("{} = {}: {value:.4} ± {sigma:.4}, {:.4}", base.name, base.relation, truth[k]);
            springs += 1;
        }
        assert!((value - truth[k]).abs() < 5.0 * sigma, "{}: {value} ± {sigma}, {}", base.name, truth[k]);
    }
    assert!(springs >= 4, "{springs}");
}
