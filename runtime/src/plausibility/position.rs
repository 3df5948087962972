//! A torque over a joint's own position that no rigid robot has: a spring, a balancer, a cable, a magnet. It is nothing
//! that is wrong with the recording.

use std::ops::Range;

use super::judged::{Judged, free_estimate};
use crate::estimation::observe::{EquationFactor, Equations, ExtraColumns, Observation, observe};
use crate::estimation::{physical_fit, residual_norm};
use crate::model::JointIndex;
use crate::signal::Motion;

/// Powers of the position: a line is a spring, a cube bends it as stops and levers do. The constant is the model's.
const POWERS: usize = 3;

/// The powers of the positions of some joints, of motions whose range is scaled to -1 to 1.
struct Powers {
    names: Vec<String>,
    columns: Vec<Vec<usize>>,
    /// Middle of each joint's range, and half of its length.
    ranges: Vec<(f64, f64)>,
}

impl Powers {
    fn of(joints: &[JointIndex], motions: &[Motion], unknowns: usize, all: usize) -> Powers {
        let (mut names, mut columns) = (Vec::new(), vec![Vec::new(); all]);
        for &JointIndex(joint) in joints {
            for power in 1..=POWERS {
                columns[joint].push(unknowns + names.len());
                names.push(format!("power {power} of the position of joint {joint}"));
            }
        }
        let range = |joint: usize| {
            let all = motions.iter().flat_map(|m| &m.q[joint]);
            let (low, high) =
                all.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &q| (low.min(q), high.max(q)));
            ((low + high) / 2.0, ((high - low) / 2.0).max(f64::MIN_POSITIVE))
        };
        Powers { names, columns, ranges: (0..all).map(range).collect() }
    }
}

impl ExtraColumns for Powers {
    fn names(&self) -> &[String] {
        &self.names
    }

    fn columns(&self, joint: usize) -> &[usize] {
        &self.columns[joint]
    }

    fn fill(
        &self,
        _: usize,
        motion: &Motion,
        range: Range<usize>,
        joint: usize,
        stride: usize,
        out: &mut [f64],
    ) {
        let (middle, half) = self.ranges[joint];
        for c in 0..self.columns[joint].len() {
            for (x, q) in out[c * stride..].iter_mut().zip(&motion.q[joint][range.clone()]) {
                *x = ((q - middle) / half).powi(c as i32 + 1);
            }
        }
    }
}

/// Relative error of each joint, and of all together, with the best parameters that a robot can have and a torque over their
/// own position on `joints`; `None` where there is no such fit.
pub(super) fn with_torques_over_position(
    judged: &Judged<'_>,
    joints: &[JointIndex],
) -> Option<(Vec<f64>, f64)> {
    let robot = judged.model.robot();
    let powers = Powers::of(joints, judged.motions, robot.base.len(), robot.joints());
    let observed =
        observe(judged.model, judged.motions, Equations::Torque, Some(&powers), judged.settings, None)
            .ok()?;
    let torques = squares(&observed, robot.joints(), |group| group.factor.norm_y());
    let beyond = beyond_powers(observed, robot.base.len());
    let fit = physical_fit(robot, &beyond, &free_estimate(&beyond))?;
    let left = squares(&beyond, robot.joints(), |group| residual_norm(group, &fit.chi));
    let error = |left: f64, all: f64| if all > 0.0 { (left / all).sqrt() } else { 0.0 };
    let of_joints = left.iter().zip(&torques).map(|(left, all)| error(*left, *all)).collect();
    Some((of_joints, error(left.iter().sum(), torques.iter().sum())))
}

/// Sum of the squares of a norm of each joint's groups.
fn squares(observed: &Observation, joints: usize, norm: impl Fn(&EquationFactor) -> f64) -> Vec<f64> {
    let mut all = vec![0.0; joints];
    for group in &observed.groups {
        all[group.equation] += norm(group).powi(2);
    }
    all
}

/// What unknowns beyond the base parameters leave of the rows, in each motion by themselves (Frisch, Waugh and Lovell).
fn beyond_powers(mut observed: Observation, base: usize) -> Observation {
    for group in observed.groups.iter_mut().chain(observed.blocks.iter_mut().flat_map(|b| &mut b.equations)) {
        let (own, extra): (Vec<usize>, Vec<usize>) =
            (0..group.columns.len()).partition(|&c| group.columns[c] < base);
        if !extra.is_empty() {
            let order: Vec<usize> = extra.iter().chain(&own).copied().collect();
            group.factor = group.factor.select(&order).beyond(extra.len());
            group.columns = own.iter().map(|&c| group.columns[c]).collect();
            group.reversals.clear();
        }
    }
    observed.unknowns.truncate(base);
    observed.exact.truncate(base);
    observed.noise_of_columns = None;
    observed
}
