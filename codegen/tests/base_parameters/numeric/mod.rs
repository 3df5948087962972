//! Standard inverse dynamic regressor by Newton and Euler in plain matrices, written for the tests alone.

use dynid_codegen::robot::RobotTable;
use dynid_description::{CouplingLaw, JointKind};
use nalgebra::{DMatrix, DVector, Matrix3, Rotation3, Vector3};

/// A frame in motion, everything in the axes of frame 0. `jv`, `jw`: velocities per unit joint speed.
struct Body {
    axes: Matrix3<f64>,
    origin: Vector3<f64>,
    speed: Vector3<f64>,
    spin: Vector3<f64>,
    acceleration: Vector3<f64>,
    spin_rate: Vector3<f64>,
    jv: Vec<Vector3<f64>>,
    jw: Vec<Vector3<f64>>,
}

fn motions(robot: &RobotTable, q: &[f64], dq: &[f64], ddq: &[f64]) -> Vec<Body> {
    let n = q.len();
    let zero = Vector3::zeros();
    let mut bodies = vec![Body {
        axes: Matrix3::identity(),
        origin: zero,
        speed: zero,
        spin: zero,
        acceleration: -Vector3::from(robot.gravity),
        spin_rate: zero,
        jv: vec![zero; n],
        jw: vec![zero; n],
    }];
    for (frame, motion) in robot.frames.iter().zip(robot.motions()) {
        let parent = &bodies[frame.parent];
        let moving = motion.kind != JointKind::Fixed;
        let [x, dx, ddx] =
            [q, dq, ddq].map(|joints| motion.terms.iter().map(|&(k, c)| c * joints[k]).sum::<f64>());
        let revolute = motion.kind == JointKind::Revolute;
        let theta = frame.theta.value() + if revolute { x } else { 0.0 };
        let r = frame.r.value() + if moving && !revolute { x } else { 0.0 };
        let about = |axis, angle: f64| Rotation3::from_axis_angle(&axis, angle).into_inner();
        let turned =
            about(Vector3::z_axis(), frame.gamma.value()) * about(Vector3::x_axis(), frame.alpha.value());
        let local = Vector3::z() * frame.b.value() + turned * Vector3::new(frame.d.value(), 0.0, r);
        let axes = parent.axes * turned * about(Vector3::z_axis(), theta);
        let z: Vector3<f64> = axes.column(2).into();
        let p = parent.axes * local;
        let w = parent.spin;
        let mut speed = parent.speed + w.cross(&p);
        let mut acceleration = parent.acceleration + parent.spin_rate.cross(&p) + w.cross(&w.cross(&p));
        let (mut spin, mut spin_rate) = (w, parent.spin_rate);
        let mut jv: Vec<_> = (0..n).map(|k| parent.jv[k] + parent.jw[k].cross(&p)).collect();
        let mut jw = parent.jw.clone();
        if revolute {
            spin += z * dx;
            spin_rate += z * ddx + w.cross(&z) * dx;
            motion.terms.iter().for_each(|&(k, c)| jw[k] += z * c);
        } else if moving {
            speed += z * dx;
            acceleration += z * ddx + w.cross(&z) * (2.0 * dx);
            motion.terms.iter().for_each(|&(k, c)| jv[k] += z * c);
        }
        bodies.push(Body { axes, origin: parent.origin + p, speed, spin, acceleration, spin_rate, jv, jw });
    }
    bodies
}

/// n x n_st: the torque of each standard parameter alone, in the order of chi_st.
pub fn regressor(robot: &RobotTable, q: &[f64], dq: &[f64], ddq: &[f64]) -> DMatrix<f64> {
    let n = q.len();
    let bodies = motions(robot, q, dq, ddq);
    let mut columns: Vec<DVector<f64>> = Vec::new();
    let motors = motor_rows(robot);
    let rotors = rotor_matrices(robot);
    let speeds = DVector::from_column_slice(dq);
    let accelerations = DVector::from_column_slice(ddq);
    let mut joint = 0;
    for (frame, body) in robot.frames.iter().zip(&bodies[1..]) {
        columns.extend((0..10).map(|k| link_torque(body, k)));
        if frame.kind == JointKind::Fixed {
            continue;
        }
        let own = |x: f64| DVector::from_fn(n, |i, _| if i == joint { x } else { 0.0 });
        columns.push(&rotors[joint] * &accelerations);
        columns.extend([own(dq[joint]), own(dq[joint].signum()), own(1.0)]);
        if robot.drive.coupled_friction.contains(&joint) {
            let speed = motors[joint].dot(&speeds);
            columns.extend([&motors[joint] * speed, &motors[joint] * speed.signum()]);
        }
        joint += 1;
    }
    for coupling in &robot.couplings {
        let mut c = DVector::zeros(n);
        coupling.terms.iter().for_each(|&(joint, factor)| c[joint] = factor);
        let (s, speed) = (c.dot(&DVector::from_column_slice(q)), c.dot(&speeds));
        match coupling.law {
            CouplingLaw::Friction => columns.extend([&c * speed, &c * speed.signum()]),
            CouplingLaw::Spring => columns.extend([&c * s, -c]),
            CouplingLaw::SpringAt(rest) => columns.push(c * (s - rest)),
            // Compared in runtime/tests/between.rs.
            CouplingLaw::Between(_) => panic!("these tables have no springs between points"),
        }
    }
    DMatrix::from_columns(&columns)
}

/// Torques of one unit inertial parameter (XX XY XZ YY YZ ZZ MX MY MZ M).
fn link_torque(body: &Body, k: usize) -> DVector<f64> {
    let mut tensor = Matrix3::zeros();
    let mut first = Vector3::zeros();
    let mut mass = 0.0;
    match k {
        0..6 => {
            let (i, j) = [(0, 0), (0, 1), (0, 2), (1, 1), (1, 2), (2, 2)][k];
            tensor[(i, j)] = 1.0;
            tensor[(j, i)] = 1.0;
        }
        6..9 => first[k - 6] = 1.0,
        _ => mass = 1.0,
    }
    let tensor = body.axes * tensor * body.axes.transpose();
    let first = body.axes * first;
    let (w, a) = (body.spin, body.acceleration);
    let force = a * mass + body.spin_rate.cross(&first) + w.cross(&w.cross(&first));
    let moment = tensor * body.spin_rate + w.cross(&(tensor * w)) + first.cross(&a);
    DVector::from_fn(body.jv.len(), |i, _| body.jv[i].dot(&force) + body.jw[i].dot(&moment))
}

/// Rows N_m / N_mm of the gear.
fn motor_rows(robot: &RobotTable) -> Vec<DVector<f64>> {
    let rows = robot.drive.gear.iter().enumerate();
    rows.map(|(m, row)| DVector::from_column_slice(row) / row[m]).collect()
}

/// A_j with Ia_j A_j ddq the torque of a rotor inertia.
fn rotor_matrices(robot: &RobotTable) -> Vec<DMatrix<f64>> {
    let gear = &robot.drive.gear;
    let n = gear.len();
    let squares = DMatrix::from_fn(n, n, |j, m| gear[m][j] * gear[m][j]);
    let outer = |m: usize| DMatrix::from_fn(n, n, |i, k| gear[m][i] * gear[m][k]);
    let regular = squares.clone().lu();
    let singular = squares.singular_values().min() < 1e-9 * squares.singular_values().max();
    match regular.try_inverse() {
        Some(inverse) if !singular => (0..n)
            .map(|j| (0..n).fold(DMatrix::zeros(n, n), |sum, m| sum + outer(m) * inverse[(m, j)]))
            .collect(),
        _ => (0..n).map(|m| outer(m) / (gear[m][m] * gear[m][m])).collect(),
    }
}
