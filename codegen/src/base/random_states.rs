//! Energies of the standard parameters at states drawn at random, in exact arithmetic.

use super::placement::{Placement, angles_of, length};
use crate::exact::{Angles, Number, Rotation, decimal};
use crate::robot::RobotTable;
use dynid_description::{CouplingLaw, JointKind, Motion, ParameterKind, StandardParameter};

/// More states than columns: one more than the rank is enough, a few more cost nothing.
const SPARE: usize = 8;

/// Rational numbers that repeat on every run, from about 2^60 of them.
struct Random(u64);

impl Random {
    fn whole(&mut self) -> i64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 34) as i64
    }

    /// Within about -2 to 2.
    fn number(&mut self) -> Number {
        let (above, below) = (self.whole() - (1 << 29), (1 << 28) + self.whole() / 8);
        // Far below the prime, so that there is an inverse.
        Number::from(above) * Number::from(below).inverse().unwrap_or(Number::ONE)
    }
}

/// A state of the joints. Of a revolute joint the turn and the position are drawn apart.
struct State {
    turn: Vec<Rotation>,
    q: Vec<Number>,
    dq: Vec<Number>,
}

impl State {
    fn random(random: &mut Random, joints: usize) -> State {
        let turn = (0..joints).map(|_| Rotation::of_half_tangent(random.number())).collect();
        let mut draw = || (0..joints).map(|_| random.number()).collect();
        State { turn, q: draw(), dq: draw() }
    }

    fn at_rest(self) -> State {
        State { dq: vec![Number::ZERO; self.q.len()], ..self }
    }
}

/// Energies of these columns at states drawn at random, less those of a state at rest: rows of one number per column.
pub(super) fn energies_at_random(
    robot: &RobotTable,
    standard: &[StandardParameter],
    columns: &[usize],
) -> Vec<Vec<Number>> {
    let joint_frames = robot.joint_frames();
    let joints = joint_frames.len();
    let angles = angles_of(robot);
    let motions = robot.motions();
    let places: Vec<Placement> = robot
        .frames
        .iter()
        .zip(&motions)
        .map(|(frame, motion)| {
            let mut frame = frame.clone();
            frame.kind = motion.kind;
            Placement::of(&frame, &angles)
        })
        .collect();
    let rotors = robot.drive.rotor_matrices();
    let joint_of = |frame: usize| joint_frames.iter().position(|&f| f == frame).unwrap_or(0);
    let energies = |state: &State| -> Vec<Number> {
        let frames = frames_in_motion(robot, (&places, &motions, &angles), state);
        let gravity = robot.gravity.map(|g| Number::from(decimal(g)));
        let bodies: Vec<[Number; 10]> = frames.iter().map(|frame| energy(frame, &gravity)).collect();
        let of_column = |&column: &usize| {
            let parameter = &standard[column];
            match parameter.kind {
                ParameterKind::Off => state.q[joint_of(parameter.frame)],
                ParameterKind::K | ParameterKind::KR => spring_energy(robot, parameter, &state.q, &frames),
                ParameterKind::Ia => {
                    let form = &rotors[joint_of(parameter.frame)];
                    let product = |i: usize, k: usize| {
                        Number::from(form[i][k].clone()) * state.dq[i] * state.dq[k] * half()
                    };
                    (0..joints)
                        .flat_map(|i| (0..joints).map(move |k| (i, k)))
                        .map(|(i, k)| product(i, k))
                        .sum()
                }
                kind => bodies[parameter.frame][kind as usize],
            }
        };
        columns.iter().map(of_column).collect()
    };
    let mut random = Random(2026);
    let rest = energies(&State::random(&mut random, joints).at_rest());
    (0..columns.len() + SPARE)
        .map(|_| {
            let row = energies(&State::random(&mut random, joints));
            row.into_iter().zip(&rest).map(|(x, y)| x - *y).collect()
        })
        .collect()
}

/// Potential energy of a spring per unit of K, K s^2 / 2 - K s0 s, or of KR, -s. Of one between points only l^2 / 2: see
/// [`is_irrational`].
fn spring_energy(
    robot: &RobotTable,
    parameter: &StandardParameter,
    q: &[Number],
    frames: &[Moving],
) -> Number {
    if let Some(between) = parameter.coupling.and_then(|k| robot.couplings[k].law.between()) {
        let place = |end: usize| {
            let point = between.points[end].map(|x| Number::from(decimal(x)));
            between.frames[end].map_or(point, |f| sum(&frames[f].origin, &times(&frames[f].axes, &point)))
        };
        let apart = sum(&place(0), &scaled(&place(1), -Number::ONE));
        return half() * dot(&apart, &apart);
    }
    let s: Number = robot.acts_on(parameter).into_iter().zip(q).map(|(c, q)| Number::from(c) * *q).sum();
    match parameter.coupling.map(|k| robot.couplings[k].law) {
        _ if parameter.kind == ParameterKind::KR => -s,
        Some(CouplingLaw::SpringAt(rest)) => half() * s * s - Number::from(decimal(rest)) * s,
        _ => half() * s * s,
    }
}

fn half() -> Number {
    Number::from(2).inverse().unwrap_or(Number::ONE)
}

type Vector = [Number; 3];
type Matrix = [Vector; 3];

fn dot(a: &Vector, b: &Vector) -> Number {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn cross(a: &Vector, b: &Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

fn sum(a: &Vector, b: &Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

fn scaled(a: &Vector, k: Number) -> Vector {
    a.map(|x| x * k)
}

fn column(m: &Matrix, k: usize) -> Vector {
    [m[0][k], m[1][k], m[2][k]]
}

fn times(m: &Matrix, v: &Vector) -> Vector {
    [dot(&m[0], v), dot(&m[1], v), dot(&m[2], v)]
}

/// A frame in motion, seen from frame 0.
#[derive(Clone, Copy)]
struct Moving {
    axes: Matrix,
    origin: Vector,
    w: Vector,
    v: Vector,
}

/// Whether the energy of a parameter has the length of a spring between points in it: the root of a polynomial that is no
/// square, which no combination of polynomials is, and none of the roots of others that are not multiples of it.
pub(super) fn is_irrational(robot: &RobotTable, parameter: &StandardParameter) -> bool {
    let between = parameter.coupling.and_then(|k| robot.couplings[k].law.between());
    between.is_some_and(|b| parameter.kind == ParameterKind::KR || b.rest.is_some_and(|rest| rest != 0.0))
}

/// Every frame in motion, seen from frame 0.
fn frames_in_motion(
    robot: &RobotTable,
    (places, motions, angles): (&[Placement], &[Motion], &Angles),
    state: &State,
) -> Vec<Moving> {
    let zero = [Number::ZERO; 3];
    let unit = |k: usize| std::array::from_fn(|i| if i == k { Number::ONE } else { Number::ZERO });
    let base = Moving { axes: [unit(0), unit(1), unit(2)], origin: zero, w: zero, v: zero };
    let mut frames: Vec<Moving> = Vec::with_capacity(robot.frames.len());
    for ((frame, place), motion) in robot.frames.iter().zip(places).zip(motions) {
        let parent = frame.parent.checked_sub(1).map_or(base, |p| frames[p]);
        let fixed: Matrix = std::array::from_fn(|i| std::array::from_fn(|j| place.rotation[i][j].value()));
        let outer: Matrix = {
            let columns = [0, 1, 2].map(|k| times(&parent.axes, &column(&fixed, k)));
            std::array::from_fn(|i| std::array::from_fn(|j| columns[j][i]))
        };
        let z = column(&outer, 2);
        let coefficient = |c: f64| Number::from(decimal(c));
        let rate: Number = motion.terms.iter().map(|&(joint, c)| coefficient(c) * state.dq[joint]).sum();
        let mut at = place.origin.clone().map(|x| x.value());
        let mut axes = outer;
        let (mut turning, mut moving) = (Number::ZERO, Number::ZERO);
        match motion.kind {
            JointKind::Revolute => {
                let constant = angles.rotation(frame.theta.value());
                let turn = motion
                    .terms
                    .iter()
                    .fold(constant, |turn, &(joint, c)| turn.then(state.turn[joint].times(c as i64)));
                let (c, s) = (turn.cos, turn.sin);
                axes = outer.map(|[x, y, z]| [x * c + y * s, y * c - x * s, z]);
                turning = rate;
            }
            JointKind::Prismatic => {
                let q = motion.terms.iter().map(|&(joint, c)| coefficient(c) * state.q[joint]);
                let r = length(&frame.r).value() + q.sum();
                at = sum(&at, &scaled(&column(&fixed, 2), r));
                moving = rate;
            }
            JointKind::Fixed => {}
        }
        let arm = times(&parent.axes, &at);
        let swept = sum(&parent.v, &cross(&parent.w, &arm));
        frames.push(Moving {
            axes,
            origin: sum(&parent.origin, &arm),
            w: sum(&parent.w, &scaled(&z, turning)),
            v: sum(&swept, &scaled(&z, moving)),
        });
    }
    frames
}

/// Kinetic and potential energy per unit of XX .. M of a frame.
fn energy(frame: &Moving, gravity: &Vector) -> [Number; 10] {
    let axes = [0, 1, 2].map(|k| column(&frame.axes, k));
    let [x, y, z] = axes.each_ref().map(|axis| dot(axis, &frame.w));
    let moment = |axis: &Vector| dot(&frame.v, &cross(&frame.w, axis)) - dot(gravity, axis);
    let [mx, my, mz] = axes.each_ref().map(moment);
    let mass = half() * dot(&frame.v, &frame.v) - dot(gravity, &frame.origin);
    [half() * x * x, x * y, x * z, half() * y * y, y * z, half() * z * z, mx, my, mz, mass]
}
