//! Samples of a motion at which a model says nothing of a joint's torque that a push could be told from.
//!
//! Near a reversal, where a joint creeps, and where a motion begins or ends, friction, play and flexible gears come and go as a
//! push does; so do they where a rotor turns round that two joints drive, and what a joint hears of another one where that one
//! does. And a curve says nothing of values beyond those that it was fitted to.

use crate::diagnosis::rows::context::Context;
use crate::diagnosis::rows::free::beyond;
use crate::diagnosis::rows::signals::directions;
use crate::diagnosis::rules::{CREEPING, REVERSAL_LEFT_OUT, SETTLING};
use crate::effects::{Axis, EffectTerm, intervals_by_joint};
use crate::model::Robot;

/// Where a model with laws is silent.
pub(in crate::diagnosis) struct Silent {
    /// For each joint the linear forms of dq with whose sign its torque changes.
    turning: Vec<Vec<Vec<f64>>>,
    /// Variables of each joint's curves with the intervals of values that these were fitted to.
    curves: Vec<Vec<Axis>>,
}

impl Silent {
    /// Of a robot with these laws.
    pub fn of(robot: &Robot, laws: &[EffectTerm]) -> Self {
        let joints = robot.joints();
        let mut turning = directions(robot);
        for (joint, forms) in turning.iter_mut().enumerate() {
            forms.extend(laws.iter().flat_map(|law| law.turns_with(joint, joints)));
        }
        Self { turning, curves: intervals_by_joint(laws, joints) }
    }

    /// Whether it is at each sample of a motion.
    pub fn samples(&self, context: &Context<'_>, joint: usize, signal: usize) -> Vec<bool> {
        let s = &context.signals[signal];
        let reach = (REVERSAL_LEFT_OUT * s.rate) as usize;
        let mut silent = vec![false; s.len()];
        for form in &self.turning[joint] {
            let top = form.iter().zip(&context.scales).map(|(factor, scale)| factor.abs() * scale.speed);
            let creeping = CREEPING * top.sum::<f64>();
            let speed: Vec<f64> = (0..s.len())
                .map(|t| form.iter().zip(&s.dq).map(|(factor, dq)| factor * dq[t]).sum())
                .collect();
            let turns = near_reversals(&speed, reach);
            let samples = silent.iter_mut().zip(turns.iter().zip(&speed));
            samples.for_each(|(silent, (turns, speed))| *silent |= *turns || speed.abs() < creeping);
        }
        let beyond = beyond(context, signal, &self.curves[joint]);
        silent.iter_mut().zip(beyond).for_each(|(silent, beyond)| *silent |= beyond);
        let settling = ((SETTLING * s.rate) as usize + s.edge_samples).min(silent.len());
        silent[..settling].fill(true);
        let end = silent.len() - settling;
        silent[end..].fill(true);
        silent
    }
}

/// Whether a speed changes its sign within so many samples of each.
fn near_reversals(dq: &[f64], reach: usize) -> Vec<bool> {
    let mut near = vec![false; dq.len()];
    for t in (1..dq.len()).filter(|&t| dq[t] * dq[t - 1] <= 0.0) {
        near[t.saturating_sub(reach)..(t + reach).min(dq.len())].fill(true);
    }
    near
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn samples_around_a_change_of_sign_are_near_a_reversal() {
        let dq: Vec<f64> = (0..20).map(|k| f64::from(k) - 9.5).collect();
        let near = near_reversals(&dq, 3);
        assert_eq!((0..20).filter(|&k| near[k]).collect::<Vec<_>>(), vec![7, 8, 9, 10, 11, 12]);
        assert!(near_reversals(&[1.0; 9], 3).iter().all(|x| !x));
        assert!(near_reversals(&[], 3).is_empty());
    }
}
