//! Base parameters of tables whose frames move with several joint variables, or several frames with one.
//!
//! First every moving frame is taken to move by itself: what is regrouped then stays zero whatever the frames' variables
//! depend on, and keeps its relation in symbols. What is left is compared at states drawn at random, in exact arithmetic:
//! a combination of columns is zero when its energy is constant. Energies are polynomials in the sines, cosines, positions
//! and speeds of the joints. One that is zero at points drawn from 2^60 values is zero (Schwartz 1980, Zippel 1979), but
//! for a chance far below that of a fault in the machine; sines and cosines of the points are those of rational rotations,
//! and a position that enters a length is as independent of its sine and cosine as the functions are.

use super::placement::{Placement, angles_of, length};
use super::regroup::{Regrouping, regroup};
use crate::exact::{Angles, Form, Number, Rotation, decimal};
use crate::robot::{DriveTable, RobotTable};
use dynid_description::{JointKind, Motion, ParameterKind, StandardParameter};
use std::collections::BTreeMap;

/// More states than columns: one more than the rank is enough, a few more cost nothing.
const SPARE: usize = 8;

/// [`regroup`] of a robot with dependent frames.
pub(super) fn regroup_dependent(robot: &RobotTable, standard: &[StandardParameter]) -> Regrouping {
    let mut regrouping = regroup_as_if_free(robot, standard);
    let inertial = |k: &usize| standard[*k].kind <= ParameterKind::M && !regrouping.contains_key(k);
    let all = (0..standard.len()).filter(|k| !robot.known.contains(k));
    let of_kind = |kind: ParameterKind| all.clone().filter(move |&k| standard[k].kind == kind);
    // First choice is what stands first in the table; rotors and offsets go into bodies where they can.
    let columns: Vec<usize> = all
        .clone()
        .filter(inertial)
        .chain(of_kind(ParameterKind::Off))
        .chain(of_kind(ParameterKind::Ia))
        .collect();
    let dependent = dependencies(&energies_at_random(robot, standard, &columns));
    let second: BTreeMap<usize, Vec<(usize, Number)>> = dependent
        .into_iter()
        .map(|(column, of)| (columns[column], of.into_iter().map(|(k, c)| (columns[k], c)).collect()))
        .collect();
    for taken in regrouping.values_mut() {
        let mut sum: BTreeMap<usize, Form> = BTreeMap::new();
        let mut add = |column: usize, share: Form| {
            let entry = sum.entry(column).or_default();
            *entry = entry.plus(&share);
        };
        for (column, factor) in taken.iter() {
            match second.get(column) {
                None => add(*column, factor.clone()),
                Some(of) => of.iter().for_each(|&(kept, c)| add(kept, factor.scaled(c))),
            }
        }
        *taken = sum.into_iter().filter(|(_, factor)| !factor.is_zero()).collect();
    }
    let forms = |of: Vec<(usize, Number)>| of.into_iter().map(|(kept, c)| (kept, Form::number(c))).collect();
    regrouping.extend(second.into_iter().map(|(column, of)| (column, forms(of))));
    regrouping
}

/// The regrouping of the bodies where every frame that moves is a joint of its own.
fn regroup_as_if_free(robot: &RobotTable, standard: &[StandardParameter]) -> Regrouping {
    let mut free = robot.clone();
    for (frame, motion) in free.frames.iter_mut().zip(robot.motions()) {
        frame.kind = motion.kind;
    }
    free.dependent = Vec::new();
    free.known = Vec::new();
    free.drive = DriveTable::direct(free.joint_frames().len());
    let places: Vec<usize> = (0..standard.len())
        .filter(|k| standard[*k].kind <= ParameterKind::M && !robot.known.contains(k))
        .collect();
    let bodies: Vec<StandardParameter> = places.iter().map(|&k| standard[k].clone()).collect();
    let found = regroup(&free, &bodies);
    found
        .into_iter()
        .map(|(column, taken)| {
            (places[column], taken.into_iter().map(|(kept, factor)| (places[kept], factor)).collect())
        })
        .collect()
}

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
fn energies_at_random(
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
        let bodies = body_energies(robot, (&places, &motions, &angles), state);
        let energy = |&column: &usize| {
            let parameter = &standard[column];
            match parameter.kind {
                ParameterKind::Off => state.q[joint_of(parameter.frame)],
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
        columns.iter().map(energy).collect()
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

/// Kinetic and potential energy per unit of XX .. M of every frame.
fn body_energies(
    robot: &RobotTable,
    (places, motions, angles): (&[Placement], &[Motion], &Angles),
    state: &State,
) -> Vec<[Number; 10]> {
    let zero = [Number::ZERO; 3];
    let unit = |k: usize| std::array::from_fn(|i| if i == k { Number::ONE } else { Number::ZERO });
    let base = Moving { axes: [unit(0), unit(1), unit(2)], origin: zero, w: zero, v: zero };
    let gravity = robot.gravity.map(|g| Number::from(decimal(g)));
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
    frames.iter().map(|frame| energy(frame, &gravity)).collect()
}

fn energy(frame: &Moving, gravity: &Vector) -> [Number; 10] {
    let axes = [0, 1, 2].map(|k| column(&frame.axes, k));
    let [x, y, z] = axes.each_ref().map(|axis| dot(axis, &frame.w));
    let moment = |axis: &Vector| dot(&frame.v, &cross(&frame.w, axis)) - dot(gravity, axis);
    let [mx, my, mz] = axes.each_ref().map(moment);
    let mass = half() * dot(&frame.v, &frame.v) - dot(gravity, &frame.origin);
    [half() * x * x, x * y, x * z, half() * y * y, y * z, half() * z * z, mx, my, mz, mass]
}

/// The columns that depend on columns before them, each as a combination of those that do not.
fn dependencies(rows: &[Vec<Number>]) -> Vec<(usize, Vec<(usize, Number)>)> {
    let mut matrix = rows.to_vec();
    let columns = matrix.first().map_or(0, Vec::len);
    let mut kept: Vec<usize> = Vec::new();
    let mut dependent: Vec<(usize, Vec<(usize, Number)>)> = Vec::new();
    for k in 0..columns {
        let rank = kept.len();
        let pivot = (rank..matrix.len())
            .filter(|&i| !matrix[i][k].is_zero())
            .max_by(|&i, &j| matrix[i][k].real().abs().total_cmp(&matrix[j][k].real().abs()));
        let Some(pivot) = pivot else {
            let of = (0..rank).filter(|&i| !matrix[i][k].is_zero()).map(|i| (kept[i], matrix[i][k]));
            dependent.push((k, of.collect()));
            continue;
        };
        matrix.swap(rank, pivot);
        // The pivot is not zero.
        let inverse = matrix[rank][k].inverse().unwrap_or(Number::ONE);
        let lead: Vec<Number> = matrix[rank].iter().map(|&x| x * inverse).collect();
        for row in &mut matrix {
            let factor = row[k];
            if !factor.is_zero() {
                row[k..].iter_mut().zip(&lead[k..]).for_each(|(x, y)| *x = *x - factor * *y);
            }
        }
        matrix[rank] = lead;
        kept.push(k);
    }
    dependent.iter_mut().for_each(|(k, of)| refine(rows, *k, of));
    dependent
}

/// Coefficients of an exact combination with the floating point values that fit best: those of a long elimination carry its
/// rounding.
fn refine(rows: &[Vec<Number>], column: usize, combination: &mut [(usize, Number)]) {
    let real = |k: usize| -> Vec<f64> { rows.iter().map(|row| row[k].real()).collect() };
    let inner = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(x, y)| x * y).sum() };
    let mut left = real(column);
    let count = combination.len();
    // Gram and Schmidt, each column twice: A = Q R.
    let mut q: Vec<Vec<f64>> = Vec::with_capacity(count);
    let mut r = vec![vec![0.0; count]; count];
    for (k, &(from, _)) in combination.iter().enumerate() {
        let mut v = real(from);
        for _ in 0..2 {
            for (i, unit) in q.iter().enumerate() {
                let along = inner(unit, &v);
                r[i][k] += along;
                v.iter_mut().zip(unit).for_each(|(x, u)| *x -= along * u);
            }
        }
        r[k][k] = inner(&v, &v).sqrt();
        q.push(v.iter().map(|x| x / r[k][k]).collect());
    }
    let mut best: Vec<f64> = q
        .iter()
        .map(|unit| {
            let along = inner(unit, &left);
            left.iter_mut().zip(unit).for_each(|(x, u)| *x -= along * u);
            along
        })
        .collect();
    for k in (0..count).rev() {
        let known: f64 = (k + 1..count).map(|i| r[k][i] * best[i]).sum();
        best[k] = (best[k] - known) / r[k][k];
    }
    for ((_, factor), best) in combination.iter_mut().zip(best) {
        *factor = factor.with_real(best).cleaned();
    }
}

#[cfg(test)]
mod tests {
    use crate::base::base_set;
    use crate::robot::parse;

    fn names(rows: &str) -> Vec<String> {
        let text = format!("name: arm\ngravity: [0, -9.81, 0]\nconstants: {{d2: 0.4}}\nframes:\n{rows}");
        let robot = parse("arm.yaml", text.as_bytes()).expect("a table without mistakes");
        base_set(&robot).base.iter().map(|p| p.relation.to_string()).collect()
    }

    #[test]
    fn two_bodies_on_one_joint_have_one_inertia() {
        let rows = "  - {j: 1, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}\n  \
                    - {j: 2, parent: 0, sigma: 0, alpha: 0, d: d2, theta: -q1, r: 0}\n";
        let expected = ["ZZ1 + Ia1 + ZZ2", "MX1 - MX2", "MY1 + MY2", "Fv1", "Fc1", "off1"];
        assert_eq!(names(rows), expected);
    }

    #[test]
    fn the_bars_of_a_parallelogram_share_inertias_across_its_branches() {
        // Upper arm 2 and lower bar 3 on the base; the bar that closes them, 4 on 3, is parallel to 2, and the forearm 5 on 2
        // to 3.
        let rows = "  - {j: 1, parent: 0, sigma: 0, alpha: 0, d: 0, theta: q1, r: 0}\n  \
                    - {j: 2, parent: 0, sigma: 0, alpha: 0, d: 0, theta: q2, r: 0}\n  \
                    - {j: 3, parent: 2, sigma: 0, alpha: 0, d: 0.1, theta: q1 - q2, r: 0}\n  \
                    - {j: 4, parent: 1, sigma: 0, alpha: 0, d: d2, theta: q2 - q1, r: 0}\n";
        let relations = names(rows);
        assert_eq!(relations[0], "ZZ1 + Ia1 + ZZ3 + d2^2*M4");
        let inertias =
            relations.iter().filter(|r| r.contains("ZZ") || r.starts_with("MX3") || r.starts_with("MX4"));
        assert_eq!(inertias.count(), 3, "{relations:?}");
        assert!(relations.contains(&"ZZ2 + Ia2 + 0.01*M3 + ZZ4".to_owned()), "{relations:?}");
    }
}
