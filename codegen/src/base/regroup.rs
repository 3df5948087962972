//! Which combinations of standard parameters the dynamics can show.

use super::attainable::{Attainable, ROW};
use super::placement::{Inertia, Placement, angles_of};
use super::{ParameterKind, StandardParameter};
use crate::exact::{Form, Surd, decimal};
use crate::robot::{JointKind, Robot};
use std::collections::BTreeMap;

/// Preference of a revolute link's parameters, by index in XX .. M: the last ones are regrouped first, so that in the
/// general case YY, MZ and M go (Gautier and Khalil 1990).
const REVOLUTE: [usize; 10] = [5, 0, 1, 2, 4, 6, 7, 3, 8, 9];
/// The same for a prismatic link, where the inertias go, then MZ and MY.
const PRISMATIC: [usize; 10] = [9, 6, 7, 8, 5, 0, 1, 2, 3, 4];

/// For each standard parameter that is not kept: its column as a combination of kept columns. Kept ones are absent.
pub(super) type Regrouping = BTreeMap<usize, Vec<(usize, Form)>>;

/// A standard column less kept columns: a function that does not depend on the joints done so far.
struct Candidate {
    /// The standard parameter.
    column: usize,
    /// Kept columns that were taken off, with their factor.
    taken: BTreeMap<usize, Form>,
    /// What is left, as the energy of bodies on frames not done yet.
    bodies: BTreeMap<usize, Inertia>,
    /// What is left as dqT C dq / 2.
    rotor: Option<Vec<Vec<Surd>>>,
    /// Whether it is the potential off q of this joint.
    offset: Option<usize>,
}

impl Candidate {
    fn of(column: usize) -> Candidate {
        Candidate { column, taken: BTreeMap::new(), bodies: BTreeMap::new(), rotor: None, offset: None }
    }

    /// What it has to do with one frame: the coordinates of [`Attainable::frame`].
    fn coordinates(&self, frame: usize, joint: usize, joints: usize) -> Option<Vec<Form>> {
        let body = self.bodies.get(&frame);
        let offset = self.offset == Some(joint);
        let rotor = self.rotor.as_ref().map(|c| &c[joint]).filter(|row| row.iter().any(|x| !x.is_zero()));
        if body.is_none() && !offset && rotor.is_none() {
            return None;
        }
        let mut coordinates = body.map_or_else(|| vec![Form::zero(); 10], |body| body.to_vec());
        coordinates.push(if offset { Form::one() } else { Form::zero() });
        match rotor {
            Some(row) => coordinates.extend(row.iter().map(|x| Form::number(x.clone()))),
            None => coordinates.resize(ROW + joints, Form::zero()),
        }
        Some(coordinates)
    }

    /// Takes off a kept column.
    fn take(&mut self, column: usize, factor: &Form) {
        let slot = self.taken.entry(column).or_default();
        *slot = slot.plus(factor);
    }
}

/// Regroups the inertial parameters, rotor inertias and offsets of a robot.
///
/// A combination of columns is zero when its kinetic energy is zero and its potential energy constant. From the last
/// frame to the first: of all that depends on the joint's position or speed, independent columns are kept and taken
/// off the others. What is left of a link is then the same wherever the joint stands, so it is a body on the parent.
/// What is left at the base moves nothing.
pub(super) fn regroup(robot: &Robot, standard: &[StandardParameter]) -> Regrouping {
    let joint_frames = robot.joint_frames();
    let joints = joint_frames.len();
    let joint_of = |frame: usize| joint_frames.iter().position(|&f| f == frame);
    let angles = angles_of(robot);
    let placements: Vec<Placement> = robot.frames.iter().map(|f| Placement::of(f, &angles)).collect();

    let base = Attainable::base(&robot.gravity.map(|g| decimal(g).into()), joints);
    let mut attainable: Vec<Attainable> = Vec::new();
    let mut visible = Vec::new();
    for (k, frame) in robot.frames.iter().enumerate() {
        let parent = if frame.parent == 0 { &base } else { &attainable[frame.parent - 1] };
        let (next, shown) = parent.frame(&placements[k], frame.kind, joint_of(k));
        attainable.push(next);
        visible.push(shown);
    }

    let mut candidates = candidates(robot, standard, &joint_of);
    for (k, frame) in robot.frames.iter().enumerate().rev() {
        if let Some(joint) = joint_of(k) {
            let preference = if frame.kind == JointKind::Revolute { REVOLUTE } else { PRISMATIC };
            let order: Vec<usize> = preference.into_iter().chain(10..ROW + joints).collect();
            for (pivot, row) in visible[k].reduced(&order) {
                keep_one(&mut candidates, standard, k, joint, joints, pivot, &row);
            }
        }
        for candidate in &mut candidates {
            move_to_parent(candidate, &placements[k], k, frame.parent, joint_of(k));
        }
    }
    candidates
        .into_iter()
        .map(|c| (c.column, c.taken.into_iter().filter(|(_, f)| !f.is_zero()).collect()))
        .collect()
}

fn candidates(
    robot: &Robot,
    standard: &[StandardParameter],
    joint_of: &impl Fn(usize) -> Option<usize>,
) -> Vec<Candidate> {
    let rotors: Vec<Vec<Vec<Surd>>> = robot
        .drive
        .rotor_matrices()
        .into_iter()
        .map(|matrix| matrix.into_iter().map(|row| row.into_iter().map(Surd::from).collect()).collect())
        .collect();
    let mut candidates = Vec::new();
    for (column, parameter) in standard.iter().enumerate() {
        let mut candidate = Candidate::of(column);
        match (parameter.kind, joint_of(parameter.frame)) {
            (ParameterKind::Ia, Some(joint)) => candidate.rotor = Some(rotors[joint].clone()),
            (ParameterKind::Off, joint @ Some(_)) => candidate.offset = joint,
            (kind, _) if kind <= ParameterKind::M => {
                let mut body: Inertia = Default::default();
                body[kind as usize] = Form::one();
                candidate.bodies.insert(parameter.frame, body);
            }
            _ => continue,
        }
        candidates.push(candidate);
    }
    candidates
}

/// Keeps one column that the visible direction `row` shows, and takes it off all others until they do not show there.
fn keep_one(
    candidates: &mut Vec<Candidate>,
    standard: &[StandardParameter],
    frame: usize,
    joint: usize,
    joints: usize,
    pivot: usize,
    row: &[Surd],
) {
    let shown: Vec<(usize, Form)> = candidates
        .iter()
        .enumerate()
        .filter_map(|(at, candidate)| {
            let coordinates = candidate.coordinates(frame, joint, joints)?;
            let parts = coordinates.iter().zip(row).filter(|(c, r)| !c.is_zero() && !r.is_zero());
            let sum = parts.fold(Form::zero(), |sum, (c, r)| sum.plus(&c.scaled(r)));
            (!sum.is_zero()).then_some((at, sum))
        })
        .collect();
    // The link's own parameter at the pivot, then the joint's own, then any.
    let rank = |at: usize| {
        let parameter = &standard[candidates[at].column];
        let own = parameter.frame == frame;
        match pivot {
            0..10 => !(own && parameter.kind as usize == pivot),
            10 => !(own && parameter.kind == ParameterKind::Off),
            _ => !(own && parameter.kind == ParameterKind::Ia),
        }
    };
    let Some((kept, its_share)) =
        shown.iter().min_by_key(|(at, _)| (rank(*at), candidates[*at].column)).cloned()
    else {
        return;
    };
    let column = candidates[kept].column;
    let gone = std::mem::replace(&mut candidates[kept], Candidate::of(column));
    for (at, share) in shown {
        if at == kept {
            continue;
        }
        let Some(factor) = share.over(&its_share) else { continue };
        let candidate = &mut candidates[at];
        candidate.take(column, &factor);
        let minus = factor.scaled(&Surd::integer(-1));
        for (&other, taken) in &gone.taken {
            candidate.take(other, &taken.times(&minus));
        }
        for (&on, body) in &gone.bodies {
            add_body(candidate, on, body, &minus);
        }
        if let Some(rotor) = &gone.rotor {
            add_rotor(candidate, rotor, minus.value());
        }
    }
    candidates.remove(kept);
}

fn add_body(candidate: &mut Candidate, frame: usize, body: &Inertia, factor: &Form) {
    let sum = candidate.bodies.entry(frame).or_default();
    for (x, y) in sum.iter_mut().zip(body) {
        *x = x.plus(&y.times(factor));
    }
}

fn add_rotor(candidate: &mut Candidate, rotor: &[Vec<Surd>], factor: &Surd) {
    let n = rotor.len();
    let sum = candidate.rotor.get_or_insert_with(|| vec![vec![Surd::zero(); n]; n]);
    for (x, y) in sum.iter_mut().flatten().zip(rotor.iter().flatten()) {
        *x = &*x + &(y * factor);
    }
}

/// Nothing of the candidate depends on the frame's joint any more.
fn move_to_parent(
    candidate: &mut Candidate,
    placement: &Placement,
    frame: usize,
    parent: usize,
    joint: Option<usize>,
) {
    if let Some(body) = candidate.bodies.remove(&frame)
        && parent > 0
    {
        add_body(candidate, parent - 1, &placement.on_parent(&body), &Form::one());
    }
    let Some(joint) = joint else { return };
    if candidate.offset == Some(joint) {
        candidate.offset = None;
    }
    if let Some(rotor) = &mut candidate.rotor {
        for (i, row) in rotor.iter_mut().enumerate() {
            for (k, x) in row.iter_mut().enumerate() {
                if i == joint || k == joint {
                    *x = Surd::zero();
                }
            }
        }
    }
}
