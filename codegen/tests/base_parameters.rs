//! Base parameters are complete and exact: against a small numeric engine that shares nothing with the generator.
#![allow(clippy::unwrap_used)]

mod numeric;
mod shipped;

use dynid_codegen::base::{BaseSet, base_set};
use dynid_codegen::robot::{DriveTable, Expression, RobotTable, TableRow, parse};
use dynid_description::{
    BaseParameter, Coupling, CouplingLaw, DependentFrame, JointKind, Limits, ParameterKind,
};
use numeric::regressor;
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;
use shipped::{robots, workspace};
use std::borrow::Cow;
use std::f64::consts::PI;

fn robot(name: &str) -> RobotTable {
    robots().into_iter().find(|robot| robot.name == name).unwrap()
}

/// Standard columns at enough random states for every rank to show.
fn observations(robot: &RobotTable, set: &BaseSet, random: &mut Pcg64) -> nalgebra::DMatrix<f64> {
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
fn check(robot: &RobotTable, random: &mut Pcg64) -> Result<(), String> {
    let set = base_set(robot);
    let rows = observations(robot, &set, random);
    // What is known to be 0 is no column.
    let mut rows = rows;
    robot.known.iter().for_each(|&k| rows.column_mut(k).fill(0.0));
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
fn the_base_of_every_robot_has_the_numeric_rank_and_the_same_torques_under_any_gravity() {
    let mut random = Pcg64::seed_from_u64(7);
    for mut robot in robots() {
        let name = robot.name.clone();
        for gravity in
            [robot.gravity, [0.0; 3], [9.81, 0.0, 0.0], [0.0, 9.81, 0.0], [0.0, 0.0, 9.81], [1.0, 2.0, 3.0]]
        {
            robot.gravity = gravity;
            check(&robot, &mut random).unwrap_or_else(|e| panic!("{name} in {gravity:?}: {e}"));
        }
    }
}

#[test]
fn the_base_of_random_tables_has_the_numeric_rank_and_the_same_torques() {
    let mut random = Pcg64::seed_from_u64(20);
    let mut wrong = Vec::new();
    for trial in 0..300 {
        let robot = random_robot(&mut random);
        if let Err(e) = check(&robot, &mut random) {
            wrong.push(format!("table {trial}: {e}\n{}", table(&robot)));
        }
    }
    assert!(wrong.is_empty(), "{} of 300 wrong\n{}", wrong.len(), wrong[..wrong.len().min(3)].join("\n"));
}

#[test]
fn the_base_of_random_tables_with_dependent_frames_has_the_numeric_rank_and_the_same_torques() {
    let mut random = Pcg64::seed_from_u64(21);
    let (mut wrong, mut dependent) = (Vec::new(), 0);
    for trial in 0..300 {
        let mut robot = random_robot(&mut random);
        make_dependent(&mut robot, &mut random);
        dependent += usize::from(!robot.dependent.is_empty());
        if let Err(e) = check(&robot, &mut random) {
            wrong.push(format!("table {trial}: {e}\n{}", table(&robot)));
        }
    }
    assert!(dependent > 150, "{dependent}");
    assert!(wrong.is_empty(), "{} of 300 wrong\n{}", wrong.len(), wrong[..wrong.len().min(3)].join("\n"));
}

#[test]
fn the_base_of_random_tables_in_which_parameters_are_known_to_be_0_has_the_numeric_rank_and_the_same_torques()
{
    let mut random = Pcg64::seed_from_u64(22);
    let mut wrong = Vec::new();
    for trial in 0..200 {
        let mut robot = random_robot(&mut random);
        if trial % 2 == 1 {
            make_dependent(&mut robot, &mut random);
        }
        let standard = robot.standard_parameters();
        let massless = random.random_range(0..robot.frames.len());
        robot.known = (0..standard.len())
            .filter(|&k| {
                let p = &standard[k];
                let body = p.kind <= ParameterKind::Ia && random.random_bool(0.2);
                body || p.frame == massless && p.kind <= ParameterKind::M
            })
            .collect();
        if let Err(e) = check(&robot, &mut random) {
            wrong.push(format!("table {trial}: {e} {:?}\n{}", robot.known, table(&robot)));
        }
    }
    assert!(wrong.is_empty(), "{} of 200 wrong\n{}", wrong.len(), wrong[..wrong.len().min(3)].join("\n"));
}

#[test]
fn the_base_of_random_tables_with_friction_between_links_and_springs_has_the_numeric_rank_and_the_same_torques()
 {
    let mut random = Pcg64::seed_from_u64(23);
    let (mut wrong, mut springs) = (Vec::new(), 0);
    for trial in 0..300 {
        let mut robot = random_robot(&mut random);
        if trial % 3 == 1 {
            make_dependent(&mut robot, &mut random);
        }
        add_couplings(&mut robot, &mut random);
        let standard = robot.standard_parameters();
        springs += standard.iter().filter(|p| p.kind == ParameterKind::K).count();
        if trial % 2 == 1 {
            // Friction and offsets of joints too, on which those of combinations lean.
            robot.known = (0..standard.len()).filter(|_| random.random_bool(0.2)).collect();
        }
        if let Err(e) = check(&robot, &mut random) {
            wrong.push(format!(
                "table {trial}: {e} {:?} {:?}\n{}",
                robot.couplings,
                robot.known,
                table(&robot)
            ));
        }
    }
    assert!(springs > 200, "{springs}");
    assert!(wrong.is_empty(), "{} of 300 wrong\n{}", wrong.len(), wrong[..wrong.len().min(3)].join("\n"));
}

#[test]
fn of_what_is_known_as_much_is_kept_as_torques_can_tell_from_the_rest() {
    let mut random = Pcg64::seed_from_u64(24);
    let (mut wrong, mut kept) = (Vec::new(), 0);
    for trial in 0..200 {
        let mut robot = random_robot(&mut random);
        if trial % 3 == 1 {
            make_dependent(&mut robot, &mut random);
        }
        add_couplings(&mut robot, &mut random);
        let count = robot.standard_parameters().len();
        for k in 0..count {
            match random.random_range(0..8) {
                0 => robot.known.push(k),
                1 => robot.fixed.push((k, random.random_range(0.1..2.0))),
                _ => {}
            }
        }
        let mut check_fixed = || -> Result<(), String> {
            check(&robot, &mut random)?;
            let set = base_set(&robot);
            let is_fixed = |k: usize| robot.fixed.iter().any(|&(fixed, _)| fixed == k);
            let mut rows = observations(&robot, &set, &mut random);
            robot.known.iter().for_each(|&k| rows.column_mut(k).fill(0.0));
            let all = rank(&rows).0;
            robot.fixed.iter().for_each(|&(k, _)| rows.column_mut(k).fill(0.0));
            let free = if rows.amax() > 0.0 { rank(&rows).0 } else { 0 };
            let known = dynid_codegen::numeric_robot(&robot, &set).fixed_base().len();
            kept += known;
            let found = set.base.iter().filter(|p| p.combination.iter().all(|&(k, _)| is_fixed(k))).count();
            if known == all - free && found == known {
                return Ok(());
            }
            Err(format!("{known} and {found} are known, rank {all} and {free}"))
        };
        if let Err(e) = check_fixed() {
            wrong.push(format!("table {trial}: {e} {:?} {:?}\n{}", robot.known, robot.fixed, table(&robot)));
        }
    }
    assert!(kept > 200, "{kept}");
    assert!(wrong.is_empty(), "{} of 200 wrong\n{}", wrong.len(), wrong[..wrong.len().min(3)].join("\n"));
}

/// Up to four combinations with friction, and up to two springs, whose stiffnesses are always independent.
fn add_couplings(robot: &mut RobotTable, random: &mut Pcg64) {
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
fn make_dependent(robot: &mut RobotTable, random: &mut Pcg64) {
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

fn table(robot: &RobotTable) -> String {
    let mut text = format!(
        "gravity {:?} gear {:?} {:?} {:?}\n",
        robot.gravity, robot.drive.gear, robot.drive.coupled_friction, robot.dependent
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
fn random_robot(random: &mut Pcg64) -> RobotTable {
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
    RobotTable {
        name: "random".to_owned(),
        description: String::new(),
        gravity,
        constants: Vec::new(),
        frames,
        dependent: Vec::new(),
        drive,
        couplings: Vec::new(),
        known: Vec::new(),
        fixed: Vec::new(),
        ellipsoids: Vec::new(),
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

fn names(set: &BaseSet) -> Vec<&str> {
    set.base.iter().map(|p| p.name.as_ref()).collect()
}

fn relation<'a>(set: &'a BaseSet, name: &str) -> &'a str {
    &set.base
        .iter()
        .find(|p| p.name == name)
        .unwrap_or_else(|| panic!("no {name} in {:?}", names(set)))
        .relation
}

/// A robot from rows of its table.
fn table_of(rows: &str, rest: &str) -> RobotTable {
    let text = format!("name: arm\nframes:\n{rows}{rest}\n");
    parse("arm.yaml", text.as_bytes()).unwrap_or_else(|m| panic!("{}", m[0]))
}

#[test]
fn inertial_counts_are_those_of_the_independent_reference() {
    let path = workspace().join("../shared/reference/regressors.json");
    let Ok(text) = std::fs::read(&path) else {
        println!("skipped: {} is not there", path.display());
        return;
    };
    let reference: serde_json::Value = serde_json::from_slice(&text).unwrap();
    for robot in robots().iter().filter(|robot| reference.get(&robot.name).is_some()) {
        let (name, set) = (&robot.name, base_set(robot));
        // The reference has no rotors: one that the mass of its link was regrouped into stands for that mass.
        let kind = |k: usize| set.standard[k].kind;
        let inertial = |p: &&BaseParameter| {
            let has_mass = p.combination.iter().any(|&(k, _)| kind(k) <= ParameterKind::M);
            kind(p.standard) <= ParameterKind::M || kind(p.standard) == ParameterKind::Ia && has_mass
        };
        let expected = reference[name]["inertial_base_count"].as_u64().unwrap() as usize;
        assert_eq!(set.base.iter().filter(inertial).count(), expected, "{name}");
    }
}

#[test]
fn the_tx40_has_the_sixty_base_parameters_of_table_ii() {
    let mut with_payload = robot("tx40");
    let set = base_set(&with_payload);
    assert_eq!(set.base.len(), 60);
    with_payload.frames.pop();
    let without_payload = base_set(&with_payload);
    let expected = "ZZ1R Fv1 Fc1 off1 XX2R XY2 XZ2R YZ2 ZZ2R MX2R MY2 Fv2 Fc2 off2 XX3R XY3 XZ3 YZ3 ZZ3R MX3 MY3R Ia3 \
                    Fv3 Fc3 off3 XX4R XY4 XZ4 YZ4 ZZ4R MX4 MY4R Ia4 Fv4 Fc4 off4 XX5R XY5 XZ5 YZ5 ZZ5R MX5 MY5R Ia5 Fv5 \
                    Fc5 off5 XX6R XY6 XZ6 YZ6 ZZ6 MX6 MY6 Ia6 Fv6 Fc6 off6 Fvm6 Fcm6";
    assert_eq!(names(&without_payload).join(" "), expected);
    // The payload stands on link 6, so that it is regrouped into all of that link.
    let payload = ["XY6R", "XZ6R", "YZ6R", "ZZ6R", "MX6R", "MY6R"];
    let expected = expected.split(' ').map(str::to_owned).collect::<Vec<_>>();
    for (name, own) in names(&set).into_iter().zip(expected) {
        assert!(name == own || payload.contains(&name) && name == format!("{own}R"), "{name} {own}");
    }
    assert_eq!(
        relation(&without_payload, "ZZ1R"),
        "ZZ1 + Ia1 + YY2 + YY3 + 2*rl3*MZ3 + (rl3^2 + d3^2)*(M3 + M4 + M5 + M6)"
    );
    assert_eq!(relation(&without_payload, "ZZ2R"), "ZZ2 + Ia2 + d3^2*(M3 + M4 + M5 + M6)");
    assert_eq!(relation(&without_payload, "MX2R"), "MX2 + d3*(M3 + M4 + M5 + M6)");
    assert_eq!(relation(&without_payload, "XZ2R"), "XZ2 - d3*MZ3 - d3*rl3*(M3 + M4 + M5 + M6)");
    assert_eq!(relation(&without_payload, "MY3R"), "MY3 - MZ4 - rl4*(M4 + M5 + M6)");
    assert_eq!(relation(&without_payload, "XX6R"), "XX6 - YY6");
    let held =
        |k: usize| without_payload.base.iter().any(|b| b.combination.iter().any(|&(column, _)| column == k));
    let without: Vec<&str> = (0..without_payload.standard.len())
        .filter(|&k| !held(k))
        .map(|k| without_payload.standard[k].name.as_ref())
        .collect();
    assert_eq!(without.join(" "), "XX1 XY1 XZ1 YY1 YZ1 MX1 MY1 MZ1 M1 MZ2 M2");
}

/// The closed form for a revolute joint (Gautier and Khalil 1990, Khalil and Dombre 2002): YY, MZ and M of link j go
/// into link j and, through alpha, d and r, into link j - 1.
#[test]
fn a_revolute_link_regroups_by_the_closed_form_rule() {
    let rows = "  - {j: 1, sigma: 0, alpha: 0.3, d: 0, theta: q1, r: 0}\n  \
                - {j: 2, sigma: 0, alpha: 0.8, d: 0.1, theta: q2, r: 0.7}\n  \
                - {j: 3, sigma: 0, alpha: a3, d: d3, theta: q3, r: r3}\n";
    let set = base_set(&table_of(rows, "constants: {a3: 0.4, d3: 0.2, r3: 0.5}"));
    let rule = [
        ("XX2R", "XX2 - YY2 + sin(a3)^2*YY3 + 2*r3*sin(a3)^2*MZ3 + (r3^2*sin(a3)^2 - d3^2)*M3"),
        ("XY2R", "XY2 + d3*sin(a3)*MZ3 + d3*r3*sin(a3)*M3"),
        ("XZ2R", "XZ2 - d3*cos(a3)*MZ3 - d3*r3*cos(a3)*M3"),
        ("YZ2R", "YZ2 + cos(a3)*sin(a3)*YY3 + 2*r3*cos(a3)*sin(a3)*MZ3 + r3^2*cos(a3)*sin(a3)*M3"),
        ("ZZ2R", "ZZ2 + sin(a3)^2*YY3 + 2*r3*sin(a3)^2*MZ3 + (r3^2*sin(a3)^2 + d3^2)*M3"),
        ("MX2R", "MX2 + d3*M3"),
        ("MY2R", "MY2 - sin(a3)*MZ3 - r3*sin(a3)*M3"),
        ("XX3R", "XX3 - YY3"),
    ];
    for (name, expected) in rule {
        assert_eq!(relation(&set, name), expected);
    }
}

#[test]
fn a_prismatic_link_leaves_its_inertias_to_its_parent() {
    let rows = "  - {j: 1, sigma: 0, alpha: 0.3, d: 0, theta: q1, r: 0}\n  \
                - {j: 2, sigma: 0, alpha: 0.8, d: 0.1, theta: q2, r: 0.7}\n  \
                - {j: 3, sigma: 1, alpha: pi/2, d: 0.2, theta: 0, r: q3}\n";
    let set = base_set(&table_of(rows, ""));
    assert_eq!(relation(&set, "XX2R"), "XX2 - YY2 + XX3 - ZZ3");
    assert_eq!(relation(&set, "ZZ2R"), "ZZ2 + YY3");
    assert_eq!(relation(&set, "XY2R"), "XY2 - XZ3");
    for name in ["MX3", "MY3", "MZ3", "M3", "Ia3"] {
        assert_eq!(relation(&set, name), name);
    }
}

#[test]
fn gravity_along_an_axis_hides_what_gravity_across_it_shows() {
    let row = "  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}\n";
    assert_eq!(names(&base_set(&table_of(row, "gravity: [0, 0, -9.81]"))), ["ZZ1R", "Fv1", "Fc1", "off1"]);
    assert_eq!(
        names(&base_set(&table_of(row, "gravity: [0, -9.81, 0]"))),
        ["ZZ1R", "MX1", "MY1", "Fv1", "Fc1", "off1"]
    );
    let tilted = names(&base_set(&table_of(row, "gravity: [0, 0.001, -9.81]"))).len();
    assert_eq!(tilted, 6);
}

#[test]
fn lengths_and_angles_that_only_rounding_keeps_apart_are_the_same() {
    // 0.1 + 0.2 and 0.3 differ in floating point; 0.3 - 0.2 - 0.1 rad does too.
    let rows = |d: &str, alpha: &str| {
        format!(
            "  - {{j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}}\n  \
             - {{j: 2, sigma: 2, alpha: 0.2, d: {d}, theta: 0, r: 0}}\n  \
             - {{j: 3, sigma: 2, alpha: 0.1, d: 0, theta: 0, r: 0}}\n  \
             - {{j: 4, sigma: 0, alpha: {alpha}, d: -0.3, theta: q4, r: 0}}\n"
        )
    };
    let count = |d: &str, alpha: &str| base_set(&table_of(&rows(d, alpha), "")).base.len();
    // Two joints about one vertical axis: ZZ1, ZZ4, Ia4 less one, and friction.
    assert_eq!(count("0.1 + 0.2", "-0.3"), count("0.3", "-0.3"));
    assert!(count("0.1 + 0.2", "-0.3") < count("0.31", "-0.3"));
    assert!(count("0.3", "-0.3") < count("0.3", "-0.31"));
}

#[test]
fn friction_of_a_motor_that_turns_with_its_own_joint_is_that_joints_friction() {
    let rows = "  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}\n  \
                - {j: 2, sigma: 0, alpha: 0, d: 0.5, theta: q2, r: 0}\n";
    let set = base_set(&table_of(rows, "drive: {gear: [10, 10], coupled_friction: [2]}"));
    assert_eq!((relation(&set, "Fv2R"), relation(&set, "Fc2R")), ("Fv2 + Fvm2", "Fc2 + Fcm2"));
    let set = base_set(&table_of(rows, "drive: {gear: [[10, 0], [5, 10]], coupled_friction: [2]}"));
    assert_eq!(
        (relation(&set, "Fv2"), relation(&set, "Fvm2"), relation(&set, "Fcm2")),
        ("Fv2", "Fvm2", "Fcm2")
    );
    // Of a differential's two motors the viscous frictions add up to those of the joints.
    let set = base_set(&table_of(rows, "drive: {gear: [[10, 10], [10, -10]], coupled_friction: [1, 2]}"));
    assert_eq!((relation(&set, "Fv1R"), relation(&set, "Fvm1R")), ("Fv1 + 2*Fvm2", "Fvm1 - Fvm2"));
}

#[test]
fn on_a_vertical_axis_a_rotor_cannot_be_told_from_mass_and_offset() {
    let set = base_set(&robot("scara4"));
    assert_eq!(relation(&set, "Ia3R"), "Ia3 + M3 + M4");
    assert_eq!(relation(&set, "off3R"), "off3 + 9.81*(M3 + M4)");
    assert_eq!(relation(&set, "ZZ1R"), "ZZ1 + Ia1 + d2^2*(M2 + M3 + M4)");
    assert_eq!(relation(&set, "MX2R"), "MX2 + MX3 + d3*(M3 + M4)");
}

/// Khalil and Dombre 2002: the first prismatic joint has the mass that it moves, and its rotor goes into that.
#[test]
fn a_gantry_keeps_the_mass_of_its_first_axis_and_the_rotors_of_the_others() {
    let rows = "  - {j: 1, sigma: 1, alpha: pi/2, d: 0, theta: 0, r: q1}\n  \
                - {j: 2, sigma: 1, alpha: pi/2, d: 0, theta: pi/2, r: q2}\n  \
                - {j: 3, sigma: 1, alpha: pi/2, d: 0, theta: pi/2, r: q3}\n";
    let set = base_set(&table_of(rows, ""));
    let moved: Vec<&str> = set.base.iter().map(|b| b.relation.as_ref()).filter(|r| r.contains('M')).collect();
    assert_eq!(
        moved,
        ["M1 + Ia1 + M2 + M3", "Ia2 + M2 + M3", "off2 - 9.81*(M2 + M3)", "Ia3 + M3"],
        "the second axis is vertical"
    );
}

#[test]
fn the_same_table_gives_the_same_base_every_time() {
    for (robot, again) in robots().iter().zip(&robots()) {
        assert_eq!(base_set(robot), base_set(again));
    }
}

#[test]
fn calibrated_tables_with_general_angles_everywhere_are_no_harder() {
    let mut random = Pcg64::seed_from_u64(5);
    let mut rows = String::new();
    for j in 1..=8 {
        let mut draw = |middle: f64, spread: f64| middle + random.random_range(-spread..spread);
        let (alpha, d, theta, r) = (draw(PI / 2.0, 1e-3), draw(0.2, 0.1), draw(0.0, 1e-3), draw(0.1, 0.1));
        let (theta, r, sigma) = if j == 5 {
            (format!("{theta}"), format!("{r}"), 2)
        } else {
            (format!("q{j} + {theta}"), format!("{r}"), 0)
        };
        rows.push_str(&format!(
            "  - {{j: {j}, sigma: {sigma}, alpha: {alpha}, d: {d}, theta: {theta}, r: {r}}}\n"
        ));
    }
    let robot = table_of(&rows, "");
    let start = std::time::Instant::now();
    let count = base_set(&robot).base.len();
    assert!(start.elapsed().as_secs_f64() < 1.0, "{:?}", start.elapsed());
    // Seven links: gravity is along no axis, so the first keeps ZZ, MX, MY, the others seven each; Ia2 .. Ia7; friction.
    assert_eq!(count, 3 + 6 * 7 + 6 + 3 * 7);
}
