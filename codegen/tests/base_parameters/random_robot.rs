//! Random tables, and what makes them harder.

use dynid_codegen::robot::{DriveTable, Expression, RobotTable, TableRow};
use dynid_description::{Coupling, CouplingLaw, DependentFrame, JointKind};
use rand::RngExt;
use rand_pcg::Pcg64;
use std::borrow::Cow;

/// Up to four combinations with friction, and up to two springs, whose stiffnesses are always independent.
pub fn add_couplings(robot: &mut RobotTable, random: &mut Pcg64) {
    let joints = robot.joint_frames().len();
    let mut terms = |least: usize| -> Cow<'static, [(usize, f64)]> {
        loop {
            let mut chosen = Vec::new();
            for joint in 0..joints {
                if random.random_bool(0.5) {
                    chosen.push((joint, [1.0, -1.0, 1.0, -1.0, 0.35, -2.0][random.random_range(0..6)]));
                }
            }
            if chosen.len() >= least.min(joints) {
                return chosen.into();
            }
        }
    };
    let counts = (terms(0).len() % 5, terms(0).len() % 3);
    for k in 0..counts.0 {
        robot.couplings.push(Coupling {
            name: format!("_f{k}").into(),
            terms: terms(2),
            law: CouplingLaw::Friction,
        });
    }
    let mut before: Option<Vec<(usize, f64)>> = None;
    for k in 0..counts.1 {
        let law = [CouplingLaw::Spring, CouplingLaw::SpringAt(0.3)][terms(0).len() % 2];
        let terms = terms(1);
        let scaled: Vec<(usize, f64)> = terms.iter().map(|&(j, c)| (j, c / terms[0].1)).collect();
        if before.as_ref() != Some(&scaled) {
            robot.couplings.push(Coupling { name: format!("_s{k}").into(), terms, law });
        }
        before = Some(scaled);
    }
}

/// Makes frames move with several joints, and several frames with one. The gear stays where no joint is lost.
pub fn make_dependent(robot: &mut RobotTable, random: &mut Pcg64) {
    let kinds: Vec<JointKind> = robot.frames.iter().map(|f| f.kind).collect();
    for (frame, &kind) in robot.frames.iter_mut().zip(&kinds).skip(1) {
        if kind != JointKind::Fixed && random.random_bool(0.25) {
            frame.kind = JointKind::Fixed;
        }
    }
    let mut owners = robot.joint_frames();
    if owners.is_empty() {
        robot.frames[0].kind = JointKind::Revolute;
        owners = vec![0];
    }
    if owners.len() != robot.drive.gear.len() {
        robot.drive = random_drive(random, owners.len());
    }
    for (k, &kind) in kinds.iter().enumerate() {
        let own = owners.iter().position(|&f| f == k);
        if kind == JointKind::Fixed || own.is_some() && random.random_bool(0.6) {
            continue;
        }
        let mut terms: Vec<(usize, f64)> = Vec::new();
        for (joint, &owner) in owners.iter().enumerate() {
            let allowed = kind == JointKind::Prismatic || robot.frames[owner].kind == JointKind::Revolute;
            if allowed && terms.len() < 4 && (Some(joint) == own || random.random_bool(0.5)) {
                let whole = [1.0, -1.0, 1.0, -1.0, 2.0][random.random_range(0..5)];
                let length = [1.0, -1.0, 0.35, -0.2][random.random_range(0..4)];
                terms.push((joint, if kind == JointKind::Revolute { whole } else { length }));
            }
        }
        if !terms.is_empty() && own.is_none_or(|own| terms.iter().any(|t| t.0 == own)) {
            robot.dependent.push(DependentFrame { frame: k, kind, terms: terms.into() });
        }
    }
}

pub fn table(robot: &RobotTable) -> String {
    let mut text = format!(
        "gravity {:?} gear {:?} {:?} {:?} {:?} known {:?} {:?}\n",
        robot.gravity,
        robot.drive.gear,
        robot.drive.coupled_friction,
        robot.dependent,
        robot.couplings,
        robot.known,
        robot.fixed
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
pub fn random_robot(random: &mut Pcg64) -> RobotTable {
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
        frames.push(TableRow { j, parent, kind, gamma, b, alpha, d, theta, r });
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
    RobotTable::of_frames("random", gravity, frames, drive)
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

fn random_drive(random: &mut Pcg64, joints: usize) -> DriveTable {
    let mut drive = DriveTable::direct(joints);
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
