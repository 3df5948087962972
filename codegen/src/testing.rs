//! Robots and base parameters for the tests of this crate.
#![allow(clippy::unwrap_used)]

use crate::base::BaseSet;
use crate::mechanics::Equations;
use crate::robot::{DriveTable, Expression, RobotTable, TableRow};
use crate::symbolic::Point;
use dynid_description::{BaseParameter, DependentFrame, JointKind, MAX_TERMS, ParameterKind};
use std::f64::consts::FRAC_PI_2;

/// A row of a table: sigma, alpha, d, theta, r, as in the reference file.
pub type Row = (u8, f64, f64, f64, f64);

/// A serial robot.
pub fn serial(name: &str, gravity: [f64; 3], rows: &[Row]) -> RobotTable {
    let number = |x: f64| Expression::Number(x);
    let frames: Vec<TableRow> = rows
        .iter()
        .enumerate()
        .map(|(k, &(sigma, alpha, d, theta, r))| TableRow {
            j: k + 1,
            parent: k,
            kind: [JointKind::Revolute, JointKind::Prismatic, JointKind::Fixed][usize::from(sigma)],
            gamma: number(0.0),
            b: number(0.0),
            alpha: number(alpha),
            d: number(d),
            theta: number(theta),
            r: number(r),
        })
        .collect();
    let n = frames.iter().filter(|f| f.kind != JointKind::Fixed).count();
    let gear = (0..n).map(|i| (0..n).map(|j| if i == j { 1.0 } else { 0.0 }).collect()).collect();
    RobotTable::of_frames(name, gravity, frames, DriveTable { gear, coupled_friction: Vec::new() })
}

/// Makes frames move with several joints, and several frames with one: some keep a variable of their own beside others, some
/// move with those of others only. `pick(n)` draws from 0 to n - 1. At least one joint stays.
pub fn make_dependent(robot: &mut RobotTable, mut pick: impl FnMut(usize) -> usize) {
    let kinds: Vec<JointKind> = robot.frames.iter().map(|f| f.kind).collect();
    for (frame, &kind) in robot.frames.iter_mut().zip(&kinds).skip(1) {
        if kind != JointKind::Fixed && pick(4) == 0 {
            frame.kind = JointKind::Fixed;
        }
    }
    let owners = robot.joint_frames();
    let mut dependent = Vec::new();
    for (k, &kind) in kinds.iter().enumerate() {
        let own = owners.iter().position(|&f| f == k);
        if kind == JointKind::Fixed || own.is_some() && pick(3) > 0 {
            continue;
        }
        let mut terms: Vec<(usize, f64)> = Vec::new();
        let allowed =
            |joint: usize| kind == JointKind::Prismatic || kinds[owners[joint]] == JointKind::Revolute;
        for joint in 0..owners.len() {
            let whole = [1.0, -1.0, 1.0, -1.0, 2.0][pick(5)];
            let taken = Some(joint) == own || pick(2) == 0;
            if taken && allowed(joint) && terms.len() < MAX_TERMS {
                let length = [1.0, -1.0, 0.35, -0.2][pick(4)];
                terms.push((joint, if kind == JointKind::Revolute { whole } else { length }));
            }
        }
        if !terms.is_empty() && own.is_none_or(|own| terms.iter().any(|t| t.0 == own)) {
            dependent.push(DependentFrame { frame: k, kind, terms: terms.into() });
        }
    }
    robot.dependent = dependent;
    robot.drive = DriveTable::direct(owners.len());
}

pub fn planar_2r() -> RobotTable {
    serial("planar_2r", [0.0, -9.81, 0.0], &[(0, 0.0, 0.0, 0.0, 0.0), (0, 0.0, 0.5, 0.0, 0.0)])
}

/// Table I without the payload frame, with the coupling of axes 5 and 6.
pub fn tx40() -> RobotTable {
    let h = FRAC_PI_2;
    let mut robot = serial(
        "tx40",
        [0.0, 0.0, -9.81],
        &[
            (0, 0.0, 0.0, 0.0, 0.0),
            (0, -h, 0.0, -h, 0.0),
            (0, 0.0, 0.225, h, 0.035),
            (0, h, 0.0, 0.0, 0.225),
            (0, -h, 0.0, 0.0, 0.0),
            (0, h, 0.0, 0.0, 0.0),
        ],
    );
    for (m, ratio) in [32.0, 32.0, 45.0, 48.0, 45.0, 32.0].into_iter().enumerate() {
        robot.drive.gear[m][m] = ratio;
    }
    robot.drive.gear[5][4] = 32.0;
    robot.drive.coupled_friction = vec![5];
    robot
}

/// chi_st of a robot, all of it kept.
pub fn all_parameters(robot: &RobotTable) -> BaseSet {
    let standard = robot.standard_parameters();
    let base = (0..standard.len())
        .map(|k| BaseParameter {
            name: standard[k].name.clone(),
            standard: k,
            combination: vec![(k, 1.0)].into(),
            relation: standard[k].name.clone(),
            unit: "".into(),
        })
        .collect();
    BaseSet { standard, base }
}

/// Base parameters by the numeric rank of the regressor: what depends on kept columns is left out, YY, MZ, M and Ia
/// being judged last. The regrouping relations are not worked out.
pub fn numeric_base(robot: &RobotTable) -> BaseSet {
    let mut set = all_parameters(robot);
    let equations = Equations::derive(robot, &set).unwrap();
    let n = equations.idm.len();
    let mut random = Random(7);
    let mut rows: Vec<Vec<f64>> = Vec::new();
    for _ in 0..3 * set.standard.len() / n {
        let point = random.point(n);
        rows.extend(equations.idm.iter().map(|row| equations.graph.evaluate(row, &point)));
    }
    let mut order: Vec<usize> = (0..set.standard.len()).collect();
    let late = |k: &usize| match set.standard[*k].kind {
        ParameterKind::MZ => 1,
        ParameterKind::YY => 2,
        ParameterKind::M => 3,
        ParameterKind::Ia => 4,
        _ => 0,
    };
    order.sort_by_key(late);
    let mut orthogonal: Vec<Vec<f64>> = Vec::new();
    let mut kept = Vec::new();
    for k in order {
        let mut column: Vec<f64> = rows.iter().map(|row| row[k]).collect();
        let size = column.iter().map(|x| x * x).sum::<f64>().sqrt();
        for _ in 0..2 {
            for q in &orthogonal {
                let along: f64 = q.iter().zip(&column).map(|(a, b)| a * b).sum();
                column.iter_mut().zip(q).for_each(|(c, q)| *c -= along * q);
            }
        }
        let rest = column.iter().map(|x| x * x).sum::<f64>().sqrt();
        if rest > 1e-9 * size.max(1.0) {
            orthogonal.push(column.iter().map(|x| x / rest).collect());
            kept.push(k);
        }
    }
    kept.sort_unstable();
    set.base = kept.into_iter().map(|k| set.base[k].clone()).collect();
    set
}

/// A small linear congruential generator, so that tests need no crate and never change.
pub struct Random(pub u64);

impl Random {
    /// Uniform in [-1, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 11) as f64 / (1_u64 << 52) as f64 - 1.0
    }

    pub fn point(&mut self, n: usize) -> Point {
        let mut values = |scale: f64| (0..n).map(|_| scale * self.unit()).collect();
        Point { q: values(3.0), dq: values(3.0), ddq: values(8.0), chi: Vec::new() }
    }
}
