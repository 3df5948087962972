//! Base parameters are complete and exact: against a small numeric engine that shares nothing with the generator.
#![allow(clippy::unwrap_used)]

mod numeric;

use dynid_codegen::base::{BaseSet, base_set};
use dynid_codegen::robot::{Drive, Expression, Frame, JointKind, Limits, Robot, parse};
use numeric::regressor;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use std::f64::consts::PI;
use std::path::{Path, PathBuf};

fn workspace() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

fn robot(name: &str) -> Robot {
    let path = workspace().join("robots").join(format!("{name}.yaml"));
    parse(name, &std::fs::read(path).unwrap()).unwrap()
}

const ROBOTS: [&str; 9] =
    ["branched", "cobot6", "panda", "planar_2r", "puma560", "scara4", "stanford", "tx40", "ur10e"];

/// Standard columns at enough random states for every rank to show.
fn observations(robot: &Robot, set: &BaseSet, random: &mut Pcg64) -> nalgebra::DMatrix<f64> {
    let n = robot.joint_frames().len();
    let states = 2 + 3 * set.standard.len() / n;
    let mut rows = nalgebra::DMatrix::zeros(states * n, set.standard.len());
    for s in 0..states {
        let mut draw = |size: f64| (0..n).map(|_| random.random_range(-size..size)).collect::<Vec<f64>>();
        let (q, dq, ddq) = (draw(PI), draw(2.0), draw(3.0));
        rows.rows_mut(s * n, n).copy_from(&regressor(robot, &q, &dq, &ddq));
    }
    rows
}

/// Numeric rank with columns scaled, and the gap: the smallest singular value that counts over the largest that does
/// not.
fn rank(matrix: &nalgebra::DMatrix<f64>) -> (usize, f64) {
    let norms: Vec<f64> = matrix.column_iter().map(|c| c.norm()).collect();
    let kept: Vec<usize> = (0..norms.len()).filter(|&k| norms[k] > 1e-10).collect();
    let scaled =
        nalgebra::DMatrix::from_fn(matrix.nrows(), kept.len(), |i, k| matrix[(i, kept[k])] / norms[kept[k]]);
    let triangle = scaled.qr().unpack_r();
    let mut singular: Vec<f64> = triangle.singular_values().iter().copied().collect();
    singular.sort_by(|a, b| b.total_cmp(a));
    let rank = singular.iter().filter(|&&s| s > 1e-10 * singular[0]).count();
    let below = singular.get(rank).copied().unwrap_or(1e-16).max(1e-16);
    (rank, singular[rank - 1] / below)
}

/// What makes a base set right; `Err` says what is wrong.
fn check(robot: &Robot, random: &mut Pcg64) -> Result<(), String> {
    let set = base_set(robot);
    let rows = observations(robot, &set, random);
    let (rank, gap) = rank(&rows);
    if set.base.len() != rank {
        return Err(format!("{} base parameters, numeric rank {rank} (gap {gap:.1e})", set.base.len()));
    }
    let chi_st = nalgebra::DVector::from_fn(set.standard.len(), |_, _| random.random_range(-1.0..1.0));
    let expected = &rows * &chi_st;
    let mut torque = nalgebra::DVector::zeros(rows.nrows());
    let mut largest = 1.0_f64;
    for parameter in &set.base {
        let chi: f64 = parameter.combination.iter().map(|&(k, c)| c * chi_st[k]).sum();
        largest = parameter.combination.iter().fold(largest, |m, &(_, c)| m.max(c.abs()));
        torque.axpy(chi, &rows.column(parameter.standard), 1.0);
    }
    let error = (torque - &expected).amax() / (expected.amax() + 1e-3);
    if error > 1e-9 {
        return Err(format!("torques differ by {error:.1e} (largest coefficient {largest:.1e})"));
    }
    Ok(())
}

#[test]
fn the_base_of_every_robot_has_the_numeric_rank_and_the_same_torques() {
    let mut random = Pcg64::seed_from_u64(7);
    for name in ROBOTS {
        check(&robot(name), &mut random).unwrap_or_else(|e| panic!("{name}: {e}"));
    }
}

#[test]
fn the_base_of_random_tables_has_the_numeric_rank_and_the_same_torques() {
    let mut random = Pcg64::seed_from_u64(20);
    let mut wrong = Vec::new();
    for trial in 0..600 {
        let robot = random_robot(&mut random);
        if let Err(e) = check(&robot, &mut random) {
            wrong.push(format!("table {trial}: {e}\n{}", table(&robot)));
        }
    }
    assert!(wrong.is_empty(), "{} of 600 wrong\n{}", wrong.len(), wrong[..wrong.len().min(3)].join("\n"));
}

fn table(robot: &Robot) -> String {
    let mut text = format!(
        "gravity {:?} gear {:?} {:?}\n",
        robot.gravity, robot.drive.gear, robot.drive.coupled_friction
    );
    for f in &robot.frames {
        text.push_str(&format!(
            "  {} parent {} {:?} gamma {} b {} alpha {} d {} theta {} r {}\n",
            f.j, f.parent, f.kind, f.gamma, f.b, f.alpha, f.d, f.theta, f.r
        ));
    }
    text
}

/// Up to eight axes: serial or tree, all kinds of joints, special and general angles and lengths, gravity along an
/// axis, none, or general, gears that couple joints.
fn random_robot(random: &mut Pcg64) -> Robot {
    let count = random.random_range(1..=9);
    let tree = random.random_bool(0.4);
    let general = random.random_bool(0.3);
    let mut frames = Vec::new();
    for j in 1..=count {
        let kind = match random.random_range(0..20) {
            0..12 => JointKind::Revolute,
            12..17 => JointKind::Prismatic,
            _ => JointKind::Fixed,
        };
        let branches = tree && random.random_bool(0.4);
        let parent = if branches { random.random_range(0..j) } else { j - 1 };
        let mut angle = || random_angle(random, general);
        let (alpha, theta, gamma) = (angle(), angle(), angle());
        let mut length = || random_length(random, general);
        let (d, r, b) = (length(), length(), length());
        let side = branches || random.random_bool(0.1);
        let off = Expression::ZERO;
        let (gamma, b) = if side { (gamma, b) } else { (off.clone(), off) };
        frames.push(Frame { j, parent, kind, gamma, b, alpha, d, theta, r });
    }
    if frames.iter().all(|f| f.kind == JointKind::Fixed)
        || frames.iter().filter(|f| f.kind != JointKind::Fixed).count() > 8
    {
        frames[0].kind = JointKind::Revolute;
        frames.truncate(8);
    }
    let gravity = match random.random_range(0..6) {
        0 => [0.0, 0.0, 0.0],
        1 => [0.0, -9.81, 0.0],
        2 => [9.81, 0.0, 0.0],
        3 => [0.0, -4.905, -8.4957],
        _ => [0.0, 0.0, -9.81],
    };
    let joints = frames.iter().filter(|f| f.kind != JointKind::Fixed).count();
    let drive = random_drive(random, joints);
    Robot {
        name: "random".to_owned(),
        description: String::new(),
        gravity,
        constants: Vec::new(),
        frames,
        drive,
        limits: Limits::default(),
        nominal: None,
    }
}

fn random_angle(random: &mut Pcg64, general: bool) -> Expression {
    let pi_over = |n: f64| Expression::Div(Box::new(Expression::Pi), Box::new(Expression::Number(n)));
    match random.random_range(0..if general { 12 } else { 8 }) {
        0..4 => Expression::ZERO,
        4 | 5 => pi_over(2.0),
        6 => pi_over(-2.0),
        7 => Expression::Pi,
        8 => pi_over(4.0),
        9 => pi_over(-3.0),
        10 => Expression::Number(0.7),
        _ => Expression::Number((random.random_range(-3.0..3.0) * 1000.0_f64).round() / 1000.0),
    }
}

fn random_length(random: &mut Pcg64, general: bool) -> Expression {
    match random.random_range(0..4) {
        0 | 1 => Expression::ZERO,
        2 if general => Expression::Number((random.random_range(-1.0..1.0) * 1000.0_f64).round() / 1000.0),
        2 => Expression::Number(0.5),
        _ => Expression::Constant("d3".to_owned(), 0.3),
    }
}

fn random_drive(random: &mut Pcg64, joints: usize) -> Drive {
    let mut drive = Drive::direct(joints);
    for (m, row) in drive.gear.iter_mut().enumerate() {
        row[m] = [10.0, 32.0, -48.0, 101.0][random.random_range(0..4)];
    }
    if joints > 1 && random.random_bool(0.4) {
        for _ in 0..random.random_range(1..=2) {
            let m = random.random_range(0..joints);
            let k = random.random_range(0..joints);
            if m > k {
                drive.gear[m][k] = [32.0, -5.0, 0.5][random.random_range(0..3)];
            }
        }
        if random.random_bool(0.3) {
            // A differential: both motors turn with the sum and the difference of two joints.
            let m = random.random_range(1..joints);
            for row in [m - 1, m] {
                drive.gear[row].fill(0.0);
                drive.gear[row][m - 1] = 20.0;
                drive.gear[row][m] = if row == m { -20.0 } else { 20.0 };
            }
        }
    }
    drive.coupled_friction = (0..joints).filter(|_| random.random_bool(0.3)).collect();
    drive
}
