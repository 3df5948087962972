//! Which columns of the standard regressor are kept, and how the others depend on them.

use super::attainable::{Attainable, OFFSET, SPEEDS};
use super::placement::{Inertia, Placement, angles_of};
use crate::exact::{Form, Number, decimal};
use crate::robot::RobotTable;
use dynid_description::{JointKind, ParameterKind, StandardParameter};
use std::collections::BTreeMap;

/// Preference of a revolute link's parameters, by index in XX .. M: the last ones are regrouped first, so that in the
/// general case YY, MZ and M go (Gautier and Khalil 1990).
const REVOLUTE: [usize; 10] = [5, 0, 1, 2, 4, 6, 7, 3, 8, 9];
/// The same for a prismatic link, where the inertias go, then MZ and MY.
const PRISMATIC: [usize; 10] = [9, 6, 7, 8, 5, 0, 1, 2, 3, 4];

/// For each standard parameter that is not kept: its column as a combination of kept columns. Kept ones are absent.
pub(super) type Regrouping = BTreeMap<usize, Vec<(usize, Form)>>;

/// Regroups the inertial parameters, rotor inertias and offsets of a robot.
///
/// A combination of columns is zero when its kinetic energy is zero and its potential energy constant. From the last
/// frame to the first: of all that depends on the joint's position or speed, independent columns are kept and taken
/// off the others. What is left of a link is then the same wherever the joint stands, so it is a body on the parent.
/// What is left at the base moves nothing.
pub(super) fn regroup(robot: &RobotTable, standard: &[StandardParameter]) -> Regrouping {
    let joint_frames = robot.joint_frames();
    let joints = joint_frames.len();
    let joint_of = |frame: usize| joint_frames.iter().position(|&f| f == frame);
    let angles = angles_of(robot);
    let placements: Vec<Placement> = robot.frames.iter().map(|f| Placement::of(f, &angles)).collect();

    let base = Attainable::base(robot.gravity.map(|g| decimal(g).into()), joints);
    let mut attainable: Vec<Attainable> = Vec::new();
    let mut visible = Vec::new();
    for (k, frame) in robot.frames.iter().enumerate() {
        let parent = if frame.parent == 0 { &base } else { &attainable[frame.parent - 1] };
        let (next, shown) = parent.frame(&placements[k], joint_of(k).map(|joint| (frame.kind, joint)));
        attainable.push(next);
        visible.push(shown);
    }

    let mut candidates = candidates(robot, standard, &joint_of);
    for (k, frame) in robot.frames.iter().enumerate().rev() {
        let joint = joint_of(k);
        if let Some(joint) = joint {
            let preference = if frame.kind == JointKind::Revolute { REVOLUTE } else { PRISMATIC };
            let order: Vec<usize> = preference.into_iter().chain(OFFSET..SPEEDS + joints).collect();
            let mut directions = visible[k].reduced(&order);
            let has = |kind| {
                candidates.iter().any(|c| standard[c.column].frame == k && standard[c.column].kind == kind)
            };
            if frame.kind == JointKind::Prismatic && has(ParameterKind::Ia) && has(ParameterKind::M) {
                let moving_base = ancestors(robot, k).any(|frame| joint_of(frame).is_some());
                let by_rotor: Vec<usize> = [SPEEDS + joint, OFFSET].into_iter().chain(order).collect();
                let by_rotor = visible[k].reduced(&by_rotor);
                if rotor_takes_mass(&by_rotor, moving_base) {
                    directions = by_rotor;
                }
            }
            for (pivot, direction) in directions {
                keep_one(&mut candidates, standard, (k, joint), pivot, &direction);
            }
        }
        for candidate in &mut candidates {
            candidate.move_to_parent(&placements[k], k, frame.parent, joint);
        }
    }
    let nonzero =
        |taken: BTreeMap<usize, Form>| taken.into_iter().filter(|(_, factor)| !factor.is_zero()).collect();
    candidates.into_iter().map(|c| (c.column, nonzero(c.taken))).collect()
}

/// The frames that a frame stands on, without the base.
fn ancestors(robot: &RobotTable, frame: usize) -> impl Iterator<Item = usize> {
    std::iter::successors(robot.frames[frame].parent.checked_sub(1), |&k| {
        robot.frames[k].parent.checked_sub(1)
    })
}

/// Whether the rotor inertia of a prismatic joint is kept and the mass of its link regrouped, not the other way round: where
/// rotor and offset leave nothing of the mass to be shown by this joint, and the mass shows elsewhere, in the weight or in what
/// the joint stands on. The rotor does not: kept instead of it, the mass would put minus the rotor's inertia into parameters
/// that the rotor has no part in.
fn rotor_takes_mass(by_rotor: &[(usize, Vec<Number>)], moving_base: bool) -> bool {
    let of_mass = ParameterKind::M as usize;
    let weighs =
        |(pivot, direction): &(usize, Vec<Number>)| *pivot == OFFSET && !direction[of_mass].is_zero();
    by_rotor.iter().all(|(pivot, _)| *pivot != of_mass) && (moving_base || by_rotor.iter().any(weighs))
}

/// A standard column less kept columns: a function that does not depend on the joints done so far.
#[derive(Default)]
struct Candidate {
    /// The standard parameter.
    column: usize,
    /// Kept columns that were taken off, with their factor.
    taken: BTreeMap<usize, Form>,
    /// What is left, as the energy of bodies on frames that are not done yet.
    bodies: BTreeMap<usize, Inertia>,
    /// What is left, as dqT C dq / 2; empty where there is none.
    rotor: Vec<Vec<Number>>,
    /// Whether it is the potential off q of this joint.
    offset: Option<usize>,
}

fn candidates(
    robot: &RobotTable,
    standard: &[StandardParameter],
    joint_of: &impl Fn(usize) -> Option<usize>,
) -> Vec<Candidate> {
    let rotors = robot.drive.rotor_matrices();
    let mut candidates = Vec::new();
    for (column, parameter) in standard.iter().enumerate() {
        if robot.is_known(column) {
            continue;
        }
        let mut candidate = Candidate { column, ..Candidate::default() };
        match (parameter.kind, joint_of(parameter.frame)) {
            (ParameterKind::Ia, Some(joint)) => {
                let row = |row: &Vec<_>| row.iter().cloned().map(Number::from).collect();
                candidate.rotor = rotors[joint].iter().map(row).collect();
            }
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

impl Candidate {
    /// How much of it a visible direction of a frame and its joint shows; see [`Attainable::frame`].
    fn shown(&self, (frame, joint): (usize, usize), direction: &[Number]) -> Form {
        let mut sum = Form::zero();
        if let Some(body) = self.bodies.get(&frame) {
            for (x, &factor) in
                body.iter().zip(direction).filter(|(x, factor)| !x.is_zero() && !factor.is_zero())
            {
                sum = sum.plus(&x.scaled(factor));
            }
        }
        if self.offset == Some(joint) {
            sum = sum.plus(&Form::number(direction[OFFSET]));
        }
        if let Some(row) = self.rotor.get(joint) {
            let products = row.iter().zip(&direction[SPEEDS..]).map(|(&x, &factor)| x * factor);
            sum = sum.plus(&Form::number(products.sum()));
        }
        sum
    }

    /// Takes off `factor` times a column that is kept.
    fn take(&mut self, kept: &Candidate, factor: &Form) {
        let minus = factor.scaled(-Number::ONE);
        let mut add = |column: usize, share: &Form| {
            let taken = self.taken.entry(column).or_default();
            *taken = taken.plus(share);
        };
        add(kept.column, factor);
        kept.taken.iter().for_each(|(&column, taken)| add(column, &taken.times(&minus)));
        kept.bodies.iter().for_each(|(&frame, body)| self.add_body(frame, body, &minus));
        self.rotor.resize(self.rotor.len().max(kept.rotor.len()), Vec::new());
        for (row, other) in self.rotor.iter_mut().zip(&kept.rotor) {
            row.resize(other.len(), Number::ZERO);
            row.iter_mut().zip(other).for_each(|(x, &y)| *x = *x + y * minus.value());
        }
    }

    fn add_body(&mut self, frame: usize, body: &Inertia, factor: &Form) {
        let sum = self.bodies.entry(frame).or_default();
        for (x, y) in sum.iter_mut().zip(body) {
            *x = x.plus(&y.times(factor));
        }
    }

    /// Nothing of it depends on the frame's joint any more: what it has there stands on the parent.
    fn move_to_parent(&mut self, placement: &Placement, frame: usize, parent: usize, joint: Option<usize>) {
        let body = self.bodies.remove(&frame);
        if let (Some(body), true) = (body, parent > 0) {
            self.add_body(parent - 1, &placement.on_parent(&body), &Form::one());
        }
        let Some(joint) = joint else { return };
        if self.offset == Some(joint) {
            self.offset = None;
        }
        for (i, row) in self.rotor.iter_mut().enumerate() {
            row.iter_mut()
                .enumerate()
                .filter(|(k, _)| i == joint || *k == joint)
                .for_each(|(_, x)| *x = Number::ZERO);
        }
    }
}

/// Keeps one column that a visible direction shows, and takes it off all others until they do not show there.
///
/// First choice is the parameter of the frame or its joint that the direction's pivot stands for.
fn keep_one(
    candidates: &mut Vec<Candidate>,
    standard: &[StandardParameter],
    place: (usize, usize),
    pivot: usize,
    direction: &[Number],
) {
    let wanted = match pivot {
        0..OFFSET => ParameterKind::INERTIAL[pivot],
        OFFSET => ParameterKind::Off,
        _ => ParameterKind::Ia,
    };
    let is_wanted = |at: usize| {
        let parameter = &standard[candidates[at].column];
        parameter.frame == place.0 && parameter.kind == wanted
    };
    let shown: Vec<(usize, Form)> = (0..candidates.len())
        .map(|at| (at, candidates[at].shown(place, direction)))
        .filter(|(_, share)| !share.is_zero())
        .collect();
    let first_choice = shown.iter().find(|(at, _)| is_wanted(*at)).or(shown.first());
    let Some((kept_at, kept_share)) = first_choice.cloned() else { return };
    let kept = std::mem::take(&mut candidates[kept_at]);
    for (at, share) in shown.iter().filter(|(at, _)| *at != kept_at) {
        // The kept share is not zero, so the quotient exists.
        if let Some(factor) = share.over(&kept_share) {
            candidates[*at].take(&kept, &factor);
        }
    }
    candidates.remove(kept_at);
}
